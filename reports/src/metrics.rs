//! `metrics.json`: numbers of which smaller is better, for trend charts over commits.

use fisura_verification::record::{Record, ResultSet};
use serde::Serialize;

use crate::number::plain;
use crate::view::{bounds, runs, timing};

/// One number, as the "custom smaller-is-better" form of benchmark dashboards takes it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Metric {
    /// Record or run, and what was measured.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Value.
    pub value: f64,
    /// What is accepted, in words; empty where nothing is.
    pub range: String,
}

/// Errors of all records that have one, then wall time and time per particle-step of each run.
pub fn metrics(set: &ResultSet) -> Vec<Metric> {
    let mut all: Vec<Metric> = set.records.iter().filter_map(error).collect();
    for (run, records) in runs(&set.records) {
        let timing = timing(&records);
        let measured =
            [("wall time", "s", timing.wall_s), ("time per particle-step", "ns", timing.ns_per_particle_step)];
        for (what, unit, value) in measured.into_iter().filter(|m| m.2.is_finite() && m.2 > 0.0) {
            let name = format!("{run}: {what}");
            all.push(Metric { name, unit: unit.to_string(), value, range: String::new() });
        }
    }
    all
}

/// The error of a record: relative to its reference if it has one, else a value that is only bounded above.
fn error(record: &Record) -> Option<Metric> {
    let value = record.value.filter(|v| v.is_finite())?;
    let reference = record.reference.as_ref().and_then(|r| r.value).filter(|r| r.is_finite() && *r != 0.0);
    let metric = |name: String, unit: &str, value| {
        let range = bounds(&record.accept, plain);
        let range = if range == "none" { String::new() } else { format!("accepted value {range}") };
        Metric { name, unit: unit.to_string(), value, range }
    };
    match reference {
        Some(reference) => {
            let error = (value - reference).abs() / reference.abs();
            Some(metric(format!("{}: relative error", record.id), "relative error", error))
        }
        None if record.accept.max.is_some() && record.accept.min.is_none() => {
            Some(metric(record.id.clone(), &record.unit, value))
        }
        None => None,
    }
}

/// `metrics.json`.
///
/// # Errors
/// Only if JSON cannot be written, which has no cause in the results.
pub fn render_metrics(set: &ResultSet) -> serde_json::Result<String> {
    Ok(serde_json::to_string_pretty(&metrics(set))? + "\n")
}
