//! `run SCENE.toml`: one scene to its end.

use std::fs;
use std::path::Path;
use std::str::FromStr;
use std::time::Duration;

use fisura::scene::Scene;
use fisura::simulation::Simulation;
use fisura_reports::number::{duration, plain};
use fisura_verification::output;
use fisura_verification::scene_run::{
    CHECKPOINT, Keep, KeepError, OnFrame, Outcome, Progress, SceneRun, Summary, run_scene, run_scene_kept,
};
use indicatif::ProgressBar;

use crate::cli::{Common, Format, SceneArgs};
use crate::environment::{changes, environment};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{console, folders, interrupt, pictures, progress, scene_input, vtk};

/// Arguments of `run`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,
    /// Files for ParaView at every frame: points.pvd (material points) and grid.pvd (mesh) open them
    #[arg(long)]
    vtk: bool,
    /// Go on from the checkpoint in the output folder, to the same bytes; from the start if there is none
    #[arg(long)]
    resume: bool,
    /// Wall time between checkpoints, or none; an interrupted run stores one too, and ends with status 130
    #[arg(long, value_name = "SECONDS|none", default_value = "60")]
    checkpoint: Interval,
}

/// Wall time between checkpoints; none if there are to be none.
#[derive(Debug, Clone, Copy)]
struct Interval(Option<Duration>);

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
    refuse(args)?;
    let file = scene_input::load(&args.scene, common)?;
    let folder = folders::output(common, "run")?;
    let goes_on = args.resume && folder.join(CHECKPOINT).exists();
    if !goes_on {
        vtk::remove(&folder);
    }
    let mut vtk = args.vtk.then(|| vtk::Files::new(&folder, &file.scene, common));
    let bar = progress::bar(common, progress::SPINNER, 0);
    bar.set_message("preparing");
    let mut on_frame = |number: usize, simulation: &Simulation| {
        if let Some(vtk) = &mut vtk {
            vtk.write(number, simulation);
        }
    };
    let outcome = simulate(args, common, &file.scene, &folder, &bar, &mut on_frame)?;
    bar.finish_and_clear();
    let run = match outcome {
        Outcome::Interrupted(at) => return Err(interrupted(at, &folder)),
        Outcome::Ended(run) => *run,
    };
    if let Some(breakdown) = run.breakdown.as_ref().filter(|breakdown| breakdown.scene.is_some()) {
        return Err(Failure::of_run(breakdown, &file));
    }
    for warning in run.summary.warnings.iter().skip(file.warnings.len()) {
        console::note(common, &format!("warning: {warning}"));
    }
    let (mut files, undrawn) = write(&run, &folder)?;
    match &vtk {
        Some(vtk) => files.extend(vtk.after(run.frames.len())),
        None if goes_on => vtk::remove(&folder),
        None => (),
    }
    match common.format {
        Format::Json => console::json(&run.summary),
        Format::Text => console::result(&text(&run.summary, &folder, &files)),
    }
    match &run.breakdown {
        None => {
            discard_checkpoint(&folder);
            if !undrawn.is_empty() {
                return Err(Failure::new(Exit::BadInput, format!("not drawn: {}", undrawn.join("; "))));
            }
            vtk.and_then(|vtk| vtk.failed).map_or(Ok(Exit::Done), |error| Err(error.into()))
        }
        Some(breakdown) => {
            let help = format!("history up to there, and the state there in breakdown.json: {}", folder.display());
            Err(Failure::from(breakdown).help(help))
        }
    }
}

fn refuse(args: &Args) -> Result<(), Failure> {
    if args.resume && args.checkpoint.0.is_none() {
        let failure = Failure::new(Exit::BadInput, "--resume does not go with --checkpoint none");
        return Err(failure.help("leave out one of the two"));
    }
    Ok(())
}

fn simulate(
    args: &Args,
    common: &Common,
    scene: &Scene,
    folder: &Path,
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
    let Some(interval) = args.checkpoint.0 else {
        return Ok(Outcome::Ended(Box::new(run_scene(scene, &mut advance, on_frame))));
    };
    let keep = Keep { path: folder.join(CHECKPOINT), program: program(), interval, interrupted: interrupt::watch()? };
    if args.resume && !keep.path.exists() {
        let message = format!("no checkpoint in {}: the run begins at the start", folder.display());
        console::note(common, &message);
    }
    run_scene_kept(scene, &keep, args.resume, &mut advance, on_frame).map_err(|error| match error {
        KeepError::Output(error) => error.into(),
        KeepError::Checkpoint(error) => Failure::new(Exit::BadInput, error.to_string()).help(error.remedy),
    })
}

