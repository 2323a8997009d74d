//! Results of airspeed velocity: `benchmarks.json`, and per machine `machine.json` and a file per commit and
//! environment.
//!
//! Source: "Benchmark suite layout and file formats" of its developer documentation, and `asv/results.py`.
//! What it calls an environment separates what is deterministic from what is timed. The date of the commit is
//! not in the results: the start of the run stands in its place.

use chrono::DateTime;
use fisura_verification::record::ResultSet;
use serde_json::{Map, Value, json};

use crate::metrics::Metric;
use crate::svg::slug;

/// Format of `benchmarks.json` and of results; that of `machine.json` is 1.
const VERSION: usize = 2;
/// Columns of a result that are written; those after them are missing, which the format allows.
const COLUMNS: [&str; 3] = ["result", "params", "version"];

/// Name and content of every file; none if the results name no commit.
pub fn files(set: &ResultSet, kinds: &[(&str, Vec<Metric>)]) -> Vec<(String, Value)> {
    let environment = &set.environment;
    if !environment.commit.chars().all(|c| c.is_ascii_hexdigit()) || environment.commit.len() < 8 {
        return Vec::new();
    }
    let cpu = if environment.cpu.is_empty() { "unknown" } else { &environment.cpu };
    let machine: String = slug(cpu).chars().take(64).collect();
    let started = DateTime::parse_from_rfc3339(&environment.started).unwrap_or_default();
    let threads = environment.threads.to_string();
    let about = json!({ "machine": machine, "cpu": cpu, "num_cpu": threads, "arch": "", "os": "", "ram": "" });
    let mut of_machine = about.clone();
    of_machine["version"] = 1.into();
    let mut benchmarks = Map::new();
    let mut files = vec![(format!("{machine}/machine.json"), of_machine)];
    for (kind, metrics) in kinds {
        let mut results = Map::new();
        for metric in metrics {
            results.insert(metric.name.clone(), json!([[metric.value], [], "1"]));
            benchmarks.insert(metric.name.clone(), benchmark(metric));
        }
        let content = json!({
            "version": VERSION,
            "commit_hash": environment.commit,
            "env_name": kind,
            "date": started.timestamp_millis(),
            "params": about,
            "python": "",
            "requirements": {},
            "env_vars": {},
            "result_columns": COLUMNS,
            "results": results,
            "durations": {},
        });
        files.push((format!("{machine}/{}-{kind}.json", &environment.commit[..8]), content));
    }
    benchmarks.insert("version".to_string(), VERSION.into());
    files.push(("benchmarks.json".to_string(), benchmarks.into()));
    files
}

/// What a benchmark is: a number that is tracked, of no parameters.
fn benchmark(metric: &Metric) -> Value {
    json!({
        "name": metric.name,
        "type": "track",
        "unit": metric.unit,
        "code": "",
        "version": "1",
        "params": [],
        "param_names": [],
        "timeout": 0,
    })
}
