//! Results of a run that is under way or was stopped: a record of status error says so.

use super::{Accept, Record, ResultSet, Status};

/// Suite of the record that stands in the place of those that are still to come.
const UNFINISHED: &str = "unfinished";

impl ResultSet {
    /// Whether cases were still to be run when it was written.
    pub fn is_unfinished(&self) -> bool {
        self.records.iter().any(|record| record.suite == UNFINISHED)
    }
}

impl Record {
    /// What stands in results as long as only some of all cases are finished: an error, so that nobody takes
    /// them for whole.
    pub fn unfinished(finished: usize, all: usize) -> Self {
        Self {
            id: format!("{UNFINISHED}/run/cases"),
            suite: UNFINISHED.to_string(),
            case: "run".to_string(),
            claim: "All cases that were selected are run to their end".to_string(),
            quantity: "finished cases".to_string(),
            unit: "1".to_string(),
            value: Some(finished as f64),
            accept: Accept { min: Some(all as f64), why: "all that were selected".to_string(), ..Accept::default() },
            status: Status::Error,
            message: Some(format!("{finished} of {all} cases are finished: the run is in progress or was stopped")),
            ..Self::default()
        }
    }
}
