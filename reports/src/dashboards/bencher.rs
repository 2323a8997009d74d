//! Bencher Metric Format: benchmarks by name, in each its measures by name with a value.
//!
//! `upper_value` is the largest error that the bounds of a record accept.
//!
//! Source: <https://bencher.dev/docs/reference/bencher-metric-format>. Names of benchmarks have at most 1024
//! characters, names of measures 64; a measure has one unit, so that values of different units are different
//! measures.

use serde_json::{Map, Value, json};

use crate::metrics::Metric;

const LONGEST_BENCHMARK: usize = 1024;
const LONGEST_MEASURE: usize = 64;

/// The document of some metrics.
pub fn document(metrics: &[Metric]) -> Value {
    let mut benchmarks: Map<String, Value> = Map::new();
    for metric in metrics {
        let name: String = metric.subject.chars().take(LONGEST_BENCHMARK).collect();
        let measure: String = measure(metric).chars().take(LONGEST_MEASURE).collect();
        let benchmark = benchmarks.entry(name).or_insert_with(|| json!({}));
        let mut number = json!({ "value": metric.value });
        if let Some(most) = metric.most {
            number["lower_value"] = 0.0.into();
            number["upper_value"] = most.into();
        }
        benchmark[measure] = number;
    }
    benchmarks.into()
}

fn measure(metric: &Metric) -> String {
    match (metric.measure, metric.unit.as_str()) {
        (Some(measure), _) => measure.to_string(),
        (None, "" | "1") => "bounded value".to_string(),
        (None, unit) => format!("bounded value ({unit})"),
    }
}
