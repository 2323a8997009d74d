//! The parts of a plan joined: what one run of the whole plan writes, byte for byte but for times and
//! environment.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::part::{PART_FILE, PART_SCHEMA, Part};
use super::{CaseOutcome, VerifyError, assemble};
use crate::output::fingerprint::{fingerprint, folder_fingerprint};
use crate::output::foreign;
use crate::output::{OutputError, OutputFolder};
use crate::record::{Environment, ResultSet};
use crate::reference::Library;

/// Most missing slices that are named.
const MOST_NAMED: usize = 100;

/// Why parts cannot be joined.
#[derive(Debug, Error)]
pub enum MergeError {
    /// They are not the slices of one plan as one program left them.
    #[error("{message}")]
    Parts {
        /// What is wrong, with the folders.
        message: String,
        /// What the user can do about it, in words.
        remedy: &'static str,
    },
    /// Reference data are wrong, or a file cannot be read or written.
    #[error(transparent)]
    File(#[from] VerifyError),
}

impl From<OutputError> for MergeError {
    fn from(error: OutputError) -> Self {
        Self::File(error.into())
    }
}

fn refused(message: String, remedy: &'static str) -> MergeError {
    MergeError::Parts { message, remedy }
}

const SLICE_AGAIN: &str = "run the slice again";
const ALL_AGAIN: &str = "run all slices again with one plan";
const PARTS: &str = "give the folders that `cargo xtask verify --partition slice:K/N` wrote";
const MORE: &str = "run the missing slices, and give the folders of all slices";

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
        let message = format!("{} cannot be merged into itself", part.display());
        return Err(refused(message, "give another folder with --out"));
    }
    // Whatever follows, the verdict of before is not that of these parts.
    out.begin(|_| false)?;
    let parts = folders.iter().map(|folder| read(folder)).collect::<Result<Vec<Part>, _>>()?;
    let Some(first) = parts.first() else { return Err(refused("there is no part".to_string(), MORE)) };
    check(folders, &parts)?;
    if first.plan.sources != sources {
        let message = format!(
            "this program was built from the sources {sources}, but the parts come from a program of the sources {}",
            first.plan.sources
        );
        return Err(refused(message, "check out the commit of the parts with the same changes, and build it again"));
    }
    if folder_fingerprint(reference_data)? != first.plan.reference_data {
        let message = "the reference data of this workspace differ from those of the parts".to_string();
        return Err(refused(message, "check out the commit of the parts with the same reference-data/"));
    }
    let mut prints: HashMap<&str, (&Path, &str)> = HashMap::new();
    for (folder, name, print) in files(folders, &parts) {
        content(folder, name, print)?;
        let (first, known) = *prints.entry(name).or_insert((folder, print));
        if known != print {
            let message = format!("{} differs in {} and {}", foreign::line(name), first.display(), folder.display());
            return Err(refused(message, ALL_AGAIN));
        }
    }
    let environment = environment(&parts);
    let plan = first.plan.clone();
    let inputs = parts.iter().flat_map(|part| part.inputs.clone()).collect();
    let outcomes = outcomes(plan.cases, &parts)?;
    let library = Library::load(reference_data).map_err(VerifyError::from)?;
    for (folder, name, print) in files(folders, &parts) {
        out.write(name, content(folder, name, print)?)?;
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
    let changed = |why: &dyn Display| changed(&folder.join(foreign::line(name).as_ref()), why);
    if !(name.starts_with("series/") && name.ends_with(".csv")) {
        return Err(changed(&"a part contains only CSV files below series/"));
    }
    let bytes = foreign::read(folder, name, foreign::SERIES_BYTES).map_err(|e| changed(&e))?;
    if fingerprint([&bytes]) != print {
        return Err(changed(&"its fingerprint differs"));
    }
    Ok(bytes)
}

fn changed(path: &Path, why: &dyn Display) -> MergeError {
    refused(format!("{} was changed after it was written: {why}", path.display()), SLICE_AGAIN)
}

/// The outcome of every case of the plan, in its order: one each, with records.
fn outcomes(cases: Vec<(String, String)>, parts: &[Part]) -> Result<Vec<CaseOutcome>, MergeError> {
    let unplanned =
        |id: &str| refused(format!("the parts contain a result of {id}, which is not in the plan"), ALL_AGAIN);
    let mut found: HashMap<&str, &CaseOutcome> = HashMap::new();
    for (id, outcome) in parts.iter().flat_map(|part| &part.outcomes) {
        if found.insert(id, outcome).is_some() {
            return Err(unplanned(id));
        }
    }
    let mut outcomes = Vec::new();
    for (id, _) in cases {
        match found.remove(id.as_str()).filter(|outcome| !outcome.records.is_empty()) {
            Some(outcome) => outcomes.push(outcome.clone()),
            None => return Err(refused(format!("no part contains the result of {id}"), SLICE_AGAIN)),
        }
    }
    found.keys().min().map_or(Ok(outcomes), |id| Err(unplanned(id)))
}

fn read(folder: &Path) -> Result<Part, MergeError> {
    let path = folder.join(PART_FILE);
    let bytes = foreign::read(folder, PART_FILE, foreign::DOCUMENT_BYTES).map_err(|e| invalid(&path, &e))?;
    let found = serde_json::from_slice::<Named>(&bytes).map_err(|e| invalid(&path, &e))?.schema;
    if found != PART_SCHEMA {
        return Err(invalid(&path, &format!("its schema is {found:?}, not {PART_SCHEMA:?}")));
    }
    let part: Part = serde_json::from_slice(&bytes).map_err(|e| invalid(&path, &e))?;
    if !part.is_whole() {
        return Err(changed(&path, &"its records differ from those of its seal"));
    }
    Ok(part)
}

fn invalid(path: &Path, why: &dyn Display) -> MergeError {
    refused(format!("{} is not a valid part: {why}", path.display()), PARTS)
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
            let (first, other) = (folders[0].display(), folder.display());
            let message = format!("{first} and {other} differ in the {what}: {here} and {there}");
            return Err(refused(message, "run all slices of one commit with the same selection, tier and changes"));
        }
    }
    let count = parts[0].plan.slices;
    let mut holders: BTreeMap<usize, &PathBuf> = BTreeMap::new();
    for (folder, part) in folders.iter().zip(parts) {
        let slice = part.slice.index;
        if !(1..=count).contains(&slice) {
            let message = format!("its slice {slice} is not between 1 and {count}");
            return Err(invalid(&folder.join(PART_FILE), &message));
        }
        if let Some(first) = holders.insert(slice, folder) {
            let message = format!("slice {slice} is a duplicate: in {} and {}", first.display(), folder.display());
            return Err(refused(message, "give every slice once"));
        }
    }
    let missing = (1..=count).filter(|slice| !holders.contains_key(slice)).take(MOST_NAMED);
    let missing: Vec<String> = missing.map(|slice| slice.to_string()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(refused(format!("of {count} slices, these are missing: {}", missing.join(", ")), MORE))
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
