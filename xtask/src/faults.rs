//! `faults`: plants known errors, one at a time, and shows which checks catch each.
//!
//! Errors can be planted in a program built with the feature `faults` alone: it is built here, into a folder
//! of its own. A process of it (`worker.rs`) runs cases one after the other with one fault, named in its
//! environment. A fault is caught if a check fails or a run breaks down that did not without it. `--matrix`
//! runs every fault on every case of the quick tier whose run without a fault passes a site of it; on the
//! others the fault changes nothing, which needs no run. Each cell is stored as it is done ([`cells`]) and
//! taken up by the next run of the same program, cases and reference data.

mod campaign;
mod cells;
mod matrix;
mod results;
mod runner;
mod table;
#[cfg(feature = "faults")]
pub mod worker;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use fisura_verification::suite::{Case, Selection, Tier, load_cases, select};

use crate::cli::Common;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{console, folders, verify};
use campaign::Campaign;
use cells::Store;
use matrix::Matrix;
use results::Results;
use runner::Runner;
use table::{Fault, faults as all};

/// Variable that names the fault to plant.
const PLANTED: &str = "FISURA_FAULT";

/// Arguments of `faults`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only these faults, separated by commas
    #[arg(long, value_name = "FAULT,…", value_delimiter = ',')]
    fault: Vec<String>,
    /// Run every fault on every case of the quick tier instead of only its named cases; cheap cases run first
    #[arg(long)]
    matrix: bool,
    /// Start no more cases after this time; finished results are stored, and the next run resumes
    #[arg(long, value_name = "SECONDS")]
    budget: Option<u64>,
    /// Use this program, built with `--features faults`, instead of building one
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

/// Plants every fault and looks for checks that turn red.
///
/// # Errors
/// An unknown fault, a program that cannot be built or started, a case file that is wrong, a folder that
/// cannot be written.
pub fn faults(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let faults = chosen(args)?;
    let folder = folders::output(common, "faults")?;
    folder.begin(|name| name.starts_with(cells::FOLDER))?;
    let program = match &args.program {
        Some(program) => program.clone(),
        None => build(common)?,
    };
    let cases = load_cases(&verify::cases_folder()?, &[])?;
    let cases = select(cases, &Selection { suites: Vec::new(), case_glob: None, tier: Tier::Quick });
    let store = Store::open(&folder, &cells::keys(&program, &folders::workspace(), &cases)?)?;
    let runner = runner(args, common, program);
    let campaign = Campaign { faults: &faults, cases: &cases, store: &store, runner: &runner, common };
    campaign.run(args.matrix)?;
    let ids: Vec<String> = cases.iter().map(Case::id).collect();
    let results = Results::new(&faults, &ids, &store, args.matrix);
    let matrix = args.matrix.then(|| Matrix::new(&faults, &ids, &store));
    results.write(&folder, matrix.as_ref())?;
    console::show(common, &results, || results.text() + &matrix.as_ref().map_or(String::new(), Matrix::text));
    let lacking = results.lacking() || matrix.is_some_and(|matrix| matrix.lacking());
    Ok(if lacking { Exit::CheckFailed } else { Exit::Done })
}

/// Processes side by side, until the time is over.
fn runner(args: &Args, common: &Common, program: PathBuf) -> Runner {
    let deadline = args.budget.map(|seconds| Instant::now() + Duration::from_secs(seconds));
    let threads = common.threads.map_or_else(rayon::current_num_threads, |n| usize::from(n.get()));
    Runner::new(program, threads, deadline)
}

/// Plants the fault that the environment names, if it names one.
///
/// # Errors
/// If no fault has that name.
#[cfg(feature = "faults")]
pub fn plant_from_environment() -> Result<(), Failure> {
    let Ok(name) = std::env::var(PLANTED) else { return Ok(()) };
    fisura::faults::plant(known(&name)?.id.clone());
    Ok(())
}

/// The fault of a name.
///
/// # Errors
/// If no fault has it.
fn known(id: &str) -> Result<&'static Fault, Failure> {
    all().iter().find(|fault| fault.id == id).ok_or_else(|| {
        let known: Vec<&str> = all().iter().map(|fault| fault.id.as_str()).collect();
        Failure::input(format!("unknown fault: {id}")).help(format!("known: {}", known.join(", ")))
    })
}

fn chosen(args: &Args) -> Result<Vec<&'static Fault>, Failure> {
    if args.fault.is_empty() {
        return Ok(all().iter().collect());
    }
    args.fault.iter().map(|id| known(id)).collect()
}

/// Builds the program in which errors can be planted.
fn build(common: &Common) -> Result<PathBuf, Failure> {
    let workspace = folders::workspace();
    let target = workspace.join("target/faults");
    console::note(common, "building the program with planted errors");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"));
    let mut command = Command::new(cargo);
    command.args(["build", "--package", "xtask", "--features", "faults", "--target-dir"]);
    command.arg(&target).current_dir(if workspace.as_os_str().is_empty() { Path::new(".") } else { &workspace });
    let status = command.status();
    let bad =
        |message: String| Failure::input(message).help("start it with `cargo xtask` in the workspace with the sources");
    match status {
        Ok(status) if status.success() => {
            Ok(target.join("debug").join(format!("xtask{}", std::env::consts::EXE_SUFFIX)))
        }
        Ok(status) => Err(bad(format!("the program with planted errors cannot be built: cargo, {status}"))),
        Err(error) => Err(bad(format!("cargo cannot be started: {error}"))),
    }
}

#[cfg(test)]
mod tests;
