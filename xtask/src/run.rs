//! `run SCENE.toml`: one scene to its end.

use std::path::Path;
use std::str::FromStr;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use fisura::scene::Scene;
use fisura::simulation::Simulation;
use fisura_reports::template::filled;
use fisura_verification::output::OutputFolder;
use fisura_verification::scene_run::checkpoint::{self, CHECKPOINT, Place, Stored};
use fisura_verification::scene_run::{Keep, OnFrame, Outcome, Progress, SceneRun, run_scene_kept};
use indicatif::ProgressBar;
use minijinja::context;
use minijinja::value::Serde;

use crate::cli::{Common, SceneArgs};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{built, console, folders, interrupt, pictures, progress, scene_input, vtk};

/// The summary for people.
const TEXT: &str = include_str!("texts/run.txt");

/// Arguments of `run`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Files for ParaView at every frame: points.pvd (material points) and grid.pvd (mesh) open them
    #[arg(long)]
    pub vtk: bool,
    /// A moving picture of the run too: the phase field if there is one, else stress; with --vtk its moments
    /// are frames as well
    #[arg(long)]
    pub animate: bool,
    /// Continue from the checkpoint in the output folder, or start if there is none; files are identical to
    /// those of an uninterrupted run
    #[arg(long)]
    pub resume: bool,
    /// Wall time between checkpoints, or none; an interrupted run stores one too, and ends with status 130
    #[arg(long, value_name = "SECONDS|none", default_value = "60")]
    pub checkpoint: Interval,
}

/// Wall time between checkpoints; none if there are to be none.
#[derive(Debug, Clone, Copy)]
pub struct Interval(Option<Duration>);

impl Interval {
    /// No checkpoints are written.
    pub const NONE: Self = Self(None);
}

impl FromStr for Interval {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "none" {
            return Ok(Self(None));
        }
        let seconds = text.parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
        seconds.map(|seconds| Self(Some(seconds))).ok_or_else(|| "give seconds, such as 60, or none".to_string())
    }
}

/// Runs a scene; what was computed is written even if the run breaks down.
///
/// # Errors
/// A bad scene, a checkpoint that cannot be taken up, an output folder that cannot be written, a breakdown.
pub fn run(args: &Args, common: &Common) -> Result<Exit, Failure> {
    run_into(args, || folders::output(common, "run"), common)
}

/// The same, into the folder that `open` gives once the scene is known to be sound.
///
/// # Errors
/// As [`run`].
pub fn run_into(
    args: &Args,
    open: impl FnOnce() -> Result<OutputFolder, Failure>,
    common: &Common,
) -> Result<Exit, Failure> {
    refuse(args)?;
    let mut file = scene_input::load(&args.scene, common)?;
    let stills = file.scene.output.frames.clone();
    if args.animate {
        pictures::add_moments(&mut file.scene);
    }
    let folder = open()?;
    let start = Start::new(args, &file.scene, &folder, common)?;
    let mut vtk = args.vtk.then(|| vtk::Files::new(&folder, &file.scene, common));
    let bar = progress::bar(common, progress::SPINNER, 0);
    bar.set_message("preparing");
    let mut on_frame = |number: usize, simulation: &Simulation| {
        if let Some(vtk) = &mut vtk {
            vtk.write(number, simulation);
        }
    };
    let goes_on = start.stored.is_some();
    let checkpoint = start.place.name.clone();
    let outcome = simulate(start, &file.scene, &folder, &bar, &mut on_frame)?;
    bar.finish_and_clear();
    let run = match outcome {
        Outcome::Interrupted(at) => return Err(interrupted(at, &folder.path().join(checkpoint))),
        Outcome::Ended(run) => *run,
    };
    if let Some(breakdown) = run.breakdown.as_ref().filter(|breakdown| breakdown.scene.is_some()) {
        return Err(Failure::of_run(breakdown, &file));
    }
    for warning in run.summary.warnings.iter().skip(file.warnings.len()) {
        console::note(common, &format!("warning: {warning}"));
    }
    let drawings = pictures::draw(&run, &stills, args.animate);
    let (mut files, undrawn) = write(&run, drawings, &folder)?;
    match &vtk {
        Some(vtk) => files.extend(vtk.after(run.frames.len())),
        None if goes_on => vtk::remove(&folder, common)?,
        None => (),
    }
    if run.breakdown.is_none() {
        folder.remove(&checkpoint)?; // a run that reached its end needs none
    }
    folder.finish()?;
    console::show(common, &run.summary, || {
        let folder = folder.path().display().to_string();
        filled("run.txt", TEXT, context! { summary => Serde(&run.summary), folder, files })
    });
    match &run.breakdown {
        None => {
            if !undrawn.is_empty() {
                return Err(Failure::input(format!("not drawn: {}", undrawn.join("; "))));
            }
            vtk.and_then(|vtk| vtk.failed).map_or(Ok(Exit::Done), |error| Err(error.into()))
        }
        Some(breakdown) => {
            let help =
                format!("history up to there, and the state there in breakdown.json: {}", folder.path().display());
            Err(Failure::from(breakdown).help(help))
        }
    }
}

