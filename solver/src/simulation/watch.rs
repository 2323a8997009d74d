//! The watch over the numbers of a run, and what is said when they break.

use super::Simulation;
use super::frame::{Frame, either};
use crate::contact::impulse::Unsettled;
use crate::contact::motion::{MOST, TooFast};
use crate::dynamics::energy::Sample;
use crate::dynamics::failure::Failure;
use crate::dynamics::loads::LostTraction;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::extremes::larger;
use crate::output::inspection::{Inspection, InvertedPoint, PointState};
use crate::scene::error::SceneError;
use crate::simulation::breakdown::Breakdown;

/// Elastic energy beyond this many times all energy that ever came in counts as numerical growth.
const GROWTH_LIMIT: f64 = 10.0;

/// A ledger open by more than this fraction of the energy that came in is worth a warning, and with a time step above the
/// critical one the end of the run: damage eats an unstable mode before its elastic energy grows.
const CLOSURE_LIMIT: f64 = 0.02;
/// Closure below this fraction of the stored energy is round-off and tolerance of the phase field.
const CLOSURE_FLOOR: f64 = 1e-6;

/// Steps between two looks at the deformation of a body in the total frame, each a third of a step's work.
const STEPS_BETWEEN_LOOKS: usize = 64;

/// An error within this factor of the tolerance when iterations ended is held up by round-off.
const NEAR_TOLERANCE: f64 = 1e3;

const RAISE_TOLERANCE: &str = "solver.phase_field_tolerance is tighter than round-off allows for this length scale and \
                               mesh; raise it, or try phase_field_solver = \"cholesky\"";
const ILL_CONDITIONED: &str = "history energies so different that iterations do not settle; look for extreme loads or \
                               seeds, or try phase_field_solver = \"cholesky\"";
const SINGULAR_MASS: &str = "weights or sizes of cells too different for the mass matrix; use mass = \"lumped\", or a mesh \
                             with weights and cells more alike";
const ENLARGE_MESH: &str = "the body moves out of the mesh; enlarge mesh.size or move mesh.origin so that it holds the \
                            whole motion, or end earlier";

const ADD_POINTS: &str = "use smaller cells or more particles_per_cell, so that a point lies inside the body";
const CARRY_TRACTION: &str = "use smaller cells or more particles_per_cell there, or let the edge follow the body";
const INSIDE_OUT: &str = "the body is turned inside out there: look for extreme loads or velocities, refine the mesh there, \
                          or halve the safety factor";
const LOST: &str = "the position of a point is not a number";
const THROWN: &str = "a point was thrown out of the mesh, further than the mesh is wide, in one step";
const NOT_FINITE: &str = "the phase-field solve ran into numbers that are not finite";
const INDEFINITE: &str = "the matrix of the phase field is not positive definite to round-off";
const TOO_FEW_POINTS: &str = "spans with fewer points than the phase field has unknowns there, or history energies many \
                              orders of magnitude apart; use more particles_per_cell or a lower degree";
const EXTREME: &str = "material constants, lengths or seeds so extreme that their products overflow";
const CONTACT_NOT_FINITE: &str = "the impulses of contact ran into numbers that are not finite";
const UNSETTLED: &str = "bodies wedged between others, or friction too large for one solution; lower contact.friction or \
                         analysis.safety, or use larger cells where they meet";
const TOO_FAST: &str = "bodies faster than contact can follow at this time step: give analysis.time_step as much less, or \
                        lower analysis.safety";
const BARE: &str = "a traction acts where there is no material any more";
const TORN: &str = "the load has torn off the points under it; lower or ramp the traction, or end earlier";

impl Simulation {
    /// State of the worst points and extremes now: for looking at a run that broke down.
    pub fn inspect(&self) -> Inspection {
        let fastest = either!(&self.frame, body => body.fastest_control_point());
        Inspection::new(fastest, |f| self.frame.for_each_point(f))
    }

