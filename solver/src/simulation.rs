//! A scene made ready to run: steps, samples, pictures, and the watch over its numbers.

pub mod breakdown;
mod frame;
pub mod state;
mod watch;

use serde::{Deserialize, Serialize};

use crate::contact::impulse::ContactForce;
use crate::dynamics::energy::Sample;
use crate::dynamics::failure::Failure;
use crate::dynamics::time_plan::TimePlan;
use crate::dynamics::total_frame::TotalFrame;
use crate::dynamics::updated_frame::UpdatedFrame;
use crate::linear_algebra::lane::LANES;
use crate::output::inspection::PointState;
use crate::output::picture::{Picture, Raster};
use crate::output::span_grid::SpanGrid;
use crate::phase_field::PhaseFieldCounts;
use crate::scene::{Scene, TimeStep};
use crate::simulation::breakdown::Breakdown;
use frame::{Bodies, either};

/// What a run models and how large it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// What is modelled: `momentum`, `phase field`, ….
    pub models: Vec<String>,
    /// Number of material points of all bodies that deform.
    pub particles: usize,
    /// Control points with mass.
    pub control_points: usize,
    /// Heap memory of mechanics, bytes.
    pub mechanics_bytes: usize,
    /// Heap memory of the phase field, bytes; zero without one.
    pub phase_field_bytes: usize,
}

/// Least and largest part of the critical step at the moved positions that an automatic step may be: longer
/// ones take energy from compressed bodies. That is taken again where points have moved a quarter of a span.
const SPARE: [f64; 2] = [0.801, 0.95];
/// By how much that part is above the safety of a scene: the first step is as long as that.
const ABOVE: f64 = 1.001;

/// A scene during its run: its bodies at the present step, the plan of the steps, and the warnings so far.
#[derive(Debug)]
pub struct Simulation {
    frame: Bodies,
    plan: TimePlan,
    /// Equal parts in which a planned step is taken, so that it stays below the critical one.
    parts: usize,
    /// Part of the critical step at the moved positions that a step may be, if the scene leaves the time step
    /// to the program.
    spare: Option<f64>,
    warnings: Vec<String>,
    steps: usize,
    /// Stored energy at t = 0, with what contact holds of bodies that overlap, J.
    initial: f64,
    /// Kinetic and elastic energy and that of contact at t = 0 and the largest external work since, J.
    energy_in: f64,
    warned: Warned,
    /// Whether a step failed: what it left is half a step.
    failed: bool,
    /// Error that phase-field solves are to reach.
    tolerance: f64,
}

/// What a run has warned of: each is told once.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Warned {
    step: bool,
    /// Time, s, and what the ledger was open by then, J, where that was widest and too wide for the energy
    /// put in until then. Told at the end, if it is too wide for all of the energy.
    open: Option<[f64; 2]>,
    boundary: bool,
    distortion: bool,
    healing: bool,
}

impl Simulation {
    /// Prepares a valid scene (see [`crate::validate::validate`]).
    ///
    /// # Errors
    /// If the initial phase field does not converge, the mass matrix is singular to round-off, or the
    /// critical step is no number.
    pub fn new(scene: &Scene) -> Result<Self, Breakdown> {
        let tolerance = scene.solver.phase_field_tolerance;
        let not_started = |failure| breakdown::not_started(scene.mesh.origin(), tolerance, failure);
        let mut frame = Bodies::new(scene).map_err(not_started)?;
        let critical = either!(&frame, body => body.critical_step());
        if critical.is_nan() {
            return Err(not_started(Failure::NoStep));
        }
        let (plan, mut warnings) = TimePlan::new(scene, critical);
        if let Bodies::Total(bodies) = &frame {
            warnings.extend(bodies.idle_slits(scene));
        }
        frame.prepare(plan.step).map_err(not_started)?;
        let start = either!(&frame, body => body.sample(plan.step));
        let held = start.contact.map_or(0.0, |contact| contact.loss); // by bodies that overlap
        let (initial, energy_in) = (start.stored() + held, start.kinetic + start.elastic + held);
        let warned = Warned { step: plan.step > critical, ..Warned::default() };
        let is_automatic = scene.analysis.time_step == TimeStep::Auto;
        let spare = is_automatic.then(|| (ABOVE * scene.analysis.safety).clamp(SPARE[0], SPARE[1]));
        let (parts, steps, failed) = (1, 0, false);
        Ok(Self { frame, plan, parts, spare, warnings, steps, initial, energy_in, warned, failed, tolerance })
    }