fn refuse(args: &Args) -> Result<(), Failure> {
    if args.resume && args.checkpoint.0.is_none() {
        let failure = Failure::input("--resume does not go with --checkpoint none");
        return Err(failure.help("leave out one of the two"));
    }
    Ok(())
}

/// From where a run starts, and where it keeps its checkpoints.
struct Start {
    /// Between checkpoints; none if there are to be none.
    interval: Option<Duration>,
    place: Place,
    stored: Option<Stored>,
    /// Whether there are, or will be, files for ParaView of this run.
    frame_files: bool,
}

impl Start {
    /// Takes up the checkpoint if that is asked for, and removes what is left of an earlier run; the
    /// checkpoint of another scene stays.
    fn new(args: &Args, scene: &Scene, folder: &OutputFolder, common: &Common) -> Result<Self, Failure> {
        let place = checkpoint::find(folder.path(), scene);
        let path = folder.path().join(&place.name);
        let mut stored = None;
        if args.resume {
            // without one of its own, that of another scene is refused with the reason
            let path = if path.exists() { path } else { folder.path().join(CHECKPOINT) };
            stored = checkpoint::read(&path, &built::program(), scene)?;
            if stored.is_none() {
                let folder = folder.path().display();
                console::note(common, &format!("no checkpoint in {folder}: the run begins at the start"));
            }
        }
        if let Some(title) = &place.other {
            keep_other(title, &place.name, folder, common)?;
        }
        folder.check(&place.name)?;
        // those of another scene may be there, if this run wrote none until it was interrupted
        let has_files = stored.as_ref().is_some_and(|stored| stored.frame_files);
        let earlier = if has_files { 0 } else { vtk::files_of_run(folder).len() };
        folder.begin(|name| checkpoint::is_checkpoint(name) || has_files && vtk::is_file_of_run(name))?;
        vtk::note_removed(earlier, folder, common);
        Ok(Self { interval: args.checkpoint.0, place, stored, frame_files: args.vtk || has_files })
    }
}

/// Says that the checkpoint of another scene stays. Its files for ParaView could not stay beside those of
/// this run.
fn keep_other(title: &str, name: &str, folder: &OutputFolder, common: &Common) -> Result<(), Failure> {
    let path = folder.path().join(CHECKPOINT);
    let message = format!("{} is of an interrupted run of another scene, {title:?}", path.display());
    if !vtk::files_of_run(folder).is_empty() {
        let failure = Failure::input(format!("{message}, which has files for ParaView there"));
        return Err(failure.help("go on with that run, or give another folder with --out"));
    }
    console::note(common, &format!("{message}: it is kept, and this run stores its own in {name}"));
    Ok(())
}

fn simulate(
    start: Start,
    scene: &Scene,
    folder: &OutputFolder,
    bar: &ProgressBar,
    on_frame: &mut OnFrame<'_>,
) -> Result<Outcome, Failure> {
    let mut started = false;
    let mut advance = |progress: Progress| {
        if !std::mem::replace(&mut started, true) {
            bar.set_style(progress::style("{wide_bar} {pos}/{len} steps, {eta} left"));
            bar.set_length(progress.steps as u64);
            bar.reset_eta();
        }
        bar.set_position(progress.step as u64);
    };
    let Start { interval, place, stored, frame_files } = start;
    let never = AtomicBool::new(false);
    let interrupted = match interval {
        Some(_) => interrupt::watch().map_err(|failure| failure.help("give --checkpoint none"))?,
        None => &never,
    };
    let keep = Keep { out: folder, name: place.name, program: built::program(), interval, frame_files, interrupted };
    Ok(run_scene_kept(scene, &keep, stored, &mut advance, on_frame)?)
}

fn interrupted(at: Progress, checkpoint: &Path) -> Failure {
    let Progress { step, steps, time } = at;
    let checkpoint = checkpoint.display();
    let message = format!("interrupted after step {step} of {steps}, t = {time:.6e} s; stored in {checkpoint}");
    Failure::new(Exit::Interrupted, message).help("go on with the same command and --resume")
}

/// Writes all files of a run; names them, and what cannot be drawn, with the reason.
fn write(
    run: &SceneRun,
    drawings: Vec<pictures::Drawing>,
    folder: &OutputFolder,
) -> Result<(Vec<String>, Vec<String>), Failure> {
    let mut files: Vec<String> = run.write(folder)?.into_iter().map(String::from).collect();
    let mut undrawn = Vec::new();
    for (name, drawing) in drawings {
        let drawn = drawing.map_err(|error| error.to_string());
        match drawn.and_then(|svg| folder.write(&name, svg).map_err(|error| error.to_string())) {
            Ok(()) => files.push(name),
            Err(error) => undrawn.push(format!("{name}: {error}")),
        }
    }
    Ok((files, undrawn))
}
