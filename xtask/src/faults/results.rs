//! What catches each fault, and the files that say so.

use fisura_reports::template::filled;
use fisura_verification::output::{OutputError, OutputFolder};
use minijinja::value::Serde;
use serde::Serialize;

use super::cells::Store;
use super::matrix::Matrix;
use super::table::Fault;

/// All that was found.
#[derive(Debug, Serialize)]
pub struct Results {
    /// One entry per fault.
    pub faults: Vec<Caught>,
    /// Cases that do not hold without a fault: nothing can be learnt from them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unsound: Vec<String>,
}

/// What caught a fault.
#[derive(Debug, Serialize)]
pub struct Caught {
    #[serde(flatten)]
    fault: &'static Fault,
    /// Records that fail, or are errors, with the fault alone.
    caught_by: Vec<String>,
    /// Checks that pass, or lie within a known limit, without it.
    checks: usize,
    /// How cases ended that have no records.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ended: Vec<String>,
}

impl Caught {
    fn new(fault: &'static Fault, cases: &[String], store: &Store, all: bool) -> Self {
        let mut caught = Self { fault, caught_by: Vec::new(), checks: 0, ended: Vec::new() };
        let others = cases.iter().filter(|case| all && !fault.cases.contains(case));
        for case in fault.cases.iter().chain(others) {
            let (Some(sound), Some(cell)) = (store.get(None, case), store.get(Some(&fault.id), case)) else { continue };
            caught.checks += sound.green.len() + sound.limited.len();
            caught.caught_by.extend(cell.red);
            caught.ended.extend(cell.ended.map(|why| format!("{case}: {why}")));
        }
        caught
    }
}

impl Results {
    /// From what is known: of the cases named for each fault, or of all.
    pub fn new(faults: &[&'static Fault], cases: &[String], store: &Store, all: bool) -> Self {
        let unsound = cases.iter().filter(|case| store.get(None, case).is_some_and(|cell| !cell.holds()));
        Self {
            faults: faults.iter().map(|fault| Caught::new(fault, cases, store, all)).collect(),
            unsound: unsound.cloned().collect(),
        }
    }

    /// Faults that no check caught.
    fn survivors(&self) -> impl Iterator<Item = &Caught> {
        self.faults.iter().filter(|fault| fault.caught_by.is_empty())
    }

    /// Whether a fault survives, or a case does not hold without one.
    pub fn lacking(&self) -> bool {
        self.survivors().next().is_some() || !self.unsound.is_empty()
    }

    /// Writes `faults.json` and `faults.md`, and `matrix.json` if there is a matrix.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn write(&self, folder: &OutputFolder, matrix: Option<&Matrix>) -> Result<(), OutputError> {
        folder.write_json("faults.json", self)?;
        if let Some(matrix) = matrix {
            folder.write_json("matrix.json", matrix)?;
        }
        folder.write("faults.md", self.markdown() + &matrix.map_or(String::new(), Matrix::markdown))?;
        folder.finish()
    }

    /// One line per fault.
    pub fn text(&self) -> String {
        filled("faults.txt", include_str!("../texts/faults.txt"), Serde(self))
    }

    /// The table of faults and checks.
    fn markdown(&self) -> String {
        filled("faults.md", include_str!("../texts/faults.md"), Serde(self))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use fisura_verification::record::Status;

    use super::super::runner::Report;
    use super::*;

    fn report(statuses: &[Status]) -> Report {
        let records = statuses.iter().enumerate().map(|(i, status)| (format!("a/b/{i}"), *status)).collect();
        Report { case: "a/b".into(), seconds: 1.0, records, passed: vec!["sign".into(), "root".into()] }
    }

    #[test]
    fn a_fault_is_caught_by_what_turns_red_and_survives_what_ends_without_records() {
        let folder = tempfile::tempdir().unwrap();
        let folder = OutputFolder::open(&folder.path().join("out"), "faults").unwrap();
        let store = Store::open(&folder, &BTreeMap::from([("a/b".into(), "key".into())])).unwrap();
        let cases = ["a/b".to_string()];
        let fault = |id: &str| -> &'static Fault {
            Box::leak(Box::new(Fault { id: id.into(), what: format!("a {id}"), cases: vec!["a/b".into()] }))
        };
        let [sign, root] = ["sign", "root"].map(fault);
        store.put(None, "a/b", Ok(report(&[Status::Pass, Status::Info, Status::Pass]))).unwrap();
        store.put(Some("sign"), "a/b", Ok(report(&[Status::Pass, Status::Info, Status::Error]))).unwrap();
        store.put(Some("root"), "a/b", Err("exit status: 101".into())).unwrap();
        let results = Results::new(&[sign, root], &cases, &store, false);
        assert_eq!((results.faults[0].caught_by.as_slice(), results.faults[0].checks), (&["a/b/2".to_string()][..], 2));
        assert!(results.lacking() && results.text().contains("1 of 2 faults are caught"));
        assert!(results.text().contains("ended without records: a/b: exit status: 101"));
        assert!(results.markdown().contains("| 2 | root | a root | a/b | **none** of 2 |"));
        assert!(!Results::new(&[sign], &cases, &store, true).lacking());
        store.put(None, "a/b", Ok(report(&[Status::Fail]))).unwrap();
        let unsound = Results::new(&[sign], &cases, &store, true);
        assert!(unsound.lacking() && unsound.text().contains("a/b does not hold without a fault"));
    }
}
