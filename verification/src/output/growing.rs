//! Files that others may read while they grow.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::PathBuf;

use super::manifest::Entry;
use super::{OutputError, OutputFolder, State};

/// A file that grows while a command runs. What is added is on disk, for others to read, when
/// [`Self::add`] returns. [`OutputFolder::write`] puts the whole file in its place.
#[derive(Debug)]
pub struct Growing {
    file: File,
    path: PathBuf,
}

impl Growing {
    /// Adds to the end.
    ///
    /// # Errors
    /// A full disk.
    pub fn add(&mut self, content: &[u8]) -> Result<(), OutputError> {
        self.file.write_all(content).map_err(|e| OutputError::unwritable(&self.path, e))
    }
}

impl OutputFolder {
    /// Begins a file of that name below the folder, empty.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn grow(&self, name: &str) -> Result<Growing, OutputError> {
        let mut manifest = self.manifest();
        let path = self.place(name, true)?;
        let failed = |error: std::io::Error| OutputError::unwritable(&path, error);
        match self.state(&manifest, name) {
            State::Changed => return Err(OutputError::foreign(&path)),
            State::Ours => fs::remove_file(&path).map_err(failed)?,
            State::Absent => {}
        }
        manifest.append_growing(&self.path, name).map_err(failed)?;
        manifest.files.insert(name.to_string(), Entry { grows: true, ..Entry::default() });
        let file = OpenOptions::new().write(true).create_new(true).open(&path).map_err(failed)?;
        Ok(Growing { file, path })
    }
}
