//! Finished cases of an interrupted run, kept in `partial/` of the results folder until the run is complete.
//!
//! An outcome is taken up only if commit, case file and overrides are the same and the work tree has no changes.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use super::{CaseOutcome, Options, VerifyError};
use crate::case::Case;
use crate::output::write_json;

/// Outcomes on disk.
pub(super) struct Store {
    folder: PathBuf,
    commit: String,
    trusted: bool,
}

impl Store {
    pub(super) fn open(options: &Options) -> Result<Self, VerifyError> {
        let folder = options.out.join("partial");
        std::fs::create_dir_all(&folder).map_err(|e| VerifyError::output(&folder, e))?;
        let environment = &options.environment;
        let trusted = options.resume && !environment.dirty && !environment.commit.is_empty();
        Ok(Self { folder, commit: environment.commit.clone(), trusted })
    }

    fn path(&self, case: &Case) -> PathBuf {
        let mut hasher = DefaultHasher::new();
        (&self.commit, case.document.text(), format!("{:?}", case.document.root)).hash(&mut hasher);
        self.folder.join(format!("{}-{}-{:016x}.json", case.suite, case.name, hasher.finish()))
    }

    /// Whether there may be cases to take up.
    pub(super) fn has_finished_cases(&self) -> bool {
        self.trusted && std::fs::read_dir(&self.folder).is_ok_and(|mut entries| entries.next().is_some())
    }

    pub(super) fn load(&self, case: &Case) -> Option<CaseOutcome> {
        if !self.trusted {
            return None;
        }
        serde_json::from_slice(&std::fs::read(self.path(case)).ok()?).ok()
    }

    pub(super) fn save(&self, case: &Case, outcome: &CaseOutcome) -> Result<(), VerifyError> {
        Ok(write_json(&self.path(case), outcome)?)
    }

    /// The run is complete: nothing is left to take up. A folder that cannot be removed does no harm.
    pub(super) fn finish(self) {
        let _ = std::fs::remove_dir_all(self.folder);
    }
}
