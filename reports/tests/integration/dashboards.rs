//! `metrics/`: each form by the rules of the program that reads it, restated here with their source.

use std::collections::{BTreeMap, BTreeSet};

use fisura_reports::dashboards::files;
use fisura_reports::metrics::render_metrics;
use fisura_verification::record::ResultSet;
use serde_json::{Value, json};

fn named() -> ResultSet {
    let mut set = crate::fixture::results();
    set.environment.commit = "0123456789abcdef0123456789abcdef01234567".to_string();
    set
}

fn rendered(set: &ResultSet) -> BTreeMap<String, String> {
    files(set).into_iter().collect()
}

fn document(files: &BTreeMap<String, String>, name: &str) -> Value {
    serde_json::from_str(&files[name]).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// What <https://bencher.dev/bmf.json> (draft 7) asks, and the lengths of names of its reference page.
#[test]
fn bencher_takes_the_metrics() {
    let mut set = named();
    set.records[0].id = format!("plate/{}/slope", "x".repeat(2000));
    let files = rendered(&set);
    for kind in ["deterministic", "timing"] {
        let found = document(&files, &format!("{kind}/bencher.json"));
        let found = found.as_object().unwrap();
        assert!(!found.is_empty(), "{kind}");
        for (benchmark, measures) in found {
            assert!((1..=1024).contains(&benchmark.chars().count()), "{benchmark}");
            for (measure, values) in measures.as_object().unwrap() {
                assert!((1..=64).contains(&measure.chars().count()), "{measure}");
                let known = |key: &str| ["value", "lower_value", "upper_value"].contains(&key);
                let values = values.as_object().unwrap();
                assert!(values.contains_key("value"), "{benchmark}: {measure}");
                assert!(values.iter().all(|(key, value)| known(key) && value.is_f64()), "{benchmark}: {values:?}");
            }
        }
        assert_eq!(files[&format!("{kind}/bencher.json")].contains("upper_value"), kind == "deterministic");
    }
}

/// `extractCustomBenchmarkResult` and `BenchmarkResult` of github-action-benchmark (`src/extract.ts`): an
/// array of name, value, unit, and range and extra if there are any, in words. It finds the value of the
/// commit before by the name. `metrics.json` has ranges without words as well.
#[test]
fn github_action_benchmark_takes_the_metrics() {
    let mut files = rendered(&named());
    files.insert("metrics.json".into(), render_metrics(&named()).unwrap());
    assert!(files["metrics.json"].contains(": wall time\"") && files["metrics.json"].contains(": relative error\""));
    for file in ["deterministic/github-action-benchmark.json", "timing/github-action-benchmark.json", "metrics.json"] {
        let mut names = BTreeSet::new();
        for entry in document(&files, file).as_array().unwrap() {
            for (key, value) in entry.as_object().unwrap() {
                let holds = match key.as_str() {
                    "value" => value.as_f64().is_some_and(|value| value.is_finite() && value >= 0.0),
                    "range" if file == "metrics.json" => value.is_string(),
                    "name" | "unit" | "range" | "extra" => value.as_str().is_some_and(|text| !text.is_empty()),
                    _ => false,
                };
                assert!(holds, "{file}: {key} of {entry}");
            }
            assert!(["name", "unit", "value"].iter().all(|key| entry.get(key).is_some()), "{entry}");
            assert!(names.insert(entry["name"].to_string()), "{entry} is there twice");
        }
        assert!(!names.is_empty());
    }
}

/// "Endpoint badge" of the documentation of shields.io: which keys must be there.
#[test]
fn shields_takes_the_badge() {
    let badge = document(&rendered(&named()), "badge.json");
    assert_eq!((&badge["schemaVersion"], &badge["label"]), (&json!(1), &json!("verify")));
    assert!(badge["message"].as_str().is_some_and(|message| message.contains("fail")), "{badge}");
    assert_eq!(badge["color"], "red");
}

#[test]
fn what_is_deterministic_does_not_depend_on_the_clock() {
    let mut later = named();
    later.environment.started = "2031-01-01T00:00:00Z".to_string();
    later.records.iter_mut().for_each(|record| record.timing.wall_s *= 3.0);
    let [before, after] = [rendered(&named()), rendered(&later)];
    for form in ["bencher.json", "github-action-benchmark.json"] {
        assert_eq!(before[&format!("deterministic/{form}")], after[&format!("deterministic/{form}")]);
        assert_ne!(before[&format!("timing/{form}")], after[&format!("timing/{form}")]);
    }
    let counted = ["particle-steps", "phase-field iterations", "relative error"];
    let deterministic = &before["deterministic/bencher.json"];
    assert!(
        counted.iter().all(|name| deterministic.contains(name)) && !deterministic.contains("wall time"),
        "{deterministic}"
    );
}
