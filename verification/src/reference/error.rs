//! What can be wrong with reference data.

use std::path::Path;

use thiserror::Error;

/// Reference data that cannot be used: which file, where in it, what is wrong and what would help.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{path}: {place}{message}; {remedy}")]
pub struct ReferenceError {
    /// Path of the file or folder that cannot be used.
    pub path: String,
    /// Line and key, followed by `: `; empty if the whole file is meant.
    pub place: String,
    /// What is wrong at that place, in words.
    pub message: String,
    /// What the user can do about it, in words.
    pub remedy: String,
}

impl ReferenceError {
    /// An error about a whole file or folder.
    pub(super) fn file(path: &Path, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { path: path.display().to_string(), place: String::new(), message: message.into(), remedy: remedy.into() }
    }

    /// An error at a key of a file.
    pub(super) fn at(
        path: &Path,
        line: usize,
        key: &str,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self { place: format!("line {line}, {key}: "), ..Self::file(path, message, remedy) }
    }
}
