//! The watch over the numbers of a run, and what is said when they break.

use super::Simulation;
use super::breakdown::{cause, numbers};
use super::frame::{Bodies, either};
use crate::contact::ContactSolver;
use crate::contact::impulse::Unconverged;
use crate::contact::motion::NotFollowed;
use crate::dynamics::energy::Sample;
use crate::dynamics::failure::Failure;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::extremes::{larger, smaller};
use crate::output::inspection::{Inspection, InvertedPoint};
use crate::simulation::breakdown::Breakdown;

/// Elastic energy beyond this many times all energy that ever came in counts as numerical growth.
const GROWTH_LIMIT: f64 = 10.0;

/// A ledger open by more than this fraction of the energy that came in is worth a warning, and with a time
/// step above the critical one the end of the run: damage eats an unstable mode before its elastic energy
/// grows.
const CLOSURE_LIMIT: f64 = 0.02;
/// Closure below this fraction of the stored energy, or of its largest term, is round-off and tolerance of
/// the phase field.
const CLOSURE_FLOOR: f64 = 1e-6;

/// Parts of a step beyond which the critical step has collapsed.
const MOST_PARTS: f64 = 64.0;

/// Part of the largest energy of a run that transfers, or contact without friction, may take without a word.
const LOSS_LIMIT: f64 = 0.05;
/// Energy besides that of the mean motion that counts as none, of the largest energy.
const LEAST_BESIDE: f64 = 1e-6;

/// Angle that material may turn by with small strains, rad, and strain that it may have. In the total frame
/// they take the angle for a strain of 0.5 %, and in the updated frame stresses do not turn with the
/// material. Energies at this strain are a tenth off.
const SMALL: f64 = 0.1;

/// Increase of a control value of c by a solve after steps without one that is worth a warning: twice what
/// the automatic interval lets c change by.
const HEALING_LIMIT: f64 = 0.1;

/// Steps between two looks at the deformation of a body in the total frame, each a third of a step's work.
const STEPS_BETWEEN_LOOKS: usize = 64;

impl Simulation {
    /// State of the worst points and extremes now: for looking at a run that broke down.
    pub fn inspect(&self) -> Inspection {
        let fastest = either!(&self.frame, body => body.fastest_control_point());
        Inspection::new(fastest, |f| self.for_each_point(f))
    }

    /// The step just taken was `result`; in the updated frame the critical step is taken again where points
    /// moved.
    pub(super) fn judge(&mut self, result: Result<(), Failure>) -> Result<(), Breakdown> {
        let healthy = self.is_healthy();
        match result {
            Ok(()) if healthy => {
                self.watch_critical_step();
                self.watch_boundary();
                Ok(())
            }
            Err(failure) if healthy => {
                self.tell_open_ledger();
                Err(self.broken(failure))
            }
            _ => {
                self.tell_open_ledger();
                Err(self.unstable())
            }
        }
    }

    /// Keeps an automatic step of moving bodies below the critical one at their positions, by parts of it;
    /// warns once if any other step exceeds that.
    fn watch_critical_step(&mut self) {
        if self.warned.step {
            return;
        }
        let (step, look) = (self.plan.step, self.steps.is_multiple_of(STEPS_BETWEEN_LOOKS));
        let critical = match &mut self.frame {
            Bodies::Updated(frame) => frame.retake_critical_step(),
            Bodies::Total(frame) if look => frame.retake_critical_step(step, self.plan.critical),
            Bodies::Total(_) => None,
        };
        if let (Some(spare), Some(critical), Bodies::Updated(_)) = (self.spare, critical, &self.frame) {
            let parts = (step / (spare * critical)).ceil();
            if parts <= MOST_PARTS {
                self.parts = larger(parts, 1.0) as usize;
                return;
            }
        }
        let Some(critical) = critical.filter(|critical| step > *critical) else { return };
        self.warned.step = true;
        self.warnings.push(format!(
            "from t = {:.4e} s on, the time step {step:.4e} s is {:.3} times the critical step {critical:.4e} s at the \
             moved positions; lower analysis.safety or the time step",
            self.time(),
            step / critical
        ));
    }

