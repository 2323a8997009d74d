//! A scene made ready to run: steps, samples, pictures, and the watch over its numbers.

use crate::energy::Sample;
use crate::error::Breakdown;
use crate::fracture::NotConverged;
use crate::lane::LANES;
use crate::phase_field::PhaseFieldCounts;
use crate::picture::Picture;
use crate::scene::{self, Scene};
use crate::time_plan::TimePlan;
use crate::total_frame::TotalFrame;
use crate::updated_frame::{Failure, UpdatedFrame};

/// Elastic energy beyond this many times all energy that ever came in counts as numerical growth.
const GROWTH_LIMIT: f64 = 10.0;

/// A ledger open by more than this fraction of the energy that came in is worth a warning, and with a time step above the
/// critical one the end of the run: damage eats an unstable mode before its elastic energy grows.
const CLOSURE_LIMIT: f64 = 0.02;
/// Closure below this fraction of the stored energy is round-off and tolerance of the phase field.
const CLOSURE_FLOOR: f64 = 1e-6;

/// What a run models and how large it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// What is modelled: `momentum`, `phase field`, ….
    pub models: Vec<String>,
    /// Material points.
    pub particles: usize,
    /// Control points with mass.
    pub control_points: usize,
    /// Heap memory of mechanics, bytes.
    pub mechanics_bytes: usize,
    /// Heap memory of the phase field, bytes; zero without one.
    pub phase_field_bytes: usize,
}

/// The body in the frame of its scene.
#[derive(Debug)]
enum Frame {
    Total(Box<TotalFrame>),
    Updated(Box<UpdatedFrame>),
}

/// The same expression for either frame.
macro_rules! either {
    ($frame:expr, $body:ident => $value:expr) => {
        match $frame {
            Frame::Total($body) => $value,
            Frame::Updated($body) => $value,
        }
    };
}

impl Frame {
    fn new(scene: &Scene) -> Result<Self, Failure> {
        Ok(match scene.analysis.frame {
            scene::Frame::Total => Self::Total(Box::new(TotalFrame::new(scene)?)),
            scene::Frame::Updated => Self::Updated(Box::new(UpdatedFrame::new(scene)?)),
        })
    }

    fn step(&mut self, dt: f64) -> Result<(), Failure> {
        match self {
            Self::Total(body) => Ok(body.step(dt)?),
            Self::Updated(body) => body.step(dt),
        }
    }

    fn particles(&self) -> usize {
        match self {
            Self::Total(body) => body.lattice().count(),
            Self::Updated(frame) => frame.fields().iter().map(|field| field.points().len()).sum(),
        }
    }

    /// Control points with mass, counted for each body.
    fn control_points(&self) -> usize {
        let massive = |mass: &[f64]| mass.iter().filter(|m| **m > 0.0).count();
        match self {
            Self::Total(body) => massive(body.mass().row_sums()),
            Self::Updated(frame) => frame.fields().iter().map(|field| massive(&field.nodes().mass)).sum(),
        }
    }

    /// Position of the fastest control point, m.
    fn fastest_place(&self) -> [f64; 2] {
        either!(self, body => body.fastest_place())
    }

    fn phase_field_counts(&self) -> Option<PhaseFieldCounts> {
        match self {
            Self::Total(body) => body.fracture.as_ref().map(|f| f.field.counts()),
            Self::Updated(frame) => frame.phase_field_counts(),
        }
    }
}

/// A running scene.
#[derive(Debug)]
pub struct Simulation {
    frame: Frame,
    plan: TimePlan,
    warnings: Vec<String>,
    steps: usize,
    /// Stored energy at t = 0, J.
    initial: f64,
    /// Kinetic and elastic energy at t = 0 and the largest external work since, J.
    energy_in: f64,
    warned_of_step: bool,
    warned_of_closure: bool,
}

