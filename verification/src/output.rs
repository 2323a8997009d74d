//! Folders that commands write to, and what in them belongs to the user.
//!
//! An [`OutputFolder`] belongs to one process at a time (`lock.rs`) and lists in its manifest (`manifest.rs`)
//! every file that was written through it, with its hash. What is not listed, or was changed since, is the
//! user's: it is neither removed nor replaced. A folder that holds files and no manifest is refused as a
//! whole. No link is followed below the folder, nothing is removed recursively, and each file appears in full
//! or not at all: it is written under a random name that did not exist before, and renamed. Only a file that
//! grows while a command runs ([`Growing`]) can be read on the way.

mod error;
pub mod fingerprint;
pub mod foreign;
mod growing;
pub mod history;
mod lock;
mod manifest;
mod temporary;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::fs::{self, File, Metadata};
use std::io::{ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::Serialize;

use crate::output::history::Table;
pub use error::OutputError;
pub use growing::Growing;
pub use manifest::MANIFEST;
use manifest::{Entry, Manifest};

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
        folder.remove_temporary_files()?;
        Ok(folder)
    }

    /// Path of this folder, as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is certain that no other process writes here; some file systems have no locks.
    pub fn is_locked(&self) -> bool {
        self.lock.is_some()
    }

    /// Names of all files that the manifest lists.
    pub fn files(&self) -> Vec<String> {
        self.manifest().files.keys().cloned().collect()
    }

    /// Marks the folder as unfinished until [`Self::finish`], and removes the files of earlier runs but those
    /// to `keep`, first those that tell a verdict.
    ///
    /// # Errors
    /// A file that was changed since it was written, before anything is removed; one that cannot be removed.
    pub fn begin(&self, keep: impl Fn(&str) -> bool) -> Result<(), OutputError> {
        let mut manifest = self.manifest();
        let old: Vec<String> = manifest.files.keys().filter(|name| !keep(name)).cloned().collect();
        let is_changed = |name: &&String| matches!(self.state(&manifest, name), State::Changed);
        let changed: Vec<&String> = old.iter().filter(is_changed).collect();
        if !changed.is_empty() {
            return Err(OutputError::changed(&self.path, &changed));
        }
        manifest.finished = false;
        manifest.store(&self.path)?;
        in_order_of_removal(old).iter().try_for_each(|name| self.remove_from(&mut manifest, name))?;
        manifest.store(&self.path)
    }

    /// Writes a file below the folder; `name` has `/` between its parts.
    ///
    /// # Errors
    /// A file there that is not ours or was changed, a link on the way, a name that leads out of the folder,
    /// a full disk.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), OutputError> {
        let content = content.as_ref();
        let mut manifest = self.manifest();
        let path = self.place(name, true)?;
        if let State::Changed = self.state(&manifest, name) {
            return Err(OutputError::foreign(&path));
        }
        let failed = |error: &dyn std::fmt::Display| OutputError::unwritable(&path, error);
        let folder = path.parent().unwrap_or(&self.path);
        let hash = manifest::hash(content);
        let above = name.rsplit_once('/').map_or(String::new(), |(above, _)| format!("{above}/"));
        let file = temporary::create(folder, |part| {
            manifest.append(&self.path, &[(&format!("{above}{part}"), &hash), (name, &hash)])
        });
        let mut file = file.map_err(|e| failed(&e))?;
        manifest.files.entry(name.to_string()).or_default().hashes.push(hash.clone());
        file.write_all(content).map_err(|e| failed(&e))?;
        // Or a power failure could leave the name of an empty file.
        file.as_file().sync_all().map_err(|e| failed(&e))?;
        let file = file.persist(&path).map_err(|e| failed(&e.error))?;
        manifest.files.insert(name.to_string(), Entry::of(hash, file.metadata().ok().map(seen)));
        Ok(())
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

    /// Whether a file of that name could be written: nothing is there, or what was written here and not
    /// changed since.
    ///
    /// # Errors
    /// If it could not.
    pub fn check(&self, name: &str) -> Result<(), OutputError> {
        let path = self.place(name, false)?;
        match self.state(&self.manifest(), name) {
            State::Changed => Err(OutputError::foreign(&path)),
            State::Absent | State::Ours => Ok(()),
        }
    }

    /// Lists a file that a program wrote that this one started for that.
    ///
    /// # Errors
    /// A file that cannot be read, or is none.
    pub fn adopt(&self, name: &str) -> Result<(), OutputError> {
        let path = self.place(name, false)?;
        let unreadable = |error: std::io::Error| OutputError::unwritable(&path, error);
        if !fs::symlink_metadata(&path).map_err(unreadable)?.is_file() {
            return Err(OutputError::foreign(&path));
        }
        let hash = manifest::hash(&fs::read(&path).map_err(unreadable)?);
        let mut manifest = self.manifest();
        let listed = manifest.append(&self.path, &[(name, &hash)]);
        listed.map_err(|e| OutputError::unwritable(&self.path.join(MANIFEST), e))?;
        manifest.files.insert(name.to_string(), Entry::of(hash, None));
        Ok(())
    }

    /// Content of a file that was written here and not changed since.
    pub fn read(&self, name: &str) -> Option<Vec<u8>> {
        let manifest = self.manifest();
        let content = fs::read(self.place(name, false).ok()?).ok()?;
        manifest.files.get(name)?.hashes.contains(&manifest::hash(&content)).then_some(content)
    }

    /// Removes a file if it is there.
    ///
    /// # Errors
    /// A file that is not ours or was changed, or that cannot be removed.
    pub fn remove(&self, name: &str) -> Result<(), OutputError> {
        self.remove_from(&mut self.manifest(), name)
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

    /// Keeps all other threads from writing, and so from being cut short when the process ends; the manifest
    /// then lists what is there and nothing that was on its way.
    pub fn hold(&self) -> Held<'_> {
        let mut manifest = self.manifest();
        if manifest.has_journal() {
            let _ = manifest.store(&self.path); // only shorter than what is there
        }
        Held { _manifest: manifest }
    }

    fn manifest(&self) -> MutexGuard<'_, Manifest> {
        // It is changed after a file, and stays true.
        self.manifest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is there under a name.
    fn state(&self, manifest: &Manifest, name: &str) -> State {
        let Ok(path) = self.place(name, false) else { return State::Changed };
        let metadata = match fs::symlink_metadata(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return State::Absent,
            Ok(metadata) if metadata.is_file() => metadata,
            _ => return State::Changed,
        };
        let Some(entry) = manifest.files.get(name) else { return State::Changed };
        let ours = entry.grows
            || entry.seen.is_some_and(|last| last == seen(metadata))
            || fs::read(&path).is_ok_and(|content| entry.hashes.contains(&manifest::hash(&content)));
        if ours { State::Ours } else { State::Changed }
    }

    /// Path of a name, with the folders above it made if asked for; none of them may be a link.
    fn place(&self, name: &str, make: bool) -> Result<PathBuf, OutputError> {
        if [MANIFEST, lock::LOCK].contains(&name) {
            return Err(OutputError::outside(&self.path, name));
        }
        let mut path = self.path.clone();
        let mut parts = Path::new(name).components().peekable();
        while let Some(part) = parts.next() {
            let Component::Normal(part) = part else { return Err(OutputError::outside(&self.path, name)) };
            path.push(part);
            if parts.peek().is_none() {
                return Ok(path);
            }
            match fs::symlink_metadata(&path) {
                Ok(metadata) if metadata.is_dir() => {}
                Ok(_) => return Err(OutputError::foreign(&path)),
                Err(_) if make => fs::create_dir(&path).map_err(|e| OutputError::unwritable(&path, e))?,
                Err(_) => {}
            }
        }
        Err(OutputError::outside(&self.path, name))
    }

    fn remove_from(&self, manifest: &mut Manifest, name: &str) -> Result<(), OutputError> {
        let path = self.path.join(name);
        match self.state(manifest, name) {
            State::Changed => return Err(OutputError::foreign(&path)),
            State::Ours => fs::remove_file(&path).map_err(|e| OutputError::unwritable(&path, e))?,
            State::Absent => {}
        }
        manifest.files.remove(name);
        let above: BTreeSet<&Path> = Path::new(name).ancestors().skip(1).filter(|a| *a != Path::new("")).collect();
        for folder in above.into_iter().rev() {
            let _ = fs::remove_dir(self.path.join(folder)); // one that holds something stays
        }
        Ok(())
    }

    /// What a process left that was killed in the middle of writing.
    fn remove_temporary_files(&self) -> Result<(), OutputError> {
        let mut manifest = self.manifest();
        let names: Vec<String> = manifest.files.keys().filter(|name| temporary::is_temporary(name)).cloned().collect();
        for name in names {
            let path = self.place(&name, false)?;
            if fs::symlink_metadata(&path).is_ok_and(|metadata| metadata.is_file()) {
                fs::remove_file(&path).map_err(|e| OutputError::unwritable(&path, e))?;
            }
            manifest.files.remove(&name);
        }
        Ok(())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        let manifest = self.manifest.get_mut().unwrap_or_else(PoisonError::into_inner);
        if manifest.has_journal() {
            let _ = manifest.store(&self.path); // only shorter than what is there
        }
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
    /// Not ours, or not as it was written, or behind a link.
    Changed,
}

/// Tells a file that this process wrote from one that somebody changed, without reading it.
fn seen(metadata: Metadata) -> (u64, Option<std::time::SystemTime>) {
    (metadata.len(), metadata.modified().ok())
}
