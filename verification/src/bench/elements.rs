//! The independent finite elements of `reference-data/independent-fem` on this machine, in the same rounds as
//! the plate: built with `cargo build --release`, run as a program of their own, on one thread and on all.
//!
//! The package is no part of the workspace and shares no line with the solver. Where it cannot be built, what
//! it took on another machine stands in its place, and the report says so.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use super::peer::program::Program;
use super::plate_error::error_of_kinetic;
use super::record::BenchRecord;
use super::timing::Contestant;
use super::{BenchError, Settings};
use crate::extremes::largest;
use crate::output::history::Table;
use crate::reference::ReferenceCurve;

/// l0 of the plate, mm.
const LENGTH_SCALE_MM: f64 = 0.25;
/// Elements at the crack over l0. The finest takes minutes; finer ones say nothing about fisura at this size.
const MESHES: [f64; 3] = [1.0, 0.5, 1.0 / 3.0];
/// Time that one run may take.
const LIMIT: Duration = Duration::from_secs(1800);
/// Open part of the balance of energies over the largest work: 0.4 % at h = l0, and less on finer meshes.
const BALANCE: f64 = 1e-2;
const LABEL: &str = "bilinear finite elements";

/// Builds the program, with its own lock file.
///
/// # Errors
/// Why it cannot be built, in words.
pub fn build(workspace: &Path) -> Result<PathBuf, String> {
    let package = workspace.join("reference-data/independent-fem/Cargo.toml");
    let target = workspace.join("target/independent-fem");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"));
    let mut command = Command::new(cargo);
    command.args(["build", "--release", "--locked", "--quiet", "--manifest-path"]).arg(&package);
    command.arg("--target-dir").arg(&target).stdin(Stdio::null()).stdout(Stdio::null());
    let output = command.output().map_err(|e| format!("cargo cannot be started: {e}"))?;
    if output.status.success() {
        return Ok(target.join("release").join(format!("independent-fem{}", std::env::consts::EXE_SUFFIX)));
    }
    let words = String::from_utf8_lossy(&output.stderr);
    let first = words.lines().find(|line| line.starts_with("error")).or_else(|| words.lines().next());
    Err(format!("cargo, {}: {}", output.status, first.unwrap_or_default()))
}

/// Runs of the half plate on meshes of equal elements, on one thread and on all.
///
/// # Errors
/// If there is no room for what they write.
pub fn contestants<'a>(
    settings: &Settings,
    program: &Path,
    reference: &'a ReferenceCurve,
) -> Result<Vec<Contestant<'a>>, BenchError> {
    let meshes = if settings.quick { &MESHES[..1] } else { &MESHES[..] };
    let threads = if settings.threads > 1 { vec![1, settings.threads] } else { vec![1] };
    let folder = settings.workspace.join("target/independent-fem");
    let pairs = meshes.iter().flat_map(|&h| threads.iter().map(move |&threads| (h, threads)));
    pairs
        .map(|(h, threads)| contestant(program, folder.join(format!("{threads}.csv")), h, threads, reference))
        .collect()
}

fn contestant<'a>(
    program: &Path,
    history: PathBuf,
    h: f64,
    threads: usize,
    reference: &'a ReferenceCurve,
) -> Result<Contestant<'a>, BenchError> {
    let size = format!("{:.9}", h * LENGTH_SCALE_MM);
    let words = ["--h-mm", &size, "--threads", &threads.to_string(), "--out"].map(String::from);
    let words = [vec![program.display().to_string()], words.to_vec()].concat();
    let program = Program::of_words(words, LIMIT);
    let count = if threads == 1 { "1 thread".to_string() } else { format!("{threads} threads") };
    let id = format!("plate/elements/h{}/{threads}", (h * 1000.0).round() / 1000.0);
    let mut record = BenchRecord::new(id, format!("{LABEL}, {count}"), 1.0, "run").with("h_over_l0", h);
    record.threads = threads;
    let run = move |record: &mut BenchRecord| {
        let _ = fs::remove_file(&history); // the answer of another run is none
        let sample = program.run(&history)?;
        match Table::read(&history) {
            Ok(table) => answer(record, &table, reference),
            Err(error) => record.verify(false, format!("it left no history: {error}")),
        }
        Ok(sample)
    };
    Ok(Contestant { record, run: Box::new(run) })
}

/// Notes the error of a history of the finite elements, and whether its balance closes.
fn answer(record: &mut BenchRecord, table: &Table, reference: &ReferenceCurve) {
    let column = |name: &str| table.column(name).unwrap_or_default();
    let size = |name: &str| largest(column(name).iter().map(|v| v.abs()));
    let open = size("balance_j_per_m") / size("external_work_j_per_m");
    record.verify_at_most("balance of energies over the largest work", open, BALANCE);
    let seconds: Vec<f64> = column("time_us").iter().map(|t| 1e-6 * t).collect();
    record.error = error_of_kinetic(&seconds, column("kinetic_j_per_m"), 1.0, reference);
    if record.error.is_none() {
        record.verify(false, "the history does not cover the window of the comparison");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::own_workspace;
    use crate::reference::Library;

    #[test]
    fn a_package_that_is_not_there_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let reason = build(folder.path()).unwrap_err();
        assert!(reason.contains("cargo, exit") && reason.contains("Cargo.toml"), "{reason}");
    }

    #[test]
    fn a_stored_history_has_the_error_of_its_mesh() {
        let data = own_workspace().join("reference-data");
        let library = Library::load(&data).unwrap();
        let reference = library.curve("independent-fem", "plate/kinetic-energy").unwrap();
        let mut stored = Table::read(&data.join("submissions/independent-fem-h1/history.csv")).unwrap();
        stored.names.push("balance_j_per_m".into());
        stored.columns.push(vec![0.0; stored.rows()]);
        let mut record = BenchRecord::new("plate/elements/h1/1", LABEL, 1.0, "run");
        answer(&mut record, &stored, reference);
        let error = record.error.as_ref().unwrap().value;
        assert!(record.verified && (0.07..0.085).contains(&error), "{record:?}");
        stored.names[1] = "kinetic".into();
        answer(&mut record, &stored, reference);
        assert!(!record.verified, "{record:?}");
    }
}
