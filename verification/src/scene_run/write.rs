//! Files of a run.

use super::SceneRun;
use crate::output::history::Table;
use crate::output::{Growing, OutputError, OutputFolder};

/// Name of the history.
pub const HISTORY: &str = "history.csv";

/// The history as it is written during a run.
pub(super) struct Followed<'a> {
    folder: &'a OutputFolder,
    /// Absent until there is a row.
    file: Option<Growing>,
    /// Number of rows of the history that the file holds already.
    rows: usize,
}

impl<'a> Followed<'a> {
    pub(super) fn new(folder: &'a OutputFolder) -> Self {
        Self { folder, file: None, rows: 0 }
    }

    /// Adds the rows that are not there yet.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(super) fn follow(&mut self, history: &Table) -> Result<(), OutputError> {
        if history.rows() == self.rows {
            return Ok(());
        }
        let text = history.csv_from(self.rows);
        let text = text.map_err(|error| OutputError::unwritable(&self.folder.path().join(HISTORY), error))?;
        let file = match &mut self.file {
            Some(file) => file,
            None => self.file.insert(self.folder.grow(HISTORY)?),
        };
        file.add(&text)?;
        self.rows = history.rows();
        Ok(())
    }
}

impl SceneRun {
    /// Writes `history.csv` (if there is a row), `summary.json` and, after a breakdown, `breakdown.json` into
    /// `folder`; names the files.
    ///
    /// # Errors
    /// The first file that cannot be written.
    pub fn write(&self, folder: &OutputFolder) -> Result<Vec<&'static str>, OutputError> {
        let mut files = Vec::new();
        if self.history.rows() > 0 {
            folder.write_table(HISTORY, &self.history)?;
            files.push(HISTORY);
        }
        folder.write_json("summary.json", &self.summary)?;
        files.push("summary.json");
        if let Some(report) = &self.breakdown_report {
            folder.write_json("breakdown.json", report)?;
            files.push("breakdown.json");
        }
        Ok(files)
    }
}
