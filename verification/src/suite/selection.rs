//! Which cases there are, and which of them are chosen.

use std::path::{Path, PathBuf};

use crate::case::{Case, Tier};
use crate::scene::SceneFileError;

/// Which cases to run.
#[derive(Debug, Clone)]
pub struct Selection {
    /// Suites; empty: all.
    pub suites: Vec<String>,
    /// Pattern that case ids match; absent: all.
    pub case_glob: Option<String>,
    /// Tier; the full tier includes the quick one.
    pub tier: Tier,
}

/// A case file that is wrong.
#[derive(Debug, Clone)]
pub struct Malformed {
    /// Suite of the case: the name of the folder that holds the file.
    pub suite: String,
    /// Id of the case: `suite/name`.
    pub id: String,
    /// What is wrong with it.
    pub error: SceneFileError,
}

/// Every case below `folder`, `<suite>/<case>.toml`, in order of suite and name, and the files that are
/// wrong. Hidden files, as editors leave them, are none. `overrides` are `--set` keys, applied to the scene
/// of every case.
pub fn read_cases(folder: &Path, overrides: &[String]) -> (Vec<Case>, Vec<Malformed>) {
    let pattern = PathBuf::from(glob::Pattern::escape(&folder.to_string_lossy())).join("*").join("*.toml");
    let options = glob::MatchOptions { require_literal_leading_dot: true, ..glob::MatchOptions::default() };
    let paths = glob::glob_with(&pattern.to_string_lossy(), options).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = paths.collect();
    paths.sort();
    let (mut cases, mut malformed) = (Vec::new(), Vec::new());
    for path in &paths {
        match Case::load(path, overrides) {
            Ok(case) => cases.push(case),
            Err(error) => {
                let word = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
                let suite = word(path.parent().and_then(Path::file_name));
                let id = format!("{suite}/{}", word(path.file_stem()));
                malformed.push(Malformed { suite, id, error });
            }
        }
    }
    (cases, malformed)
}

/// The same where no file may be wrong.
///
/// # Errors
/// The first case file that is wrong.
pub fn load_cases(folder: &Path, overrides: &[String]) -> Result<Vec<Case>, SceneFileError> {
    let (cases, malformed) = read_cases(folder, overrides);
    malformed.into_iter().next().map_or(Ok(cases), |wrong| Err(wrong.error))
}

impl Selection {
    /// Whether suite and id are selected, whatever the tier.
    pub fn names(&self, suite: &str, id: &str) -> bool {
        let pattern = self.case_glob.as_deref().map(glob::Pattern::new);
        (self.suites.is_empty() || self.suites.iter().any(|known| known == suite))
            && pattern.is_none_or(|pattern| pattern.is_ok_and(|pattern| pattern.matches(id)))
    }
}

/// The cases a selection names.
pub fn select(cases: Vec<Case>, selection: &Selection) -> Vec<Case> {
    let chosen = |case: &Case| selection.names(&case.suite, &case.id()) && case.tier <= selection.tier;
    cases.into_iter().filter(chosen).collect()
}
