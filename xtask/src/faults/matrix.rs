//! Every fault against every case, and the checks that no fault turns red.

use std::collections::{BTreeMap, BTreeSet};

use fisura_reports::template::filled;
use minijinja::value::Serde;
use minijinja::{Value, context};
use serde::Serialize;

use super::cells::Store;
use super::table::{Fault, faults as all, reason_to_stay};

/// A cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// So many records turn red.
    Fail(usize),
    /// All hold as without the fault.
    Pass,
    /// The process ended, or took too long, without records.
    Ended,
    /// The case passes no site of the fault, which changes nothing in it.
    NotApplicable,
    /// Nothing is known yet.
    NotRun,
}

/// A check that no fault turns red, whatever its variant.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct Idle {
    /// `suite/case/quantity`.
    check: String,
    /// Why it stays.
    reason: Option<&'static str>,
}

/// The matrix.
#[derive(Debug, Serialize)]
pub struct Matrix {
    faults: Vec<&'static str>,
    /// States by case and, in the order of the faults, by fault.
    cases: Vec<(String, Vec<State>)>,
    /// Checks in all, those of finished cases, and those of them that stay green.
    checks: usize,
    decided: usize,
    idle: Vec<Idle>,
}

impl Matrix {
    /// From what is known.
    pub fn new(faults: &[&'static Fault], cases: &[String], store: &Store) -> Self {
        let rows: Vec<(String, Vec<State>)> = cases
            .iter()
            .map(|case| (case.clone(), faults.iter().map(|fault| state(store, &fault.id, case)).collect()))
            .collect();
        let mut matrix = Self {
            faults: faults.iter().map(|f| f.id.as_str()).collect(),
            cases: rows,
            checks: 0,
            decided: 0,
            idle: Vec::new(),
        };
        let all_planted = faults.len() == all().len();
        for (case, states) in &matrix.cases {
            let Some(sound) = store.get(None, case) else { continue };
            let green: BTreeSet<String> = sound.green.iter().map(|id| check_of(id)).collect();
            matrix.checks += green.len();
            if all_planted && !states.contains(&State::NotRun) {
                let cells = faults.iter().filter_map(|fault| store.get(Some(&fault.id), case));
                let red: BTreeSet<String> = cells.flat_map(|cell| cell.red).map(|id| check_of(&id)).collect();
                matrix.decided += green.len();
                let idle = green.difference(&red);
                matrix.idle.extend(idle.map(|check| Idle { check: check.clone(), reason: reason_to_stay(check) }));
            }
        }
        matrix
    }

    /// Whether a check stays green with every fault, and nobody said why, or it is not known whether one
    /// does.
    pub fn lacking(&self) -> bool {
        self.is_incomplete() || self.idle.iter().any(|idle| idle.reason.is_none())
    }

    /// Whether cells are to come, of all faults. With some of the faults nothing is said of checks that stay
    /// green.
    fn is_incomplete(&self) -> bool {
        self.faults.len() == all().len() && self.count(|state| state == State::NotRun) > 0
    }

    fn count(&self, wanted: impl Fn(State) -> bool) -> usize {
        self.cases.iter().flat_map(|(_, states)| states).filter(|state| wanted(**state)).count()
    }

    /// What it says, in a few lines.
    pub fn text(&self) -> String {
        filled("matrix.txt", include_str!("../texts/matrix.txt"), self.values())
    }

    /// Summary, suites, table of cases and faults, and list of the checks that stay green.
    pub fn markdown(&self) -> String {
        filled("matrix.md", include_str!("../texts/matrix.md"), self.values())
    }

    fn values(&self) -> Value {
        let of = |state: State| self.count(|other| other == state);
        context! {
            matrix => Serde(self),
            suites => Serde(self.suites()),
            incomplete => self.is_incomplete(),
            fail => self.count(|state| matches!(state, State::Fail(_))),
            pass => of(State::Pass),
            not_applicable => of(State::NotApplicable),
            ended => of(State::Ended),
            not_run => of(State::NotRun),
        }
    }

    /// Cases of each suite, and faults that turn a check of it red.
    fn suites(&self) -> BTreeMap<&str, (usize, usize)> {
        let mut suites: BTreeMap<&str, (usize, BTreeSet<usize>)> = BTreeMap::new();
        for (case, states) in &self.cases {
            let entry = suites.entry(case.split('/').next().unwrap_or_default()).or_default();
            entry.0 += 1;
            entry.1.extend((0..states.len()).filter(|&fault| matches!(states[fault], State::Fail(_))));
        }
        suites.into_iter().map(|(suite, (cases, faults))| (suite, (cases, faults.len()))).collect()
    }
}

fn state(store: &Store, fault: &str, case: &str) -> State {
    let Some(sound) = store.get(None, case) else { return State::NotRun };
    if sound.ended.is_none() && !sound.passed.iter().any(|passed| passed == fault) {
        return State::NotApplicable;
    }
    match store.get(Some(fault), case) {
        None => State::NotRun,
        Some(cell) if !cell.red.is_empty() => State::Fail(cell.red.len()),
        Some(cell) if cell.ended.is_some() => State::Ended,
        Some(_) => State::Pass,
    }
}

/// `suite/case/quantity` of a record `suite/case/variant/quantity`; variants may hold slashes, quantities do
/// not.
fn check_of(id: &str) -> String {
    let mut parts = id.splitn(3, '/');
    let (suite, case) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    let quantity = parts.next().and_then(|rest| rest.rsplit('/').next()).unwrap_or_default();
    format!("{suite}/{case}/{quantity}")
}

#[cfg(test)]
mod tests {
    use fisura_verification::output::OutputFolder;
    use fisura_verification::record::Status;

