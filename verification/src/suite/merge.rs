//! The parts of a plan joined: what one run of the whole plan writes, byte for byte but for times and
//! environment.

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::part::{PART_FILE, PART_SCHEMA, Part};
use super::{CaseOutcome, VerifyError, assemble};
use crate::output::OutputFolder;
use crate::output::fingerprint::{fingerprint, folder_fingerprint};
use crate::output::foreign;
use crate::record::{Environment, ResultSet};
use crate::reference::{Library, ReferenceError};

/// Most missing slices that are named.
const MOST_NAMED: usize = 100;

/// Why parts cannot be joined.
#[derive(Debug, Error)]
pub enum MergeError {
    /// A folder holds no part.
    #[error("{} is not a valid part: {message}", path.display())]
    Unreadable {
        /// `part.json` of the folder.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// Two parts belong to different plans.
    #[error("{} and {} differ in the {what}: {here} and {there}", first.display(), other.display())]
    Differs {
        /// First folder.
        first: PathBuf,
        /// Other folder.
        other: PathBuf,
        /// What differs.
        what: &'static str,
        /// In the first.
        here: String,
        /// In the other.
        there: String,
    },
    /// A slice is there twice.
    #[error("slice {slice} is a duplicate: in {} and {}", first.display(), other.display())]
    Doubled {
        /// Which.
        slice: usize,
        /// First folder.
        first: PathBuf,
        /// Other folder.
        other: PathBuf,
    },
    /// Two parts hold a series of the same name.
    #[error("{name} differs in {} and {}", first.display(), other.display())]
    Contradicts {
        /// Of the series.
        name: String,
        /// First folder.
        first: PathBuf,
        /// Other folder.
        other: PathBuf,
    },
    /// A part is where the results are to be written.
    #[error("{} cannot be merged into itself", .0.display())]
    Itself(PathBuf),
    /// Slices are not there.
    #[error("of {count} slices, these are missing: {}", list(slices))]
    Missing {
        /// How many the plan has.
        count: usize,
        /// Which are missing, the first hundred.
        slices: Vec<usize>,
    },
    /// A part does not hold what it was sealed with.
    #[error("{} was changed after it was written: {message}", path.display())]
    Changed {
        /// File.
        path: PathBuf,
        /// How that is known.
        message: String,
    },
    /// A case of the plan has no outcome in the parts, or one without a record.
    #[error("no part contains the result of {0}")]
    NoOutcome(String),
    /// A case has two outcomes, or one that no slice was to find.
    #[error("the parts contain a result of {0}, which is not in the plan")]
    Unplanned(String),
    /// The parts would be put together by another program than the one that made them.
    #[error("this program was built from the sources {here}, but the parts come from a program of the sources {parts}")]
    OtherProgram {
        /// Fingerprint of the sources of this program.
        here: String,
        /// Fingerprint of those of the parts.
        parts: String,
    },
    /// The figures would be drawn beside other references than those the checks used.
    #[error("the reference data of this workspace differ from those of the parts")]
    OtherReferences,
    /// Reference data are wrong.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] VerifyError),
}

fn list(slices: &[usize]) -> String {
    slices.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

/// Joins the parts in `folders` into `out`: `results.json` and `series/`. `sources` is the fingerprint of the
/// sources of the present program.
///
/// # Errors
/// Parts of different plans or programs, emptied or edited ones, slices missing or doubled, files that cannot
/// be read or written; `out` is then marked as unfinished, without the results of before.
pub fn merge(
    folders: &[PathBuf],
    out: &OutputFolder,
    reference_data: &Path,
    sources: &str,
) -> Result<ResultSet, MergeError> {
    let own = fs::canonicalize(out.path()).ok();
    if let Some(part) = folders.iter().find(|folder| own.is_some() && fs::canonicalize(folder).ok() == own) {
        return Err(MergeError::Itself(part.clone()));
    }
    // Whatever follows, the verdict of before is not that of these parts.
    out.begin(|_| false).map_err(VerifyError::from)?;
    let parts = folders.iter().map(|folder| read(folder)).collect::<Result<Vec<Part>, _>>()?;
    let Some(first) = parts.first() else { return Err(MergeError::Missing { count: 0, slices: Vec::new() }) };
    check(folders, &parts)?;
    if first.plan.sources != sources {
        return Err(MergeError::OtherProgram { here: sources.to_string(), parts: first.plan.sources.clone() });
    }
    if folder_fingerprint(reference_data).map_err(VerifyError::from)? != first.plan.reference_data {
        return Err(MergeError::OtherReferences);
    }
    let mut prints: HashMap<&str, (&Path, &str)> = HashMap::new();
    for (folder, name, print) in files(folders, &parts) {
        content(folder, name, print)?;
        let (first, known) = *prints.entry(name).or_insert((folder, print));
        if known != print {
            let name = foreign::line(name).into_owned();
            return Err(MergeError::Contradicts { name, first: first.to_path_buf(), other: folder.to_path_buf() });
        }
    }
    let environment = environment(&parts);
    let plan = first.plan.clone();
    let inputs = parts.iter().flat_map(|part| part.inputs.clone()).collect();
    let outcomes = outcomes(plan.cases, &parts)?;
    let library = Library::load(reference_data)?;
    for (folder, name, print) in files(folders, &parts) {
        out.write(name, content(folder, name, print)?).map_err(VerifyError::from)?;
    }
    Ok(assemble(out, outcomes, inputs, environment, &library)?)
}

/// Every series file of every part: folder, name, fingerprint.
fn files<'a>(folders: &'a [PathBuf], parts: &'a [Part]) -> impl Iterator<Item = (&'a Path, &'a str, &'a str)> {
    let of_part = |(folder, part): (&'a PathBuf, &'a Part)| {
        part.files.iter().map(|(name, print)| (folder.as_path(), name.as_str(), print.as_str()))
    };
    folders.iter().zip(parts).flat_map(of_part)
}

/// The bytes of a series file, if they are those that the part was written with.
fn content(folder: &Path, name: &str, print: &str) -> Result<Vec<u8>, MergeError> {
    let changed = |message: String| MergeError::Changed { path: folder.join(foreign::line(name).as_ref()), message };
    if !(name.starts_with("series/") && name.ends_with(".csv")) {
        return Err(changed("a part contains only CSV files below series/".to_string()));
    }
    let bytes = foreign::read(folder, name, foreign::SERIES_BYTES).map_err(|e| changed(e.to_string()))?;
    if fingerprint([&bytes]) != print {
        return Err(changed("its fingerprint differs".to_string()));
    }
    Ok(bytes)
}

/// The outcome of every case of the plan, in its order: one each, with records.
fn outcomes(cases: Vec<(String, String)>, parts: &[Part]) -> Result<Vec<CaseOutcome>, MergeError> {
    let mut found: HashMap<&str, &CaseOutcome> = HashMap::new();
    for (id, outcome) in parts.iter().flat_map(|part| &part.outcomes) {
        if found.insert(id, outcome).is_some() {
            return Err(MergeError::Unplanned(id.clone()));
        }
    }
    let mut outcomes = Vec::new();
    for (id, _) in cases {
        match found.remove(id.as_str()).filter(|outcome| !outcome.records.is_empty()) {
            Some(outcome) => outcomes.push(outcome.clone()),
            None => return Err(MergeError::NoOutcome(id)),
        }
    }
    found.keys().min().map_or(Ok(outcomes), |id| Err(MergeError::Unplanned(id.to_string())))
}

fn read(folder: &Path) -> Result<Part, MergeError> {
    let path = folder.join(PART_FILE);
    let fail = |message: String| MergeError::Unreadable { path: path.clone(), message };
    let bytes = foreign::read(folder, PART_FILE, foreign::DOCUMENT_BYTES).map_err(|e| fail(e.to_string()))?;
    let found = serde_json::from_slice::<Named>(&bytes).map_err(|e| fail(e.to_string()))?.schema;
    if found != PART_SCHEMA {
        return Err(fail(format!("its schema is {found:?}, not {PART_SCHEMA:?}")));
    }
    let part: Part = serde_json::from_slice(&bytes).map_err(|e| fail(e.to_string()))?;
    if !part.is_whole() {
        let message = "its records differ from those of its seal".to_string();
        return Err(MergeError::Changed { path, message });
    }
    Ok(part)
}

/// The one key that every document has.
#[derive(serde::Deserialize)]
struct Named {
    #[serde(default)]
    schema: String,
}

/// One plan, every slice once.
fn check(folders: &[PathBuf], parts: &[Part]) -> Result<(), MergeError> {
    for (folder, part) in folders.iter().zip(parts).skip(1) {
        if let Some((what, here, there)) = parts[0].plan.difference(&part.plan) {
            return Err(MergeError::Differs { first: folders[0].clone(), other: folder.clone(), what, here, there });
        }
    }
    let count = parts[0].plan.slices;
    let mut holders: BTreeMap<usize, &PathBuf> = BTreeMap::new();
    for (folder, part) in folders.iter().zip(parts) {
        let slice = part.slice.index;
        if !(1..=count).contains(&slice) {
            let message = format!("its slice {slice} is not between 1 and {count}");
            return Err(MergeError::Unreadable { path: folder.join(PART_FILE), message });
        }
        if let Some(first) = holders.insert(slice, folder) {
            return Err(MergeError::Doubled { slice, first: first.clone(), other: folder.clone() });
        }
    }
    let missing: Vec<usize> = (1..=count).filter(|slice| !holders.contains_key(slice)).take(MOST_NAMED).collect();
    if missing.is_empty() { Ok(()) } else { Err(MergeError::Missing { count, slices: missing }) }
}

/// Where the parts were run: every processor, the earliest start.
fn environment(parts: &[Part]) -> Environment {
    let mut all = parts.iter().map(|part| part.environment.clone());
    let first = all.next().unwrap_or_default();
    let mut processors = vec![first.cpu.clone()];
    all.fold(first, |mut joined, environment| {
        if !processors.contains(&environment.cpu) {
            processors.push(environment.cpu);
            joined.cpu = processors.join("; ");
        }
        joined.dirty |= environment.dirty;
        joined.started = joined.started.min(environment.started);
        joined
    })
}