    /// Warns once if the boundary of a body has lost its material somewhere.
    fn watch_boundary(&mut self) {
        if self.warned.boundary {
            return;
        }
        let Some([x, y]) = self.updated_frame().and_then(|frame| frame.opened_boundary()) else { return };
        self.warned.boundary = true;
        self.warnings.push(format!(
            "from t = {:.4e} s on, the boundary of a body is open near ({x:.6e}, {y:.6e}) m: its material there is gone, and \
             what comes to light inside has no boundary: other bodies can enter; end earlier, or refine the mesh",
            self.time()
        ));
    }

    fn watch_distortion(&mut self) {
        if self.warned.distortion {
            return;
        }
        let Some(([x, y], distortion)) = either!(&self.frame, body => body.distorted_beyond(SMALL)) else { return };
        self.warned.distortion = true;
        self.warnings.push(format!(
            "at t = {:.4e} s material near ({x:.6e}, {y:.6e}) m {distortion}: small strains hold up to {SMALL} rad and \
             strains of {:.0} %; use analysis.kinematics = \"finite\"",
            self.time(),
            100.0 * SMALL
        ));
    }

    /// Warns once if a solve took back much of what steps without one had carried on.
    fn watch_healing(&mut self) {
        let fracture = self.total_frame().and_then(|frame| frame.fracture.as_ref());
        let Some(healing) = fracture.and_then(|fracture| fracture.field.healing()) else { return };
        if self.warned.healing || healing <= HEALING_LIMIT {
            return;
        }
        self.warned.healing = true;
        self.warnings.push(format!(
            "by t = {:.4e} s a solve raised the phase field by {healing:.2} where steps without a solve had carried its \
             decrease on too far; lower solver.phase_field_interval",
            self.time()
        ));
    }

    /// Warns at the end of what the transfers and contact took or gave, if that is much beside the energy
    /// that is not of the motion as one rigid body.
    fn watch_losses(&mut self, sample: &Sample) {
        if !self.finished() {
            return;
        }
        let rigid = self.updated_frame().map_or(0.0, |frame| frame.rigid_energy(sample));
        let fracture = sample.fracture.as_ref().map_or(0.0, |fracture| fracture.energy);
        let friction = sample.contact.map_or(0.0, |contact| contact.friction);
        let beside = [sample.kinetic - rigid, sample.elastic, fracture, friction, self.energy_in - rigid];
        let least = LEAST_BESIDE * larger(self.energy_in, sample.largest_term());
        let largest = beside.into_iter().fold(least, larger);
        let by_contact = sample.contact.map_or(0.0, |contact| contact.loss - friction);
        let damped = "motion that varies over one or two spans is damped, and so are stresses where points cross spans; use \
                      frame = \"total\" and kinematics = \"finite\", or compare meshes";
        let grows = "this is unstable; lower analysis.safety, or use degree 2 or more and more particles_per_cell";
        let soft = self.updated_frame().is_none_or(|frame| frame.contact.as_ref().is_some_and(ContactSolver::is_soft));
        let contact = match (soft, self.updated_frame().is_some()) {
            (true, false) => ("overlaps of boundaries", "hold", "contact is soft; raise contact.stiffness"),
            (true, true) => {
                let remedy = "bodies that lie on each other need a larger contact.stiffness, and those that land on a \
                              corner smaller cells or frame = \"total\"";
                ("overlaps of boundaries", "hold or took", remedy)
            }
            (false, _) => {
                let remedy = "an impact of rigid boundaries takes the energy of a span; use contact.stiffness = 0.5, \
                              which lets boundaries overlap, frame = \"total\", or compare meshes";
                ("contact without friction", "took", remedy)
            }
        };
        let spins = self.updated_frame().is_none_or(|frame| frame.keeps_spin());
        let unspun = "flip, pic and xpic brake bodies that turn; use analysis.transfer = \"apic\", the default";
        let transfers = ("transfers between points and grid", "took", if spins { damped } else { unspun });
        let by_transfers = sample.transfer_loss.unwrap_or(0.0);
        // Transfers smooth what soft boundaries push: what contact gives these take, and the sum counts.
        let given = if soft && sample.transfer_loss.is_some() { smaller(by_contact, 0.0) } else { 0.0 };
        let (by_transfers, by_contact) = (by_transfers + given, by_contact - given);
        for ((who, does, remedy), column, loss) in
            [(transfers, "transfer_loss_j", by_transfers), (contact, "contact_loss_j less friction_j", by_contact)]
        {
            let (does, remedy) = if loss < 0.0 { ("gave", grows) } else { (does, remedy) };
            if loss.abs() > LOSS_LIMIT * largest {
                let part = 100.0 * loss.abs() / largest;
                self.warnings.push(format!(
                    "{who} {does} {:.3e} J ({column}), {part:.0} % of the largest energy of the run besides that of the motion \
                     as one rigid body: {remedy}",
                    loss.abs()
                ));
            }
        }
    }

