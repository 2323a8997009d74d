//! Suites: which cases there are, which are chosen, and running them into a folder of results.

pub mod figures;
pub(crate) mod judge;
pub mod merge;
pub mod part;
pub mod partition;
pub mod prepare;
mod resume;
mod schedule;
mod seconds;
mod selection;
mod session;
mod supervise;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use thiserror::Error;

pub use crate::case::{Case, Tier};
use crate::output::{OutputError, OutputFolder};
pub use crate::record::worst;
use crate::record::{Environment, Figure, Record, ResultSet, SCHEMA};
use crate::reference::{Library, ReferenceError};
use crate::scene::SceneFileError;
use crate::study::scene::RunInfo;
pub use seconds::Seconds;
pub use selection::{Malformed, Selection, load_cases, read_cases, select};

use prepare::Prepared;
pub use session::Session;
use supervise::{Ended, Supervisor};

/// Where and how to run.
#[derive(Debug, Clone)]
pub struct Options<'a> {
    /// Folder into which the results are written.
    pub out: Arc<OutputFolder>,
    /// Folder of reference data.
    pub reference_data: &'a Path,
    /// Recorded with the results.
    pub environment: Environment,
    /// Name and sources of the program: cases that another one finished are not taken up.
    pub program: &'a str,
    /// Takes up the cases that an interrupted run of the same program finished.
    pub resume: bool,
    /// Longest time of a case; absent: ten times its estimate, and no less than five minutes.
    pub case_timeout: Option<Duration>,
    /// How long cases take on this machine.
    pub seconds: &'a Seconds,
}

/// Told what is going on, by several threads at once; does nothing about what it does not define.
pub trait Progress: Sync {
    /// Called when a case starts, also if its result is taken up from an interrupted run.
    fn started(&self, _case: &Case) {}
    /// The finished fraction of the case.
    fn advanced(&self, _case: &Case, _fraction: f64) {}
    /// A case has been running for ten times as long as it should.
    fn slow(&self, _case: &Case, _limit: Duration) {}
    /// A case is over its time and was asked to stop.
    fn late(&self, _case: &Case, _limit: Duration) {}
    /// A case is finished.
    fn finished(&self, _case: &Case, _records: &[Record]) {}
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
    /// An interrupted run could be gone on with, and this one would remove what it finished.
    #[error("{} contains {cases} finished cases of an interrupted run in partial/ that this run does not resume", folder.display())]
    Interrupted {
        /// Path of the results folder.
        folder: PathBuf,
        /// Number of finished cases that would be lost.
        cases: usize,
    },
}

/// What one case found, as stored between sessions.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CaseOutcome {
    /// Records, in the order of the checks.
    pub records: Vec<Record>,
    /// Figures of the study itself.
    pub figures: Vec<Figure>,
    /// What figures need to know of each scene that was run; empty unless the case has a `scene` study.
    pub runs: Vec<RunInfo>,
}

/// Runs the cases and writes `results.json` and `series/*.csv` into the results folder.
///
/// # Errors
/// If a case or reference file is wrong, which is known before anything runs, or the folder cannot be
/// written. A failed check is a record, not an error, and so is a case that breaks down, panics or exceeds
/// its time.
pub fn verify(cases: &[Case], options: &Options, progress: &dyn Progress) -> Result<ResultSet, VerifyError> {
    let session = Session::begin(cases, None, options)?;
    session.run(progress)?;
    session.results()
}

/// Least limit for the time of a case.
const LEAST_TIME: Duration = Duration::from_secs(300);
/// Least time after which a case is called slow.
const LEAST_SLOW: Duration = Duration::from_secs(30);
/// A case is slow, and over its time, beyond this multiple of its estimate.
const PATIENCE: f64 = 10.0;

/// Runs a case under supervision, on a number of threads.
fn run_case(
    case: &Case,
    prepared: &Arc<Prepared>,
    threads: usize,
    options: &Options,
    library: &Arc<Library>,
    progress: &dyn Progress,
) -> Ended<Result<CaseOutcome, VerifyError>> {
    let patience = |seconds: f64| Duration::from_secs_f64((PATIENCE * seconds).min(1e9));
    let limit = options.case_timeout.unwrap_or(patience(case.seconds).max(LEAST_TIME));
    let slow = patience(options.seconds.of(case)).max(LEAST_SLOW);
    let (judged, out) = (case.clone(), Arc::clone(&options.out));
    let (plan, references) = (Arc::clone(prepared), Arc::clone(library));
    let work = move || judge::run_case(&judged, &plan, &out, &references);
    let supervisor = Supervisor {
        threads,
        slow,
        limit,
        advanced: &|fraction| progress.advanced(case, fraction),
        is_slow: &|| progress.slow(case, slow),
        is_late: &|| progress.late(case, limit),
    };
    supervisor.run(work)
}

/// Writes what the outcomes of all cases give together: figures over several runs, their reference curves,
/// the records.
fn assemble(
    out: &OutputFolder,
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
    out.write_json("results.json", &results)?;
    Ok(results)
}

/// What each case simulates.
fn inputs(cases: &[Case]) -> BTreeMap<String, String> {
    cases.iter().map(|case| (case.id(), case.inputs())).collect()
}

/// Writes `series/<stem>.csv`; a stem such as `timing/bar` has a folder of its own.
fn write_series(out: &OutputFolder, stem: &str, table: &crate::output::history::Table) -> Result<(), VerifyError> {
    Ok(out.write_table(&format!("series/{stem}.csv"), table)?)
}

#[cfg(test)]
mod tests {
    use super::prepare::{Planned, Prepared};
    use super::*;
    use crate::record::Status;

    #[test]
    fn a_panic_is_an_error_for_every_record_of_the_case() {
        let text = "claim = \"c\"\nseconds = 1\nstudy = \"basis\"\n[[check]]\nid = \"unity\"\n\
                    quantity = \"partition of unity, largest error\"\n";
        let case = Case::parse(Path::new("trial/case.toml"), text, &[]).unwrap();
        let planned = |variant: &str| Planned { check: 0, variant: variant.to_string(), scene: None };
        let records = ["p=1", "p=2", "p=3", "p=4"].map(planned).to_vec();
        let prepared = Prepared { scenes: Vec::new(), records };
        let supervisor = Supervisor {
            threads: 1,
            slow: LEAST_TIME,
            limit: LEAST_TIME,
            advanced: &|_| (),
            is_slow: &|| (),
            is_late: &|| (),
        };
        let ended = supervisor.run(|| -> () { panic!("planted") });
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
