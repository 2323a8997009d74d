//! `faults`: plants known errors in the solver, one at a time, and shows which checks catch each.
//!
//! Errors can be planted in a program built with the feature `faults` alone. It is built here, into a folder of its own, and
//! started once per fault and case with the name of the fault in its environment. A fault is caught if a check fails or a run
//! breaks down that did not without it.

mod results;
mod table;

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cli::{Common, Format};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{console, folders, progress};
use results::{CaseRun, Caught, Results};
use table::{FAULTS, Fault};

/// Variable that names the fault to plant.
const PLANTED: &str = "FISURA_FAULT";

/// Arguments of `faults`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only these faults, separated by commas
    #[arg(long, value_name = "FAULT,…", value_delimiter = ',')]
    fault: Vec<String>,
}

/// Plants every fault and looks for checks that turn red.
///
/// # Errors
/// An unknown fault, a program that cannot be built or started, a case that fails without a fault, a folder that cannot be
/// written.
pub fn faults(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let faults = chosen(args)?;
    let folder = folders::output(common, "faults")?;
    folder.begin(|_| false)?;
    let runner = Runner { program: build(common)?, folder: folder.path(), common };
    let cases: BTreeSet<&str> = faults.iter().flat_map(|fault| fault.cases).copied().collect();
    let runs = cases.len() + faults.iter().map(|fault| fault.cases.len()).sum::<usize>();
    let bar = progress::bar(common, "{msg} {wide_bar} {pos}/{len}, {elapsed}", runs as u64);
    let mut sound = Vec::new();
    for case in cases {
        bar.set_message(format!("no fault, {case}"));
        sound.push(runner.run(None, case)?.sound()?);
        bar.inc(1);
    }
    let mut results = Results { faults: Vec::new() };
    for fault in faults {
        let mut caught = Caught::new(fault);
        for case in fault.cases {
            bar.set_message(format!("{}, {case}", fault.id));
            let run = runner.run(Some(fault), case)?;
            if let Some(sound) = sound.iter().find(|sound| sound.case == *case) {
                caught.compare(&run, sound);
            }
            bar.inc(1);
        }
        results.faults.push(caught);
    }
    bar.finish_and_clear();
    results.write(&folder)?;
    match common.format {
        Format::Json => console::json(&results),
        Format::Text => console::result(&results.text()),
    }
    Ok(if results.survivors().next().is_some() { Exit::CheckFailed } else { Exit::Done })
}

/// Plants the fault that the environment names, if it names one.
///
/// # Errors
/// If no fault has that name.
#[cfg(feature = "faults")]
pub fn plant_from_environment() -> Result<(), Failure> {
    let Ok(name) = std::env::var(PLANTED) else { return Ok(()) };
    fisura::faults::plant(&name).map_err(|message| Failure::new(Exit::BadInput, message))
}

fn chosen(args: &Args) -> Result<Vec<&'static Fault>, Failure> {
    if args.fault.is_empty() {
        return Ok(FAULTS.iter().collect());
    }
    let find = |id: &String| {
        FAULTS.iter().find(|fault| fault.id == id).ok_or_else(|| {
            let known: Vec<&str> = FAULTS.iter().map(|fault| fault.id).collect();
            Failure::new(Exit::BadInput, format!("unknown fault: {id}")).help(format!("known: {}", known.join(", ")))
        })
    };
    args.fault.iter().map(find).collect()
}

/// Builds the program in which errors can be planted; it need not be fast, but soon there.
fn build(common: &Common) -> Result<PathBuf, Failure> {
    let workspace = folders::workspace();
    let target = workspace.join("target/faults");
    console::note(common, "building the program in which errors can be planted");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"));
    let mut command = Command::new(cargo);
    command.args(["build", "--quiet", "--release", "--package", "xtask", "--features", "faults", "--target-dir"]);
    command.arg(&target).current_dir(if workspace.as_os_str().is_empty() { Path::new(".") } else { &workspace });
    command.env("CARGO_PROFILE_RELEASE_LTO", "off").env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16");
    let status = command.status();
    let bad = |message: String| {
        Failure::new(Exit::BadInput, message).help("start it with `cargo xtask` in the workspace, with its source")
    };
    match status {
        Ok(status) if status.success() => {
            Ok(target.join("release").join(format!("xtask{}", std::env::consts::EXE_SUFFIX)))
        }
        Ok(status) => Err(bad(format!("the program in which errors can be planted cannot be built: cargo, {status}"))),
        Err(error) => Err(bad(format!("cargo cannot be started: {error}"))),
    }
}

/// Runs cases in the program in which errors can be planted.
struct Runner<'a> {
    program: PathBuf,
    folder: &'a Path,
    common: &'a Common,
}

impl Runner<'_> {
    fn run(&self, fault: Option<&Fault>, case: &str) -> Result<CaseRun, Failure> {
        let name = fault.map_or("none", |fault| fault.id);
        let folder = self.folder.join("runs").join(name).join(case.replace('/', "-"));
        let mut command = Command::new(&self.program);
        command.args(["verify", "--case", case, "--quiet", "--out"]).arg(&folder).env_remove(PLANTED);
        if let Some(fault) = fault {
            command.env(PLANTED, fault.id);
        }
        if let Some(threads) = self.common.threads {
            command.args(["--threads", &threads.to_string()]);
        }
        let output = command.output();
        let output = output.map_err(|error| {
            Failure::new(Exit::BadInput, format!("{} cannot be started: {error}", self.program.display()))
        })?;
        Ok(CaseRun::read(case, &folder, &output))
    }
}
