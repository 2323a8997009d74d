//! What runs computed, counted, on both sides: particle-steps and iterations of the phase field.
//!
//! Counts of one program are the same on every run, so a gate on them needs no spread. Another compiler or
//! processor may round differently and so change an iteration here and there: [`MINOR`] and [`MAJOR`] leave
//! room for that.

use std::collections::HashMap;

use fisura_verification::record::{Record, ResultSet, Work};
use serde::Serialize;

use super::{Change, Effect, graded};
use crate::view::{run_id, runs};

/// A count that changes by more than this part is a minor change …
const MINOR: f64 = 0.001;
/// … and by more than this a major one.
const MAJOR: f64 = 0.02;

/// How a count of one run changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorkChange {
    /// Id of the run: that of its records without the check.
    pub run: String,
    /// What is counted: `particle-steps` or `phase-field iterations`.
    pub what: &'static str,
    /// Count of the run in the base.
    pub base: u64,
    /// In the new results.
    pub new: u64,
    /// How much it changed.
    pub change: Change,
    /// For better or worse.
    pub effect: Effect,
}

impl WorkChange {
    /// Whether a run computes more than the base by more than rounding explains.
    pub fn is_major_loss(&self) -> bool {
        self.change == Change::Major && self.effect == Effect::Worse
    }
}

/// Every count of the runs that both have, in the order of the base.
pub(super) fn of(base: &ResultSet, new: &ResultSet) -> Vec<WorkChange> {
    let new: HashMap<&str, Work> = new.records.iter().rev().filter_map(counted).collect();
    let base = runs(&base.records).into_iter().filter_map(|(_, records)| records.into_iter().find_map(counted));
    let pairs = base.filter_map(|(run, work)| Some((run, work, *new.get(run)?)));
    pairs
        .flat_map(|(run, base, new)| counts(base).into_iter().zip(counts(new)).map(move |pair| judge(run, pair)))
        .collect()
}

fn counted(record: &Record) -> Option<(&str, Work)> {
    Some((run_id(record), record.work?))
}

fn counts(work: Work) -> [(&'static str, u64); 2] {
    [("particle-steps", work.particle_steps), ("phase-field iterations", work.phase_field_iterations)]
}

fn judge(run: &str, ((what, base), (_, new)): ((&'static str, u64), (&'static str, u64))) -> WorkChange {
    let part = base.abs_diff(new) as f64 / base.max(1) as f64;
    let (change, effect) = graded(part > MINOR, part > MAJOR, new > base);
    WorkChange { run: run.to_string(), what, base, new, change, effect }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::compare;
    use crate::example::results;

    #[test]
    fn more_iterations_are_found_and_nothing_else_is() {
        let base = results();
        let unchanged = compare(&base, &base);
        assert!(!unchanged.work.is_empty() && unchanged.is_unchanged());
        let mut more = base.clone();
        for record in &mut more.records {
            let work = record.work.as_mut().unwrap();
            work.phase_field_iterations += work.phase_field_iterations / 2;
        }
        let found = compare(&base, &more);
        let lost: Vec<&str> = found.work.iter().filter(|w| w.is_major_loss()).map(|w| w.what).collect();
        assert!(!lost.is_empty() && lost.iter().all(|what| *what == "phase-field iterations"), "{lost:?}");
        assert_eq!(found.major_losses, lost.len());
        assert_eq!(compare(&more, &base).major_losses, 0, "less work is no loss");
    }

    #[test]
    fn an_iteration_here_and_there_is_no_loss() {
        let work = |iterations| ("phase-field iterations", iterations);
        let change = |new| judge("run", (work(10_000), work(new))).change;
        assert_eq!(
            [10_000, 10_009, 10_011, 10_201].map(change),
            [Change::Unchanged, Change::Unchanged, Change::Minor, Change::Major]
        );
        assert_eq!(judge("run", (work(0), work(5))).change, Change::Major, "work where there was none");
    }
}
