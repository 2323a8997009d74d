//! Files of a run.

use std::path::Path;

use super::SceneRun;
use crate::output::{OutputError, replace_file, write_json};

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
        write_json(&folder.join("summary.json"), &self.summary)?;
        files.push("summary.json");
        if let Some(report) = &self.breakdown_report {
            write_json(&folder.join("breakdown.json"), report)?;
            files.push("breakdown.json");
        }
        Ok(files)
    }
}
