//! `run`: files, statuses, breakdowns, the same bytes for any number of threads.

use std::path::Path;

use super::support::{BLOCK, NOTCHED, Place, wait_until};

#[test]
fn an_elastic_scene_has_nothing_of_fracture() {
    let place = Place::with("block.toml", BLOCK);
    let run = place.succeeds("run block.toml --out out --format json");
    assert_eq!(run.err, "", "no warnings, and no progress bar off a terminal");
    assert_eq!(run.json()["models"], serde_json::json!(["momentum"]));
    assert_eq!(run.out, place.read("out/summary.json"));
    let history = place.read("out/history.csv");
    assert_eq!(
        history.lines().next().unwrap(),
        "time_s,kinetic_j,stagger_j,elastic_j,external_work_j,closure_j,momentum_x,momentum_y,angular_momentum,\
         time_step_s"
    );
    assert_eq!(history.lines().count(), 1 + 11);
    let files = ["energies.svg", "history.csv", "stress-0s.svg", "stress-5us.svg", "summary.json"];
    assert_eq!(place.files("out"), files);
}

#[test]
fn titles_and_names_do_not_steer_the_terminal() {
    let steering = "\\u001b]0;owned\\u0007\\u009b2J\\nclosure  0";
    let scene = BLOCK.replace("title = \"Block\"", &format!("title = \"{steering}\""));
    let place = Place::with("block.toml", &scene);
    let wrong = scene.replace("[analysis]", &format!("[analysis]\n\"{steering}\" = \"{steering}\""));
    place.write("wrong.toml", &wrong);
    for (command, status) in [("run block.toml", 0), ("check block.toml", 0), ("check wrong.toml", 2)] {
        for format in ["text", "json"] {
            let outcome = place.xtask(&format!("{command} --format {format}")).with_status(status);
            let shown = outcome.out.clone() + &outcome.err;
            assert!(!shown.contains(['\u{1b}', '\u{7}', '\u{9b}']), "{outcome:?}");
            assert!(shown.contains("]0;owned"), "{outcome:?}");
            assert!(!shown.lines().any(|line| line.starts_with("closure  0")), "{outcome:?}");
        }
    }
}

#[test]
fn a_fracture_scene_gives_the_same_bytes_for_one_and_two_threads() {
    let place = Place::with("notched.toml", NOTCHED);
    for threads in ["1", "2"] {
        let run = format!("run notched.toml --threads {threads} --out {threads} --set mesh.cells=[80,40]");
        place.succeeds(&run).says(&["momentum, phase field"]);
    }
    let history = place.read("1/history.csv");
    assert_eq!(history, place.read("2/history.csv"));
    for name in place.files("1").iter().filter(|name| name.ends_with(".svg")) {
        assert_eq!(place.read(&format!("1/{name}")), place.read(&format!("2/{name}")), "{name}");
    }
    assert_eq!(
        history.lines().next().unwrap(),
        "time_s,kinetic_j,stagger_j,elastic_j,fracture_j,external_work_j,history_work_j,closure_j,crack_tip_x_m,\
         crack_tip_y_m,min_phase_field,momentum_x,momentum_y,angular_momentum,time_step_s,phase_field_iterations"
    );
    assert!(place.path("1/phase-0s.svg").is_file() && place.path("1/phase-5us.svg").is_file());
}

#[test]
fn a_step_above_the_critical_one_ends_with_3_and_keeps_the_history() {
    let place = Place::with("block.toml", BLOCK);
    let critical = place.xtask("check block.toml --format json").json()["critical_step_s"].as_f64().unwrap();
    let times = format!("analysis.time_step={:e} --set analysis.end_time={:e}", 1.2 * critical, 240.0 * critical);
    let output = "--set output.frames=[0] --set output.samples=100";
    let run = place.xtask(&format!("run block.toml --out out --set {times} {output}")).with_status(3);
    let run = run.complains_of(&["at step", "t = ", "near point ", "likely cause", "1.200 times the critical step"]);
    run.says(&["Block"]);
    let rows = place.read("out/history.csv").lines().count() - 1;
    assert!((2..101).contains(&rows), "{rows} rows");
    assert!(!place.read("out/history.csv").contains("nan"));
    let (summary, report) = (place.json("out/summary.json"), place.json("out/breakdown.json"));
    assert!(summary["breakdown"]["step"].as_u64().unwrap() > 1);
    assert!(place.path("out/stress-0s.svg").is_file());
    assert_eq!(report["step"], summary["breakdown"]["step"]);
    assert_eq!((&report["points"], &report["points_not_finite"]), (&200.into(), &0.into()));
    assert_eq!(report["worst_points"][0]["position_m"], summary["breakdown"]["place_m"]);
    assert!(report["extremes"]["largest_strain"].as_f64().unwrap() > 0.0 && report["row"]["elastic_j"].is_f64());

    place.succeeds("run block.toml --out out");
    assert!(!place.path("out/breakdown.json").exists(), "the breakdown of the run before is gone");
}

