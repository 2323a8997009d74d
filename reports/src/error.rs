//! What can go wrong when a report is written.

use std::fmt::Display;
use std::path::PathBuf;

use fisura_verification::output::OutputError;
use thiserror::Error;

use crate::series::FigureError;

/// A report that cannot be written, or not completely.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file cannot be read, is no JSON of the expected form and schema, or cannot be rendered.
    #[error("{path}: {message}", path = path.display())]
    File {
        /// Path of the file with the error.
        path: PathBuf,
        /// What is wrong, with line and column.
        message: String,
    },
    /// Some figures could not be drawn; everything else was written, with a note in their place.
    #[error("{} figure(s) could not be drawn:{}", .0.len(), list(.0))]
    Figures(Vec<FigureError>),
}

impl ReportError {
    /// Something wrong with a file.
    pub fn file(path: impl Into<PathBuf>, message: impl Display) -> Self {
        Self::File { path: path.into(), message: message.to_string() }
    }
}

fn list(errors: &[FigureError]) -> String {
    errors.iter().map(|e| format!("\n  {e}")).collect()
}
