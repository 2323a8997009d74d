//! `run --resume`: killed and interrupted runs go on to the same bytes; checkpoints of others are refused.

use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::support::{Place, notched};

/// A cracking plate that takes a second or two, with frames on the way.
fn plate() -> Place {
    let text = notched().replacen("cells  = [10, 5]", "cells  = [80, 40]", 1);
    let text =
        text.replacen("frames  = [\"0 us\", \"5 us\"]", "frames  = [\"0 us\", \"2 us\", \"6 us\", \"20 us\"]", 1);
    let text = text.replacen("end_time = \"5 us\"", "end_time = \"20 us\"", 1);
    Place::with("plate.toml", &text.replacen("samples = 10", "samples = 200", 1))
}

const ARGUMENTS: [&str; 6] = ["run", "plate.toml", "--vtk", "--threads", "2", "--out"];
const OFTEN: [&str; 2] = ["--checkpoint", "0.02"];

/// Waits until `there` is true, a minute at most.
fn wait_until(there: impl Fn() -> bool) {
    let clock = Instant::now();
    while !there() && clock.elapsed() < Duration::from_secs(60) {
        sleep(Duration::from_millis(5));
    }
}

/// Starts a run in `killed` and kills it once `there` is true.
fn kill_once(place: &Place, more: &[&str], there: impl Fn() -> bool) {
    let mut command = place.command(&[&ARGUMENTS[..], &["killed"], &OFTEN, more].concat());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the binary starts");
    wait_until(there);
    child.kill().and_then(|()| child.wait()).expect("SIGKILL");
}

/// Histories, pictures and files for ParaView are those of the undisturbed run, and nothing else is left.
#[track_caller]
fn same_files(place: &Place) {
    let names = place.files("undisturbed");
    assert_eq!(place.files("killed"), names);
    for name in names.iter().filter(|name| *name != "summary.json") {
        let bytes = |folder: &str| std::fs::read(place.path(folder).join(name)).expect("a file");
        assert!(bytes("killed") == bytes("undisturbed"), "{name} differs");
    }
    assert!(names.iter().any(|name| name == "history.csv") && names.len() == 3 + 2 * 4 + 2 * (4 + 1), "{names:?}");
}

#[test]
fn a_run_killed_again_and_again_gives_the_bytes_of_an_undisturbed_one() {
    let place = plate();
    let clock = Instant::now();
    place.xtask(&[&ARGUMENTS[..], &["undisturbed", "--checkpoint", "none"]].concat()).with_status(0);
    let whole = clock.elapsed();
    for part in [0.05, 0.3, 0.1, 0.45, 0.2] {
        let begun = Instant::now();
        kill_once(&place, &["--resume"], || begun.elapsed() >= whole.mul_f64(part));
        let finished = place.path("killed/summary.json").exists();
        let marked =
            !place.path("killed/fisura.sha256").exists() || place.read("killed/fisura.sha256").contains("# unfinished");
        assert!(finished || marked, "a part of a history looks finished");
    }
    kill_once(&place, &["--resume"], || place.path("killed/checkpoint.bin").exists());
    place.xtask(&[&ARGUMENTS[..], &["killed", "--resume"]].concat()).with_status(0);
    same_files(&place);
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_stores_where_it_is_and_ends_with_130() {
    for signal in ["-INT", "-TERM"] {
        let place = plate();
        place.xtask(&[&ARGUMENTS[..], &["undisturbed"]].concat()).with_status(0);
        let mut command = place.command(&[&ARGUMENTS[..], &["killed"]].concat());
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the binary starts");
        wait_until(|| {
            place.path("killed/history.csv").exists() && place.read("killed/history.csv").lines().count() >= 2
        });
        let id = child.id().to_string();
        assert!(std::process::Command::new("kill").args([signal, &id]).status().expect("kill").success());
        let output = child.wait_with_output().expect("it ends");
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{signal}: {err}");
        assert!(err.contains("interrupted after step") && err.contains("--resume"), "{err}");
        let mut files = place.files("killed");
        files.retain(|name| !name.ends_with(".vtu") && !name.ends_with(".pvd"));
        assert_eq!(files, ["checkpoint.bin", "history.csv"]);
        let (part, whole) = (place.read("killed/history.csv"), place.read("undisturbed/history.csv"));
        assert!(part.lines().count() >= 2 && whole.starts_with(&part), "rows up to the interrupt: {part}");
        let run = place.xtask(&[&ARGUMENTS[..], &["killed", "--resume"]].concat()).with_status(0);
        assert_eq!(run.err, "");
        same_files(&place);
    }
}

/// Starts a run in `killed` and interrupts it once its checkpoint of that name is there.
#[cfg(unix)]
fn interrupt(place: &Place, name: &str, more: &[&str]) -> String {
    let scene = ["run", "plate.toml", "--threads", "2", "--out", "killed"];
    let mut command = place.command(&[&scene[..], &OFTEN, more].concat());
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the binary starts");
    wait_until(|| place.path("killed").join(name).exists());
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().expect("kill").success());
    let output = child.wait_with_output().expect("it ends");
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(130), "{err}");
    err
}

