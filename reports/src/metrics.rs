//! Numbers of which smaller is better, for trend charts over commits: `metrics.json`, and what
//! [`crate::dashboards`] writes.
//!
//! [`deterministic`] figures come out the same whenever one program runs the same cases; [`times`] do not.

use fisura_verification::extremes::larger;
use fisura_verification::record::{Record, ResultSet};
use serde::Serialize;

use crate::number::plain;
use crate::view::{Counts, bounds, by_suite, runs, timing};

/// One number, as the "custom smaller-is-better" form of benchmark dashboards takes it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Metric {
    /// Record, run or suite, and what was measured.
    pub name: String,
    /// Unit of the value, or what it counts, such as `s`, `iterations` or `relative error`.
    pub unit: String,
    /// The measured value.
    pub value: f64,
    /// What is accepted, in words; empty where nothing is.
    pub range: String,
    /// Largest value that is accepted, where the value is an error.
    #[serde(skip)]
    pub most: Option<f64>,
    /// Id of the record, the run or the suite that the number belongs to.
    #[serde(skip)]
    pub subject: String,
    /// What was measured, if the name of the record does not say it.
    #[serde(skip)]
    pub measure: Option<&'static str>,
}

impl Metric {
    fn new(subject: &str, measure: Option<&'static str>, unit: &str, value: f64) -> Self {
        let name = measure.map_or(subject.to_string(), |measure| format!("{subject}: {measure}"));
        let (range, most) = (String::new(), None);
        Self { name, unit: unit.into(), value, range, most, subject: subject.into(), measure }
    }
}

/// Errors of all records that have one, then what each run computed.
pub fn deterministic(set: &ResultSet) -> Vec<Metric> {
    errors(set).chain(work(set)).collect()
}

/// Wall time and time per particle-step of each run.
pub fn times(set: &ResultSet) -> Vec<Metric> {
    let mut all = Vec::new();
    for (run, records) in runs(&set.records) {
        let timing = timing(&records);
        let measured =
            [("wall time", "s", timing.wall_s), ("time per particle-step", "ns", timing.ns_per_particle_step)];
        let measured = measured.into_iter().filter(|m| m.2.is_finite() && m.2 > 0.0);
        all.extend(measured.map(|(what, unit, value)| Metric::new(run, Some(what), unit, value)));
    }
    all
}

fn errors(set: &ResultSet) -> impl Iterator<Item = Metric> {
    set.records.iter().filter_map(error)
}

/// The error of a record: relative to its reference if it has one, else a value that is only bounded above.
fn error(record: &Record) -> Option<Metric> {
    let value = record.value.filter(|v| v.is_finite())?;
    let reference = record.reference.as_ref().and_then(|r| r.value).filter(|r| r.is_finite() && *r != 0.0);
    let range = match bounds(&record.accept, plain) {
        range if range == "none" => String::new(),
        range => format!("accepted value {range}"),
    };
    let metric = match reference {
        Some(reference) => {
            let error = (value - reference).abs() / reference.abs();
            Metric::new(&record.id, Some("relative error"), "relative error", error)
        }
        None if record.accept.max.is_some() && record.accept.min.is_none() => {
            Metric::new(&record.id, None, &record.unit, value)
        }
        None => return None,
    };
    let most = match reference {
        None => record.accept.max,
        Some(reference) => {
            let sides = [record.accept.min, record.accept.max].into_iter().flatten();
            sides.map(|bound| (bound - reference).abs() / reference.abs()).reduce(larger)
        }
    };
    Some(Metric { range, most: most.filter(|most| most.is_finite() && *most > 0.0), ..metric })
}

/// Two numbers of each suite: how many records do not agree, and the mean share of the accepted error in use.
pub fn suites(set: &ResultSet) -> Vec<Metric> {
    let of = |(suite, records): (&str, Vec<&Record>)| {
        let counts = Counts::of(records.iter().copied());
        let disagree = (counts.known_limit + counts.fail + counts.error) as f64;
        let shares: Vec<f64> =
            records.iter().filter_map(|record| error(record)).filter_map(|m| Some(m.value.abs() / m.most?)).collect();
        let count = Metric::new(suite, Some("known limits and failures"), "records", disagree);
        let mean = (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64);
        let share = mean.map(|mean| Metric::new(suite, Some("mean share of the accepted error"), "1", mean));
        std::iter::once(count).chain(share).collect::<Vec<_>>()
    };
    by_suite(set).into_iter().flat_map(of).collect()
}

/// Wall time of the runs of each suite, added up.
pub fn suite_times(set: &ResultSet) -> Vec<Metric> {
    let seconds = |records: &[&Record]| -> f64 {
        let runs = runs(records.iter().copied());
        runs.iter().map(|(_, records)| timing(records).wall_s).filter(|wall| wall.is_finite()).sum()
    };
    let of = |(suite, records): (&str, Vec<&Record>)| {
        Metric::new(suite, Some("wall time of its runs"), "s", seconds(&records))
    };
    by_suite(set).into_iter().map(of).filter(|metric| metric.value > 0.0).collect()
}

/// Counts of each run that computed something; counts that are zero are left out.
fn work(set: &ResultSet) -> impl Iterator<Item = Metric> {
    runs(&set.records).into_iter().flat_map(|(run, records)| {
        let work = records.iter().find_map(|record| record.work).unwrap_or_default();
        let counts = [
            ("particle-steps", "particle-steps", work.particle_steps),
            ("phase-field iterations", "iterations", work.phase_field_iterations),
        ];
        let counts = counts.into_iter().filter(|count| count.2 > 0);
        counts.map(|(what, unit, count)| Metric::new(run, Some(what), unit, count as f64)).collect::<Vec<_>>()
    })
}

/// `metrics.json`: errors, then times.
///
/// # Errors
/// Only if JSON cannot be written, which has no cause in the results.
pub fn render_metrics(set: &ResultSet) -> serde_json::Result<String> {
    let all: Vec<Metric> = errors(set).chain(times(set)).collect();
    Ok(serde_json::to_string_pretty(&all)? + "\n")
}
