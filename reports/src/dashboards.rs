//! `metrics/`: the numbers of a run in the forms that dashboards read, what is deterministic apart from what
//! is timed.
//!
//! | below `metrics/` | for |
//! |---|---|
//! | `deterministic/bencher.json`, `timing/bencher.json` | Bencher, adapter `json` (Bencher Metric Format) |
//! | `…/github-action-benchmark.json` of both | github-action-benchmark, `customSmallerIsBetter` |
//! | `deterministic/Test.xml`, `timing/Test.xml` | CDash, as `ctest` submits it |
//! | `asv/` | `results_dir` of airspeed velocity |

mod asv;
mod bencher;
mod ctest;

use fisura_verification::record::ResultSet;

use crate::metrics::{Metric, deterministic, times};

/// Name below `metrics/` and content of every file; those of asv only if the results name a commit.
///
/// # Errors
/// The file that cannot be rendered and why, which has no cause in the results.
pub fn files(set: &ResultSet) -> Result<Vec<(String, String)>, (&'static str, String)> {
    let kinds = [("deterministic", deterministic(set)), ("timing", times(set))];
    let json = |value: &serde_json::Value| format!("{value:#}\n");
    let mut files = Vec::new();
    for (kind, metrics) in &kinds {
        files.push((format!("{kind}/bencher.json"), json(&bencher::document(metrics))));
        files.push((format!("{kind}/github-action-benchmark.json"), json(&smaller_is_better(metrics))));
        let xml = ctest::document(set, kind, metrics).map_err(|error| ("metrics/Test.xml", error.to_string()))?;
        files.push((format!("{kind}/Test.xml"), xml));
    }
    files.extend(asv::files(set, &kinds).into_iter().map(|(name, value)| (format!("asv/{name}"), json(&value))));
    Ok(files)
}

/// The list of `customSmallerIsBetter`; `range` is there only where something is accepted.
fn smaller_is_better(metrics: &[Metric]) -> serde_json::Value {
    let entry = |metric: &Metric| {
        let mut entry = serde_json::json!({ "name": metric.name, "unit": metric.unit, "value": metric.value });
        if !metric.range.is_empty() {
            entry["range"] = metric.range.as_str().into();
        }
        entry
    };
    metrics.iter().map(entry).collect()
}
