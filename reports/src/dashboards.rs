//! `metrics/`: the numbers of a run in the forms that dashboards read, what is deterministic apart from what
//! is timed.
//!
//! | below `metrics/` | for |
//! |---|---|
//! | `deterministic/bencher.json`, `timing/bencher.json` | Bencher, adapter `json`: all metrics with bounds |
//! | `…/github-action-benchmark.json` of both | `customSmallerIsBetter`: a few series per suite |
//! | `badge.json` | an endpoint badge of shields.io |

mod bencher;

use fisura_verification::record::{ResultSet, Status};
use serde_json::{Value, json};

use crate::metrics::{Metric, deterministic, suite_times, suites, times};
use crate::view::Counts;

/// Name below `metrics/` and content of every file.
pub fn files(set: &ResultSet) -> Vec<(String, String)> {
    let kinds = [("deterministic", deterministic(set), suites(set)), ("timing", times(set), suite_times(set))];
    let json = |value: &Value| format!("{value:#}\n");
    let mut files = vec![("badge.json".to_string(), json(&badge(set)))];
    for (kind, all, few) in &kinds {
        files.push((format!("{kind}/bencher.json"), json(&bencher::document(all))));
        files.push((format!("{kind}/github-action-benchmark.json"), json(&smaller_is_better(few))));
    }
    files
}

/// The badge, by <https://shields.io/badges/endpoint-badge>.
fn badge(set: &ResultSet) -> Value {
    let counts = Counts::of(&set.records);
    let colour = match counts.verdict() {
        Status::Fail | Status::Error => "red",
        Status::Pass => "green",
        Status::KnownLimit | Status::Info => "lightgrey",
    };
    let message = match counts.fail + counts.error {
        0 => format!("{} pass, {} known limits", counts.pass, counts.known_limit),
        bad => format!("{bad} of {} fail", counts.judged()),
    };
    json!({ "schemaVersion": 1, "label": "verify", "message": message, "color": colour })
}

/// The list of `customSmallerIsBetter`; `range` is there only where something is accepted.
fn smaller_is_better(metrics: &[Metric]) -> Value {
    let entry = |metric: &Metric| {
        let mut entry = json!({ "name": metric.name, "unit": metric.unit, "value": metric.value });
        if !metric.range.is_empty() {
            entry["range"] = metric.range.as_str().into();
        }
        entry
    };
    metrics.iter().map(entry).collect()
}
