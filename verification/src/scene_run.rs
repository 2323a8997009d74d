//! A scene run to its end: history, pictures, and a summary of what it modelled and cost.
//!
//! [`run_scene`] steps a [`Simulation`], samples it at every multiple of the plan's interval, and takes each frame at
//! the nearest step. A run that breaks down keeps what was computed until then. The clock is read here and in no
//! solver module: preparation, steps, samples and pictures are timed from outside.

mod summary;
mod write;

use std::time::Instant;

use fisura::energy::Sample;
use fisura::error::Breakdown;
use fisura::picture::Picture;
use fisura::scene::Scene;
use fisura::simulation::{Simulation, square_pixels};
use fisura::validate::validate;

use crate::history::Table;

pub use summary::{BreakdownSummary, Stages, Summary};
pub use write::{OutputError, replace_file};

/// Pixels of a frame along its longer side.
pub const FRAME_PIXELS: usize = 400;

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Steps taken.
    pub step: usize,
    /// Steps in all.
    pub steps: usize,
    /// Simulated time, s.
    pub time: f64,
}

impl Progress {
    /// Part of the steps that is taken, 0 to 1.
    pub fn fraction(&self) -> f64 {
        self.step as f64 / self.steps.max(1) as f64
    }
}

/// What a run gave. After a breakdown it holds what was computed until then.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneRun {
    /// Columns of `history.csv`; no column at all if the run broke down before it started.
    pub history: Table,
    /// Pictures at the frames of the scene, in time order, each with the time of its step.
    pub frames: Vec<Picture>,
    /// What was modelled and what it cost.
    pub summary: Summary,
    /// How the run ended, if not as planned.
    pub breakdown: Option<Breakdown>,
}

/// Runs a valid scene (see [`validate`]) to its end; `progress` is called after every step.
pub fn run_scene(scene: &Scene, progress: &mut dyn FnMut(Progress)) -> SceneRun {
    let mut run = Run::new(scene);
    let breakdown = run.prepare_and_run(scene, progress).err();
    run.finish(breakdown)
}

/// Steps nearest to the frames, each once and in order, with a warning for frames that share a step.
pub fn frame_steps(times: &[f64], time_step: f64, steps: usize) -> (Vec<usize>, Vec<String>) {
    let nearest = |time: &f64| ((time / time_step).round().max(0.0) as usize).min(steps);
    let mut found: Vec<usize> = times.iter().map(nearest).collect();
    found.sort_unstable();
    found.dedup();
    let missing = times.len() - found.len();
    let warning = || format!("{missing} of {} frames fall on the step of another and are not repeated", times.len());
    let warnings = (missing > 0).then(warning).into_iter().collect();
    (found, warnings)
}

/// A run in the making.
struct Run {
    history: Table,
    frames: Vec<Picture>,
    summary: Summary,
    stages: Stages,
    start: Instant,
    largest_closure: f64,
    largest_energy: f64,
}

impl Run {
    fn new(scene: &Scene) -> Self {
        let found = validate(scene).unwrap_or_default();
        let warnings = found.iter().map(|w| format!("{}: {}", w.key, w.message)).collect();
        Self {
            history: Table::default(),
            frames: Vec::new(),
            summary: Summary { title: scene.title.clone(), warnings, ..Summary::default() },
            stages: Stages::default(),
            start: Instant::now(),
            largest_closure: 0.0,
            largest_energy: 0.0,
        }
    }

    fn prepare_and_run(&mut self, scene: &Scene, progress: &mut dyn FnMut(Progress)) -> Result<(), Breakdown> {
        let prepared = timed(&mut self.stages.preparation, || Simulation::new(scene));
        let mut simulation = prepared?;
        let plan = *simulation.plan();
        let (frames, warnings) = frame_steps(&scene.output.frames, plan.step, plan.steps());
        self.describe(&simulation);
        self.summary.warnings.extend(warnings);
        self.sample(&simulation);
        self.picture(scene, &simulation, &frames);
        progress(Progress { step: 0, steps: plan.steps(), time: 0.0 });
        while !simulation.finished() {
            timed(&mut self.stages.steps, || simulation.step())?;
            let step = simulation.steps();
            self.summary.steps = step;
            if step.is_multiple_of(plan.steps_per_sample) {
                let sample = self.sample(&simulation);
                simulation.watch_ledger(&sample)?;
            }
            self.picture(scene, &simulation, &frames);
            progress(Progress { step, steps: plan.steps(), time: step as f64 * plan.step });
        }
        Ok(())
    }

    /// What is modelled, how large it is, and the plan of its steps.
    fn describe(&mut self, simulation: &Simulation) {
        let (extent, plan) = (simulation.extent(), simulation.plan());
        let summary = &mut self.summary;
        summary.models = extent.models;
        summary.particles = extent.particles;
        summary.control_points = extent.control_points;
        summary.planned_steps = plan.steps();
        summary.time_step_s = Some(plan.step);
        summary.critical_step_s = Some(plan.critical).filter(|c| c.is_finite());
        summary.warnings.extend(simulation.warnings().iter().cloned());
    }

    /// One row of the history.
    fn sample(&mut self, simulation: &Simulation) -> Sample {
        let sample: Sample = timed(&mut self.stages.samples, || simulation.sample());
        let (names, values): (Vec<_>, Vec<_>) = sample.named_values().into_iter().unzip();
        if self.history.names.is_empty() {
            self.history = Table::new(&names);
        }
        self.history.push(&values);
        self.largest_closure = self.largest_closure.max(sample.closure.abs());
        self.largest_energy = self.largest_energy.max(sample.largest_term());
        sample
    }

    /// A picture, if the present step is one of `frames`.
    fn picture(&mut self, scene: &Scene, simulation: &Simulation, frames: &[usize]) {
        if frames.binary_search(&simulation.steps()).is_ok() {
            let (low, high) = (scene.mesh.origin(), scene.mesh.end());
            let pixels = square_pixels([high[0] - low[0], high[1] - low[1]], FRAME_PIXELS);
            self.frames.push(timed(&mut self.stages.pictures, || simulation.picture(pixels)));
        }
    }

    fn finish(mut self, breakdown: Option<Breakdown>) -> SceneRun {
        let summary = &mut self.summary;
        summary.wall_s = self.start.elapsed().as_secs_f64();
        summary.stages_s = self.stages;
        let particle_steps = summary.particles as f64 * summary.steps as f64;
        summary.ns_per_particle_step = (particle_steps > 0.0).then(|| 1e9 * self.stages.steps / particle_steps);
        summary.peak_memory_mb = summary::peak_memory_mb();
        summary.final_energies_j = summary::final_energies(&self.history);
        if self.largest_energy > 0.0 {
            summary.largest_closure_over_largest_energy = self.largest_closure / self.largest_energy;
        }
        summary.breakdown = breakdown.as_ref().map(BreakdownSummary::from);
        SceneRun { history: self.history, frames: self.frames, summary: self.summary, breakdown }
    }
}

/// Adds the wall time of `work` to `total`, s.
fn timed<T>(total: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *total += start.elapsed().as_secs_f64();
    result
}

#[cfg(test)]
mod tests;
