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
    // results of an older version have no list of what was written
    place.refuses("report results", &["results", "no fisura.sha256", "--out"]);
    let outcome = place.succeeds("report results --out copy --format json");
    assert!(outcome.json()["files"].as_array().unwrap().contains(&"copy/report.html".into()));
    let first = place.read("copy/report.html");
    let outcome = place.succeeds("report copy");
    assert!(outcome.out.lines().any(|line| line == "copy/report.html"), "{outcome:?}");
    assert_eq!(place.read("copy/report.html"), first);
    assert_eq!(place.files("results"), ["results.json", "series"], "nothing was written there");
    assert_eq!(place.read("copy/series/timing/a.csv"), "x\n1\n");
}

#[test]
fn a_folder_below_that_of_the_results_is_no_part_of_them() {
    let place = Place::with("results/results.json", RESULTS);
    place.write("results/series/a.csv", "x\n1\n");
    for out in ["results/series/copy", "results/copy"] {
        for _ in 0..2 {
            place.succeeds(&format!("report results --out {out}"));
        }
        assert_eq!(place.read(&format!("{out}/series/a.csv")), "x\n1\n");
    }
    assert!(!place.path("results/series/copy/series/copy/series/copy").exists());
}

#[cfg(unix)]
#[test]
fn links_and_pipes_are_not_copied() {
    let place = Place::with("results/results.json", RESULTS);
    place.write("secret.csv", "x\n1\n");
    place.write("results/series/a.csv", "x\n1\n");
    let refused = |name: &str| {
        place.refuses("report results --out copy", &[name, "regular files", "help:"]);
        assert!(!place.path("copy/series").exists(), "nothing is copied");
        std::fs::remove_file(place.path("results").join(name)).unwrap();
    };
    std::os::unix::fs::symlink(place.path("secret.csv"), place.path("results/series/b.csv")).unwrap();
    refused("series/b.csv");
    let pipe = std::process::Command::new("mkfifo").arg(place.path("results/series/c.csv")).status().unwrap();
    assert!(pipe.success());
    refused("series/c.csv");
    place.succeeds("report results --out copy");
}

#[test]
fn texts_of_results_do_not_steer_the_terminal() {
    let steering = "\\u001b]0;owned\\u0007\\u009b2J";
    let place =
        Place::with("results/results.json", &RESULTS.replace("\"cpu\": \"\"", &format!("\"cpu\": \"{steering}\"")));
    for format in ["text", "json"] {
        let outcome = place.succeeds(&format!("report results --out {format} --format {format}"));
        assert!(!(outcome.out + &outcome.err).contains(['\u{1b}', '\u{7}', '\u{9b}']));
    }
    place.write("foreign/results.json", &RESULTS.replace("fisura.results/1", steering));
    let outcome = place.refuses("report foreign", &["]0;owned", "fisura.results/1"]);
    assert!(!outcome.err.contains(['\u{1b}', '\u{7}', '\u{9b}']), "{outcome:?}");
}

#[test]
fn missing_or_foreign_results_end_with_2() {
    let place = Place::with("foreign/results.json", "{\"schema\": \"other/7\"}");
    place.write("broken/results.json", "{\"schema\": \"fisura.results/1\", \"records\": 3}");
    place.refuses("report absent", &["absent/results.json", "verify"]);
    place.refuses("report foreign", &["other/7", "fisura.results/1"]);
    place.write("both/results.json", RESULTS);
    place.write("both/bench.json", "{}");
    place.refuses("report both", &["results.json and bench.json", "a folder of its own"]);
    place.refuses("report broken", &["broken/results.json", "line 1"]);
}
