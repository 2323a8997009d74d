//! What belongs to the user stays: folders, files, links, and results that are not finished.

use std::fs;

use super::bench;
use super::merge;
use super::support::{BLOCK, Place};

const MINE: &str = "mine";

/// Files of a user that have names such as commands write.
const FILES: [&str; 10] = [
    "partial/deep/mine.txt",
    "figures/mine.svg",
    "series/mine.csv",
    "part.json",
    "checkpoint.bin",
    "report.html.part",
    "stress-strain.svg",
    "phase-diagram.svg",
    "points-1.vtu",
    "peer/short/mine.csv",
];

fn write_mine(place: &Place, folder: &str, files: &[&str]) {
    files.iter().for_each(|name| place.write(&format!("{folder}/{name}"), MINE));
}

#[track_caller]
fn mine_are_there(place: &Place, folder: &str, files: &[&str]) {
    for name in files {
        assert_eq!(place.read(&format!("{folder}/{name}")), MINE, "{name}");
    }
}

#[test]
fn every_command_refuses_a_folder_of_the_user() {
    let place = merge::workspace();
    place.write("scene.toml", BLOCK);
    place.succeeds("verify --case energy/* --out results");
    place.succeeds("verify --case energy/* --partition slice:1/1 --out part");
    write_mine(&place, "mine", &FILES);
    place.write("mine/results.json", MINE);
    place.write("mine/summary.json", MINE);
    let before = place.files("mine");
    for command in [
        "run scene.toml",
        "verify",
        "merge part",
        "compare results results",
        "figures --from results",
        "report results",
        "bench --quick",
        "faults",
    ] {
        let command = format!("{command} --out mine");
        place.refuses(&command, &["mine is not empty and has no fisura.sha256", "--out"]);
        mine_are_there(&place, "mine", &FILES);
        assert_eq!(place.files("mine"), before, "{command:?}");
    }
}

#[test]
fn files_of_the_user_stay_beside_those_of_a_command() {
    let place = merge::workspace();
    place.write("scene.toml", BLOCK);
    for (command, folder) in [("run scene.toml --out run", "run"), ("verify --case energy/* --out verify", "verify")] {
        place.succeeds(command);
        write_mine(&place, folder, &FILES[..if folder == "run" { 4 } else { FILES.len() }]);
        place.write(&format!("{folder}/stress-strain.svg"), MINE);
        let before = place.files(folder);
        place.succeeds(command);
        assert_eq!(place.files(folder), before);
        mine_are_there(&place, folder, &FILES[..4]);
        place.write(&format!("{folder}/summary.md"), "changed");
    }
    place.refuses("verify --case energy/* --out verify", &["changed after they were written: summary.md", "--out"]);
    assert_eq!(place.read("verify/summary.md"), "changed");
}

#[cfg(unix)]
#[test]
fn nothing_is_written_through_a_link() {
    let place = Place::with("scene.toml", BLOCK);
    place.write("mine/f", MINE);
    place.succeeds("run scene.toml --out out");
    let link = |name: &str| std::os::unix::fs::symlink(place.path("mine/f"), place.path("out").join(name)).unwrap();
    let names = [".fisura-writable.part", "history.csv.part", "summary.json.part", "checkpoint.bin.part"];
    names.into_iter().for_each(link);
    place.succeeds("run scene.toml --out out");
    mine_are_there(&place, "mine", &["f"]);
    fs::remove_file(place.path("out/history.csv")).unwrap();
    link("history.csv");
    place.refuses("run scene.toml --out out", &["changed after they were written: history.csv"]);
    mine_are_there(&place, "mine", &["f"]);
}

#[cfg(unix)]
mod signals {
    use std::io::{BufRead, BufReader};
    use std::process::Child;
    use std::thread::sleep;
    use std::time::Duration;

    use super::super::support::{NOTCHED, end};
    use super::super::verify::{case, case_of, workspace_with};
    use super::*;

    const FULL: &str = "verify --tier full --out out";