impl Simulation {
    /// Prepares a valid scene (see [`crate::validate::validate`]).
    ///
    /// # Errors
    /// If the initial phase field does not converge.
    pub fn new(scene: &Scene) -> Result<Self, Breakdown> {
        let origin = scene.mesh.origin();
        let frame = Frame::new(scene).map_err(|failure| breakdown(0, 0.0, origin, failure))?;
        let critical = either!(&frame, body => body.critical_step());
        let (plan, warnings) = TimePlan::new(&scene.analysis, &scene.output, critical);
        let start = either!(&frame, body => body.sample(plan.step));
        let (initial, energy_in) = (start.stored(), start.kinetic + start.elastic);
        let warned_of_step = plan.step > critical;
        Ok(Self { frame, plan, warnings, steps: 0, initial, energy_in, warned_of_step, warned_of_closure: false })
    }

    /// Steps and samples.
    pub fn plan(&self) -> &TimePlan {
        &self.plan
    }

    /// Warnings found in preparation, and since.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Steps taken.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Whether every planned step is taken.
    pub fn finished(&self) -> bool {
        self.steps >= self.plan.steps()
    }

    /// The body of a scene in the total frame, for verification.
    pub fn total_frame(&self) -> Option<&TotalFrame> {
        if let Frame::Total(frame) = &self.frame { Some(frame) } else { None }
    }

    /// The body of a scene in the updated frame, for verification.
    pub fn updated_frame(&self) -> Option<&UpdatedFrame> {
        if let Frame::Updated(frame) = &self.frame { Some(frame) } else { None }
    }

    /// Takes one step.
    ///
    /// # Errors
    /// If the numbers break: not finite, growing without a source, a solve that does not converge, or a point that leaves
    /// the patch.
    pub fn step(&mut self) -> Result<(), Breakdown> {
        self.steps += 1;
        let result = self.frame.step(self.plan.step);
        let time = self.steps as f64 * self.plan.step;
        let healthy = self.is_healthy();
        match result {
            Ok(()) if healthy => {
                self.watch_critical_step(time);
                Ok(())
            }
            Err(failure) if healthy => Err(breakdown(self.steps, time, self.frame.fastest_place(), failure)),
            _ => Err(self.unstable(time)),
        }
    }

    /// Takes the critical step again where points moved, and warns once if the step in use exceeds it.
    fn watch_critical_step(&mut self, time: f64) {
        let Frame::Updated(frame) = &mut self.frame else { return };
        if self.warned_of_step || !frame.critical_step_is_due() {
            return;
        }
        let critical = frame.critical_step();
        if self.plan.step > critical {
            self.warned_of_step = true;
            self.warnings.push(format!(
                "from t = {time:.4e} s on, the time step {:.4e} s is {:.3} times the critical step {critical:.4e} s at the \
                 moved positions; lower analysis.safety or the time step",
                self.plan.step,
                self.plan.step / critical
            ));
        }
    }

