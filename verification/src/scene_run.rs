//! A scene run to its end: history, pictures, and a summary of what it modelled and cost.
//!
//! [`run_scene`] steps a [`Simulation`], samples it at every multiple of the plan's interval, and takes each
//! frame at the nearest step. A run that breaks down keeps what was computed until then. [`run_scene_kept`]
//! stores checkpoints on the way, goes on from one, and writes every row as it is sampled. The clock is read
//! here and in no solver module:
//! preparation, steps, samples and pictures are timed from outside.

mod breakdown;
pub mod checkpoint;
mod keep;
mod summary;
mod write;

use std::time::Instant;

use fisura::dynamics::energy::Sample;
use fisura::output::picture::Picture;
use fisura::scene::Scene;
use fisura::simulation::breakdown::Breakdown;
use fisura::simulation::{Simulation, square_pixels};
use fisura::validate::validate;
use serde::{Deserialize, Serialize};

use crate::extremes::larger;
use crate::output::history::Table;
use crate::watch;

pub use breakdown::{BreakdownReport, Extremes, WorstPoint};
use keep::Keeper;
pub use keep::{Keep, Outcome, run_scene_kept};
pub use summary::{BreakdownSummary, Stages, Summary, peak_memory_mb};
use write::Followed;
pub use write::HISTORY;

/// Pixels of a frame along its longer side.
pub const FRAME_PIXELS: usize = 400;

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Number of time steps taken so far.
    pub step: usize,
    /// Number of time steps of the whole run.
    pub steps: usize,
    /// Simulated time that the run has reached, s.
    pub time: f64,
}

impl Progress {
    fn of(simulation: &Simulation) -> Self {
        Self { step: simulation.steps(), steps: simulation.plan().steps(), time: simulation.time() }
    }

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
    /// The state at which it broke down.
    pub breakdown_report: Option<BreakdownReport>,
}

/// Called at a frame with its number, counted from 0, and the state then. A run that is taken up again may
/// come to a frame a second time, with the same state.
pub type OnFrame<'a> = dyn FnMut(usize, &Simulation) + 'a;

/// Runs a valid scene (see [`validate`]) to its end, or until its [`watch`] stops it; `progress` is called
/// after every step, and `on_frame` at every frame with its number.
pub fn run_scene(scene: &Scene, progress: &mut dyn FnMut(Progress), on_frame: &mut OnFrame<'_>) -> SceneRun {
    let mut run = Run::new(scene, Record::default());
    match timed(&mut run.record.stages.preparation, || Simulation::new(scene)) {
        Err(breakdown) => run.finish(None, Some(breakdown), None),
        Ok(mut simulation) => {
            let breakdown = run.advance(&mut simulation, progress, on_frame, &mut |_, _| watch::check().is_err()).err();
            run.finish(Some(&simulation), breakdown, None)
        }
    }
}

/// Steps nearest to the frames, each once and in order, with a warning for frames that share a step.
pub fn frame_steps(times: &[f64], time_step: f64, steps: usize) -> (Vec<usize>, Vec<String>) {
    let nearest = |time: &f64| ((time / time_step).round().max(0.0) as usize).min(steps);
    let mut found: Vec<usize> = times.iter().map(nearest).collect();
    found.sort_unstable();
    found.dedup();
    let missing = times.len() - found.len();
    let warning = || {
        format!(
            "{missing} of {} frames are duplicates: they coincide with the step of another frame and are not written",
            times.len()
        )
    };
    let warnings = (missing > 0).then(warning).into_iter().collect();
    (found, warnings)
}

/// What a run has gathered so far: beside the state of the simulation, what a checkpoint holds.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Record {
    history: Table,
    frames: Vec<Picture>,
    stages: Stages,
    /// Wall time until the last checkpoint, s.
    wall_s: f64,
    largest_closure: f64,
    largest_energy: f64,
}

/// A run in the making.
struct Run<'a> {
    scene: &'a Scene,
    record: Record,
    /// Warnings about frames, and about the file that is followed.
    warnings: Vec<String>,
    /// The history on disk, if it is written during the run.
    followed: Option<Followed<'a>>,
    /// Since the run began or was taken up.
    start: Instant,
}

impl<'a> Run<'a> {
    fn new(scene: &'a Scene, record: Record) -> Self {
        Self { scene, record, warnings: Vec::new(), followed: None, start: Instant::now() }
    }

