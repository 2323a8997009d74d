//! Files of a run: each appears in full or not at all.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::SceneRun;

/// A file of a run that cannot be written.
#[derive(Debug, Error)]
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
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&Path) -> Result<(), Box<dyn std::error::Error>>,
) -> Result<(), OutputError> {
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

impl SceneRun {
    /// Writes `history.csv` (if there is a row), `summary.json` and, after a breakdown, `breakdown.json` into `folder`, which
    /// must exist; names the files.
    ///
    /// # Errors
    /// The first file that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<Vec<&'static str>, OutputError> {
        let mut files = Vec::new();
        if self.history.rows() > 0 {
            replace_file(&folder.join("history.csv"), |part| Ok(self.history.write(part)?))?;
            files.push("history.csv");
        }
        replace_file(&folder.join("summary.json"), |part| {
            let text = serde_json::to_string_pretty(&self.summary)?;
            Ok(fs::write(part, text + "\n")?)
        })?;
        files.push("summary.json");
        if let Some(report) = &self.breakdown_report {
            replace_file(&folder.join("breakdown.json"), |part| {
                Ok(fs::write(part, serde_json::to_string_pretty(report)? + "\n")?)
            })?;
            files.push("breakdown.json");
        }
        Ok(files)
    }
}
