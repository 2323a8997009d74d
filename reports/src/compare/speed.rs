//! Times of two result sets, held against their spread.
//!
//! A single time says little on a shared machine. The spread comes from the comparison itself: how far the
//! ratios of all runs scatter about their median. A change of all runs together shows in the median.

use std::collections::{HashMap, HashSet};

use fisura_verification::record::{Record, ResultSet};
use serde::Serialize;

use super::{Change, Effect, graded};
use crate::view::{run_id, runs, timing};

/// Times below this in both results are noise, s.
const FLOOR: f64 = 1.0;
/// The logarithm of a ratio is taken to scatter by at least this.
const LEAST_SPREAD: f64 = 0.1;
/// A minor change is beyond this ratio and this many spreads.
const MINOR: (f64, f64) = (1.5, 4.0);
/// A major change is beyond this ratio and this many spreads.
const MAJOR: (f64, f64) = (2.0, 6.0);

/// How the time of one run changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpeedChange {
    /// The run; the first of a study whose runs are timed as one.
    pub run: String,
    /// Wall time in the base, s.
    pub base_s: f64,
    /// Wall time in the new results, s.
    pub new_s: f64,
    /// Wall time in the new results over that in the base.
    pub ratio: f64,
    /// How much it changed.
    pub change: Change,
    /// For better or worse.
    pub effect: Effect,
}

impl SpeedChange {
    /// Whether it became slower by far more than times scatter.
    pub fn is_major_loss(&self) -> bool {
        self.change == Change::Major && self.effect == Effect::Worse
    }
}

/// Wall times of two result sets, compared run by run and as a whole.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Speed {
    /// Why times are not compared; absent if they are.
    pub not_compared: Option<String>,
    /// Median of the ratios new over base.
    pub median_ratio: Option<f64>,
    /// Spread of the logarithm of the ratios about their median, 1.4826 times the median absolute deviation.
    pub spread: f64,
    /// Every time that was measured and is above the floor of 1 s, once.
    pub runs: Vec<SpeedChange>,
}

impl Speed {
    /// Compares the times of the runs that both have.
    pub(super) fn of(base: &ResultSet, new: &ResultSet) -> Self {
        let none = |why: &str| Self {
            not_compared: Some(why.into()),
            median_ratio: None,
            spread: LEAST_SPREAD,
            runs: Vec::new(),
        };
        if (&base.environment.cpu, base.environment.threads) != (&new.environment.cpu, new.environment.threads) {
            return none("the processor or the number of threads differs");
        }
        let times = measured(base, new);
        let Some(median_ratio) = median(times.iter().map(|t| t.1[1] / t.1[0])) else {
            return none("no common run takes a second or more");
        };
        let deviations = times.iter().map(|t| (t.1[1] / t.1[0] / median_ratio).ln().abs());
        let spread = (1.4826 * median(deviations).unwrap_or(0.0)).max(LEAST_SPREAD);
        let runs = times.into_iter().map(|(run, [base_s, new_s])| judge(run, base_s, new_s, spread)).collect();
        Self { not_compared: None, median_ratio: Some(median_ratio), spread, runs }
    }

    /// The changes by run, and by case and times.
    pub(super) fn lookup(&self) -> Lookup<'_> {
        let by_run = self.runs.iter().map(|run| (run.run.as_str(), run)).collect();
        let mut by_time = HashMap::new();
        for run in &self.runs {
            let case = run.run.match_indices('/').nth(1).map_or(run.run.as_str(), |(end, _)| &run.run[..end]);
            by_time.entry((case.to_string(), [run.base_s, run.new_s].map(f64::to_bits))).or_insert(run);
        }
        Lookup { by_run, by_time }
    }
}

/// Finds the change of the run that a record belongs to.
pub(super) struct Lookup<'a> {
    by_run: HashMap<&'a str, &'a SpeedChange>,
    by_time: HashMap<(String, [u64; 2]), &'a SpeedChange>,
}

impl Lookup<'_> {
    /// The change of the run that a record belongs to; absent if its time was not compared.
    pub(super) fn of_record(&self, base: &Record, new: &Record) -> Option<SpeedChange> {
        let times = [base, new].map(|record| record.timing.wall_s.to_bits());
        let same = || self.by_time.get(&(format!("{}/{}", base.suite, base.case), times));
        self.by_run.get(run_id(base)).or_else(same).map(|run| (*run).clone())
    }
}

/// Times above the floor, each measurement once: runs of one study repeat the time of the whole.
fn measured(base: &ResultSet, new: &ResultSet) -> Vec<(String, [f64; 2])> {
    let of = |set: &ResultSet| -> Vec<(String, String, f64)> {
        let grouped = runs(&set.records);
        grouped
            .iter()
            .map(|(run, of)| (run.to_string(), format!("{}/{}", of[0].suite, of[0].case), timing(of).wall_s))
            .collect()
    };
    let there: HashMap<String, f64> = of(new).into_iter().map(|(run, _, wall)| (run, wall)).collect();
    let mut seen = HashSet::new();
    let mut times = Vec::new();
    for (run, case, wall) in of(base) {
        let Some(&other) = there.get(&run) else { continue };
        let once = (case, wall.to_bits(), other.to_bits());
        if wall.max(other) >= FLOOR && wall > 0.0 && other > 0.0 && seen.insert(once) {
            times.push((run, [wall, other]));
        }
    }
    times
}

fn judge(run: String, base_s: f64, new_s: f64, spread: f64) -> SpeedChange {
    let ratio = new_s / base_s;
    let size = ratio.ln().abs();
    let beyond = |(least, spreads): (f64, f64)| size > f64::max(least.ln(), spreads * spread);
    let (change, effect) = graded(beyond(MINOR), beyond(MAJOR), ratio > 1.0);
    SpeedChange { run, base_s, new_s, ratio, change, effect }
}

/// The median; the mean of the two in the middle for an even count.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let (low, high) = (sorted.len().checked_sub(1)? / 2, sorted.len() / 2);
    Some(0.5 * (sorted[low] + sorted[high]))
}