    use super::super::runner::Report;
    use super::*;

    #[test]
    fn every_cell_says_whether_it_was_run_and_idle_checks_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let cases = ["a/b".to_string(), "a/c".to_string(), "a/d".to_string()];
        let keys = cases.iter().map(|case| (case.clone(), "key".to_string())).collect();
        let folder = OutputFolder::open(&folder.path().join("out"), "faults").unwrap();
        let store = Store::open(&folder, &keys).unwrap();
        let faults: Vec<&'static Fault> = all().iter().collect();
        let report = |case: &str, status| {
            let records = vec![(format!("{case}/h=1/2/error"), status), (format!("{case}/drift"), Status::Pass)];
            Ok(Report {
                case: case.into(),
                seconds: 1.0,
                records,
                passed: vec![all()[0].id.clone(), all()[1].id.clone()],
            })
        };
        for case in ["a/b", "a/c"] {
            store.put(None, case, report(case, Status::Pass)).unwrap();
            store.put(Some(&all()[0].id), case, report(case, Status::Fail)).unwrap();
        }
        store.put(Some(&all()[1].id), "a/b", report("a/b", Status::Pass)).unwrap();
        let matrix = Matrix::new(&faults, &cases, &store);
        let row = |case: usize| &matrix.cases[case].1[..3];
        assert_eq!(row(0), [State::Fail(1), State::Pass, State::NotApplicable]);
        assert_eq!(row(1), [State::Fail(1), State::NotRun, State::NotApplicable]);
        assert_eq!(row(2), [State::NotRun; 3]);
        assert_eq!(matrix.idle, [Idle { check: "a/b/drift".into(), reason: None }], "a/c is not finished");
        assert!(matrix.lacking() && matrix.text().contains("no reason is given: a/b/drift"));
        assert!(matrix.markdown().contains("| a/b | 1 | · | |"));

        let lacking = |faults: &[&'static Fault], cases: &[String]| {
            let matrix = Matrix { idle: Vec::new(), ..Matrix::new(faults, cases, &store) };
            (matrix.lacking(), matrix.text().contains("not complete"))
        };
        assert_eq!(lacking(&faults, &cases), (true, true));
        assert_eq!(lacking(&faults, &cases[..1]), (false, false));
        assert_eq!(lacking(&faults[..2], &cases), (false, false), "of some faults nothing more is known");
    }
}
