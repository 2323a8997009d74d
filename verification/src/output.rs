//! Files that are written: each appears in full or not at all.

use std::error::Error;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// A file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{} cannot be written: {message}", path.display())]
pub struct OutputError {
    /// File.
    pub path: PathBuf,
    /// Reason.
    pub message: String,
}

/// Lets `write` fill a temporary file beside `path`, then gives it that name.
///
/// # Errors
/// What `write` says, or a name that cannot be given; the temporary file is removed.
pub fn replace_file(path: &Path, write: impl FnOnce(&Path) -> Result<(), Box<dyn Error>>) -> Result<(), OutputError> {
    let mut part: OsString = path.as_os_str().to_owned();
    part.push(".part");
    let part = PathBuf::from(part);
    let kept = |()| Ok(fs::File::open(&part)?.sync_all()?); // or a power failure could leave the name of an empty file
    let renamed = write(&part).and_then(kept).and_then(|()| Ok(fs::rename(&part, path)?));
    renamed.map_err(|error| {
        let _ = fs::remove_file(&part); // may not exist; the error to tell is the first one
        OutputError { path: path.to_path_buf(), message: error.to_string() }
    })
}

/// Writes `content`.
///
/// # Errors
/// See [`replace_file`].
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<(), OutputError> {
    replace_file(path, |part| Ok(fs::write(part, content)?))
}

/// Writes `value` as indented JSON with a newline at its end.
///
/// # Errors
/// See [`replace_file`].
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), OutputError> {
    replace_file(path, |part| Ok(fs::write(part, serde_json::to_string_pretty(value)? + "\n")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_written_is_named_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("absent/summary.json");
        let error = write(&path, "{}").unwrap_err();
        assert!(error.to_string().contains("absent/summary.json cannot be written"), "{error}");
        let path = folder.path().join("half.csv");
        let error = replace_file(&path, |part| {
            fs::write(part, "a,b\n")?;
            Err("no more rows".into())
        });
        assert_eq!(error.unwrap_err().message, "no more rows");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
