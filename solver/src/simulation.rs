//! A scene made ready to run: steps, samples, pictures, and the watch over its numbers.

use crate::energy::Sample;
use crate::error::Breakdown;
use crate::fracture::NotConverged;
use crate::lane::LANES;
use crate::phase_field::PhaseFieldCounts;
use crate::picture::Picture;
use crate::scene::Scene;
use crate::time_plan::TimePlan;
use crate::total_frame::TotalFrame;

/// Elastic energy beyond this many times all energy that ever came in counts as numerical growth.
const GROWTH_LIMIT: f64 = 10.0;

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

/// A running scene.
#[derive(Debug)]
pub struct Simulation {
    frame: TotalFrame,
    plan: TimePlan,
    warnings: Vec<String>,
    steps: usize,
    initial: f64,
    energy_in: f64,
}

impl Simulation {
    /// Prepares a valid scene (see [`crate::validate::validate`]).
    ///
    /// # Errors
    /// If the initial phase field does not converge.
    pub fn new(scene: &Scene) -> Result<Self, Breakdown> {
        let origin = scene.mesh.origin();
        let frame = TotalFrame::new(scene).map_err(|failure| not_converged(0, 0.0, origin, failure))?;
        let (plan, warnings) = TimePlan::new(&scene.analysis, &scene.output, frame.critical_step());
        let start = frame.sample(plan.step);
        let initial = start.stored();
        let energy_in = start.kinetic + start.elastic;
        Ok(Self { frame, plan, warnings, steps: 0, initial, energy_in })
    }

    /// Steps and samples.
    pub fn plan(&self) -> &TimePlan {
        &self.plan
    }

    /// Warnings found in preparation.
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

    /// The body, for verification.
    pub fn frame(&self) -> &TotalFrame {
        &self.frame
    }

    /// Takes one step.
    ///
    /// # Errors
    /// If the numbers break: not finite, growing without a source, or a solve that does not converge.
    pub fn step(&mut self) -> Result<(), Breakdown> {
        self.steps += 1;
        let result = self.frame.step(self.plan.step);
        let time = self.steps as f64 * self.plan.step;
        let healthy = self.is_healthy();
        match result {
            Ok(()) if healthy => Ok(()),
            Err(failure) if healthy => Err(not_converged(self.steps, time, self.fastest_place(), failure)),
            _ => Err(self.unstable(time)),
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
        Ok(self.sample())
    }

    /// Energies, momenta and crack tip now, with closure.
    pub fn sample(&self) -> Sample {
        let mut sample = self.frame.sample(self.plan.step);
        sample.time = self.steps as f64 * self.plan.step;
        sample.close(self.initial);
        sample
    }

    /// Phase-field counters; all zero where none is modelled.
    pub fn phase_field_counts(&self) -> PhaseFieldCounts {
        self.frame.fracture.as_ref().map(|f| f.field.counts()).unwrap_or_default()
    }

    /// What is modelled and how large it is.
    pub fn extent(&self) -> Extent {
        let mut models = vec!["momentum".to_string()];
        if self.frame.fracture.is_some() {
            models.push("phase field".to_string());
        }
        let [mechanics_bytes, phase_field_bytes] = self.frame.bytes();
        Extent {
            models,
            particles: self.frame.lattice().count(),
            control_points: self.frame.mass().iter().filter(|m| **m > 0.0).count(),
            mechanics_bytes,
            phase_field_bytes,
        }
    }

    /// Fields on a raster of `pixels` over the patch.
    pub fn picture(&self, pixels: [usize; 2]) -> Picture {
        Picture::of(&self.frame, self.steps as f64 * self.plan.step, pixels)
    }

    fn is_healthy(&mut self) -> bool {
        let (elastic, work) = (self.frame.elastic_energy(), self.frame.external_work().abs());
        self.energy_in = self.energy_in.max(work + self.initial.abs());
        elastic.is_finite() && elastic <= GROWTH_LIMIT * self.energy_in
    }

    /// Greville point of the fastest control point, m.
    fn fastest_place(&self) -> [f64; 2] {
        let frame = &self.frame;
        let [vx, vy] = frame.velocity();
        let grid = frame.lattice().grid;
        let speed = |at: &usize| {
            let speed = vx[*at].hypot(vy[*at]);
            if speed.is_nan() { f64::INFINITY } else { speed }
        };
        let fastest = grid.indices().max_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap_or(0);
        let [x, y] = [0, 1].map(|d| frame.patch().spaces[d].greville());
        [x[grid.column_of(fastest)], y[grid.row_of(fastest)]]
    }

    fn unstable(&self, time: f64) -> Breakdown {
        let elastic = self.frame.elastic_energy();
        let what = if elastic.is_finite() {
            format!("elastic energy {elastic:.3e} J exceeds {GROWTH_LIMIT} times all energy put in")
        } else {
            "the elastic energy is not a number".to_string()
        };
        let ratio = self.plan.step / self.plan.critical;
        let cause = if ratio > 1.0 {
            format!(
                "the time step {:.4e} s is {ratio:.3} times the critical step {:.4e} s; use time_step = \"auto\"",
                self.plan.step, self.plan.critical
            )
        } else {
            "the time step is below the critical one of the undamaged body; look for extreme loads or velocities, \
             and halve the safety factor"
                .to_string()
        };
        Breakdown { step: self.steps, time, place: self.fastest_place(), what, cause }
    }
}

fn not_converged(step: usize, time: f64, place: [f64; 2], failure: NotConverged) -> Breakdown {
    Breakdown {
        step,
        time,
        place,
        what: format!(
            "the phase-field solve stopped after {} iterations at a relative residual of {:.3e}",
            failure.iterations, failure.relative_residual
        ),
        cause: "solver.phase_field_tolerance is tighter than round-off allows for this length scale and mesh; \
                raise it, or try phase_field_solver = \"cholesky\""
            .to_string(),
    }
}

/// Pixels of a picture of a patch: square ones, at most `most` along the longer side.
pub fn square_pixels(size: [f64; 2], most: usize) -> [usize; 2] {
    let pixel = size[0].max(size[1]) / most as f64;
    size.map(|s| ((s / pixel).round() as usize).clamp(1, most.max(LANES)))
}
