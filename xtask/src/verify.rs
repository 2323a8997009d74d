//! `verify`: runs the suites, writes the report, says whether every check holds.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use fisura_reports::annotations::render_annotations;
use fisura_reports::number::duration;
use fisura_reports::text::render_text;
use fisura_verification::output::OutputFolder;
use fisura_verification::record::{Environment, Record, ResultSet, Status};
use fisura_verification::reference::Library;
use fisura_verification::suite::part::{Invocation, Plan};
use fisura_verification::suite::partition::Slice;
use fisura_verification::suite::prepare::prepare;
use fisura_verification::suite::{
    Case, Malformed, Options, Seconds, Selection, Session, Tier, VerifyError, read_cases, select, worst,
};

use crate::cli::Common;
use crate::environment::environment;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::watch::Watch;
use crate::{built, console, folders, interrupt};

/// Arguments of `verify`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only these suites, separated by commas
    #[arg(long, value_name = "SUITE,…", value_delimiter = ',')]
    suite: Vec<String>,
    /// Only cases whose id matches, such as plate/*
    #[arg(long, value_name = "GLOB")]
    case: Option<String>,
    /// quick (a few minutes in total), or full (all cases, about 3 hours)
    #[arg(long, value_name = "TIER", default_value = "quick", value_parser = str::parse::<Tier>)]
    tier: Tier,
    /// Only slice K of N of the selected cases, balanced by their estimated time; see `merge`
    #[arg(long, value_name = "slice:K/N", value_parser = str::parse::<Slice>)]
    partition: Option<Slice>,
    /// Timeout of a case, in seconds: its records become errors, and the other cases continue
    /// [default: ten times its estimate, at least 300]
    #[arg(long, value_name = "S", value_parser = seconds)]
    case_timeout: Option<Duration>,
    /// Change a value in the scene of every case; entries count from 0
    #[arg(long, value_name = "key.path=value")]
    set: Vec<String>,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse::<f64>().map_err(|error| error.to_string())?;
    let duration = Duration::try_from_secs_f64(seconds).map_err(|error| error.to_string())?;
    if duration.is_zero() { Err("the timeout must be positive".to_string()) } else { Ok(duration) }
}

/// Runs what is selected.
///
/// # Errors
/// Unknown suites, a bad pattern, nothing selected, a case or reference file that is wrong, a folder that
/// cannot be written.
pub fn verify(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let workspace = folders::workspace();
    let reference_data = workspace.join("reference-data");
    let environment = environment(&workspace);
    let mut cases = selected(args, common)?;
    let mut part = None;
    if let Some(slice) = args.partition {
        let invocation = Invocation {
            selection: &args.selection(),
            set: &args.set,
            commit: &environment.commit,
            sources: built::SOURCES,
            reference_data: &reference_data,
        };
        part = Some((slice, Plan::new(&cases, slice.count, invocation)?));
        cases = slice.take(cases);
        console::note(common, &format!("{slice}: {}", estimate(&cases, "cases")));
    } else if args.tier == Tier::Full {
        console::note(common, &estimate(&cases, "cases"));
    }
    let folder = Arc::new(folders::output(common, "verify")?);
    let stops = (args.tier == Tier::Full, args.case_timeout);
    let results = carry_out(&cases, part, (&folder, environment), stops, common)?;
    conclude(&results, &folder, common)
}

/// How many cases, by what they are called, and how long they take in all.
pub fn estimate(cases: &[Case], what: &str) -> String {
    let seconds = cases.iter().map(|case| case.seconds).sum();
    format!("{} {what}, estimated {} on two cores", cases.len(), duration(seconds))
}

/// Runs cases into a folder whose report says until [`conclude`] that they are unfinished, taking up what is
/// finished if that is asked for. An interrupt ends the process; what is finished then is in the report.
///
/// # Errors
/// A wrong case, files that cannot be read or written.
pub fn carry_out(
    cases: &[Case],
    part: Option<(Slice, Plan)>,
    (out, environment): (&Arc<OutputFolder>, Environment),
    (resume, case_timeout): (bool, Option<Duration>),
    common: &Common,
) -> Result<ResultSet, Failure> {
    let options = &Options {
        out: Arc::clone(out),
        reference_data: &folders::workspace().join("reference-data"),
        environment,
        program: &built::program(),
        resume,
        case_timeout,
        seconds: &Seconds::remembered(folders::workspace().join("target/fisura/seconds.json")),
    };
    let session = Session::begin(cases, part, options)?;
    fisura_reports::render(out.path(), out)?;
    let watch = Watch::new(cases, options.seconds, common);
    let stop = || {
        watch.finish();
        interrupted(&session, options).show();
        out.hold()
    };
    let run = interrupt::guard(|| session.run(&watch), stop)?;
    watch.finish();
    run?;
    Ok(session.results()?)
}

/// Writes what is finished.
fn interrupted(session: &Session, options: &Options) -> Failure {
    let folder = options.out.path();
    let written = session.results().map_err(Failure::from);
    if let Err(failure) = written.and_then(|_| Ok(fisura_reports::render(folder, &options.out)?)) {
        failure.show();
    }
    let (finished, all) = session.finished();
    let message =
        format!("interrupted: {finished} of {all} cases are finished; their report is in {}", folder.display());
    let help = if options.resume { "the same command continues with the remaining cases" } else { "run it again" };
    Failure::new(Exit::Interrupted, message).help(help)
}

