//! `metrics/` by the rules of the program that reads it, restated here with their source.

use std::collections::{BTreeMap, BTreeSet};

use fisura_reports::metrics::files;
use fisura_verification::record::ResultSet;
use serde_json::Value;

fn rendered(set: &ResultSet) -> BTreeMap<String, String> {
    files(set).unwrap().into_iter().collect()
}

/// `extractCustomBenchmarkResult` and `BenchmarkResult` of github-action-benchmark (`src/extract.ts`): an
/// array of name, value, unit, and range and extra if there are any, in words. It finds the value of the
/// commit before by the name.
#[test]
fn github_action_benchmark_takes_the_metrics() {
    let files = rendered(&crate::fixture::results());
    for kind in ["deterministic", "timing"] {
        let mut names = BTreeSet::new();
        let file: Value = serde_json::from_str(&files[&format!("{kind}/github-action-benchmark.json")]).unwrap();
        for entry in file.as_array().unwrap() {
            for (key, value) in entry.as_object().unwrap() {
                let holds = match key.as_str() {
                    "value" => value.as_f64().is_some_and(f64::is_finite),
                    "name" | "unit" | "range" | "extra" => value.as_str().is_some_and(|text| !text.is_empty()),
                    _ => false,
                };
                assert!(holds, "{kind}: {key} of {entry}");
            }
            assert!(["name", "unit", "value"].iter().all(|key| entry.get(key).is_some()), "{entry}");
            assert!(names.insert(entry["name"].to_string()), "{entry} is there twice");
        }
        assert!(!names.is_empty());
    }
}

#[test]
fn what_is_deterministic_does_not_depend_on_the_clock() {
    let mut later = crate::fixture::results();
    later.environment.started = "2031-01-01T00:00:00Z".to_string();
    later.records.iter_mut().for_each(|record| record.timing.wall_s *= 3.0);
    let [before, after] = [rendered(&crate::fixture::results()), rendered(&later)];
    let [deterministic, timing] =
        ["deterministic", "timing"].map(|kind| format!("{kind}/github-action-benchmark.json"));
    assert_eq!(before[&deterministic], after[&deterministic]);
    assert_ne!(before[&timing], after[&timing]);
    assert!(before[&deterministic].contains("mean share") && !before[&deterministic].contains("wall time"));
}
