//! Which files of a folder commands wrote: `fisura.files`, a name per line.
//!
//! A name is listed before its file is there, so that a process that is killed leaves no file that nobody
//! knows.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use super::error::OutputError;
use super::lock::LOCK;
use super::whole::{self, PART};

/// Name of the list.
pub const MANIFEST: &str = "fisura.files";

/// Begins the first line, which ends with the command that the folder belongs to.
const SCHEMA: &str = "# fisura.files/1 ";
const UNFINISHED: &str = "# unfinished: a command is writing here, or was interrupted";

/// The list of a folder.
#[derive(Debug, Default)]
pub(super) struct Manifest {
    /// Command that the folder belongs to; empty if nothing was written yet.
    pub owner: String,
    pub finished: bool,
    pub names: BTreeSet<String>,
}

/// Reads the list of a folder; an empty folder has an empty one.
///
/// # Errors
/// A folder that holds something and has no list, or cannot be read.
pub(super) fn read(folder: &Path) -> Result<Manifest, OutputError> {
    let path = folder.join(MANIFEST);
    let failed = |error| OutputError::folder(folder, error);
    // through a link it would be that of another folder
    if fs::symlink_metadata(&path).is_ok_and(|metadata| metadata.is_file())
        && let Some(manifest) = parse(&String::from_utf8_lossy(&fs::read(&path).map_err(failed)?))
    {
        return Ok(manifest);
    }
    for entry in fs::read_dir(folder).map_err(failed)? {
        let name = entry.map_err(failed)?.file_name();
        if name != LOCK && name != PART {
            return Err(OutputError::without_manifest(folder));
        }
    }
    Ok(Manifest::default())
}

fn parse(text: &str) -> Option<Manifest> {
    let mut lines = text.lines();
    let owner = lines.next()?.strip_prefix(SCHEMA)?.to_string();
    let mut names: BTreeSet<String> = lines.map(String::from).collect();
    let finished = !names.remove(UNFINISHED);
    Some(Manifest { owner, finished, names })
}

impl Manifest {
    /// Writes the list.
    pub(super) fn store(&self, folder: &Path) -> Result<(), OutputError> {
        let mut text = format!("{SCHEMA}{}\n", self.owner);
        let mark = (!self.finished).then_some(UNFINISHED);
        mark.into_iter().chain(self.names.iter().map(String::as_str)).for_each(|line| text += &format!("{line}\n"));
        let path = folder.join(MANIFEST);
        whole::write(&path, text.as_bytes()).map_err(|e| OutputError::unwritable(&path, e))
    }
}