#[test]
fn set_changes_the_scene_and_pictures_of_the_run_before_go() {
    let place = Place::with("block.toml", BLOCK);
    place.succeeds("run block.toml --out out");
    place.write("out/phase-notes.txt", "mine");
    let sets = "--set output.samples=4 --set output.frames=[] --set mesh.degree=3";
    let run = place.succeeds(&format!("run block.toml --out out {sets}"));
    assert!(run.out.contains("particles") && run.err.is_empty(), "{run:?}");
    assert_eq!(place.read("out/history.csv").lines().count(), 1 + 5);
    assert_eq!(place.files("out"), ["energies.svg", "history.csv", "phase-notes.txt", "summary.json"]);
}

/// Files go to the target folder of the workspace, or of the current folder.
#[test]
fn a_scene_is_found_and_files_are_written_from_any_folder_of_the_workspace() {
    let mut place = Place::with("workspace/scenes/block.toml", BLOCK);
    place.succeeds("run workspace/scenes/block.toml --quiet");
    assert!(place.path("target/fisura/run/history.csv").is_file());
    place.write("workspace/Cargo.toml", "[workspace]\n");
    place.write("workspace/solver/src/lib.rs", "");
    place.manifest = Some(place.path("workspace/xtask"));
    let below = "workspace/solver/src";
    for command in ["check", "run"] {
        place.xtask_in(below, &format!("{command} scenes/block.toml")).with_status(0);
    }
    assert!(place.path("workspace/target/fisura/run/history.csv").is_file());
    let nearer = BLOCK.replace("Block", "Nearer");
    place.write("workspace/solver/src/scenes/block.toml", &nearer);
    place.xtask_in(below, "check scenes/block.toml").with_status(0).says(&["Nearer"]);
    for command in ["check", "run"] {
        let absent = place.xtask_in(below, &format!("{command} scenes/absent.toml")).with_status(2);
        let absent =
            absent.complains_of(&["there is no scenes/absent.toml", "workspace/solver/src and ", "workspace\n"]);
        assert_eq!(absent.out, "");
    }
    place.manifest = None;
    let absent = place.xtask_in(below, "check absent.toml").with_status(2);
    assert!(absent.err.contains("solver/src\n"), "one place: {absent:?}");
}

/// The rows of a run that is far from its end.
#[test]
fn the_history_can_be_followed() {
    let place = Place::with("block.toml", BLOCK);
    let long = "--set 'analysis.end_time=5 ms' --set output.samples=5000 --set output.frames=[]";
    for checkpoint in ["none", "60"] {
        let mut child = place.begin(&format!("run block.toml --out out --checkpoint {checkpoint} {long}"));
        let rows = || std::fs::read_to_string(place.path("out/history.csv")).unwrap_or_default();
        wait_until(|| rows().lines().count() >= 12);
        let ended = child.try_wait().unwrap();
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(ended.is_none() && !place.path("out/summary.json").exists(), "{checkpoint}: it ended before");
        let text = rows();
        let whole = &text[..text.rfind('\n').unwrap() + 1];
        assert!(whole.starts_with("time_s,") && whole.lines().count() >= 12, "{whole}");
        assert!(whole.lines().all(|line| line.matches(',').count() == 9), "{whole}");
    }
    place.succeeds("run block.toml --out out");
    assert_eq!(place.read("out/history.csv").lines().count(), 1 + 11, "the part of a run is replaced");
}

#[test]
fn an_output_folder_that_cannot_be_written_is_refused_before_the_run() {
    let place = Place::with("block.toml", BLOCK);
    place.write("file", "not a folder");
    let parts = ["output folder file/out cannot be written", "--out"];
    assert_eq!(place.refuses("run block.toml --out file/out", &parts).out, "");
}

/// Files beyond a limit cannot be written, as on a full disk.
#[cfg(unix)]
#[test]
fn a_full_disk_ends_with_2_and_leaves_nothing_that_looks_finished() {
    let place = Place::with("block.toml", BLOCK);
    let run = format!("exec {} run block.toml --out out", env!("CARGO_BIN_EXE_xtask"));
    let run = place.start(Path::new("sh"), "", &format!("-c \"trap '' XFSZ; ulimit -f 1; {run}\""));
    run.with_status(2).complains_of(&["out/", "cannot be written", "--out"]);
    assert!(place.files("out").iter().all(|name| !name.ends_with(".part")), "{:?}", place.files("out"));
    assert!(!place.path("out/energies.svg").exists());
}

#[test]
fn the_demonstration_draws_energies_and_says_what_comes_next() {
    let place = Place::with("verification/scenes/plate.toml", NOTCHED);
    let demo = place.succeeds("demo --out out");
    demo.says(&["e elastic", "│", "coarse", "cargo xtask verify --suite plate", "phase-80us.svg"]);
    assert!(place.files("out").contains(&"history.csv".to_string()));
}
