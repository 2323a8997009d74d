//! Another checkout of this workspace on the same scenes: `bench --baseline PATH`.
//!
//! Its `xtask` is built in its own folder. Then both programs run the same scene files in turn, as processes
//! of their own on all threads, and processor time from start to end counts. An answer holds if kinetic,
//! elastic and fracture energy at the end are those of a run of this checkout with a phase-field tolerance of
//! 1e-10, within 1e-3 of the largest of them; for the other checkout, which may have had looser rules, within
//! 1e-2.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;

use super::peer::program::Program;
use super::record::{AnswerError, BenchRecord};
use super::timing::{Contestant, round_robin};
use super::{BenchError, Settings};
use crate::extremes::{larger, largest};
use crate::output::history::Table;
use crate::scene::typed::plain;

/// Name, label, case below `verification/cases`, and settings of the scenes.
const SCENES: [(&str, &str, &str, &[&str]); 3] = [
    ("plate", "plate, 262144 points, p = 2", "plate/paper-p2-262144", &["output.frames=[]"]),
    (
        "half-plate",
        "half of the plate, h = l0/2, p = 2",
        "plate/half-p2-h1",
        &["output.frames=[]", "mesh.cells=[800, 160]"],
    ),
    ("rings", "two rings, total frame, p = 2", "rings/collision", &["output.frames=[]"]),
];
/// The one that stands for all in a quick run.
const QUICK: (&str, &str, &str, &[&str]) =
    ("half-plate-coarse", "half of the plate, h = 2 l0, p = 2", "plate/half-p2-h2", &["output.frames=[]"]);
/// Time that one run may take.
const LIMIT: Duration = Duration::from_secs(3600);
/// Seconds after which a program is not run once more.
const ENOUGH: f64 = 60.0;
/// Tolerance of the run that both are held against.
const TIGHT: &str = "solver.phase_field_tolerance=1e-10";
/// Energies at the end, compared over the largest of them.
const ENERGIES: [&str; 3] = ["kinetic_j", "elastic_j", "fracture_j"];

/// What `--baseline` names.
#[derive(Debug, Clone)]
pub struct Baseline {
    /// Path of this program, which runs the same scenes as that of the other checkout.
    pub program: PathBuf,
    /// Folder of the other checkout.
    pub checkout: PathBuf,
}

/// Times both programs; nothing if there is no other checkout.
///
/// # Errors
/// If the other one cannot be built, or a run fails.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let Some(baseline) = &settings.baseline else { return Ok(Vec::new()) };
    let theirs = build(&baseline.checkout)?;
    let scenes: &[_] = if settings.quick { &[QUICK] } else { &SCENES };
    let mut contestants = Vec::new();
    for &(name, label, case, set) in scenes {
        let folder = settings.out.path().join("baseline").join(name);
        let scene = scene_of(settings, case, &folder)?;
        let run = |program: &Path, further: &[&str]| {
            let set = set.iter().chain(further).flat_map(|value| ["--set".to_string(), value.to_string()]);
            let words = [path(program), "run".into(), path(&scene), "--threads".into(), settings.threads.to_string()];
            let words = words.into_iter().chain(["--checkpoint".into(), "none".into()]).chain(set);
            Program::of_words(words.chain(["--out".into()]).collect(), LIMIT)
        };
        let tight = folder.join("tight");
        run(&baseline.program, &[TIGHT]).run(&tight)?;
        let tight = energies(&tight)?;
        for (who, program, limit) in [("this", &baseline.program, 1e-3), ("other", &theirs, 1e-2)] {
            let mut record = BenchRecord::new(format!("baseline/{name}/{who}"), label, 1.0, "run")
                .with("checkout", if who == "this" { ".".to_string() } else { name_of(&baseline.checkout) });
            record.threads = settings.threads;
            let (program, folder) = (run(program, &[]), folder.join(who));
            let run = move |record: &mut BenchRecord| {
                let _ = fs::remove_dir_all(&folder); // the answer of the round before is none
                let sample = program.run(&folder)?;
                let found = energies(&folder)?;
                let size = tight.iter().copied().fold(0.0, larger);
                let error = largest(found.iter().zip(tight).map(|(a, b)| (a - b).abs() / size));
                record.verify_at_most("energies at the end against a tolerance of 1e-10", error, limit);
                let quantity = "difference of the energies at the end over the largest";
                let reference = "this checkout with a tolerance of 1e-10";
                record.error = Some(AnswerError::relative(quantity, error, reference));
                Ok(sample)
            };
            contestants.push(Contestant { record, run: Box::new(run) });
        }
    }
    round_robin(contestants, 3, ENOUGH)
}