    /// Planned time steps and samples of the run.
    pub fn plan(&self) -> &TimePlan {
        &self.plan
    }

    /// Warnings found in preparation, and since.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Number of planned steps that were taken so far.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Whether every planned step is taken.
    pub fn finished(&self) -> bool {
        self.steps >= self.plan.steps()
    }

    /// The first body of a scene in the total frame, for verification.
    pub fn total_frame(&self) -> Option<&TotalFrame> {
        if let Bodies::Total(bodies) = &self.frame { bodies.bodies.first() } else { None }
    }

    /// The body of a scene in the updated frame, for verification.
    pub fn updated_frame(&self) -> Option<&UpdatedFrame> {
        if let Bodies::Updated(frame) = &self.frame { Some(frame) } else { None }
    }

    /// Takes one step.
    ///
    /// # Errors
    /// If the numbers break: not finite, growing without a source, a solve that does not converge, or a point
    /// that leaves the patch.
    pub fn step(&mut self) -> Result<(), Breakdown> {
        self.steps += 1;
        // within the pool of rayon: from outside, every parallel loop would wake it and wait for it
        let sampled = self.steps.is_multiple_of(self.plan.steps_per_sample);
        let (part, last) = (self.part_of_step(), self.parts - 1);
        let result =
            rayon::scope(|_| (0..=last).try_for_each(|number| self.frame.step(part, sampled && number == last)));
        if sampled {
            either!(&mut self.frame, body => body.note_crack_start());
        }
        self.judge(result).inspect_err(|_| self.failed = true)
    }

    /// Length of the steps that are taken now, s.
    fn part_of_step(&self) -> f64 {
        self.plan.step / self.parts as f64
    }

    /// Time since the start of the run, s.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.plan.step
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
        let mut sample = either!(&self.frame, body => body.sample(self.part_of_step()));
        sample.time = self.time();
        sample.close(self.initial);
        sample
    }

    /// Forces of contact now.
    pub fn contact_forces(&self) -> Vec<ContactForce> {
        either!(&self.frame, body => body.contact_forces(self.part_of_step()))
    }

    /// Mass (kg) and momentum (kg m/s) of every body that deforms, or fragment, with the velocities of half a
    /// step before.
    pub fn momenta(&self) -> Vec<(f64, [f64; 2])> {
        either!(&self.frame, body => body.momenta(self.part_of_step()))
    }

    /// Phase-field counters; all zero where none is modelled.
    pub fn phase_field_counts(&self) -> PhaseFieldCounts {
        either!(&self.frame, body => body.phase_field_counts()).unwrap_or_default()
    }

    /// What is modelled and how large it is.
    pub fn extent(&self) -> Extent {
        let mut models = vec!["momentum".to_string()];
        if either!(&self.frame, body => body.phase_field_counts()).is_some() {
            models.push("phase field".to_string());
        }
        if either!(&self.frame, body => body.contact.is_some()) {
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

    /// Calls `f` with the state of every material point now, body by body.
    pub fn for_each_point(&self, f: &mut dyn FnMut(PointState)) {
        either!(&self.frame, body => body.for_each_point_state(f));
    }

    /// The spans of the mesh with material points, and position, velocity and phase field at their corners
    /// now.
    pub fn span_grid(&self) -> SpanGrid {
        either!(&self.frame, body => body.span_grid())
    }

    /// Fields on a raster of `pixels` over the patch.
    pub fn picture(&self, pixels: [usize; 2]) -> Picture {
        either!(&self.frame, body => {
            let raster = Raster::new(&body.patch, pixels);
            Picture::new(raster, self.time(), body.paint(&raster))
        })
    }
}

/// Pixels of a picture of a patch: square ones, at most `most` along the longer side.
pub fn square_pixels(size: [f64; 2], most: usize) -> [usize; 2] {
    let pixel = size[0].max(size[1]) / most as f64;
    size.map(|s| ((s / pixel).round() as usize).clamp(1, most.max(LANES)))
}
