//! `report`: stored results once more.

use super::support::Place;

const RESULTS: &str = r#"{
    "schema": "fisura.results/1",
    "environment": {"commit": "", "dirty": false, "rustc": "", "cpu": "", "threads": 1, "started": ""},
    "records": [], "figures": []
}"#;

#[test]
fn a_report_is_written_beside_its_results_or_elsewhere() {
    let place = Place::with("results/results.json", RESULTS);
    place.write("results/series/timing/a.csv", "x\n1\n");
    let outcome = place.xtask(&["report", "results"]).with_status(0);
    assert!(outcome.out.lines().any(|line| line == "results/report.html"), "{outcome:?}");
    let outcome = place.xtask(&["report", "results", "--out", "copy", "--format", "json"]).with_status(0);
    assert!(outcome.json()["files"].as_array().unwrap().contains(&"copy/report.html".into()));
    assert_eq!(place.files("copy"), place.files("results"));
    assert_eq!(place.read("copy/report.html"), place.read("results/report.html"));
    assert_eq!(place.read("copy/series/timing/a.csv"), "x\n1\n");
}

#[test]
fn missing_or_foreign_results_end_with_2() {
    let place = Place::with("foreign/results.json", "{\"schema\": \"other/7\"}");
    place.write("broken/results.json", "{\"schema\": \"fisura.results/1\", \"records\": 3}");
    place.xtask(&["report", "absent"]).with_status(2).complains_of(&["absent/results.json", "verify"]);
    place.xtask(&["report", "foreign"]).with_status(2).complains_of(&["other/7", "fisura.results/1"]);
    place.write("both/results.json", RESULTS);
    place.write("both/bench.json", "{}");
    place
        .xtask(&["report", "both"])
        .with_status(2)
        .complains_of(&["results.json and bench.json", "a folder of its own"]);
    place.xtask(&["report", "broken"]).with_status(2).complains_of(&["broken/results.json", "line 1"]);
}
