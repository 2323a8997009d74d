//! Folders that commands write to, and what in them belongs to the user.
//!
//! An [`OutputFolder`] belongs to one process at a time (`lock.rs`) and lists in its manifest (`manifest.rs`)
//! the name of every file that was written through it. What is not listed is the user's: it is neither
//! removed nor replaced. A folder that holds files and no manifest is refused as a whole. No link is followed
//! below the folder, nothing is removed recursively, and each file appears in full or not at all
//! (`whole.rs`). Only a file that grows while a command runs ([`Growing`]) can be read on the way.

mod error;
pub mod fingerprint;
pub mod foreign;
mod growing;
pub mod history;
mod lock;
mod manifest;
mod whole;

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::Serialize;

use crate::output::history::Table;
pub use error::OutputError;
pub use growing::Growing;
pub use manifest::MANIFEST;
use manifest::Manifest;
use whole::PART;

/// A folder that a command writes to: locked, and with a list of what was written.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    manifest: Mutex<Manifest>,
    /// Absent where the file system has no locks.
    lock: Option<File>,
}

/// Keeps everybody else from writing to a folder; see [`OutputFolder::hold`].
#[derive(Debug)]
pub struct Held<'a> {
    _manifest: MutexGuard<'a, Manifest>,
}

impl OutputFolder {
    /// Locks a folder for `command`, made if it is not there. No file is touched yet.
    ///
    /// # Errors
    /// A folder that cannot be made or written, that another process writes to, that holds files and no
    /// manifest, or the files of another command.
    pub fn open(path: &Path, command: &str) -> Result<Self, OutputError> {
        let folder = Self::locked(path, true)?;
        let mut manifest = folder.manifest();
        if manifest.owner.is_empty() {
            manifest.owner = command.to_string();
        }
        if manifest.owner != command {
            return Err(OutputError::of_another_command(path, &manifest.owner));
        }
        drop(manifest);
        Ok(folder)
    }

    /// Locks a folder to write beside what is there, whichever command wrote it.
    ///
    /// # Errors
    /// As [`Self::open`]; the folder must be there.
    pub fn reopen(path: &Path) -> Result<Self, OutputError> {
        Self::locked(path, false)
    }

    fn locked(path: &Path, make: bool) -> Result<Self, OutputError> {
        if make {
            fs::create_dir_all(path).map_err(|e| OutputError::folder(path, e))?;
        }
        manifest::read(path)?; // a folder of the user stays as it is, also a file that is called as the lock
        let lock = lock::take(path)?;
        let manifest = manifest::read(path)?;
        let folder = Self { path: path.to_path_buf(), manifest: Mutex::new(manifest), lock };
        folder.remove_parts()?;
        Ok(folder)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is certain that no other process writes here; some file systems have no locks.
    pub fn is_locked(&self) -> bool {
        self.lock.is_some()
    }

    /// Names of all files that the manifest lists.
    pub fn files(&self) -> Vec<String> {
        self.manifest().names.iter().cloned().collect()
    }

    /// Marks the folder as unfinished until [`Self::finish`], and removes the files of earlier runs but those
    /// to `keep`, first those that tell a verdict.
    ///
    /// # Errors
    /// A link or folder in place of a file, before anything is removed; a file that cannot be removed.
    pub fn begin(&self, keep: impl Fn(&str) -> bool) -> Result<(), OutputError> {
        let mut manifest = self.manifest();
        let old: Vec<String> = manifest.names.iter().filter(|name| !keep(name)).cloned().collect();
        let is_foreign = |name: &&String| matches!(self.state(&manifest, name), State::Foreign);
        let foreign: Vec<&String> = old.iter().filter(is_foreign).collect();
        if !foreign.is_empty() {
            return Err(OutputError::replaced(&self.path, &foreign));
        }
        manifest.finished = false;
        manifest.store(&self.path)?;
        in_order_of_removal(old).iter().try_for_each(|name| self.remove_from(&mut manifest, name))?;
        manifest.store(&self.path)
    }

    /// Writes a file below the folder; `name` has `/` between its parts.
    ///
    /// # Errors
    /// A file there that is not ours, a link on the way, a name that leads out of the folder, a full disk.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), OutputError> {
        let mut manifest = self.manifest(); // held to the end: one file is written at a time
        let path = self.claim(&mut manifest, name)?;
        whole::write(&path, content.as_ref()).map_err(|e| OutputError::unwritable(&path, e))
    }