    /// Takes the steps that are left, until `stop` says after one of them that it is enough; whether it did.
    fn advance(
        &mut self,
        simulation: &mut Simulation,
        progress: &mut dyn FnMut(Progress),
        on_frame: &mut OnFrame<'_>,
        stop: &mut dyn FnMut(&Self, &mut Simulation) -> bool,
    ) -> Result<bool, Breakdown> {
        let plan = *simulation.plan();
        let (frames, warnings) = frame_steps(&self.scene.output.frames, plan.step, plan.steps());
        self.warnings = warnings;
        self.follow(); // what a run that is taken up sampled before
        if simulation.steps() == 0 {
            self.sample(simulation);
            self.picture(simulation, &frames, on_frame);
        }
        progress(Progress::of(simulation));
        while !simulation.finished() {
            timed(&mut self.record.stages.steps, || simulation.step())?;
            if simulation.steps().is_multiple_of(plan.steps_per_sample) {
                let sample = self.sample(simulation);
                simulation.watch_ledger(&sample)?;
            }
            self.picture(simulation, &frames, on_frame);
            progress(Progress::of(simulation));
            if stop(self, simulation) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// One row of the history.
    fn sample(&mut self, simulation: &Simulation) -> Sample {
        let record = &mut self.record;
        let sample: Sample = timed(&mut record.stages.samples, || simulation.sample());
        let (names, values): (Vec<_>, Vec<_>) = sample.named_values().into_iter().unzip();
        if record.history.names.is_empty() {
            record.history = Table::new(&names);
        }
        record.history.push(&values);
        record.largest_closure = larger(record.largest_closure, sample.closure.abs());
        record.largest_energy = larger(record.largest_energy, sample.largest_term());
        self.follow();
        sample
    }

    /// Writes the rows that are not on disk yet, until that fails: what cannot be written is told in the end.
    fn follow(&mut self) {
        let Some(Err(error)) = self.followed.as_mut().map(|file| file.follow(&self.record.history)) else { return };
        self.followed = None;
        self.warnings.push(format!("rows of the history are not written during the run: {error}"));
    }

    /// A picture, if the present step is one of `frames`.
    fn picture(&mut self, simulation: &Simulation, frames: &[usize], on_frame: &mut OnFrame<'_>) {
        if let Ok(number) = frames.binary_search(&simulation.steps()) {
            let (low, high) = (self.scene.mesh.origin(), self.scene.mesh.end());
            let pixels = square_pixels([high[0] - low[0], high[1] - low[1]], FRAME_PIXELS);
            let picture = timed(&mut self.record.stages.pictures, || simulation.picture(pixels));
            self.record.frames.push(picture);
            timed(&mut self.record.stages.pictures, || on_frame(number, simulation));
        }
    }

    /// `simulation` is absent if the run never started, and so is `keeper` if nobody kept it.
    fn finish(
        self,
        simulation: Option<&Simulation>,
        breakdown: Option<Breakdown>,
        keeper: Option<&Keeper<'_>>,
    ) -> SceneRun {
        let wall_s = self.wall_s();
        let Record { history, frames, stages, largest_closure, largest_energy, .. } = self.record;
        let mut summary = Summary { title: self.scene.title.clone(), wall_s, stages_s: stages, ..Summary::default() };
        let found = validate(self.scene).unwrap_or_default();
        summary.warnings = found.iter().map(|w| format!("{}: {}", w.key, w.message)).collect();
        if let Some(simulation) = simulation {
            summary.describe(simulation);
        }
        summary.warnings.extend(self.warnings);
        summary.warnings.extend(keeper.and_then(|keeper| keeper.warning.clone()));
        let particle_steps = summary.particles as f64 * summary.steps as f64;
        summary.ns_per_particle_step = (particle_steps > 0.0).then(|| 1e9 * stages.steps / particle_steps);
        summary.peak_memory_mb = summary::peak_memory_mb();
        summary.final_energies_j = summary::final_energies(&history);
        if largest_energy > 0.0 {
            summary.largest_closure_over_largest_energy = largest_closure / largest_energy;
        }
        summary.breakdown = breakdown.as_ref().map(BreakdownSummary::from);
        let last_checkpoint = keeper.and_then(|keeper| keeper.stored_time);
        let report = breakdown.as_ref().map(|found| BreakdownReport::new(found, simulation, last_checkpoint));
        SceneRun { history, frames, summary, breakdown, breakdown_report: report }
    }

    /// Wall time in all, s.
    fn wall_s(&self) -> f64 {
        self.record.wall_s + self.start.elapsed().as_secs_f64()
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
