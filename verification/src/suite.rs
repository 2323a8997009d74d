//! Suites: which cases there are, which are chosen, and running them into a folder of results.

mod judge;
pub mod merge;
pub mod part;
pub mod partition;
pub mod prepare;
mod resume;
mod selection;
mod supervise;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use thiserror::Error;

pub use crate::case::{Case, Tier};
use crate::figures;
use crate::foreign;
use crate::output::{OutputError, replace_file, write_json};
use crate::record::{Environment, Figure, Record, ResultSet, SCHEMA, Status};
use crate::reference::{Library, ReferenceError};
use crate::scene_file::SceneFileError;
use crate::study::scene::RunInfo;
pub use selection::{Malformed, Selection, load_cases, read_cases, select};

use part::{PART_SCHEMA, Part, Plan};
use partition::Slice;
use prepare::{Prepared, prepare};
use supervise::{Ended, supervised};

/// Where and how to run.
#[derive(Debug, Clone)]
pub struct Options<'a> {
    /// Results folder.
    pub out: &'a Path,
    /// Folder of reference data.
    pub reference_data: &'a Path,
    /// Recorded with the results.
    pub environment: Environment,
    /// Takes up the cases that an interrupted run of the same commit finished.
    pub resume: bool,
    /// Longest time of a case; absent: ten times its estimate, and no less than five minutes.
    pub case_timeout: Option<Duration>,
}

/// Told what is going on.
pub trait Progress: Sync {
    /// A case starts; `index` counts from 0.
    fn started(&self, case: &Case, index: usize, count: usize);
    /// The finished fraction of the case.
    fn advanced(&self, fraction: f64);
    /// A case is over its time and was asked to stop.
    fn late(&self, case: &Case, limit: Duration);
    /// A case is finished.
    fn finished(&self, case: &Case, records: &[Record]);
}