    /// The step just taken was `result`; in the updated frame the critical step is taken again where points moved.
    pub(super) fn judge(&mut self, result: Result<(), Failure>) -> Result<(), Breakdown> {
        let healthy = self.is_healthy();
        match result {
            Ok(()) if healthy => {
                self.watch_critical_step();
                self.watch_boundary();
                Ok(())
            }
            Err(failure) if healthy => Err(self.broken(failure)),
            _ => Err(self.unstable()),
        }
    }

    /// Warns once if the step in use exceeds the critical one at the moved positions.
    fn watch_critical_step(&mut self) {
        if self.warned_of_step {
            return;
        }
        let (step, look) = (self.plan.step, self.steps.is_multiple_of(STEPS_BETWEEN_LOOKS));
        let critical = match &mut self.frame {
            Frame::Updated(frame) => frame.critical_step_is_due().then(|| frame.critical_step()),
            Frame::Total(frame) if look => frame.shortened_critical_step(step, self.plan.critical),
            Frame::Total(_) => None,
        };
        let Some(critical) = critical.filter(|critical| step > *critical) else { return };
        self.warned_of_step = true;
        self.warnings.push(format!(
            "from t = {:.4e} s on, the time step {step:.4e} s is {:.3} times the critical step {critical:.4e} s at the \
             moved positions; lower analysis.safety or the time step",
            self.time(),
            step / critical
        ));
    }

    /// Warns once if the boundary of a body has lost its material somewhere.
    fn watch_boundary(&mut self) {
        if self.warned_of_boundary {
            return;
        }
        let Some([x, y]) = self.updated_frame().and_then(|frame| frame.opened_boundary()) else { return };
        self.warned_of_boundary = true;
        self.warnings.push(format!(
            "from t = {:.4e} s on, the boundary of a body is open near ({x:.6e}, {y:.6e}) m: its material there is gone, and \
             what comes to light inside has no boundary: other bodies can enter; end earlier, or refine the mesh",
            self.time()
        ));
    }

    /// A point whose numbers are not finite makes the sum over all points so, which no fold or comparison on the way loses.
    fn is_healthy(&mut self) -> bool {
        let (elastic, work) = either!(&self.frame, body => (body.elastic_energy(), body.external_work().abs()));
        self.energy_in = larger(self.energy_in, work);
        elastic.is_finite()
            && self.energy_in.is_finite()
            && elastic <= GROWTH_LIMIT * (self.energy_in + self.initial.abs())
    }

    /// Holds a sample to its ledger: an open one is a warning, once, and a breakdown if the step is above the critical one.
    ///
    /// # Errors
    /// If a number of the sample is not finite, or the ledger is open and the time step is too long to be stable, or the
    /// impulses of contact in the sample did not settle.
    pub fn watch_ledger(&mut self, sample: &Sample) -> Result<(), Breakdown> {
        let held = self.hold_to_ledger(sample);
        self.failed |= held.is_err();
        held
    }

