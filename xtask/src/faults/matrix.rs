//! Every fault against every case, and the checks that no fault turns red.

use std::collections::{BTreeMap, BTreeSet};

use fisura_reports::template::filled;
use minijinja::value::Serde;
use minijinja::{Value, context};
use serde::Serialize;

use super::cells::Store;
use super::table::{Fault, faults as all, reason_to_stay};

/// What is known of one case with one fault.
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
    /// Id of the check without its variant: `suite/case/quantity`.
    check: String,
    /// Why it may stay green, as `table.toml` says; absent if it says nothing.
    reason: Option<&'static str>,
}

/// What every fault does to every case, and which checks no fault turns red.
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