    /// A point whose numbers are not finite makes the sum over all points so, which no fold or comparison on
    /// the way loses.
    fn is_healthy(&mut self) -> bool {
        let (elastic, work) = either!(&self.frame, body => (body.elastic_energy(), body.external_work().abs()));
        self.energy_in = larger(self.energy_in, work);
        elastic.is_finite()
            && self.energy_in.is_finite()
            && elastic <= GROWTH_LIMIT * (self.energy_in + self.initial.abs())
    }

    /// Holds a sample to its ledger: an open one is a warning at the end, and a breakdown if the step is
    /// above the critical one. Warns once of material that is distorted too far for small strains.
    ///
    /// # Errors
    /// If a number of the sample is not finite, or the ledger is open and the time step is too long to be
    /// stable, or the impulses of contact in the sample did not converge.
    pub fn watch_ledger(&mut self, sample: &Sample) -> Result<(), Breakdown> {
        self.watch_distortion();
        self.watch_healing();
        self.watch_losses(sample);
        let held = self.hold_to_ledger(sample);
        self.failed |= held.is_err();
        if self.finished() || held.is_err() {
            self.tell_open_ledger();
        }
        held
    }

    /// Warns of the ledger where it was open widest, if that is much of all energy: where a run ends.
    fn tell_open_ledger(&mut self) {
        if let Some([time, open]) = self.warned.open.take()
            && open.abs() > CLOSURE_LIMIT * self.energy_in
        {
            self.warnings.push(format!(
                "at t = {time:.4e} s the energy ledger is open by {open:.3e} J of {:.3e} J put in by the end: the time step \
                 is long for contact or for the work of stress (lower analysis.safety; 0.2 leaves about a sixteenth of \
                 it), or, with contact.self_contact, a part that went half a span deep into another was let go (take \
                 shorter spans)",
                self.energy_in
            ));
        }
    }

    fn hold_to_ledger(&mut self, sample: &Sample) -> Result<(), Breakdown> {
        if let Some(name) = sample.not_finite() {
            return Err(self.at_worst_point(&format!("{name} of the history is not a finite number"), None));
        }
        if let Some(frame) = self.updated_frame() {
            frame.contact_converges(self.part_of_step()).map_err(|found| self.broken(Failure::Unconverged(found)))?;
        }
        let Sample { closure, time, .. } = *sample;
        let limit =
            CLOSURE_LIMIT * self.energy_in + CLOSURE_FLOOR * larger(sample.stored().abs(), sample.largest_term());
        if closure.abs() > limit {
            if self.warned.step {
                let so_far = self.energy_in;
                let what = format!("the energy ledger is open by {closure:.3e} J of {so_far:.3e} J put in so far");
                return Err(self.at_worst_point(&what, None));
            }
            if self.warned.open.is_none_or(|[_, widest]| closure.abs() > widest.abs()) {
                self.warned.open = Some([time, closure]);
            }
        }
        Ok(())
    }

    fn unstable(&self) -> Breakdown {
        let elastic = either!(&self.frame, body => body.elastic_energy());
        if !elastic.is_finite() {
            return self.not_finite("numbers are not finite: the elastic energy is none");
        }
        if !self.energy_in.is_finite() {
            return self.not_finite("numbers are not finite: the work of the loads is none");
        }
        let what = format!("elastic energy {elastic:.3e} J exceeds {GROWTH_LIMIT} times all energy put in");
        self.at_worst_point(&what, None)
    }

