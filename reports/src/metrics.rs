//! `metrics/`: numbers of each suite of which smaller is better, for charts over commits.
//!
//! `deterministic/github-action-benchmark.json` comes out the same whenever one program runs the same cases,
//! `timing/github-action-benchmark.json` does not. Both have the form of its tool `customSmallerIsBetter`.

use fisura_verification::extremes::larger;
use fisura_verification::record::{Record, ResultSet};
use serde::Serialize;

use crate::view::{Counts, by_suite, runs, timing};

/// One number.
#[derive(Debug, Serialize)]
struct Metric {
    name: String,
    unit: &'static str,
    value: f64,
}

impl Metric {
    fn new(suite: &str, what: &str, unit: &'static str, value: f64) -> Self {
        Self { name: format!("{suite}: {what}"), unit, value }
    }
}

/// Name below `metrics/` and content of every file.
///
/// # Errors
/// Only if JSON cannot be written, which has no cause in the results.
pub fn files(set: &ResultSet) -> serde_json::Result<Vec<(String, String)>> {
    let kinds = [("deterministic", agreement(set)), ("timing", times(set))];
    let file = |(kind, metrics): (&str, Vec<Metric>)| {
        Ok((format!("{kind}/github-action-benchmark.json"), serde_json::to_string_pretty(&metrics)? + "\n"))
    };
    kinds.into_iter().map(file).collect()
}

/// How many records do not agree, and the mean share of the accepted error in use.
fn agreement(set: &ResultSet) -> Vec<Metric> {
    let of = |(suite, records): (&str, Vec<&Record>)| {
        let counts = Counts::of(records.iter().copied());
        let disagree = (counts.known_limit + counts.fail + counts.error) as f64;
        let shares: Vec<f64> = records.iter().filter_map(|record| share(record)).collect();
        let count = Metric::new(suite, "known limits and failures", "records", disagree);
        let mean = (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64);
        let share = mean.map(|mean| Metric::new(suite, "mean share of the accepted error", "1", mean));
        std::iter::once(count).chain(share).collect::<Vec<_>>()
    };
    by_suite(set).into_iter().flat_map(of).collect()
}

/// The error of a record over the largest that is accepted: of the difference from its reference if it has
/// one, else of a value that is only bounded above.
fn share(record: &Record) -> Option<f64> {
    let value = record.value.filter(|v| v.is_finite())?;
    let reference = record.reference.as_ref().and_then(|r| r.value).filter(|r| r.is_finite() && *r != 0.0);
    let (min, max) = (record.accept.min, record.accept.max);
    let (error, most) = match reference {
        Some(reference) => {
            let sides = [min, max].into_iter().flatten().map(|bound| (bound - reference).abs());
            (value - reference, sides.reduce(larger)?)
        }
        None if min.is_none() => (value, max?),
        None => return None,
    };
    (most.is_finite() && most > 0.0).then(|| error.abs() / most)
}

/// Wall time of the runs of each suite, added up.
fn times(set: &ResultSet) -> Vec<Metric> {
    let seconds = |records: &[&Record]| -> f64 {
        let runs = runs(records.iter().copied());
        runs.iter().map(|(_, records)| timing(records).wall_s).filter(|wall| wall.is_finite()).sum()
    };
    let of =
        |(suite, records): (&str, Vec<&Record>)| Metric::new(suite, "wall time of its runs", "s", seconds(&records));
    by_suite(set).into_iter().map(of).filter(|metric| metric.value > 0.0).collect()
}