/// Name, version and commit of this program, as far as they are known.
fn program() -> String {
    let workspace = folders::workspace();
    let found = if workspace.as_os_str().is_empty() { Default::default() } else { environment(&workspace) };
    let changes = if found.dirty { format!(" with changes {}", changes(&workspace)) } else { String::new() };
    let commit = if found.commit.is_empty() { String::new() } else { format!(" of commit {}{changes}", found.commit) };
    format!("fisura {}{commit}", env!("CARGO_PKG_VERSION"))
}

fn interrupted(at: Progress, folder: &Path) -> Failure {
    let Progress { step, steps, time } = at;
    let message = format!("interrupted after step {step} of {steps}, t = {time:.6e} s; stored in {}", folder.display());
    Failure::new(Exit::Interrupted, message).help("go on with the same command and --resume")
}

/// A run that reached its end needs none; nor a part of one that was killed while it was written.
fn discard_checkpoint(folder: &Path) {
    for name in [CHECKPOINT.to_string(), format!("{CHECKPOINT}.part")] {
        let _ = fs::remove_file(folder.join(name)); // often there is none
    }
}

/// Writes all files of a run in place of those of the run before; names them, and what cannot be drawn, with the reason.
fn write(run: &SceneRun, folder: &Path) -> Result<(Vec<String>, Vec<String>), Failure> {
    remove_files_of_earlier_run(folder);
    let mut files: Vec<String> = run.write(folder)?.into_iter().map(String::from).collect();
    let mut undrawn = Vec::new();
    for (name, drawing) in pictures::draw(run) {
        match drawing {
            Ok(svg) => {
                output::write(&folder.join(&name), svg)?;
                files.push(name);
            }
            Err(error) => undrawn.push(format!("{name}: {error}")),
        }
    }
    Ok((files, undrawn))
}

/// Pictures of another run beside this one's history would mislead. Only a folder with a summary is one of ours.
fn remove_files_of_earlier_run(folder: &Path) {
    let entries = fs::read_dir(folder).ok().filter(|_| folder.join("summary.json").is_file());
    for entry in entries.into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let picture = (name.starts_with("phase-") || name.starts_with("stress-")) && name.ends_with(".svg");
        if picture || ["history.csv", "summary.json", "energies.svg", "breakdown.json"].contains(&name.as_str()) {
            let _ = fs::remove_file(entry.path()); // what cannot be removed cannot be replaced, which is told then
        }
    }
}

fn text(summary: &Summary, folder: &Path, files: &[String]) -> String {
    let count = |n: usize| n.to_string();
    let seconds = |s: Option<f64>| s.map_or("-".to_string(), |s| format!("{} s", plain(s, 5)));
    let mut rows = vec![
        ("title", summary.title.clone()),
        ("models", summary.models.join(", ")),
        ("particles", count(summary.particles)),
        ("control points", count(summary.control_points)),
        ("steps", format!("{} of {}", count(summary.steps), count(summary.planned_steps))),
        ("time step", format!("{}, critical {}", seconds(summary.time_step_s), seconds(summary.critical_step_s))),
        ("wall time", wall_time(summary)),
    ];
    rows.extend(summary.peak_memory_mb.map(|mb| ("peak memory", format!("{} MB", plain(mb, 3)))));
    let energies = summary.final_energies_j.iter();
    let energies: Vec<String> = energies.map(|(name, e)| format!("{} {}", label(name), plain(*e, 5))).collect();
    rows.push(("final energies (J)", energies.join(", ")));
    rows.push(("closure", format!("{} of the largest energy", plain(summary.largest_closure_over_largest_energy, 3))));
    rows.push(("written to", folder.display().to_string()));
    rows.push(("files", files.join(", ")));
    console::table(&rows)
}

fn label(column: &str) -> String {
    column.trim_end_matches("_j").replace('_', " ")
}

fn wall_time(summary: &Summary) -> String {
    let stages = summary.stages_s;
    let stages = [
        ("preparation", stages.preparation),
        ("steps", stages.steps),
        ("samples", stages.samples),
        ("pictures", stages.pictures),
    ];
    let stages: Vec<String> = stages.iter().map(|(name, s)| format!("{name} {}", duration(*s))).collect();
    let per_step = summary.ns_per_particle_step;
    let per_step = per_step.map(|ns| format!("; {} ns per particle and step", plain(ns, 3))).unwrap_or_default();
    format!("{} ({}){per_step}", duration(summary.wall_s), stages.join(", "))
}
