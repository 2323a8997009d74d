//! What can go wrong when a report is written.

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
    /// A file cannot be read, or a folder made.
    #[error("{path}: {source}", path = path.display())]
    File {
        /// File.
        path: PathBuf,
        /// Reason.
        source: std::io::Error,
    },
    /// The results are no JSON of the expected form.
    #[error("{path}: {message}", path = path.display())]
    Results {
        /// File.
        path: PathBuf,
        /// What is wrong, with line and column.
        message: String,
    },
    /// The results follow another schema.
    #[error("{path}: schema {found:?} is not {expected:?}; render it with the version of fisura that wrote it", path = path.display())]
    Schema {
        /// File.
        path: PathBuf,
        /// Schema of the file, empty if it names none.
        found: String,
        /// Schema that is understood.
        expected: &'static str,
    },
    /// Some figures could not be drawn; everything else was written, with a note in their place.
    #[error("{} figure(s) could not be drawn:{}", .0.len(), list(.0))]
    Figures(Vec<FigureError>),
    /// A writer of XML, JSON or HTML gave up.
    #[error("{file} cannot be rendered: {message}")]
    Render {
        /// File that was to be written.
        file: &'static str,
        /// Words of the library.
        message: String,
    },
}

fn list(errors: &[FigureError]) -> String {
    errors.iter().map(|e| format!("\n  {e}")).collect()
}
