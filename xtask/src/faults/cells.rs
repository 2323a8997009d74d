//! What is known of each case with each fault: a file of `cells/` per cell, written as soon as it is done. A
//! cell counts as long as program, case file and reference data are those it was made with.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use fisura_verification::output::fingerprint::{fingerprint, folder_fingerprint};
use fisura_verification::output::{OutputError, OutputFolder};
use fisura_verification::record::Status;
use fisura_verification::suite::Case;
use serde::{Deserialize, Serialize};

use super::runner::{Ending, Report};
use crate::failure::Failure;

/// Below this folder of the output.
pub const FOLDER: &str = "cells/";

/// A case with a fault, or without any.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// The fault; none in a sound run.
    pub fault: Option<String>,
    /// Id of the case: `suite/name`.
    pub case: String,
    key: String,
    /// Wall time on one thread, s.
    pub seconds: f64,
    /// Records that fail or are errors; with a fault also those that pass in the sound run and no longer do.
    pub red: Vec<String>,
    /// Records within a known limit.
    pub limited: Vec<String>,
    /// Of a sound run: records that pass, which are those that could turn red.
    pub green: Vec<String>,
    /// Of a sound run: faults whose sites it passes.
    pub passed: Vec<String>,
    /// Why there are no records, if there are none.
    pub ended: Option<String>,
}

/// All cells that count.
#[derive(Debug)]
pub struct Store<'a> {
    folder: &'a OutputFolder,
    keys: BTreeMap<String, String>,
    cells: Mutex<BTreeMap<(Option<String>, String), Cell>>,
}

/// What the cells of every case depend on.
///
/// # Errors
/// A program or reference data that cannot be read.
pub fn keys(program: &Path, workspace: &Path, cases: &[Case]) -> Result<BTreeMap<String, String>, Failure> {
    let common = [program_key(program)?, folder_fingerprint(&workspace.join("reference-data"))?];
    let key = |case: &Case| fingerprint([&common[0], &common[1], &case.fingerprint()]);
    Ok(cases.iter().map(|case| (case.id(), key(case))).collect())
}

/// Fingerprint of the planted program.
fn program_key(program: &Path) -> Result<String, Failure> {
    let unreadable = |e| Failure::input(format!("{} cannot be read: {e}", program.display()));
    Ok(fingerprint([fs::read(program).map_err(unreadable)?]))
}

impl<'a> Store<'a> {
    /// The cells in a folder that count; others are removed, and so are those of runs that ended without
    /// records: the machine may have been busy then.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn open(folder: &'a OutputFolder, keys: &BTreeMap<String, String>) -> Result<Self, OutputError> {
        let mut cells = BTreeMap::new();
        for name in folder.files().into_iter().filter(|name| name.starts_with(FOLDER)) {
            let cell = folder.read(&name).and_then(|bytes| serde_json::from_slice::<Cell>(&bytes).ok());
            let counts = |cell: &Cell| keys.get(&cell.case) == Some(&cell.key) && cell.ended.is_none();
            match cell.filter(counts) {
                Some(cell) => drop(cells.insert((cell.fault.clone(), cell.case.clone()), cell)),
                None => folder.remove(&name)?,
            }
        }
        Ok(Self { folder, keys: keys.clone(), cells: Mutex::new(cells) })
    }

    /// Adds a cell.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn put(&self, fault: Option<&str>, case: &str, ending: Ending) -> Result<(), OutputError> {
        let mut cell = Cell::new(fault, case, self.keys.get(case).cloned().unwrap_or_default(), ending);
        if let Some(sound) = fault.and_then(|_| self.get(None, case)) {
            let lost = cell.limited.iter().filter(|id| sound.green.contains(id));
            cell.red.extend(lost.cloned());
        }
        self.folder.write_json(&format!("{FOLDER}{}/{case}.json", fault.unwrap_or("none")), &cell)?;
        self.cells().insert((cell.fault.clone(), cell.case.clone()), cell);
        Ok(())
    }

    /// A cell, if it is known; that of the sound run for no fault.
    pub fn get(&self, fault: Option<&str>, case: &str) -> Option<Cell> {
        self.cells().get(&(fault.map(String::from), case.to_string())).cloned()
    }

    fn cells(&self) -> MutexGuard<'_, BTreeMap<(Option<String>, String), Cell>> {
        self.cells.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Cell {
    fn new(fault: Option<&str>, case: &str, key: String, ending: Ending) -> Self {
        let (fault, case) = (fault.map(String::from), case.to_string());
        let (ended, Report { seconds, records, passed, .. }) = match ending {
            Ok(report) => (None, report),
            Err(message) => (Some(message), Report::default()),
        };
        let those = |wanted: fn(Status) -> bool| {
            let ids = records.iter().filter(|(_, status)| wanted(*status)).map(|(id, _)| id.clone());
            ids.collect::<Vec<String>>()
        };
        let red = those(|status| matches!(status, Status::Fail | Status::Error));
        let limited = those(|status| status == Status::KnownLimit);
        let sound = fault.is_none();
        let green = if sound { those(|status| status == Status::Pass) } else { Vec::new() };
        Self { fault, case, key, seconds, red, limited, green, passed: if sound { passed } else { Vec::new() }, ended }
    }

    /// Whether no check fails.
    pub fn holds(&self) -> bool {
        self.red.is_empty() && self.ended.is_none()
    }
}