    /// Takes the steps up to the next sample.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn advance_to_next_sample(&mut self) -> Result<Sample, Breakdown> {
        for _ in 0..self.plan.steps_per_sample {
            self.step()?;
        }
        let sample = self.sample();
        self.watch_ledger(&sample)?;
        Ok(sample)
    }

    /// Energies, momenta and crack tip now, with closure.
    pub fn sample(&self) -> Sample {
        let mut sample = either!(&self.frame, body => body.sample(self.plan.step));
        sample.time = self.steps as f64 * self.plan.step;
        sample.close(self.initial);
        sample
    }

    /// Phase-field counters; all zero where none is modelled.
    pub fn phase_field_counts(&self) -> PhaseFieldCounts {
        self.frame.phase_field_counts().unwrap_or_default()
    }

    /// What is modelled and how large it is.
    pub fn extent(&self) -> Extent {
        let mut models = vec!["momentum".to_string()];
        if self.frame.phase_field_counts().is_some() {
            models.push("phase field".to_string());
        }
        if self.updated_frame().is_some_and(|frame| frame.contact().is_some()) {
            models.push("contact".to_string());
        }
        let [mechanics_bytes, phase_field_bytes] = either!(&self.frame, body => body.bytes());
        Extent {
            models,
            particles: self.frame.particles(),
            control_points: self.frame.control_points(),
            mechanics_bytes,
            phase_field_bytes,
        }
    }

    /// Fields on a raster of `pixels` over the patch.
    pub fn picture(&self, pixels: [usize; 2]) -> Picture {
        let time = self.steps as f64 * self.plan.step;
        match &self.frame {
            Frame::Total(frame) => Picture::of(frame, time, pixels),
            Frame::Updated(frame) => Picture::of_updated(frame, time, pixels),
        }
    }

    fn is_healthy(&mut self) -> bool {
        let (elastic, work) = either!(&self.frame, body => (body.elastic_energy(), body.external_work().abs()));
        self.energy_in = self.energy_in.max(work);
        elastic.is_finite() && elastic <= GROWTH_LIMIT * (self.energy_in + self.initial.abs())
    }

    /// Holds a sample to its ledger: an open one is a warning, once, and a breakdown if the step is above the critical one.
    ///
    /// # Errors
    /// If the ledger is open and the time step is too long to be stable.
    pub fn watch_ledger(&mut self, sample: &Sample) -> Result<(), Breakdown> {
        let Sample { closure, time, .. } = *sample;
        let limit = CLOSURE_LIMIT * self.energy_in + CLOSURE_FLOOR * sample.stored().abs();
        if closure.abs() <= limit {
            return Ok(());
        }
        let what = format!("the energy ledger is open by {closure:.3e} J of {:.3e} J put in so far", self.energy_in);
        if self.warned_of_step {
            let cause = self.cause_of_growth();
            return Err(Breakdown { step: self.steps, time, place: self.frame.fastest_place(), what, cause });
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

    fn unstable(&self, time: f64) -> Breakdown {
        let elastic = either!(&self.frame, body => body.elastic_energy());
        let what = if elastic.is_finite() {
            format!("elastic energy {elastic:.3e} J exceeds {GROWTH_LIMIT} times all energy put in")
        } else {
            "the elastic energy is not a number".to_string()
        };
        Breakdown { step: self.steps, time, place: self.frame.fastest_place(), what, cause: self.cause_of_growth() }
    }

    fn cause_of_growth(&self) -> String {
        let ratio = self.plan.step / self.plan.critical;
        if ratio > 1.0 {
            format!(
                "the time step {:.4e} s is {ratio:.3} times the critical step {:.4e} s; use time_step = \"auto\"",
                self.plan.step, self.plan.critical
            )
        } else if let Some([x, y]) = either!(&self.frame, body => body.inverted_place()) {
            format!(
                "the body is turned inside out at ({x:.6e}, {y:.6e}) m: look for extreme loads or velocities, refine the mesh \
                 there, or halve the safety factor"
            )
        } else {
            "the time step is below the critical one of the undamaged body; look for extreme loads or velocities, \
             and halve the safety factor"
                .to_string()
        }
    }
}

/// A step that could not be taken, near `place` (m).
fn breakdown(step: usize, time: f64, place: [f64; 2], failure: Failure) -> Breakdown {
    match failure {
        Failure::NotConverged(NotConverged { iterations, relative_residual }) => Breakdown {
            step,
            time,
            place,
            what: format!(
                "the phase-field solve stopped after {iterations} iterations at a relative residual of \
                 {relative_residual:.3e}"
            ),
            cause: "solver.phase_field_tolerance is tighter than round-off allows for this length scale and mesh; \
                    raise it, or try phase_field_solver = \"cholesky\""
                .to_string(),
        },
        Failure::Left(place) => Breakdown {
            step,
            time,
            place,
            what: "a point left the mesh".to_string(),
            cause: "the body moves out of the mesh; enlarge mesh.size or move mesh.origin so that it holds the whole \
                    motion, or end earlier"
                .to_string(),
        },
    }
}

/// Pixels of a picture of a patch: square ones, at most `most` along the longer side.
pub fn square_pixels(size: [f64; 2], most: usize) -> [usize; 2] {
    let pixel = size[0].max(size[1]) / most as f64;
    size.map(|s| ((s / pixel).round() as usize).clamp(1, most.max(LANES)))
}
