//! The independent finite elements of `reference-data/independent-fem` on this machine, in the same rounds as
//! the plate, on one thread, as fast as they are known to be.
//!
//! | what | choice |
//! |---|---|
//! | build | `cargo build --release` in its folder: for the instructions of this processor |
//! | mesh | graded: elements twice and four times as large where no crack runs |
//! | step | the critical one of an element |
//! | phase field | solved for in every third step, in between it goes on linearly |
//! | toughness | Gc, and Gc/kappa ([`fisura::material::mesh_toughness`]) |
//! | tolerance | 1e-3, 1e-4 and the 1e-6 of the reference |
//!
//! What else was tried, with numbers, is in the README of the package. It is no part of the workspace and
//! shares no line with the solver. Where it cannot be built, nothing is compared, and the report says so.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use fisura::material::mesh_toughness::slope;
use fisura::scene::CrackModel;

use super::peer::program::Program;
use super::plate_error::References;
use super::record::{BenchRecord, Sample};
use super::timing::Contestant;
use super::{BenchError, Settings};
use crate::extremes::largest;
use crate::output::history::Table;

/// l0 of the plate, mm, and its Gc, J/m².
const LENGTH_SCALE_MM: f64 = 0.25;
const TOUGHNESS: f64 = 3.0;
/// Elements at the crack over l0. The finest takes a minute or more.
const MESHES: [f64; 10] = [5.6, 4.0, 2.8, 2.0, 1.4, 1.0, 0.7, 0.5, 1.0 / 3.0, 0.25];
/// The first of them for a quick run.
const QUICK: usize = 8;
/// Tolerances of the phase field, with Gc as it is and with Gc/kappa.
const WITH_GC: [f64; 2] = [1e-3, 1e-6];
const WITH_KAPPA: [f64; 3] = [1e-3, 1e-4, 1e-6];
/// Options of a fast run: the critical step, samples that leave room for it, solves in every third step.
const FAST: [&str; 7] = ["--graded", "--fraction", "1", "--interval-us", "1", "--every", "3"];
/// Time that one run may take.
const LIMIT: Duration = Duration::from_secs(1800);
/// Processor time of short runs in all, s: it is told in ticks of 10 ms. And the most runs.
const ENOUGH: f64 = 0.5;
const MOST_RUNS: f64 = 50.0;
/// Open part of the balance of energies over the largest work.
const BALANCE: f64 = 2e-2;

/// Builds the program with its own lock file and configuration, into a folder of the workspace; its path.
///
/// # Errors
/// Why it cannot be built, in words.
pub fn build(workspace: &Path) -> Result<PathBuf, String> {
    let package = workspace.join("reference-data/independent-fem");
    if !package.is_dir() {
        return Err(format!("{} is missing", package.display()));
    }
    let target = std::path::absolute(folder(workspace)).map_err(|e| e.to_string())?;
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"));
    let mut command = Command::new(cargo);
    command.args(["build", "--release", "--locked", "--quiet"]).current_dir(&package); // with the configuration there
    command.arg("--target-dir").arg(&target).stdin(Stdio::null()).stdout(Stdio::null());
    command.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    let output = command.output().map_err(|e| format!("cargo cannot be started: {e}"))?;
    if output.status.success() {
        return Ok(target.join("release").join(format!("independent-fem{}", std::env::consts::EXE_SUFFIX)));
    }
    let words = String::from_utf8_lossy(&output.stderr);
    let first = words.lines().find(|line| line.starts_with("error")).or_else(|| words.lines().next());
    Err(format!("cargo, {}: {}", output.status, first.unwrap_or_default()))
}

fn folder(workspace: &Path) -> PathBuf {
    workspace.join("target/independent-fem")
}

/// One way to run them on one mesh.
#[derive(Debug, Clone, Copy)]
struct Run {
    h: f64,
    tolerance: f64,
    corrected: bool,
}

impl Run {
    fn id(&self) -> String {
        let toughness = if self.corrected { "kappa" } else { "gc" };
        format!("plate/elements/{toughness}-{:e}/h{}", self.tolerance, (self.h * 1000.0).round() / 1000.0)
    }

    fn label(&self) -> String {
        let toughness = if self.corrected { "Gc/κ" } else { "Gc" };
        format!("elements, graded, {toughness}, {:e}", self.tolerance)
    }

    fn words(&self, program: &Path) -> Vec<String> {
        let kappa = 1.0 + if self.corrected { self.h * slope(CrackModel::At2, 1, 2).unwrap_or(0.0) } else { 0.0 };
        let mut words = vec![program.display().to_string()];
        words.extend(FAST.map(String::from));
        words.extend(["--h-mm".into(), format!("{:.9}", self.h * LENGTH_SCALE_MM)]);
        words.extend(["--toughness".into(), format!("{:.9}", TOUGHNESS / kappa)]);
        words.extend(["--tolerance".into(), format!("{:e}", self.tolerance), "--out".into()]);
        words
    }
}

