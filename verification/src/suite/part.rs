//! What a slice of a plan leaves for `merge`: `part.json`, beside the results of the slice itself.

use std::collections::BTreeMap;
use std::path::Path;

use crate::output::fingerprint::{fingerprint, folder_fingerprint};
use serde::{Deserialize, Serialize};

use super::partition::Slice;
use super::{CaseOutcome, Selection, VerifyError};
use crate::case::Case;
use crate::output::OutputFolder;
use crate::record::Environment;

/// Name of the schema written and read.
pub const PART_SCHEMA: &str = "fisura.part/2";
/// File of a part in its results folder.
pub const PART_FILE: &str = "part.json";

/// What was to be run in all slices together; parts go together only if theirs are the same.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Commit of the work tree, or empty.
    pub commit: String,
    /// Fingerprint of the sources that the program was built from.
    pub sources: String,
    /// Tier that was asked for.
    pub tier: String,
    /// Suites; empty: all.
    pub suites: Vec<String>,
    /// Pattern of case ids, if one was given.
    pub case_glob: Option<String>,
    /// Changes of `--set`.
    pub set: Vec<String>,
    /// Number of slices into which the plan is divided.
    pub slices: usize,
    /// Fingerprint of the reference data.
    pub reference_data: String,
    /// Id and fingerprint of every case, in order.
    pub cases: Vec<(String, String)>,
}

/// What the caller knows of a plan beside its cases.
#[derive(Debug, Clone, Copy)]
pub struct Invocation<'a> {
    /// Suites, cases and tier that were selected.
    pub selection: &'a Selection,
    /// Changes of `--set`.
    pub set: &'a [String],
    /// Commit of the work tree, or empty.
    pub commit: &'a str,
    /// Fingerprint of the sources that the program was built from.
    pub sources: &'a str,
    /// Folder of reference data.
    pub reference_data: &'a Path,
}

impl Plan {
    /// The plan of `cases` in `slices` slices.
    ///
    /// # Errors
    /// Reference data that cannot be read.
    pub fn new(cases: &[Case], slices: usize, invocation: Invocation) -> Result<Self, VerifyError> {
        let Invocation { selection, set, commit, sources, reference_data } = invocation;
        Ok(Self {
            commit: commit.to_string(),
            sources: sources.to_string(),
            tier: selection.tier.to_string(),
            suites: selection.suites.clone(),
            case_glob: selection.case_glob.clone(),
            set: set.to_vec(),
            slices,
            reference_data: folder_fingerprint(reference_data)?,
            cases: cases.iter().map(|case| (case.id(), case.fingerprint())).collect(),
        })
    }

    /// In what two plans differ first, and how: name, this one, the other.
    pub fn difference(&self, other: &Self) -> Option<(&'static str, String, String)> {
        let of = |plan: &Self| {
            let list = |all: &[String]| if all.is_empty() { "none".to_string() } else { all.join(", ") };
            let word = |text: &str| if text.is_empty() { "none".to_string() } else { text.to_string() };
            [
                ("commit", word(&plan.commit)),
                ("sources of the program", word(&plan.sources)),
                ("number of slices", plan.slices.to_string()),
                ("tier", plan.tier.clone()),
                ("suites", list(&plan.suites)),
                ("pattern of cases", word(plan.case_glob.as_deref().unwrap_or_default())),
                ("changes of --set", list(&plan.set)),
                ("reference data", plan.reference_data.clone()),
            ]
        };
        let differing = of(self).into_iter().zip(of(other)).find(|(a, b)| a != b);
        let named = differing.map(|((name, here), (_, there))| (name, here, there));
        named.or_else(|| {
            let case = |plan: &Self, at: usize| {
                plan.cases.get(at).map_or("none".into(), |(id, print)| format!("{id} ({print})"))
            };
            let count = self.cases.len().max(other.cases.len());
            let at = (0..count).find(|&i| self.cases.get(i) != other.cases.get(i))?;
            Some(("cases", case(self, at), case(other, at)))
        })
    }
}

/// What one slice found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Name and version of the format, [`PART_SCHEMA`].
    pub schema: String,
    /// Number of the slice, and how many slices there are.
    pub slice: Slice,
    /// What it is a slice of.
    pub plan: Plan,
    /// Where and when it was run.
    pub environment: Environment,
    /// Fingerprint of what each of its cases simulated.
    pub inputs: BTreeMap<String, String>,
    /// Id and outcome of its cases, in the order of the plan.
    pub outcomes: Vec<(String, CaseOutcome)>,
    /// Fingerprint of every series file, by its name relative to the folder.
    pub files: BTreeMap<String, String>,
    /// Fingerprint of all of the above.
    pub digest: String,
}

impl Part {
    /// The same part with the fingerprint of what it holds. Whoever can write the file can make one: it tells
    /// a part that was cut off or edited from a whole one, not who made it.
    pub fn sealed(self) -> Self {
        Self { digest: self.content(), ..self }
    }

    /// Whether it holds what it was sealed with.
    pub fn is_whole(&self) -> bool {
        self.digest == self.content()
    }

    fn content(&self) -> String {
        let content = Self { digest: String::new(), ..self.clone() };
        fingerprint([serde_json::to_vec(&content).unwrap_or_default()]) // plain data, which JSON can hold
    }

    pub(super) fn write(self, out: &OutputFolder) -> Result<(), VerifyError> {
        Ok(out.write_json(PART_FILE, &self.sealed())?)
    }
}

/// Fingerprints of the series files that were written into a results folder, by their names.
pub(super) fn series_fingerprints(out: &OutputFolder) -> BTreeMap<String, String> {
    let names = out.files().into_iter().filter(|name| name.starts_with("series/"));
    names.filter_map(|name| Some((fingerprint([out.read(&name)?]), name))).map(|(print, name)| (name, print)).collect()
}
