//! How long cases take on this machine: remembered from run to run, else what the case file says.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::NamedTempFile;

use crate::case::Case;

/// Wall times of cases, s.
#[derive(Debug, Default)]
pub struct Seconds {
    /// Where they are remembered, if they are.
    path: Option<PathBuf>,
    known: Mutex<BTreeMap<String, f64>>,
}

impl Seconds {
    /// Those remembered in a file; none if it is not there or not readable.
    pub fn remembered(path: PathBuf) -> Self {
        let text = std::fs::read(&path).unwrap_or_default();
        let known: BTreeMap<String, f64> = serde_json::from_slice(&text).unwrap_or_default();
        let sound = known.into_iter().filter(|(_, seconds)| seconds.is_finite() && *seconds >= 0.0);
        Self { path: Some(path), known: Mutex::new(sound.collect()) }
    }

    /// Expected wall time of a case, s: the remembered one, else that of the case file.
    pub fn of(&self, case: &Case) -> f64 {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.get(&case.id()).copied().unwrap_or(case.seconds)
    }

    /// A case took that long.
    pub(super) fn took(&self, case: &Case, seconds: f64) {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).insert(case.id(), seconds);
    }

    /// Remembers them. They only order what runs, so a file that cannot be written is no failure.
    pub(super) fn remember(&self) {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(path) = &self.path {
            let _ = replace(path, &known);
        }
    }
}

fn replace(path: &Path, known: &BTreeMap<String, f64>) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut file = NamedTempFile::new_in(folder)?;
    file.write_all(&serde_json::to_vec_pretty(known)?)?;
    file.persist(path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_remembered_and_a_spoiled_file_is_as_good_as_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("seconds.json");
        let text = "claim = \"c\"\nseconds = 7\nstudy = \"basis\"\n[[check]]\nid = \"unity\"\n\
                    quantity = \"partition of unity, largest error\"\n";
        let case = Case::parse(Path::new("trial/case.toml"), text, &[]).unwrap();
        let seconds = Seconds::remembered(path.clone());
        assert_eq!(seconds.of(&case), 7.0);
        seconds.took(&case, 2.5);
        seconds.remember();
        assert_eq!(Seconds::remembered(path.clone()).of(&case), 2.5);
        std::fs::write(&path, "{").unwrap();
        assert_eq!(Seconds::remembered(path).of(&case), 7.0);
    }
}