    /// Numbers that are not finite: because a point is inverted, which has no strain, or for another reason.
    fn not_finite(&self, what: &str) -> Breakdown {
        let inverted = either!(&self.frame, body => body.inverted_point());
        let Some(InvertedPoint { point, position, determinant }) = inverted else {
            return self.at_worst_point(what, None);
        };
        let what = format!("a material point is inverted, det F = {determinant:.4e}");
        let cause = "the body is turned inside out there: look for extreme loads or velocities, refine the mesh there, or \
                     halve the safety factor";
        Breakdown { point: Some(point), ..self.at(position, what, Some(cause)) }
    }

    /// A step that could not be taken though the elastic energy of the last one that could is well.
    fn broken(&self, failure: Failure) -> Breakdown {
        let (what, cause) = (failure.to_string(), cause(failure, self.tolerance));
        match failure {
            Failure::Left(place) if !place.iter().all(|x| x.is_finite()) => {
                self.not_finite("the position of a point is not a number")
            }
            Failure::Left(place) if self.is_far_outside(place) => {
                let what = "a point was thrown out of the mesh, further than the mesh is wide, in one step";
                self.at_worst_point(what, None)
            }
            Failure::Left(place) if self.is_on_mesh(place) => {
                let what = "a load or condition acts where there is no material any more";
                let cause = "it has torn off or left behind the points under it; lower or ramp it, end earlier, or use \
                             frame = \"total\"";
                self.at(place, what, Some(cause))
            }
            Failure::PhaseField(SolveFailure::NotFinite) => self.not_finite(&what),
            Failure::Unconverged(found) if !found.residual.is_finite() => {
                self.not_finite("the impulses of contact ran into numbers that are not finite")
            }
            Failure::Left(place)
            | Failure::Unconverged(Unconverged { place, .. })
            | Failure::NotFollowed(NotFollowed::TooFast { place, .. } | NotFollowed::TooDeep { place, .. }) => {
                self.at(place, what, Some(cause))
            }
            _ => self.at_worst_point(&what, Some(cause)),
        }
    }

    /// A breakdown at a place (m); without a cause of its own it is growth. A time step that is too long is
    /// named beside other causes, not in their place.
    fn at(&self, place: [f64; 2], what: impl Into<String>, cause: Option<&str>) -> Breakdown {
        let cause = match cause {
            None => self.cause_of_growth(),
            Some(cause) if self.step_is_too_long() => format!("{cause}; besides, {}", self.cause_of_growth()),
            Some(cause) => cause.to_string(),
        };
        let (step, time) = (self.steps, self.time());
        Breakdown { step, time, place, point: None, what: what.into(), cause, scene: None }
    }

    /// A breakdown at the point whose numbers are worst, which are added to what happened.
    fn at_worst_point(&self, what: &str, cause: Option<&str>) -> Breakdown {
        let inspection = self.inspect();
        let worst = inspection.worst.first().filter(|point| point.position.iter().all(|x| x.is_finite()));
        let what = worst.map_or(what.to_string(), |point| format!("{what}; {} there", numbers(point)));
        let place = worst.map_or(inspection.fastest.0, |point| point.position);
        Breakdown { point: worst.map(|point| point.point), ..self.at(place, what, cause) }
    }

    /// Whether a position is on the mesh of the bodies that move through it.
    fn is_on_mesh(&self, place: [f64; 2]) -> bool {
        self.updated_frame().is_some_and(|frame| frame.patch.locate(place).is_some())
    }

    /// Whether a position is further out of the mesh than that is wide.
    fn is_far_outside(&self, place: [f64; 2]) -> bool {
        let Some(frame) = self.updated_frame() else { return false };
        let (low, high) = frame.patch.bounding_box();
        (0..2).any(|d| (low[d] - place[d]).max(place[d] - high[d]) > high[d] - low[d])
    }

    fn step_is_too_long(&self) -> bool {
        self.warned.step || self.plan.step > self.plan.critical
    }

    fn cause_of_growth(&self) -> String {
        let ratio = self.plan.step / self.plan.critical;
        if ratio > 1.0 {
            format!(
                "the time step {:.4e} s is {ratio:.3} times the critical step {:.4e} s; use time_step = \"auto\"",
                self.plan.step, self.plan.critical
            )
        } else if self.warned.step {
            "the time step exceeds the critical one at the moved positions; lower analysis.safety".to_string()
        } else {
            "loads or velocities may be extreme: check their values and units; if they are right, halve analysis.safety \
             (the time step is below the critical one of the undamaged body)"
                .to_string()
        }
    }
}
