//! The parts of a plan joined: what one run of the whole plan writes, byte for byte but for times and environment.

use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::part::{PART_FILE, PART_SCHEMA, Part, folder_fingerprint};
use super::{CaseOutcome, VerifyError, assemble, remove_old_results};
use crate::record::{Environment, ResultSet};
use crate::reference::{Library, ReferenceError};

/// Why parts cannot be joined.
#[derive(Debug, Error)]
pub enum MergeError {
    /// A folder holds no part.
    #[error("{} cannot be read as a part: {message}", path.display())]
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
    #[error("slice {slice} is there twice, in {} and {}", first.display(), other.display())]
    Doubled {
        /// Which.
        slice: usize,
        /// First folder.
        first: PathBuf,
        /// Other folder.
        other: PathBuf,
    },
    /// Slices are not there.
    #[error("of {count} slices, these are missing: {}", list(slices))]
    Missing {
        /// How many the plan has.
        count: usize,
        /// Which are missing.
        slices: Vec<usize>,
    },
    /// A case of the plan has no outcome in the parts.
    #[error("no part holds the outcome of {0}")]
    NoOutcome(String),
    /// The figures would be drawn beside other references than those the checks used.
    #[error("the reference data here are not those of the parts")]
    OtherReferences,
    /// The results would be written over a part.
    #[error("{} is one of the parts; the joined results need a folder of their own", .0.display())]
    OverPart(PathBuf),
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

/// Joins the parts in `folders` into `out`: `results.json` and `series/`.
///
/// # Errors
/// Parts of different plans, slices missing or doubled, files that cannot be read or written; nothing is written then
/// but what the last two leave.
pub fn merge(folders: &[PathBuf], out: &Path, reference_data: &Path) -> Result<ResultSet, MergeError> {
    let parts = folders.iter().map(|folder| read(folder)).collect::<Result<Vec<Part>, _>>()?;
    let Some(first) = parts.first() else { return Err(MergeError::Missing { count: 0, slices: Vec::new() }) };
    check(folders, &parts)?;
    if folder_fingerprint(reference_data)? != first.plan.reference_data {
        return Err(MergeError::OtherReferences);
    }
    let same = |folder: &&PathBuf| fs::canonicalize(folder).ok().is_some_and(|f| fs::canonicalize(out).ok() == Some(f));
    if let Some(part) = folders.iter().find(same) {
        return Err(MergeError::OverPart(part.clone()));
    }
    let environment = environment(&parts);
    let plan = first.plan.clone();
    let inputs = parts.iter().flat_map(|part| part.inputs.clone()).collect();
    let mut found: Vec<(String, CaseOutcome)> = parts.into_iter().flat_map(|part| part.outcomes).collect();
    let mut outcomes = Vec::new();
    for (id, _) in plan.cases {
        let at = found.iter().position(|(found, _)| *found == id).ok_or_else(|| MergeError::NoOutcome(id.clone()))?;
        outcomes.push(found.swap_remove(at).1);
    }
    let library = Library::load(reference_data)?;
    remove_old_results(out);
    for folder in folders {
        copy(&folder.join("series"), &out.join("series"))?;
    }
    Ok(assemble(out, outcomes, inputs, environment, &library)?)
}

fn read(folder: &Path) -> Result<Part, MergeError> {
    let path = folder.join(PART_FILE);
    let fail = |message: String| MergeError::Unreadable { path: path.clone(), message };
    let text = fs::read_to_string(&path).map_err(|e| fail(e.to_string()))?;
    let value: serde_json::Value = serde_json::from_str(&text).map_err(|e| fail(e.to_string()))?;
    match value.get("schema").and_then(|s| s.as_str()) {
        Some(PART_SCHEMA) => serde_json::from_str(&text).map_err(|e| fail(e.to_string())),
        found => Err(fail(format!("its schema is {:?}, not {PART_SCHEMA:?}", found.unwrap_or_default()))),
    }
}

/// One plan, every slice once.
fn check(folders: &[PathBuf], parts: &[Part]) -> Result<(), MergeError> {
    for (folder, part) in folders.iter().zip(parts).skip(1) {
        if let Some((what, here, there)) = parts[0].plan.difference(&part.plan) {
            return Err(MergeError::Differs { first: folders[0].clone(), other: folder.clone(), what, here, there });
        }
    }
    let count = parts[0].plan.slices;
    let mut missing = Vec::new();
    for slice in 1..=count {
        let mut holders = folders.iter().zip(parts).filter(|(_, part)| part.slice.index == slice).map(|(f, _)| f);
        match (holders.next(), holders.next()) {
            (Some(first), Some(other)) => {
                return Err(MergeError::Doubled { slice, first: first.clone(), other: other.clone() });
            }
            (None, _) => missing.push(slice),
            (Some(_), None) => {}
        }
    }
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

/// Copies all finished files of a folder; one that is not there has nothing to copy.
fn copy(from: &Path, to: &Path) -> Result<(), VerifyError> {
    fs::create_dir_all(to).map_err(|e| VerifyError::output(to, e))?;
    for entry in fs::read_dir(from).into_iter().flatten() {
        let entry = entry.map_err(|e| VerifyError::output(from, e))?;
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        if source.is_dir() {
            copy(&source, &target)?;
        } else if source.extension().is_some_and(|ending| ending == "csv") {
            fs::copy(&source, &target).map_err(|e| VerifyError::output(&source, e))?;
        }
    }
    Ok(())
}
