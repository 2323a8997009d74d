//! Runs that survive: a checkpoint at intervals and on interrupt, and runs taken up from one.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use fisura::scene::Scene;
use fisura::simulation::Simulation;
use fisura::simulation::state::ResumeError;

use super::checkpoint::{self, Stored};
use super::write::Followed;
use super::{OnFrame, Progress, Record, Run, SceneRun, timed};
use crate::output::{OutputError, OutputFolder};

/// How a run is kept safe.
#[derive(Debug)]
pub struct Keep<'a> {
    /// Folder of the checkpoint.
    pub out: &'a OutputFolder,
    /// Its name there; see [`checkpoint::find`].
    pub name: String,
    /// Name and version of the program: only the same one goes on with the same bits.
    pub program: String,
    /// Wall time between checkpoints; none if there are to be none.
    pub interval: Option<Duration>,
    /// Whether files are written at the frames; see [`Stored::frame_files`].
    pub frame_files: bool,
    /// Once this is set the run stores a checkpoint after the present step, and stops.
    pub interrupted: &'a AtomicBool,
}

/// How a kept run ended.
#[derive(Debug)]
pub enum Outcome {
    /// As planned, or with a breakdown.
    Ended(Box<SceneRun>),
    /// Stored, to be taken up.
    Interrupted(Progress),
}

/// Runs a valid scene as [`run_scene`](super::run_scene) does, storing checkpoints. From a `stored` one it
/// goes on: history and frames are then, bit by bit, those of a run that nobody disturbed. Every row of the
/// history is in [`HISTORY`](super::HISTORY) as soon as it is sampled.
///
/// A checkpoint that cannot be written at an interval is a warning in the summary, and tried again at the
/// next.
///
/// # Errors
/// A checkpoint that cannot be taken up, or cannot be written on interrupt.
pub fn run_scene_kept(
    scene: &Scene,
    keep: &Keep<'_>,
    stored: Option<Stored>,
    progress: &mut dyn FnMut(Progress),
    on_frame: &mut OnFrame<'_>,
) -> Result<Outcome, OutputError> {
    let (record, state): (Record, Option<Vec<u8>>) =
        stored.map_or_else(Default::default, |stored| (stored.run, Some(stored.state)));
    let mut run = Run::new(scene, record);
    run.followed = Some(Followed::new(keep.out));
    let prepared = timed(&mut run.record.stages.preparation, || match &state {
        Some(state) => Simulation::resume(scene, state),
        None => Simulation::new(scene).map_err(ResumeError::from),
    });
    let mut keeper = Keeper { keep, stored: Instant::now(), stored_time: None, warning: None, failed: None };
    let mut simulation = match prepared {
        Ok(simulation) => simulation,
        Err(ResumeError::Breakdown(breakdown)) => {
            return Ok(Outcome::Ended(Box::new(run.finish(None, Some(breakdown), None))));
        }
        Err(ResumeError::State(error)) => {
            return Err(checkpoint::unfit(&keep.out.path().join(&keep.name), error));
        }
    };
    keeper.stored_time = state.is_some().then(|| simulation.time());
    let mut stop = |run: &Run<'_>, simulation: &mut Simulation| keeper.after_step(run, simulation);
    match run.advance(&mut simulation, progress, on_frame, &mut stop) {
        Ok(true) => match keeper.failed {
            Some(error) => Err(error),
            None => Ok(Outcome::Interrupted(Progress::of(&simulation))),
        },
        ended => Ok(Outcome::Ended(Box::new(run.finish(Some(&simulation), ended.err(), Some(&keeper))))),
    }
}

/// Stores checkpoints.
pub(super) struct Keeper<'a> {
    keep: &'a Keep<'a>,
    /// When the last checkpoint was stored, and its simulated time, s.
    stored: Instant,
    pub(super) stored_time: Option<f64>,
    /// Of checkpoints that could not be written.
    pub(super) warning: Option<String>,
    /// Why the last one could not be written.
    failed: Option<OutputError>,
}

impl Keeper<'_> {
    /// Stores a checkpoint if it is time or the run is interrupted; whether it is.
    fn after_step(&mut self, run: &Run<'_>, simulation: &mut Simulation) -> bool {
        let interrupted = self.keep.interrupted.load(Ordering::Relaxed);
        if interrupted || self.keep.interval.is_some_and(|interval| self.stored.elapsed() >= interval) {
            self.failed = self.store(run, simulation).err();
            if let Some(error) = &self.failed {
                let step = simulation.steps();
                self.warning = Some(format!("the checkpoint at step {step} was not written: {error}"));
            }
            self.stored = Instant::now();
        }
        interrupted
    }

    fn store(&mut self, run: &Run<'_>, simulation: &mut Simulation) -> Result<(), OutputError> {
        let Keep { out, name, program, frame_files, .. } = self.keep;
        let state = simulation.checkpoint().map_err(|error| OutputError::unwritable(&out.path().join(name), error))?;
        let record = Record { wall_s: run.wall_s(), ..run.record.clone() };
        let stored = Stored { run: record, state, frame_files: *frame_files };
        checkpoint::write((out, name), program, run.scene, &stored)?;
        self.stored_time = Some(simulation.time());
        Ok(())
    }
}