/// Runs of the half plate on graded meshes, on one thread.
pub fn contestants<'a>(settings: &Settings, program: &Path, references: &Arc<References<'a>>) -> Vec<Contestant<'a>> {
    let meshes = if settings.quick { &MESHES[..QUICK] } else { &MESHES[..] };
    let history = folder(&settings.workspace).join("history.csv");
    let ways = WITH_GC.map(|tolerance| (tolerance, false)).into_iter();
    let ways = ways.chain(WITH_KAPPA.map(|tolerance| (tolerance, true)));
    let runs = ways.flat_map(|(tolerance, corrected)| meshes.iter().map(move |&h| Run { h, tolerance, corrected }));
    runs.map(|run| contestant(program, history.clone(), run, Arc::clone(references))).collect()
}

fn contestant<'a>(program: &Path, history: PathBuf, run: Run, references: Arc<References<'a>>) -> Contestant<'a> {
    let program = Program::of_words(run.words(program), LIMIT);
    let record =
        BenchRecord::new(run.id(), run.label(), 1.0, "run").with("h_over_l0", run.h).with("options", FAST.join(" "));
    written(
        record,
        history,
        move |file| mean_of_runs(|| program.run(file)),
        move |record, table| {
            answer(record, table, &references);
        },
    )
}

/// A program that writes its history to a file, which tells its `answer`.
pub fn written<'a>(
    record: BenchRecord,
    file: PathBuf,
    run: impl Fn(&Path) -> Result<Sample, BenchError> + 'a,
    answer: impl Fn(&mut BenchRecord, &Table) + 'a,
) -> Contestant<'a> {
    let run = move |record: &mut BenchRecord| {
        let _ = fs::remove_file(&file); // the answer of another run is none
        let sample = run(&file)?;
        match Table::read(&file) {
            Ok(table) => answer(record, &table),
            Err(error) => record.verify(false, format!("it wrote no history: {error}")),
        }
        Ok(sample)
    };
    Contestant { record, run: Box::new(run) }
}

/// Mean time of runs that take half a second of processor time in all.
pub fn mean_of_runs(run: impl Fn() -> Result<Sample, BenchError>) -> Result<Sample, BenchError> {
    let (mut sum, mut runs) = (run()?, 1.0);
    while sum.cpu_s < ENOUGH && runs < MOST_RUNS {
        let Sample { wall_s, cpu_s } = run()?;
        (sum, runs) = (Sample { wall_s: sum.wall_s + wall_s, cpu_s: sum.cpu_s + cpu_s }, runs + 1.0);
    }
    Ok(Sample { wall_s: sum.wall_s / runs, cpu_s: sum.cpu_s / runs })
}

/// Notes the errors of a history of the finite elements, and whether its balance closes.
fn answer(record: &mut BenchRecord, table: &Table, references: &References<'_>) {
    let column = |name: &str| table.column(name).unwrap_or_default();
    let size = |name: &str| largest(column(name).iter().map(|v| v.abs()));
    let open = size("balance_j_per_m") / size("external_work_j_per_m");
    record.verify_at_most("balance of energies over the largest work", open, BALANCE);
    record.note_errors(references.errors_of_elements(table));
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
        assert!(reason.contains("independent-fem is missing"), "{reason}");
    }

    #[test]
    fn a_corrected_run_has_the_toughness_of_its_mesh() {
        let run = Run { h: 0.5, tolerance: 1e-4, corrected: true };
        let words = run.words(Path::new("fem")).join(" ");
        assert!(words.contains("--h-mm 0.125000000 --toughness 2.771362587 --tolerance 1e-4 --out"), "{words}");
        assert_eq!(run.id(), "plate/elements/kappa-1e-4/h0.5");
        assert_eq!(run.label(), "elements, graded, Gc/κ, 1e-4");
        let words = Run { corrected: false, ..run }.words(Path::new("fem")).join(" ");
        assert!(words.contains("--toughness 3.000000000"), "{words}");
    }

    #[test]
    fn a_stored_history_has_the_error_of_its_mesh() {
        let data = own_workspace().join("reference-data");
        let library = Library::load(&data).unwrap();
        let references = References::of(&library).unwrap();
        let mut stored = Table::read(&data.join("submissions/independent-fem-h1/history.csv")).unwrap();
        stored.names[3] = "fracture_increment_j_per_m".into();
        stored.names.push("balance_j_per_m".into());
        stored.columns.push(vec![0.0; stored.rows()]);
        let mut record = BenchRecord::new("plate/elements/h1", "elements", 1.0, "run");
        answer(&mut record, &stored, &references);
        let error = record.error.as_ref().unwrap().value;
        assert!(record.verified && (0.07..0.095).contains(&error), "{record:?}");
        assert_eq!(record.errors().count(), 5);
        stored.names[1] = "kinetic".into();
        answer(&mut record, &stored, &references);
        assert!(!record.verified, "{record:?}");
    }
}