    fn hold_to_ledger(&mut self, sample: &Sample) -> Result<(), Breakdown> {
        if let Some(name) = sample.not_finite() {
            return Err(self.at_worst_point(format!("{name} of the history is not a finite number"), None));
        }
        if let Some(frame) = self.updated_frame() {
            frame.contact_settles(self.plan.step).map_err(|failure| self.broken(failure.into()))?;
        }
        let Sample { closure, time, .. } = *sample;
        let limit = CLOSURE_LIMIT * self.energy_in + CLOSURE_FLOOR * sample.stored().abs();
        if closure.abs() <= limit {
            return Ok(());
        }
        let what = format!("the energy ledger is open by {closure:.3e} J of {:.3e} J put in so far", self.energy_in);
        if self.warned_of_step {
            return Err(self.at_worst_point(what, None));
        }
        if !self.warned_of_closure {
            self.warned_of_closure = true;
            self.warnings.push(format!(
                "at t = {time:.4e} s {what}: the quadrature of the stress work is coarse; lower analysis.safety (0.2 \
                 leaves a sixteenth of it)"
            ));
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
        self.at_worst_point(what, None)
    }

    /// Numbers that are not finite: because a point is inverted, which has no strain, or for another reason.
    fn not_finite(&self, what: &str) -> Breakdown {
        let inverted = either!(&self.frame, body => body.inverted_point());
        let Some(InvertedPoint { point, position, determinant }) = inverted else {
            return self.at_worst_point(what.to_string(), None);
        };
        let what = format!("a material point is inverted, det F = {determinant:.4e}");
        let cause = if self.step_is_too_long() { self.cause_of_growth() } else { INSIDE_OUT.to_string() };
        Breakdown { step: self.steps, time: self.time(), place: position, point: Some(point), what, cause, scene: None }
    }

    /// A step that could not be taken though the elastic energy of the last one that could is well.
    fn broken(&self, failure: Failure) -> Breakdown {
        match failure {
            Failure::Left(place) if !place.iter().all(|x| x.is_finite()) => self.not_finite(LOST),
            Failure::Left(place) if self.is_far_outside(place) => self.at_worst_point(THROWN.to_string(), None),
            Failure::Left(place) => {
                let bare = self.updated_frame().is_some_and(|frame| frame.patch().locate(place).is_some());
                let torn = (BARE.to_string(), TORN.to_string());
                let (what, cause) = if bare { torn } else { what_and_cause(failure, self.tolerance) };
                let cause = if self.step_is_too_long() { self.cause_of_growth() } else { cause };
                Breakdown { step: self.steps, time: self.time(), place, point: None, what, cause, scene: None }
            }
            Failure::PhaseField(SolveFailure::NotFinite) => self.not_finite(NOT_FINITE),
            Failure::Unsettled(found) if !found.residual.is_finite() => self.not_finite(CONTACT_NOT_FINITE),
            Failure::Unsettled(Unsettled { place, .. }) | Failure::TooFast(TooFast { place, .. }) => {
                let (what, cause) = what_and_cause(failure, self.tolerance);
                Breakdown { step: self.steps, time: self.time(), place, point: None, what, cause, scene: None }
            }
            Failure::PhaseField(_)
            | Failure::SingularMass
            | Failure::NoStep
            | Failure::NoPoints(_)
            | Failure::LostTraction { .. } => {
                let (what, cause) = what_and_cause(failure, self.tolerance);
                self.at_worst_point(what, Some(cause).filter(|_| !self.step_is_too_long()))
            }
        }
    }

    /// A breakdown at the point whose numbers are worst, which are added to what happened.
    fn at_worst_point(&self, what: String, cause: Option<String>) -> Breakdown {
        let inspection = self.inspect();
        let worst = inspection.worst.first().filter(|point| point.position.iter().all(|x| x.is_finite()));
        let what = worst.map_or(what.clone(), |point| format!("{what}; {} there", numbers(point)));
        Breakdown {
            step: self.steps,
            time: self.time(),
            place: worst.map_or(inspection.fastest.0, |point| point.position),
            point: worst.map(|point| point.point),
            what,
            cause: cause.unwrap_or_else(|| self.cause_of_growth()),
            scene: None,
        }
    }

    /// Whether a position is further out of the mesh than that is wide.
    fn is_far_outside(&self, place: [f64; 2]) -> bool {
        let Some(frame) = self.updated_frame() else { return false };
        let (low, high) = frame.patch().bounding_box();
        (0..2).any(|d| (low[d] - place[d]).max(place[d] - high[d]) > high[d] - low[d])
    }

    fn step_is_too_long(&self) -> bool {
        self.warned_of_step || self.plan.step > self.plan.critical
    }

    fn cause_of_growth(&self) -> String {
        let ratio = self.plan.step / self.plan.critical;
        if ratio > 1.0 {
            format!(
                "the time step {:.4e} s is {ratio:.3} times the critical step {:.4e} s; use time_step = \"auto\"",
                self.plan.step, self.plan.critical
            )
        } else if self.warned_of_step {
            "the time step exceeds the critical one at the moved positions; lower analysis.safety".to_string()
        } else {
            "the time step is below the critical one of the undamaged body; look for extreme loads or velocities, \
             and halve the safety factor"
                .to_string()
        }
    }
}

/// What keeps a scene from starting, near `place` (m).
pub(super) fn not_started(place: [f64; 2], tolerance: f64, failure: Failure) -> Breakdown {
    let (what, cause) = what_and_cause(failure, tolerance);
    let (place, key) = match failure {
        Failure::Left(place) | Failure::TooFast(TooFast { place, .. }) => (place, None),
        Failure::NoPoints(body) => (place, Some(format!("body.{body}.shape"))),
        Failure::LostTraction { body, traction, lost: LostTraction::Bare(place) }
        | Failure::LostTraction { body, traction, lost: LostTraction::Unbalanced { place, .. } } => {
            (place, Some(format!("body.{body}.traction.{traction}")))
        }
        Failure::PhaseField(_) | Failure::SingularMass | Failure::NoStep | Failure::Unsettled(_) => (place, None),
    };
    let scene = key.map(|key| Box::new(SceneError { key, message: what.clone(), remedy: cause.clone() }));
    Breakdown { step: 0, time: 0.0, place, point: None, what, cause, scene }
}

fn what_and_cause(failure: Failure, tolerance: f64) -> (String, String) {
    let (what, cause) = match failure {
        Failure::Left(_) => ("a point left the mesh".to_string(), ENLARGE_MESH),
        Failure::PhaseField(SolveFailure::NotConverged { iterations, error }) => (
            format!("the phase-field solve stopped after {iterations} iterations at an error of {error:.3e}"),
            if error <= NEAR_TOLERANCE * tolerance { RAISE_TOLERANCE } else { ILL_CONDITIONED },
        ),
        Failure::PhaseField(SolveFailure::NotPositiveDefinite) => (INDEFINITE.to_string(), TOO_FEW_POINTS),
        Failure::PhaseField(SolveFailure::NotFinite) => (NOT_FINITE.to_string(), EXTREME),
        Failure::Unsettled(Unsettled { rounds, residual, .. }) => (
            format!("the impulses of contact did not settle in {rounds} rounds: they still change by {residual:.3e}"),
            UNSETTLED,
        ),
        Failure::TooFast(TooFast { spans, .. }) => (
            format!(
                "bodies that are about to meet approach each other by {spans:.3} spans in a step, and contact follows \
                 {MOST}"
            ),
            TOO_FAST,
        ),
        Failure::NoStep => ("the critical time step is not a number".to_string(), EXTREME),
        Failure::SingularMass => ("the consistent mass matrix is singular to round-off".to_string(), SINGULAR_MASS),
        Failure::NoPoints(_) => ("the body holds no material point".to_string(), ADD_POINTS),
        Failure::LostTraction { lost: LostTraction::Bare([x, y]), .. } => (
            format!("there is no material point within a cell of ({x:.6e}, {y:.6e}) m, where the traction acts"),
            CARRY_TRACTION,
        ),
        Failure::LostTraction { lost: LostTraction::Unbalanced { force, moment, .. }, .. } => (
            format!(
                "the forces on the control points miss the traction by {force:.1e} of its force and {moment:.1e} of its \
                 moment"
            ),
            CARRY_TRACTION,
        ),
    };
    (what, cause.to_string())
}

/// The numbers of a point in words.
fn numbers(point: &PointState) -> String {
    let largest = |values: &[f64; 3]| {
        let magnitudes = values.iter().map(|value| if value.is_nan() { f64::INFINITY } else { value.abs() });
        let largest = magnitudes.fold(0.0, larger);
        if largest.is_finite() { format!("{largest:.3e}") } else { "not finite".to_string() }
    };
    let mut text = format!("the strain is {}", largest(&point.strain));
    if let Some(fracture) = point.fracture {
        text += &format!(", the history energy {} J/m³", largest(&[fracture.history; 3]));
    }
    text
}
