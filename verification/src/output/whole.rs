//! Files that appear in full or not at all.

use std::fs::{self, OpenOptions};
use std::io::{Result, Write};
use std::path::Path;

/// Name of a file on its way to its own; a process that is killed may leave one.
pub(super) const PART: &str = ".fisura.part";

/// Writes a file, or leaves what is there.
pub(super) fn write(path: &Path, content: &[u8]) -> Result<()> {
    let part = path.with_file_name(PART);
    let mut file = OpenOptions::new().write(true).create_new(true).open(&part)?;
    // Without the second step a power failure could leave the name of an empty file.
    let written = file.write_all(content).and_then(|()| file.sync_all());
    drop(file);
    written.and_then(|()| fs::rename(&part, path)).inspect_err(|_| drop(fs::remove_file(&part)))
}