    /// A case that is done at once, and one that takes minutes.
    fn workspace() -> Place {
        let endless = NOTCHED.replacen("end_time = \"5 us\"", "end_time = \"50000 us\"", 1);
        let endless = endless.replacen("cells  = [10, 5]", "cells  = [80, 40]", 1);
        workspace_with(&[
            ("energy/a".to_string(), case("The ledger closes", "quick", 1e-12)),
            ("energy/b".to_string(), case_of(&endless, "The ledger closes", "full", 1.0)),
        ])
    }

    /// Starts a command and waits until its standard error has a line with `mark`; what is left of it is read
    /// no more.
    fn start(place: &Place, line: &str, mark: &str) -> Child {
        let mut child = place.begin(line);
        let mut reader = BufReader::new(child.stderr.take().expect("standard error"));
        let mut line = String::new();
        while !line.contains(mark) {
            line.clear();
            assert!(reader.read_line(&mut line).expect("a line") > 0, "it ended before {mark:?}");
        }
        child.stderr = Some(reader.into_inner());
        sleep(Duration::from_millis(300)); // it is in the middle of what follows
        child
    }

    #[track_caller]
    fn is_unfinished(place: &Place, finished: usize) {
        let words = format!("{finished} of 2 cases are finished: the run is in progress or was stopped");
        for name in ["results.json", "report.html", "summary.md", "junit.xml"] {
            let text = place.read(&format!("out/{name}"));
            assert!(text.contains(&words), "{name} does not say {words:?}: {text}");
        }
        assert!(place.read("out/fisura.sha256").contains("# unfinished"));
    }

    #[test]
    fn an_interrupted_verification_keeps_what_is_finished_and_says_that_it_is_not() {
        let place = workspace();
        place.succeeds("verify --out out");
        let verdict = place.read("out/summary.md").lines().next().expect("a verdict").to_string();
        for signal in ["-INT", "-TERM"] {
            assert_eq!(end(start(&place, FULL, "[1/2] energy/a pass"), signal).0, Some(130));
            is_unfinished(&place, 1);
            assert!(!place.read("out/summary.md").contains(&verdict), "{verdict}");
            assert_eq!(place.json("out/results.json")["records"][0]["status"], "pass");
            assert!(place.path("out/series/energy-a.csv").is_file() && place.files("out/partial").len() == 1);
        }
        // the other tier would remove what is finished
        place.refuses("verify --out out", &["1 finished cases of an interrupted run in partial/", "--out"]);
        assert_eq!(place.files("out/partial").len(), 1);
    }

    #[test]
    fn a_killed_verification_leaves_no_old_verdict() {
        let place = workspace();
        place.succeeds("verify --out out");
        let child = start(&place, FULL, "[1/2] energy/a pass");
        let holder = format!("in use by process {}: xtask verify --tier full --out out", child.id());
        place.refuses("verify --out out", &[&holder, "wait"]);
        place.refuses("report out", &[&holder]);
        assert_eq!(end(child, "-KILL").0, None);
        is_unfinished(&place, 0);
        place.succeeds("report out");
        is_unfinished(&place, 0);
    }

    #[test]
    fn a_report_that_cannot_be_written_does_not_hide_what_the_checks_say() {
        let place = workspace();
        let child = start(&place, &format!("{FULL} --case-timeout 4"), "[1/2] energy/a pass");
        fs::remove_file(place.path("out/junit.xml")).expect("a file");
        fs::create_dir_all(place.path("out/junit.xml/in-the-way")).expect("a folder");
        let output = child.wait_with_output().expect("it ends");
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{err}");
        assert!(err.contains("junit.xml cannot be written"), "{err}");
    }

    #[test]
    fn interrupted_benchmarks_keep_what_is_measured_and_say_that_they_are_not_finished() {
        let place = bench::workspace();
        let child = start(&place, "bench --quick --family ceilings --out out", "ceilings");
        assert_eq!(end(child, "-INT").0, Some(130));
        let words = "0 of 1 families are measured: the run is in progress or was stopped";
        for name in ["bench.json", "bench.html", "summary.md"] {
            assert!(place.read(&format!("out/{name}")).contains(words), "{name}");
        }
    }
}
