//! What was written into a folder: `fisura.sha256`, which `sha256sum -c` reads.
//!
//! While a command runs, lines are appended before the files they list are there, so a name may be listed
//! with several hashes, and names of temporary files are listed; at the beginning and the end of a command
//! the list is written anew, without these. A file that grows while a command runs is named in a comment: its
//! hash is not known yet.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Read, Result as IoResult, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::SystemTime;

use sha2::{Digest, Sha256};

use super::error::OutputError;
use super::lock::LOCK;
use super::temporary;

/// Name of the file that lists what was written into a folder.
pub const MANIFEST: &str = "fisura.sha256";

/// Begins the first line, which ends with the command that the folder belongs to.
const SCHEMA: &str = "# fisura.manifest/1 ";
const UNFINISHED: &str = "# unfinished: a command is writing here, or was interrupted";
/// Begins the line of a file that grows.
const GROWS: &str = "# grows: ";

/// What is known of a file.
#[derive(Debug, Default)]
pub(super) struct Entry {
    /// Hashes of what may have been written.
    pub hashes: Vec<String>,
    /// Length and time of change after this process wrote it.
    pub seen: Option<(u64, Option<SystemTime>)>,
    /// Whether it grew when the list was written: what it holds then is ours, whatever it is.
    pub grows: bool,
}

impl Entry {
    /// A file of that hash, as it was seen when it was written.
    pub(super) fn of(hash: String, seen: Option<(u64, Option<SystemTime>)>) -> Self {
        Self { hashes: vec![hash], seen, grows: false }
    }
}

/// The list of a folder.
#[derive(Debug)]
pub(super) struct Manifest {
    /// Command that the folder belongs to; empty if nothing was written yet.
    pub owner: String,
    pub finished: bool,
    pub files: BTreeMap<String, Entry>,
    /// Where lines are appended, once there is one.
    journal: Option<File>,
}

/// Reads the list of a folder; an empty folder has an empty one.
///
/// # Errors
/// A folder that holds something and has no list, or cannot be read.
pub(super) fn read(folder: &Path) -> Result<Manifest, OutputError> {
    let path = folder.join(MANIFEST);
    // through a link it would be that of another folder
    let is_there = fs::symlink_metadata(&path).is_ok_and(|metadata| metadata.is_file());
    let text = if is_there { fs::read(&path).map_err(|e| OutputError::folder(folder, e))? } else { Vec::new() };
    if let Some(manifest) = parse(&String::from_utf8_lossy(&text)) {
        return Ok(manifest);
    }
    let begun = is_there && is_begun(&text);
    let entries = fs::read_dir(folder).map_err(|e| OutputError::folder(folder, e))?;
    for entry in entries {
        let name = entry.map_err(|e| OutputError::folder(folder, e))?.file_name();
        let ours = name == LOCK || begun && name == MANIFEST || temporary::is_temporary(&name.to_string_lossy());
        if !ours {
            return Err(OutputError::without_manifest(folder));
        }
    }
    Ok(Manifest { owner: String::new(), finished: false, files: BTreeMap::new(), journal: None })
}

/// Whether a list ends within its first line: the process that made it was killed, and wrote nothing else
/// yet.
fn is_begun(text: &[u8]) -> bool {
    !text.contains(&b'\n') && (SCHEMA.as_bytes().starts_with(text) || text.starts_with(SCHEMA.as_bytes()))
}

/// Lines that are no entries, such as half of one that was being written, list nothing.
fn parse(text: &str) -> Option<Manifest> {
    let mut lines = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
    let owner = lines.next()?.strip_prefix(SCHEMA)?.to_string();
    let mut finished = true;
    let mut files: BTreeMap<String, Entry> = BTreeMap::new();
    for line in lines {
        finished &= line != UNFINISHED;
        if let Some(name) = line.strip_prefix(GROWS) {
            files.entry(name.to_string()).or_default().grows = true;
        }
        let Some((hash, name)) = line.split_once("  ") else { continue };
        if hash.len() == 64 && hash.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            files.entry(name.to_string()).or_default().hashes.push(hash.to_string());
        }
    }
    Some(Manifest { owner, finished, files, journal: None })
}

impl Manifest {
    /// Whether lines were appended.
    pub(super) fn has_journal(&self) -> bool {
        self.journal.is_some()
    }

    /// Writes the whole list.
    pub(super) fn store(&mut self, folder: &Path) -> Result<(), OutputError> {
        let path = folder.join(MANIFEST);
        let failed = |error: &dyn std::fmt::Display| OutputError::unwritable(&path, error);
        let mut text = self.head();
        for (name, entry) in &self.files {
            if entry.grows {
                let _ = writeln!(text, "{GROWS}{name}"); // a String takes anything
            }
            for hash in &entry.hashes {
                let _ = writeln!(text, "{hash}  {name}");
            }
        }
        let hash = hash(text.as_bytes());
        let file = temporary::create(folder, |part| self.append(folder, &[(part, &hash)]));
        let mut file = file.map_err(|e| failed(&e))?;
        file.write_all(text.as_bytes()).map_err(|e| failed(&e))?;
        file.as_file().sync_all().map_err(|e| failed(&e))?;
        self.journal = Some(file.persist(&path).map_err(|e| failed(&e.error))?);
        Ok(())
    }

    /// The lines before those of files.
    fn head(&self) -> String {
        let unfinished = if self.finished { String::new() } else { format!("{UNFINISHED}\n") };
        format!("{SCHEMA}{}\n{unfinished}", self.owner)
    }

    /// Adds lines of names and hashes to the list on disk.
    pub(super) fn append(&mut self, folder: &Path, lines: &[(&str, &str)]) -> IoResult<()> {
        self.append_text(folder, &lines.iter().map(|(name, hash)| format!("{hash}  {name}\n")).collect::<String>())
    }

    /// Adds the line of a file that grows to the list on disk.
    pub(super) fn append_growing(&mut self, folder: &Path, name: &str) -> IoResult<()> {
        self.append_text(folder, &format!("{GROWS}{name}\n"))
    }

    fn append_text(&mut self, folder: &Path, text: &str) -> IoResult<()> {
        let mut journal = match self.journal.take() {
            Some(journal) => journal,
            None => self.open_journal(&folder.join(MANIFEST))?,
        };
        let end = journal.seek(SeekFrom::End(0))?;
        let written = journal.write_all(text.as_bytes()).and_then(|()| journal.sync_data());
        if written.is_err() {
            let _ = journal.set_len(end); // half a line would spoil the next one
        }
        self.journal = Some(journal);
        written
    }

    /// The list on disk as it is, without half a line at its end; begun if there is none.
    fn open_journal(&self, path: &Path) -> IoResult<File> {
        let is_new = match fs::symlink_metadata(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => true,
            found => !found?.is_file(), // then it is refused to be made
        };
        let mut file = OpenOptions::new().read(true).write(true).create_new(is_new).open(path)?;
        let mut text = Vec::new();
        file.read_to_end(&mut text)?;
        let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        file.set_len(whole as u64)?;
        if whole == 0 {
            file.rewind()?;
            file.write_all(self.head().as_bytes())?;
        }
        Ok(file)
    }
}

/// SHA-256 in hexadecimal digits.
pub(super) fn hash(content: &[u8]) -> String {
    Sha256::digest(content).iter().map(|byte| format!("{byte:02x}")).collect()
}