/// What keeps a verification from being carried out at all.
#[derive(Debug, Error)]
pub enum VerifyError {
    /// A case file is wrong.
    #[error(transparent)]
    Case(#[from] SceneFileError),
    /// Reference data are wrong.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// A file of the results cannot be written.
    #[error(transparent)]
    File(#[from] OutputError),
    /// The results folder cannot be made or read.
    #[error("{path}: {message}")]
    Output {
        /// File or folder.
        path: String,
        /// What is wrong.
        message: String,
    },
}

impl VerifyError {
    fn output(path: &Path, error: impl std::fmt::Display) -> Self {
        Self::Output { path: path.display().to_string(), message: error.to_string() }
    }
}

/// What one case found, as stored between sessions.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CaseOutcome {
    /// Records, in the order of the checks.
    pub records: Vec<Record>,
    /// Figures of the study itself.
    pub figures: Vec<Figure>,
    /// Runs of scenes.
    pub runs: Vec<RunInfo>,
}

/// Runs the cases and writes `results.json` and `series/*.csv` into the results folder.
///
/// # Errors
/// If a case or reference file is wrong, which is known before anything runs, or the folder cannot be written. A failed check
/// is a record, not an error, and so is a case that breaks down, panics or exceeds its time.
pub fn verify(cases: &[Case], options: &Options, progress: &dyn Progress) -> Result<ResultSet, VerifyError> {
    let library = Arc::new(Library::load(options.reference_data)?);
    let (outcomes, store) = run_cases(cases, options, &library, progress)?;
    let results = assemble(options.out, outcomes, inputs(cases), options.environment.clone(), &library)?;
    store.finish();
    Ok(results)
}

/// The same for a slice of a plan, `cases` being those of the slice; leaves a part for [`merge::merge`] as well.
///
/// # Errors
/// As [`verify`].
pub fn verify_slice(
    cases: &[Case],
    (slice, plan): (Slice, Plan),
    options: &Options,
    progress: &dyn Progress,
) -> Result<ResultSet, VerifyError> {
    let library = Arc::new(Library::load(options.reference_data)?);
    let (outcomes, store) = run_cases(cases, options, &library, progress)?;
    let named = cases.iter().map(Case::id).zip(outcomes.iter().cloned()).collect();
    let environment = options.environment.clone();
    let inputs = inputs(cases);
    let results = assemble(options.out, outcomes, inputs.clone(), environment.clone(), &library)?;
    let files = part::series_fingerprints(options.out)?;
    let (schema, digest) = (PART_SCHEMA.to_string(), String::new());
    Part { schema, slice, plan, environment, inputs, outcomes: named, files, digest }.write(options.out)?;
    store.finish();
    Ok(results)
}

/// The outcome of every case, run or taken up, and the store that still holds them.
fn run_cases(
    cases: &[Case],
    options: &Options,
    library: &Arc<Library>,
    progress: &dyn Progress,
) -> Result<(Vec<CaseOutcome>, resume::Store), VerifyError> {
    let prepared: Vec<Prepared> = cases.iter().map(|case| prepare(case, library)).collect::<Result<_, _>>()?;
    let series = options.out.join("series");
    let store = resume::Store::open(options)?;
    if !store.has_finished_cases() {
        remove_old_results(options.out);
    }
    std::fs::create_dir_all(&series).map_err(|e| VerifyError::output(&series, e))?;
    let mut outcomes = Vec::new();
    for (index, (case, prepared)) in cases.iter().zip(prepared).enumerate() {
        progress.started(case, index, cases.len());
        let outcome = match store.load(case) {
            Some(outcome) => outcome,
            None => {
                let prepared = Arc::new(prepared);
                match run_case(case, &prepared, options, library, progress) {
                    Ended::InTime(outcome) => {
                        let outcome = outcome?;
                        store.save(case, &outcome)?;
                        outcome
                    }
                    // to be tried again, and not taken up
                    Ended::Stopped(outcome) => outcome?,
                    Ended::Broken(message) => judge::broken(case, &prepared, &message),
                }
            }
        };
        progress.finished(case, &outcome.records);
        outcomes.push(outcome);
    }
    Ok((outcomes, store))
}

/// Least limit for the time of a case.
const LEAST_TIME: Duration = Duration::from_secs(300);
/// Limit for the time of a case over its estimate.
const PATIENCE: f64 = 10.0;

/// Runs a case under supervision.
fn run_case(
    case: &Case,
    prepared: &Arc<Prepared>,
    options: &Options,
    library: &Arc<Library>,
    progress: &dyn Progress,
) -> Ended<Result<CaseOutcome, VerifyError>> {
    let estimated = Duration::from_secs_f64((PATIENCE * case.seconds).min(1e9));
    let limit = options.case_timeout.unwrap_or(estimated.max(LEAST_TIME));
    let (judged, out) = (case.clone(), options.out.to_path_buf());
    let (plan, references) = (Arc::clone(prepared), Arc::clone(library));
    let work = move || judge::run_case(&judged, &plan, &out, &references);
    supervised(limit, &|part| progress.advanced(part), &|| progress.late(case, limit), work)
}

/// Writes what the outcomes of all cases give together: figures over several runs, their reference curves, the records.
fn assemble(
    out: &Path,
    outcomes: Vec<CaseOutcome>,
    inputs: BTreeMap<String, String>,
    environment: Environment,
    library: &Library,
) -> Result<ResultSet, VerifyError> {
    let runs: Vec<RunInfo> = outcomes.iter().flat_map(|o| o.runs.clone()).collect();
    let mut figures: Vec<Figure> = outcomes.iter().flat_map(|o| o.figures.clone()).collect();
    let mut tables = figures::add_references(&mut figures, library);
    let (drawn, of_runs) = figures::of_runs(&runs, library);
    tables.extend(of_runs);
    figures.extend(drawn);
    for (stem, table) in tables {
        write_series(out, &stem, &table)?;
    }
    let records = outcomes.into_iter().flat_map(|o| o.records).collect();
    let results = ResultSet { schema: SCHEMA.to_string(), environment, inputs, records, figures };
    write_json(&out.join("results.json"), &results)?;
    Ok(results)
}

/// What each case simulates.
fn inputs(cases: &[Case]) -> BTreeMap<String, String> {
    cases.iter().map(|case| (case.id(), case.inputs())).collect()
}

/// Series and figures of an earlier run, if the folder is one of results: they would pass for those of this one.
fn remove_old_results(out: &Path) {
    if out.join("results.json").exists() {
        let _ = std::fs::remove_file(out.join(part::PART_FILE)); // as below
        for folder in ["series", "figures"] {
            // What cannot be removed is overwritten where it matters, and writing reports the reason.
            let _ = std::fs::remove_dir_all(out.join(folder));
        }
    }
}

/// Worst status of a set of records.
pub fn worst(records: &[Record]) -> Option<Status> {
    let rank = |status: Status| match status {
        Status::Info => 0,
        Status::Pass => 1,
        Status::Fail => 2,
        Status::Error => 3,
    };
    records.iter().map(|r| r.status).max_by_key(|s| rank(*s))
}

/// Writes `series/<stem>.csv`, whole or not at all; a stem such as `timing/bar` has a folder of its own.
fn write_series(out: &Path, stem: &str, table: &crate::history::Table) -> Result<(), VerifyError> {
    let name = format!("series/{stem}.csv");
    let path = out.join(&name);
    if !foreign::is_plain(&name) {
        return Err(VerifyError::output(&path, "a series is named by plain names joined by single slashes"));
    }
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|e| VerifyError::output(folder, e))?;
    }
    Ok(replace_file(&path, |part| Ok(table.write(part)?))?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::history::Table;

    #[test]
    fn measured_times_have_a_folder_that_goes_with_old_results() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path();
        let mut table = Table::new(&["seconds"]);
        table.push(&[0.25]);
        write_series(out, "timing/bar", &table).unwrap();
        let written = out.join("series/timing/bar.csv");
        assert_eq!(Table::read(&written).unwrap(), table);
        remove_old_results(out);
        assert!(written.exists(), "a folder without results.json is none of ours");
        std::fs::write(out.join("results.json"), "{}").unwrap();
        remove_old_results(out);
        assert!(!out.join("series").exists());
    }

    #[test]
    fn a_panic_is_an_error_for_every_record_of_the_case() {
        let text = "claim = \"c\"\nseconds = 1\nstudy = \"basis\"\n[[check]]\nid = \"unity\"\n\
                    quantity = \"partition of unity, largest error\"\n";
        let case = Case::parse(Path::new("trial/case.toml"), text, &[]).unwrap();
        let prepared = prepare(&case, &Library::default()).unwrap();
        let ended = supervised(LEAST_TIME, &|_| (), &|| (), || -> () { panic!("planted") });
        let Ended::Broken(message) = ended else { panic!("it ended well") };
        let records = judge::broken(&case, &prepared, &message).records;
        let ids: Vec<&str> = records.iter().map(|record| record.id.as_str()).collect();
        assert_eq!(ids, ["p=1", "p=2", "p=3", "p=4"].map(|p| format!("trial/case/{p}/unity")));
        for record in &records {
            assert_eq!(record.status, Status::Error);
            let message = record.message.as_deref().unwrap();
            assert!(message.contains("planted") && message.contains("suite.rs"), "{message}");
        }
    }
}
