//! Folders of results, as they are made and changed.

use std::fs;
use std::path::Path;

use fisura_reports::{Rendered, ReportError};
use fisura_verification::output::OutputFolder;
use fisura_verification::record::{Curve, Figure, FigureBody, ResultSet};
use tempfile::TempDir;

/// The fixture in a folder.
pub fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    crate::fixture::write(folder.path());
    folder
}

/// The fixture with changed results.
pub fn changed(edit: impl FnOnce(&mut ResultSet)) -> TempDir {
    let folder = folder();
    let mut results = crate::fixture::results();
    edit(&mut results);
    fs::write(folder.path().join("results.json"), serde_json::to_string(&results).unwrap()).unwrap();
    folder
}

/// Renders results beside themselves.
pub fn render(folder: &Path) -> Result<Rendered, ReportError> {
    fisura_reports::render(folder, &OutputFolder::reopen(folder).unwrap())
}

pub fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

pub fn curves(figure: &mut Figure) -> &mut Vec<Curve> {
    match &mut figure.body {
        FigureBody::Chart { curves, .. } => curves,
        FigureBody::Field { .. } => panic!("a field has no curves"),
    }
}
