//! `run SCENE.toml`: one scene to its end.

use std::fs;
use std::path::Path;

use fisura_reports::number::{duration, plain};
use fisura_verification::scene_run::{SceneRun, Summary, run_scene};

use crate::cli::{Common, Format, SceneArgs};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{console, folders, pictures, progress, scene_input};

/// Arguments of `run`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,
    /// Field files for ParaView; not offered yet
    #[arg(long, hide = true)]
    vtk: bool,
    /// Go on from the last checkpoint; not offered yet
    #[arg(long, hide = true)]
    resume: bool,
}

/// Runs a scene; what was computed is written even if the run breaks down.
///
/// # Errors
/// A bad scene, an output folder that cannot be written, a breakdown.
pub fn run(args: &Args, common: &Common) -> Result<Exit, Failure> {
    refuse(args)?;
    let file = scene_input::load(&args.scene, common)?;
    let folder = folders::output(common, "run")?;
    let bar = progress::bar(common, progress::SPINNER, 0);
    bar.set_message("preparing");
    let run = run_scene(&file.scene, &mut |progress| {
        if progress.step == 0 {
            bar.set_style(progress::style("{wide_bar} {pos}/{len} steps, {eta} left"));
            bar.set_length(progress.steps as u64);
            bar.reset_eta();
        }
        bar.set_position(progress.step as u64);
    });
    bar.finish_and_clear();
    for warning in run.summary.warnings.iter().skip(file.warnings.len()) {
        console::note(common, &format!("warning: {warning}"));
    }
    let files = write(&run, &folder, common)?;
    match common.format {
        Format::Json => console::json(&run.summary),
        Format::Text => console::result(&text(&run.summary, &folder, &files)),
    }
    match &run.breakdown {
        None => Ok(Exit::Done),
        Some(breakdown) => Err(Failure::from(breakdown).help(format!("history up to there: {}", folder.display()))),
    }
}

fn refuse(args: &Args) -> Result<(), Failure> {
    let refused = [(args.vtk, "--vtk"), (args.resume, "--resume")].into_iter().find(|(given, _)| *given);
    refused.map_or(Ok(()), |(_, flag)| {
        Err(Failure::new(Exit::BadInput, format!("run {flag} is not supported yet")).help(format!("leave out {flag}")))
    })
}

/// Writes all files of a run in place of those of the run before; names them.
fn write(run: &SceneRun, folder: &Path, common: &Common) -> Result<Vec<String>, Failure> {
    remove_files_of_earlier_run(folder);
    let mut files: Vec<String> = run.write(folder)?.into_iter().map(String::from).collect();
    for (name, drawing) in pictures::draw(run) {
        match drawing {
            Ok(svg) => {
                fisura_verification::scene_run::replace_file(&folder.join(&name), |part| Ok(fs::write(part, svg)?))?;
                files.push(name);
            }
            Err(error) => console::note(common, &format!("warning: {name} is not drawn: {error}")),
        }
    }
    Ok(files)
}

/// Pictures of another run beside this one's history would mislead. Only a folder with a summary is one of ours.
fn remove_files_of_earlier_run(folder: &Path) {
    let entries = fs::read_dir(folder).ok().filter(|_| folder.join("summary.json").is_file());
    for entry in entries.into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let picture = (name.starts_with("phase-") || name.starts_with("stress-")) && name.ends_with(".svg");
        if picture || ["history.csv", "summary.json", "energies.svg"].contains(&name.as_str()) {
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
