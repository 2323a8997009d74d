//! Files of a run.

use super::SceneRun;
use crate::output::{OutputError, OutputFolder};

impl SceneRun {
    /// Writes `history.csv` (if there is a row), `summary.json` and, after a breakdown, `breakdown.json` into
    /// `folder`; names the files.
    ///
    /// # Errors
    /// The first file that cannot be written.
    pub fn write(&self, folder: &OutputFolder) -> Result<Vec<&'static str>, OutputError> {
        let mut files = Vec::new();
        if self.history.rows() > 0 {
            folder.write_table("history.csv", &self.history)?;
            files.push("history.csv");
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