    /// Writes `value` as indented JSON with a newline at its end.
    ///
    /// # Errors
    /// As [`Self::write`], and a value that JSON cannot hold.
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), OutputError> {
        let text = serde_json::to_string_pretty(value);
        self.write(name, text.map_err(|e| OutputError::unwritable(&self.path.join(name), e))? + "\n")
    }

    /// Writes a table as CSV.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn write_table(&self, name: &str, table: &Table) -> Result<(), OutputError> {
        self.write(name, table.to_csv().map_err(|e| OutputError::unwritable(&self.path.join(name), e))?)
    }

    /// Whether a file of that name could be written: nothing is there, or what was written here.
    ///
    /// # Errors
    /// If it could not.
    pub fn check(&self, name: &str) -> Result<(), OutputError> {
        let path = self.place(name, false)?;
        match self.state(&self.manifest(), name) {
            State::Foreign => Err(OutputError::foreign(&path)),
            State::Absent | State::Ours => Ok(()),
        }
    }

    /// Lists a file that a program wrote that this one started for that.
    ///
    /// # Errors
    /// Anything but a file.
    pub fn adopt(&self, name: &str) -> Result<(), OutputError> {
        let path = self.place(name, false)?;
        if !fs::symlink_metadata(&path).is_ok_and(|metadata| metadata.is_file()) {
            return Err(OutputError::foreign(&path));
        }
        self.list(&mut self.manifest(), name)
    }

    /// Content of a file that was written here.
    pub fn read(&self, name: &str) -> Option<Vec<u8>> {
        let ours = matches!(self.state(&self.manifest(), name), State::Ours);
        fs::read(self.place(name, false).ok()?).ok().filter(|_| ours)
    }

    /// Removes a file if it is there.
    ///
    /// # Errors
    /// A file that is not ours, or that cannot be removed.
    pub fn remove(&self, name: &str) -> Result<(), OutputError> {
        let mut manifest = self.manifest();
        self.remove_from(&mut manifest, name)?;
        manifest.store(&self.path)
    }

    /// The folder is complete: takes the mark of [`Self::begin`] away.
    ///
    /// # Errors
    /// A manifest that cannot be written.
    pub fn finish(&self) -> Result<(), OutputError> {
        let mut manifest = self.manifest();
        manifest.finished = true;
        manifest.store(&self.path)
    }

    /// Keeps all other threads from writing, and so from being cut short when the process ends.
    pub fn hold(&self) -> Held<'_> {
        Held { _manifest: self.manifest() }
    }

    fn manifest(&self) -> MutexGuard<'_, Manifest> {
        // It is changed after a file, and stays true.
        self.manifest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a name to the list.
    fn list(&self, manifest: &mut Manifest, name: &str) -> Result<(), OutputError> {
        let stored = if manifest.names.insert(name.to_string()) { manifest.store(&self.path) } else { Ok(()) };
        if stored.is_err() {
            manifest.names.remove(name);
        }
        stored
    }

    /// Path of a file that is to be written, with the folders above it and its name in the list.
    fn claim(&self, manifest: &mut Manifest, name: &str) -> Result<PathBuf, OutputError> {
        let path = self.place(name, true)?;
        if let State::Foreign = self.state(manifest, name) {
            return Err(OutputError::foreign(&path));
        }
        self.list(manifest, name)?;
        Ok(path)
    }

    /// What is there under a name.
    fn state(&self, manifest: &Manifest, name: &str) -> State {
        let Ok(path) = self.place(name, false) else { return State::Foreign };
        match fs::symlink_metadata(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => State::Absent,
            Ok(metadata) if metadata.is_file() && manifest.names.contains(name) => State::Ours,
            _ => State::Foreign,
        }
    }

    /// Path of a name, with the folders above it made if asked for; none of them may be a link.
    fn place(&self, name: &str, make: bool) -> Result<PathBuf, OutputError> {
        let last = name.rsplit('/').next().unwrap_or(name);
        if !foreign::is_plain(name) || [MANIFEST, lock::LOCK, PART].contains(&last) {
            return Err(OutputError::outside(&self.path, name));
        }
        let path = self.path.join(name);
        for folder in self.folders_above(name) {
            match fs::symlink_metadata(&folder) {
                Ok(metadata) if metadata.is_dir() => {}
                Ok(_) => return Err(OutputError::foreign(&folder)),
                Err(_) if make => fs::create_dir(&folder).map_err(|e| OutputError::unwritable(&folder, e))?,
                Err(_) => {}
            }
        }
        Ok(path)
    }

    /// Folders between this one and a file, from the outside in.
    fn folders_above(&self, name: &str) -> Vec<PathBuf> {
        name.match_indices('/').map(|(end, _)| self.path.join(&name[..end])).collect()
    }

    fn remove_from(&self, manifest: &mut Manifest, name: &str) -> Result<(), OutputError> {
        let path = self.path.join(name);
        match self.state(manifest, name) {
            State::Foreign => return Err(OutputError::foreign(&path)),
            State::Ours => fs::remove_file(&path).map_err(|e| OutputError::unwritable(&path, e))?,
            State::Absent => {}
        }
        manifest.names.remove(name);
        for folder in self.folders_above(name).iter().rev() {
            let _ = fs::remove_dir(folder); // one that holds something stays
        }
        Ok(())
    }

    /// Removes what a process left that was killed in the middle of writing.
    fn remove_parts(&self) -> Result<(), OutputError> {
        let names = self.files();
        let mut folders: BTreeSet<PathBuf> = names.iter().flat_map(|name| self.folders_above(name)).collect();
        folders.insert(self.path.clone());
        for part in folders.iter().map(|folder| folder.join(PART)) {
            if fs::symlink_metadata(&part).is_ok_and(|metadata| metadata.is_file()) {
                fs::remove_file(&part).map_err(|e| OutputError::unwritable(&part, e))?;
            }
        }
        Ok(())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        if let Some(lock) = &self.lock {
            let _ = lock.set_len(0); // nobody holds it any more
            // Closing is not enough while a process that is being started still has the file.
            let _ = lock.unlock();
        }
    }
}

/// Files that tell what a command found, or begin so: none may outlive the others.
const VERDICTS: [&str; 6] = ["results.json", "report.html", "summary.md", "junit.xml", "metrics", "bench."];

/// Names with those that tell a verdict first.
fn in_order_of_removal(mut names: Vec<String>) -> Vec<String> {
    names.sort_by_key(|name| !VERDICTS.iter().any(|verdict| name.starts_with(verdict)));
    names
}

/// What is there under a name.
enum State {
    Absent,
    Ours,
    /// Not listed, no file, or behind a link.
    Foreign,
}

#[cfg(test)]
mod tests;