fn path(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// The commit of a checkout, or its folder where git knows none.
fn name_of(checkout: &Path) -> String {
    let git = Command::new("git").args(["rev-parse", "--short", "HEAD"]).current_dir(checkout).output();
    let commit = git.ok().filter(|output| output.status.success());
    commit.map_or_else(|| path(checkout), |output| String::from_utf8_lossy(&output.stdout).trim().to_string())
}

/// The scene of a case as a file of its own, which `run` takes.
fn scene_of(settings: &Settings, case: &str, folder: &Path) -> Result<PathBuf, BenchError> {
    let case = settings.case(case, &[])?;
    let wrong = |reason: String| BenchError::input(format!("{}: {reason}", case.path.display()));
    let scene = case.scene_with_numbers()?.ok_or_else(|| wrong("it has no scene".into()))?;
    let scene = toml::to_string(&plain(&scene)).map_err(|error| wrong(error.to_string()))?;
    let target = folder.join("scene.toml");
    let written = fs::create_dir_all(folder).and_then(|()| fs::write(&target, scene));
    written.map_err(|error| BenchError::input(format!("{}: {error}", target.display())))?;
    Ok(target)
}

/// Energies at the end of a run, J; zero where the scene has none.
fn energies(folder: &Path) -> Result<[f64; 3], BenchError> {
    let file = folder.join("history.csv");
    let history = Table::read(&file).map_err(|error| BenchError::input(format!("{}: {error}", file.display())))?;
    Ok(ENERGIES.map(|name| history.column(name).and_then(|c| c.last().copied()).unwrap_or(0.0)))
}

/// Builds the program of a checkout as its own `cargo xtask` would, and names it.
fn build(checkout: &Path) -> Result<PathBuf, BenchError> {
    let wrong = |reason: String| BenchError::input(format!("--baseline {}: {reason}", checkout.display()));
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"));
    let mut command = Command::new(cargo);
    command.args(["build", "--package", "xtask", "--message-format", "json-render-diagnostics"]);
    let config = fs::read_to_string(checkout.join(".cargo/config.toml")).unwrap_or_default();
    if alias_is_optimised(&config) {
        command.arg("--release");
    }
    command.current_dir(checkout).stdin(Stdio::null()).stderr(Stdio::inherit());
    let output = command.output().map_err(|error| wrong(format!("cargo cannot be started there: {error}")))?;
    if !output.status.success() {
        return Err(wrong(format!("its package xtask cannot be built: cargo, {}", output.status)));
    }
    let messages = String::from_utf8_lossy(&output.stdout);
    let mut programs = messages.lines().filter_map(|line| {
        let message: Value = serde_json::from_str(line).ok()?;
        let named = message["target"]["name"] == "xtask";
        message["executable"].as_str().filter(|_| named).map(PathBuf::from)
    });
    programs.next_back().ok_or_else(|| wrong("cargo built no program named xtask".into()))
}

/// Whether the alias `xtask` of a configuration of cargo asks for the release profile.
fn alias_is_optimised(config: &str) -> bool {
    let config: toml::Table = config.parse().unwrap_or_default();
    let alias = config.get("alias").and_then(|aliases| aliases.get("xtask"));
    alias.is_some_and(|alias| alias.to_string().contains("--release"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_a_checkout_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let error = build(folder.path()).unwrap_err().to_string();
        assert!(error.contains("--baseline") && error.contains("cannot be built"), "{error}");
        let error = build(&folder.path().join("nowhere")).unwrap_err().to_string();
        assert!(error.contains("cargo cannot be started there"), "{error}");
    }

    #[test]
    fn the_profile_is_that_of_the_alias_and_of_nothing_else() {
        assert!(alias_is_optimised("[alias]\nxtask = \"run --release --package xtask --\""));
        assert!(alias_is_optimised("[alias]\nxtask = [\"run\", \"--release\"]"));
        assert!(!alias_is_optimised("[alias]\nxtask = \"run --package xtask --\"\nfast = \"run --release\""));
        assert!(!alias_is_optimised(""));
    }

    #[test]
    fn the_energies_are_those_of_the_last_row() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("history.csv"), "time_s,kinetic_j,elastic_j\n0,1,2\n1,3,4\n").unwrap();
        assert_eq!(energies(folder.path()).unwrap(), [3.0, 4.0, 0.0]);
        assert!(energies(&folder.path().join("nowhere")).is_err());
    }
}
