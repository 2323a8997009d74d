//! The errors that can be planted, and the checks that none turns red, as `table.toml` lists them.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

/// An error that can be planted, in the solver or where results are judged.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fault {
    /// Name, as at its sites.
    pub id: String,
    /// Description of the error in words.
    pub what: String,
    /// Cases of the quick tier it is run on.
    pub cases: Vec<String>,
}

/// Checks that stay green.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Idle {
    /// Pattern of `suite/case/quantity`.
    checks: String,
    reason: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    fault: Vec<Fault>,
    idle: Vec<Idle>,
}

static TABLE: LazyLock<Table> =
    LazyLock::new(|| toml::from_str(include_str!("table.toml")).expect("table.toml lists faults; tests read it"));

/// All errors that can be planted.
pub fn faults() -> &'static [Fault] {
    &TABLE.fault
}

/// Why a check stays though no fault turns it red, if somebody said so.
pub fn reason_to_stay(check: &str) -> Option<&'static str> {
    let matches = |idle: &&Idle| glob::Pattern::new(&idle.checks).is_ok_and(|pattern| pattern.matches(check));
    TABLE.idle.iter().find(matches).map(|idle| idle.reason.as_str())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::{Path, PathBuf};

    use fisura_verification::case::{Case, Tier};

    use super::*;

    fn workspace() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
    }

    fn source_files() -> impl Iterator<Item = String> {
        let patterns = ["solver", "verification"].map(|part| workspace().join(part).join("src/**/*.rs"));
        let paths = patterns.into_iter().flat_map(|pattern| glob::glob(&pattern.to_string_lossy()).unwrap());
        paths.map(|path| std::fs::read_to_string(path.unwrap()).unwrap())
    }

    /// Names behind `fault!(` in the code of a text, comments left out.
    fn sites(text: &str) -> BTreeSet<String> {
        let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        let text = code.join("\n");
        let behind = text.split("fault!(").skip(1).filter_map(|rest| rest.trim_start().strip_prefix('"'));
        behind.filter_map(|rest| rest.split('"').next()).map(str::to_string).collect()
    }

    #[test]
    fn the_table_and_the_sites_name_the_same_faults() {
        let table: BTreeSet<String> = faults().iter().map(|fault| fault.id.clone()).collect();
        assert_eq!(table.len(), faults().len(), "a name stands twice");
        let found: BTreeSet<String> = source_files().flat_map(|text| sites(&text)).collect();
        assert_eq!(found, table);
    }

    #[test]
    fn every_fault_names_cases_of_the_quick_tier() {
        for fault in faults() {
            assert!(!fault.cases.is_empty(), "{}", fault.id);
            for case in &fault.cases {
                let path = workspace().join("verification/cases").join(case).with_extension("toml");
                let found = Case::load(&path, &[]).unwrap_or_else(|e| panic!("{}: {case}: {e}", fault.id));
                assert!(found.tier == Tier::Quick, "{case} is not of the quick tier");
            }
        }
    }
}
