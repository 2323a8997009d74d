//! Suites: which cases there are, which are chosen, and running them into a folder of results.

mod judge;
pub mod merge;
pub mod part;
pub mod partition;
mod resume;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use thiserror::Error;

pub use crate::case::{Case, Tier};
use crate::figures;
use crate::output::{OutputError, replace_file, write_json};
use crate::record::{Environment, Figure, Record, ResultSet, SCHEMA, Status};
use crate::reference::{Library, ReferenceError};
use crate::scene_file::SceneFileError;
use crate::study::scene::RunInfo;

use part::{PART_SCHEMA, Part, Plan};
use partition::Slice;

/// Which cases to run.
#[derive(Debug, Clone)]
pub struct Selection {
    /// Suites; empty: all.
    pub suites: Vec<String>,
    /// Pattern that case ids match; absent: all.
    pub case_glob: Option<String>,
    /// Tier; the full tier includes the quick one.
    pub tier: Tier,
}

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
}

/// Told what is going on.
pub trait Progress: Sync {
    /// A case starts; `index` counts from 0.
    fn started(&self, case: &Case, index: usize, count: usize);
    /// The finished fraction of the case.
    fn advanced(&self, fraction: f64);
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

/// Every case below `folder`, `<suite>/<case>.toml`, in order of suite and name.
///
/// # Errors
/// The first case file that is wrong. `overrides` are `--set` keys, applied to the scene of every case.
pub fn load_cases(folder: &Path, overrides: &[String]) -> Result<Vec<Case>, SceneFileError> {
    let pattern = folder.join("*").join("*.toml");
    let paths = glob::glob(&pattern.to_string_lossy()).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = paths.collect();
    paths.sort();
    paths.iter().map(|path| Case::load(path, overrides)).collect()
}

/// The cases a selection names.
pub fn select(cases: Vec<Case>, selection: &Selection) -> Vec<Case> {
    let pattern = selection.case_glob.as_deref().and_then(|g| glob::Pattern::new(g).ok());
    let chosen = |case: &Case| {
        (selection.suites.is_empty() || selection.suites.contains(&case.suite))
            && (selection.case_glob.is_none() || pattern.as_ref().is_some_and(|p| p.matches(&case.id())))
            && case.tier <= selection.tier
    };
    cases.into_iter().filter(chosen).collect()
}

/// Runs the cases and writes `results.json` and `series/*.csv` into the results folder.
///
/// # Errors
/// If a case or reference file is wrong, or the folder cannot be written. A failed check is a record, not an error.
pub fn verify(cases: &[Case], options: &Options, progress: &dyn Progress) -> Result<ResultSet, VerifyError> {
    let library = Library::load(options.reference_data)?;
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
    let library = Library::load(options.reference_data)?;
    let (outcomes, store) = run_cases(cases, options, &library, progress)?;
    let named = cases.iter().map(Case::id).zip(outcomes.iter().cloned()).collect();
    let environment = options.environment.clone();
    let inputs = inputs(cases);
    let results = assemble(options.out, outcomes, inputs.clone(), environment.clone(), &library)?;
    Part { schema: PART_SCHEMA.to_string(), slice, plan, environment, inputs, outcomes: named }.write(options.out)?;
    store.finish();
    Ok(results)
}

/// The outcome of every case, run or taken up, and the store that still holds them.
fn run_cases(
    cases: &[Case],
    options: &Options,
    library: &Library,
    progress: &dyn Progress,
) -> Result<(Vec<CaseOutcome>, resume::Store), VerifyError> {
    let series = options.out.join("series");
    let store = resume::Store::open(options)?;
    if !store.has_finished_cases() {
        remove_old_results(options.out);
    }
    std::fs::create_dir_all(&series).map_err(|e| VerifyError::output(&series, e))?;
    let mut outcomes = Vec::new();
    for (index, case) in cases.iter().enumerate() {
        progress.started(case, index, cases.len());
        let outcome = match store.load(case) {
            Some(outcome) => outcome,
            None => {
                let outcome = judge::run_case(case, options.out, library, progress)?;
                store.save(case, &outcome)?;
                outcome
            }
        };
        progress.finished(case, &outcome.records);
        outcomes.push(outcome);
    }
    Ok((outcomes, store))
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
    let path = out.join("series").join(format!("{stem}.csv"));
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
}
