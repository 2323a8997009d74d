//! Why a file or folder cannot be written, and what would help.

use std::fmt::Display;
use std::path::Path;

use super::manifest::MANIFEST;

/// A file or folder that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct OutputError {
    /// What is wrong, with the path.
    pub message: String,
    /// What the user can do about it, in words.
    pub remedy: String,
}

const ELSEWHERE: &str = "give a folder that can be written with --out";

impl OutputError {
    pub(crate) fn new(message: String, remedy: impl Into<String>) -> Self {
        Self { message, remedy: remedy.into() }
    }

    /// A file that the system does not let be written.
    pub fn unwritable(path: &Path, reason: impl Display) -> Self {
        Self::new(format!("{} cannot be written: {reason}", path.display()), ELSEWHERE)
    }

    pub(super) fn unreadable(path: &Path, reason: impl Display) -> Self {
        Self::new(format!("{} cannot be read: {reason}", path.display()), "check the path and the permissions")
    }

    pub(super) fn folder(path: &Path, reason: impl Display) -> Self {
        Self::new(format!("the output folder {} cannot be written: {reason}", path.display()), ELSEWHERE)
    }

    pub(super) fn in_use(path: &Path, holder: &str) -> Self {
        let message = format!("the output folder {} is in use by {holder}", path.display());
        Self::new(message, "wait until it has ended, or give another folder with --out")
    }

    pub(super) fn without_manifest(path: &Path) -> Self {
        let path = path.display();
        let message =
            format!("the folder {path} is not empty and has no {MANIFEST}: its files were not written by this program");
        Self::new(
            message,
            "give a new or empty folder with --out; if an older version of fisura wrote it, remove or move the folder",
        )
    }

    pub(super) fn of_another_command(path: &Path, owner: &str) -> Self {
        let message = format!("the folder {} contains the output of `{owner}`", path.display());
        Self::new(message, "give another folder with --out")
    }

    pub(super) fn changed(path: &Path, names: &[&String]) -> Self {
        let shown: Vec<&str> = names.iter().take(3).map(|name| name.as_str()).collect();
        let more = names.len().saturating_sub(3);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let message = format!(
            "the folder {} contains files that were changed after they were written: {}{more}",
            path.display(),
            shown.join(", ")
        );
        Self::new(message, "move them, remove them if they are not needed, or give another folder with --out")
    }

    pub(super) fn foreign(path: &Path) -> Self {
        let message = format!(
            "{} cannot be written: the existing file was not written by this program or was changed",
            path.display()
        );
        Self::new(message, "move it, remove it, or give another folder with --out")
    }

    pub(super) fn outside(path: &Path, name: &str) -> Self {
        Self::new(format!("{name:?} is not a valid name of a file in {}", path.display()), "use plain relative names")
    }
}
