//! `bench`: speed against error.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

use fisura_reports::bench::{self as report, Exhibit, Records};
use fisura_verification::bench::baseline::Baseline;
use fisura_verification::bench::record::BenchSet;
use fisura_verification::bench::{BenchError, FAMILIES, Session, Settings};
use fisura_verification::output::OutputFolder;
use fisura_verification::study::StudyError;

use crate::cli::Common;
use crate::environment::environment;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{console, folders, interrupt};

/// Arguments of `bench`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Few meshes and repetitions: under five minutes on an idle machine
    #[arg(long)]
    quick: bool,
    /// Only these families, separated by commas: work-precision, plate, scoreboard, stages, solves, threads,
    /// ceilings, scenes, contact, motion, scale
    #[arg(long, value_name = "FAMILY,…", value_delimiter = ',')]
    family: Vec<String>,
    /// Also time another checkout of this workspace on the same scenes; it is built in its own folder
    #[arg(long, value_name = "PATH")]
    baseline: Option<PathBuf>,
    /// Also time this program; it is called with a folder as its last argument, which holds particles.csv and
    /// block.json
    #[arg(long, value_name = "CMD")]
    peer: Option<String>,
    /// Timeout of one run of the program, in seconds
    #[arg(long, value_name = "SECONDS", default_value = "600", value_parser = clap::value_parser!(u64).range(1..))]
    peer_timeout: u64,
}

/// Measures, writes the report, and says which targets are met.
///
/// # Errors
/// An unknown family, a case or reference file that is wrong, a run that breaks down, a peer that fails, a
/// folder that cannot be written.
pub fn bench(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let known: Vec<&str> = FAMILIES.iter().map(|(name, _)| *name).collect();
    if let Some(unknown) = args.family.iter().find(|name| !known.contains(&name.as_str())) {
        let failure = Failure::input(format!("unknown family: {unknown}"));
        return Err(failure.help(format!("known families: {}", known.join(", "))));
    }
    if args.family.iter().any(|name| name == "peer") && args.peer.is_none() {
        return Err(Failure::input("the family peer needs a program").help("give one with --peer CMD"));
    }
    if args.family.iter().any(|name| name == "baseline") && args.baseline.is_none() {
        let failure = Failure::input("the family baseline needs another checkout of fisura");
        return Err(failure.help("give its folder with --baseline PATH"));
    }
    let baseline = args.baseline.as_deref().map(other_checkout).transpose()?;
    let folder = folders::output(common, "bench")?;
    let workspace = folders::workspace();
    let settings = Settings {
        quick: args.quick,
        threads: rayon::current_num_threads(),
        workspace: workspace.clone(),
        out: &folder,
        baseline,
        peer: args.peer.clone(),
        peer_timeout: Duration::from_secs(args.peer_timeout),
        families: args.family.clone(),
        elements: OnceLock::new(),
    };
    let session = Session::new(&settings, environment(&workspace))?;
    folder.begin(|_| false)?;
    write(&session, &folder)?; // says that it is unfinished, until the end
    let stop = || {
        if let Err(failure) = write(&session, &folder) {
            failure.show();
        }
        let message = format!("interrupted: the measurements so far are in {}", folder.path().display());
        Failure::new(Exit::Interrupted, message).show();
        folder.hold()
    };
    let run = interrupt::guard(|| session.run(&|family| console::note(common, family)), stop)?;
    let set = session.set();
    let mut written = write(&session, &folder);
    if run.is_ok() {
        // Otherwise it stays marked as unfinished.
        written = written.and(folder.finish().map_err(Failure::from));
    }
    console::show(common, &set, || text(&set));
    console::note(common, &format!("report: {}", folder.path().join("bench.html").display()));
    if let Err(error) = run {
        if let Err(failure) = written {
            failure.show();
        }
        return Err(error.into());
    }
    let holds = set.records.iter().all(|record| record.verified);
    Failure::beside(if holds { Exit::Done } else { Exit::CheckFailed }, written)
}

/// The other checkout, and this program to run beside it.
fn other_checkout(path: &Path) -> Result<Baseline, Failure> {
    let checkout = path.canonicalize().ok().filter(|path| path.join("xtask/Cargo.toml").is_file());
    let checkout = checkout.ok_or_else(|| {
        let failure = Failure::input(format!("--baseline {}: this folder is not a checkout of fisura", path.display()));
        failure.help("give a folder with another commit of this workspace, for example from `git worktree add`")
    })?;
    let program = std::env::current_exe();
    let program = program.map_err(|e| Failure::input(format!("the path of this program cannot be determined: {e}")))?;
    Ok(Baseline { program, checkout })
}

/// Writes what is measured so far, and its report.
fn write(session: &Session, folder: &OutputFolder) -> Result<(), Failure> {
    report::store(folder, &session.set())?;
    report::render(folder.path(), folder)?;
    Ok(())
}

/// The targets, the readings, and what does not hold.
fn text(set: &BenchSet) -> String {
    let mut rows: Vec<(String, String)> = Vec::new();
    for ratio in report::ratios::found(Records(&set.records)) {
        let word = match (ratio.verified, ratio.holds()) {
            (true, None) => String::new(),
            (true, Some(_)) => format!(", target {}", ratio.word()),
            (false, _) => format!(", {}", ratio.word()),
        };
        rows.push((ratio.what, format!("{:.3}{word}", ratio.value.median)));
    }
    let mut out = console::table(&rows);
    for exhibit in report::sections(set).into_iter().flat_map(|section| section.exhibits) {
        if let Exhibit::Plot(plot) = exhibit {
            out.push_str(&format!("\n{}: {}\n", plot.title, plot.reading));
        }
    }
    for record in set.records.iter().filter(|record| !record.verified) {
        out.push_str(&format!("\nFAIL {}: {}\n", record.id, record.answer));
    }
    out
}

impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Study(StudyError::Breakdown(breakdown)) => Self::from(&breakdown),
            BenchError::Study(other) => Self::new(Exit::BrokeDown, other.to_string()),
            BenchError::Case(error) => error.into(),
            BenchError::File(error) => error.into(),
            BenchError::Input(message) => {
                Self::input(message).help("`bench` reads verification/cases and reference-data of the workspace")
            }
            BenchError::Reference(error) => Self::input(error.to_string()),
            peer @ BenchError::Peer { .. } => Self::input(peer.to_string())
                .help("the program must take a folder as its last argument and end with status 0 before the timeout"),
        }
    }
}