#[cfg(unix)]
#[test]
fn the_checkpoint_of_another_scene_is_kept_and_named() {
    let place = plate();
    let run = ["run", "plate.toml", "--threads", "2", "--out"];
    place.xtask(&[&run[..], &["undisturbed"]].concat()).with_status(0);
    interrupt(&place, "checkpoint.bin", &[]);
    let first = std::fs::read(place.path("killed/checkpoint.bin")).expect("a checkpoint");
    let head = String::from_utf8_lossy(&first[..200]).into_owned();
    let head: Vec<&str> = head.lines().take(4).collect();
    assert_eq!((head[0], head[3]), ("fisura checkpoint 4", "Block"));
    assert!(head[1].starts_with("fisura 0.1.0 of commit ") && head[2].len() == 16, "{head:?}");

    let other = ["--set", "output.samples=100"];
    let names = place.files("killed");
    let title = ["checkpoint.bin is of an interrupted run of another scene, \"Block\"", "kept"];
    let done = place.xtask(&[&run[..], &["killed"], &other].concat()).with_status(0).complains_of(&title);
    assert!(done.err.contains("stores its own in checkpoint-"), "{done:?}");
    assert!(std::fs::read(place.path("killed/checkpoint.bin")).expect("a checkpoint") == first);
    let own = done.err.split("its own in ").nth(1).expect("a name").trim().to_string();
    interrupt(&place, &own, &other);
    assert_eq!(place.files("killed"), [own.as_str(), names[0].as_str(), "history.csv"]);
    place.xtask(&[&run[..], &["killed", "--resume"]].concat()).with_status(0);
    for name in place.files("undisturbed").iter().filter(|name| *name != "summary.json") {
        assert!(place.read(&format!("killed/{name}")) == place.read(&format!("undisturbed/{name}")), "{name} differs");
    }
    assert!(place.files("killed").contains(&own) && !place.files("killed").contains(&names[0]));
    let resumed = place.xtask(&[&run[..], &["killed", "--resume"], &other].concat()).with_status(0);
    assert!(resumed.err.is_empty() && !place.files("killed").contains(&own), "{resumed:?}");
}

#[cfg(unix)]
#[test]
fn files_for_paraview_of_another_scene_are_not_taken_for_those_of_the_run() {
    let place = plate();
    let run = ["run", "plate.toml", "--threads", "2", "--out", "killed"];
    interrupt(&place, "checkpoint.bin", &[]);
    place.xtask(&[&run[..], &["--vtk", "--set", "output.samples=100"]].concat()).with_status(0);
    assert!(place.path("killed/points-0.vtu").exists() && place.path("killed/checkpoint.bin").exists());
    let resumed = place.xtask(&[&run[..], &["--vtk", "--resume"]].concat()).with_status(0);
    assert!(resumed.err.contains("computed without --vtk"), "{resumed:?}");
    assert!(!place.path("killed/points-0.vtu").exists() && !place.read("killed/points.pvd").contains("points-0.vtu"));
}

#[test]
fn without_a_checkpoint_the_run_begins_at_the_start_and_says_so() {
    let place = Place::with("block.toml", super::support::BLOCK);
    let run = place.xtask(&["run", "block.toml", "--out", "out", "--resume"]).with_status(0);
    run.complains_of(&["no checkpoint in out", "begins at the start"]);
    assert!(place.path("out/history.csv").is_file() && !place.path("out/checkpoint.bin").exists());
}

#[test]
fn a_checkpoint_of_another_scene_or_damaged_is_refused_with_2() {
    let place = plate();
    kill_once(&place, &[], || place.path("killed/checkpoint.bin").exists());
    let resumed = |more: &[&str]| place.xtask(&[&ARGUMENTS[..], &["killed", "--resume"], more].concat());
    let refused = |more: &[&str], parts: &[&str]| {
        assert_eq!(resumed(more).with_status(2).complains_of(parts).out, "");
    };
    refused(&["--set", "output.samples=100"], &["checkpoint.bin cannot be resumed", "another scene", "--set"]);
    refused(&["--checkpoint", "none"], &["--resume does not go with --checkpoint none"]);
    refused(&["--checkpoint", "soon"], &["soon", "seconds"]);
    let path = place.path("killed/checkpoint.bin");
    let whole = std::fs::read(&path).expect("a checkpoint");
    let mut flipped = whole.clone();
    *flipped.last_mut().expect("bytes") ^= 1;
    let older = [b"fisura checkpoint 0\n", &whole[20..]].concat();
    for (bytes, part) in [
        (&flipped[..], "checksum"),
        (&whole[..whole.len() / 2], "checksum"),
        (&older, "another version"),
        (b"", "not a checkpoint"),
    ] {
        std::fs::write(&path, bytes).expect("a file");
        refused(&[], &[part, "--resume"]);
    }
    std::fs::write(&path, &whole).expect("a file");
    resumed(&[]).with_status(0);
}