/// Renders the report of finished results, prints them, and gives the verdict.
///
/// # Errors
/// A report that cannot be written.
pub fn conclude(results: &ResultSet, folder: &OutputFolder, common: &Common) -> Result<Exit, Failure> {
    let rendered = fisura_reports::render(folder.path(), folder).map(drop).map_err(Failure::from);
    let finished = folder.finish().map_err(Failure::from);
    console::show(common, results, || render_text(results));
    if std::env::var_os("GITHUB_ACTIONS").is_some_and(|value| value == "true") {
        console::error_text(&render_annotations(results));
    }
    console::note(common, &format!("report: {}", folder.path().join("report.html").display()));
    Failure::beside(verdict(&results.records), rendered.and(finished))
}

impl Args {
    fn selection(&self) -> Selection {
        Selection { suites: self.suite.clone(), case_glob: self.case.clone(), tier: self.tier }
    }
}

impl From<VerifyError> for Failure {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Case(error) => error.into(),
            VerifyError::File(error) => error.into(),
            VerifyError::Interrupted { .. } => Self::input(error.to_string()).help(
                "resume with the interrupted command, remove partial/ if it is not needed, or give another folder with --out",
            ),
            other => Self::input(other.to_string()),
        }
    }
}

/// The folder of the case files.
///
/// # Errors
/// If there is none.
pub fn cases_folder() -> Result<PathBuf, Failure> {
    let folder = folders::workspace().join("verification/cases");
    if folder.is_dir() {
        return Ok(folder);
    }
    let message = format!("there is no folder {} with case files", folder.display());
    Err(Failure::input(message).help("start it with `cargo xtask` or in the root of the workspace"))
}

/// The pattern of `--case`.
///
/// # Errors
/// If it is none.
pub fn checked_glob(pattern: Option<&str>) -> Result<Option<String>, Failure> {
    let Some(pattern) = pattern else { return Ok(None) };
    match glob::Pattern::new(pattern) {
        Ok(_) => Ok(Some(pattern.to_string())),
        Err(error) => Err(Failure::input(format!("--case {pattern}: {error}")).help("write a pattern such as plate/*")),
    }
}

/// The reference data.
///
/// # Errors
/// If they are wrong.
pub fn library() -> Result<Library, Failure> {
    Ok(Library::load(&folders::workspace().join("reference-data")).map_err(VerifyError::from)?)
}

fn selected(args: &Args, common: &Common) -> Result<Vec<Case>, Failure> {
    checked_glob(args.case.as_deref())?;
    let (cases, malformed) = read_cases(&cases_folder()?, &[]);
    let suites = cases.iter().map(|case| &case.suite).chain(malformed.iter().map(|file| &file.suite));
    let known: BTreeSet<&str> = suites.map(String::as_str).collect();
    let unknown: Vec<&str> = args.suite.iter().map(String::as_str).filter(|s| !known.contains(s)).collect();
    if !unknown.is_empty() {
        let known = known.into_iter().collect::<Vec<_>>().join(", ");
        return Err(
            Failure::input(format!("unknown suite: {}", unknown.join(", "))).help(format!("known suites: {known}"))
        );
    }
    let selection = args.selection();
    let (meant, others): (Vec<&Malformed>, Vec<&Malformed>) =
        malformed.iter().partition(|file| selection.names(&file.suite, &file.id));
    if let Some((first, rest)) = meant.split_first() {
        for file in rest {
            Failure::from(file.error.clone()).show();
        }
        return Err(first.error.clone().into());
    }
    for file in others {
        console::note(common, &format!("warning: {} is not valid and not selected; see `cargo xtask list`", file.id));
    }
    let cases = select(cases, &selection);
    if cases.is_empty() {
        let message = format!("no case of the {} tier is selected", args.tier);
        return Err(Failure::new(Exit::NothingSelected, message).help("`cargo xtask list` lists all cases"));
    }
    changed(args, cases, common)
}

/// The cases with the changes of `--set`, everything about them known to be valid before anything runs. A
/// case without a scene has nothing that could be changed: it is said, and the case stays as it is.
fn changed(args: &Args, cases: Vec<Case>, common: &Common) -> Result<Vec<Case>, Failure> {
    let library = library()?;
    let mut ready = Vec::new();
    for case in cases {
        let case = match case.scene_node() {
            Some(_) => Case::load(&case.path, &args.set)?,
            None => {
                if !args.set.is_empty() {
                    console::note(common, &format!("warning: {} has no scene that --set could change", case.id()));
                }
                case
            }
        };
        prepare(&case, &library)?;
        ready.push(case);
    }
    Ok(ready)
}

/// Exit status that the records deserve.
pub fn verdict(records: &[Record]) -> Exit {
    match worst(records.iter().map(|record| record.status)) {
        Some(Status::Error) => Exit::BrokeDown,
        Some(Status::Fail) => Exit::CheckFailed,
        _ => Exit::Done,
    }
}
