//! Finished cases of an interrupted run, kept in `partial/` of the results folder until the run is complete.
//!
//! An outcome is taken up only if program, case file, overrides and reference data are the same, and nobody
//! changed the file.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{CaseOutcome, Options, VerifyError};
use crate::case::Case;
use crate::output::OutputFolder;
use crate::output::fingerprint::{fingerprint, folder_fingerprint};

const FOLDER: &str = "partial/";

/// Outcomes of finished cases, stored in `partial/` of the results folder.
#[derive(Debug)]
pub(super) struct Store {
    out: Arc<OutputFolder>,
    /// What outcomes depend on beside their case; none if no outcome is stored or taken up.
    basis: Option<String>,
    /// Files of the selected cases.
    names: BTreeSet<String>,
    /// Those that are there, to be taken up.
    stored: BTreeSet<String>,
}

impl Store {
    /// # Errors
    /// If outcomes are there that this run would not take up, or reference data cannot be read.
    pub(super) fn open(cases: &[Case], options: &Options) -> Result<Self, VerifyError> {
        let out = Arc::clone(&options.out);
        let basis = if options.resume {
            Some(fingerprint([options.program, &folder_fingerprint(options.reference_data)?]))
        } else {
            None
        };
        let mut store = Self { out, basis, names: BTreeSet::new(), stored: BTreeSet::new() };
        store.names = cases.iter().filter_map(|case| store.name(case)).collect();
        // on disk, not only listed: who removed them did not want them any more
        let stored = store.out.files().into_iter().filter(|name| name.starts_with(FOLDER));
        store.stored = stored.filter(|name| store.out.read(name).is_some()).collect();
        let lost = store.stored.difference(&store.names).count();
        if lost > 0 {
            return Err(VerifyError::Interrupted { folder: store.out.path().to_path_buf(), cases: lost });
        }
        Ok(store)
    }

    fn name(&self, case: &Case) -> Option<String> {
        let print = fingerprint([self.basis.as_ref()?, &case.fingerprint()]);
        Some(format!("{FOLDER}{}-{}-{print}.json", case.suite, case.name))
    }

    /// Whether a file of the run before belongs to the cases that are taken up.
    pub(super) fn keeps(&self, name: &str) -> bool {
        self.stored.contains(name) || !self.stored.is_empty() && name.starts_with("series/")
    }

    pub(super) fn load(&self, case: &Case) -> Option<CaseOutcome> {
        serde_json::from_slice(&self.out.read(&self.name(case)?)?).ok()
    }

    pub(super) fn save(&self, case: &Case, outcome: &CaseOutcome) -> Result<(), VerifyError> {
        match self.name(case) {
            Some(name) => Ok(self.out.write_json(&name, outcome)?),
            None => Ok(()),
        }
    }

    /// The run is complete: nothing of it is left to take up.
    pub(super) fn finish(&self) -> Result<(), VerifyError> {
        let stored = self.out.files().into_iter().filter(|name| self.names.contains(name));
        Ok(stored.into_iter().try_for_each(|name| self.out.remove(&name))?)
    }
}
