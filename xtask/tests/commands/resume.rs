//! `run --resume`: killed and interrupted runs go on to the same bytes; checkpoints of others are refused.

use std::time::Instant;

use super::support::{NOTCHED, Place, end, wait_until};

/// A cracking plate that takes a second or two, with frames on the way.
fn plate() -> Place {
    let text = NOTCHED.replacen("cells  = [10, 5]", "cells  = [80, 40]", 1);
    let text =
        text.replacen("frames  = [\"0 us\", \"5 us\"]", "frames  = [\"0 us\", \"2 us\", \"6 us\", \"20 us\"]", 1);
    let text = text.replacen("end_time = \"5 us\"", "end_time = \"20 us\"", 1);
    Place::with("plate.toml", &text.replacen("samples = 10", "samples = 200", 1))
}

/// A run of the plate into the folder that follows, and one that leaves files for ParaView as well.
const RUN: &str = "run plate.toml --threads 2 --out";
const RUN_VTK: &str = "run plate.toml --vtk --threads 2 --out";
const OFTEN: &str = "--checkpoint 0.02";

/// Starts a run in `killed` and kills it once `there` is true.
fn kill_once(place: &Place, more: &str, there: impl Fn() -> bool) {
    let mut child = place.begin(&format!("{RUN_VTK} killed {OFTEN} {more}"));
    wait_until(there);
    child.kill().and_then(|()| child.wait()).expect("SIGKILL");
}

/// The files of the run in `killed` but its summary are those of the undisturbed run; names them.
#[track_caller]
fn same_files(place: &Place) -> Vec<String> {
    let names = place.files("undisturbed");
    for name in names.iter().filter(|name| *name != "summary.json") {
        let bytes = |folder: &str| std::fs::read(place.path(folder).join(name)).expect("a file");
        assert!(bytes("killed") == bytes("undisturbed"), "{name} differs");
    }
    names
}

/// Histories, pictures and files for ParaView are those of the undisturbed run, and nothing else is left.
#[track_caller]
fn nothing_else_is_left(place: &Place) {
    let names = same_files(place);
    assert_eq!(place.files("killed"), names);
    assert!(names.iter().any(|name| name == "history.csv") && names.len() == 3 + 2 * 4 + 2 * (4 + 1), "{names:?}");
}

#[test]
fn a_run_killed_again_and_again_gives_the_bytes_of_an_undisturbed_one() {
    let place = plate();
    let clock = Instant::now();
    place.succeeds(&format!("{RUN_VTK} undisturbed --checkpoint none"));
    let whole = clock.elapsed();
    for part in [0.05, 0.3, 0.1, 0.45, 0.2] {
        let begun = Instant::now();
        kill_once(&place, "--resume", || begun.elapsed() >= whole.mul_f64(part));
        let finished = place.path("killed/summary.json").exists();
        let marked =
            !place.path("killed/fisura.sha256").exists() || place.read("killed/fisura.sha256").contains("# unfinished");
        assert!(finished || marked, "a part of a history looks finished");
    }
    kill_once(&place, "--resume", || place.path("killed/checkpoint.bin").exists());
    place.succeeds(&format!("{RUN_VTK} killed --resume"));
    nothing_else_is_left(&place);
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_stores_where_it_is_and_ends_with_130() {
    for signal in ["-INT", "-TERM"] {
        let place = plate();
        place.succeeds(&format!("{RUN_VTK} undisturbed"));
        let child = place.begin(&format!("{RUN_VTK} killed"));
        wait_until(|| {
            place.path("killed/history.csv").exists() && place.read("killed/history.csv").lines().count() >= 2
        });
        let (status, err) = end(child, signal);
        assert_eq!(status, Some(130), "{signal}: {err}");
        assert!(err.contains("interrupted after step") && err.contains("--resume"), "{err}");
        let mut files = place.files("killed");
        files.retain(|name| !name.ends_with(".vtu") && !name.ends_with(".pvd"));
        assert_eq!(files, ["checkpoint.bin", "history.csv"]);
        let (part, whole) = (place.read("killed/history.csv"), place.read("undisturbed/history.csv"));
        assert!(part.lines().count() >= 2 && whole.starts_with(&part), "rows up to the interrupt: {part}");
        assert_eq!(place.succeeds(&format!("{RUN_VTK} killed --resume")).err, "");
        nothing_else_is_left(&place);
    }
}

/// Starts a run in `killed` and interrupts it once its checkpoint of that name is there.
#[cfg(unix)]
fn interrupt(place: &Place, name: &str, more: &str) {
    let child = place.begin(&format!("{RUN} killed {OFTEN} {more}"));
    wait_until(|| place.path("killed").join(name).exists());
    let (status, err) = end(child, "-INT");
    assert_eq!(status, Some(130), "{err}");
}

#[cfg(unix)]
#[test]
fn the_checkpoint_of_another_scene_is_kept_and_named() {
    let place = plate();
    place.succeeds(&format!("{RUN} undisturbed"));
    interrupt(&place, "checkpoint.bin", "");
    let first = std::fs::read(place.path("killed/checkpoint.bin")).expect("a checkpoint");
    let head = String::from_utf8_lossy(&first[..200]).into_owned();
    let head: Vec<&str> = head.lines().take(4).collect();
    assert_eq!((head[0], head[3]), ("fisura checkpoint 4", "Block"));
    assert!(head[1].starts_with("fisura 0.1.0 of commit ") && head[2].len() == 16, "{head:?}");

    let other = "--set output.samples=100";
    let names = place.files("killed");
    let title = ["checkpoint.bin is of an interrupted run of another scene, \"Block\"", "kept"];
    let done = place.succeeds(&format!("{RUN} killed {other}")).complains_of(&title);
    assert!(done.err.contains("stores its own in checkpoint-"), "{done:?}");
    assert!(std::fs::read(place.path("killed/checkpoint.bin")).expect("a checkpoint") == first);
    let own = done.err.split("its own in ").nth(1).expect("a name").trim().to_string();
    interrupt(&place, &own, other);
    assert_eq!(place.files("killed"), [own.as_str(), names[0].as_str(), "history.csv"]);
    place.succeeds(&format!("{RUN} killed --resume"));
    same_files(&place);
    assert!(place.files("killed").contains(&own) && !place.files("killed").contains(&names[0]));
    let resumed = place.succeeds(&format!("{RUN} killed --resume {other}"));
    assert!(resumed.err.is_empty() && !place.files("killed").contains(&own), "{resumed:?}");
}

#[cfg(unix)]
#[test]
fn files_for_paraview_of_another_scene_are_not_taken_for_those_of_the_run() {
    let place = plate();
    interrupt(&place, "checkpoint.bin", "");
    place.succeeds(&format!("{RUN_VTK} killed --set output.samples=100"));
    assert!(place.path("killed/points-0.vtu").exists() && place.path("killed/checkpoint.bin").exists());
    place.succeeds(&format!("{RUN_VTK} killed --resume")).complains_of(&["computed without --vtk"]);
    assert!(!place.path("killed/points-0.vtu").exists() && !place.read("killed/points.pvd").contains("points-0.vtu"));
}

#[test]
fn without_a_checkpoint_the_run_begins_at_the_start_and_says_so() {
    let place = Place::with("block.toml", super::support::BLOCK);
    let run = place.succeeds("run block.toml --out out --resume");
    run.complains_of(&["no checkpoint in out", "begins at the start"]);
    assert!(place.path("out/history.csv").is_file() && !place.path("out/checkpoint.bin").exists());
}

#[test]
fn a_checkpoint_of_another_scene_or_damaged_is_refused_with_2() {
    let place = plate();
    kill_once(&place, "", || place.path("killed/checkpoint.bin").exists());
    let refused = |more: &str, parts: &[&str]| {
        assert_eq!(place.refuses(&format!("{RUN_VTK} killed --resume {more}"), parts).out, "");
    };
    refused("--set output.samples=100", &["checkpoint.bin cannot be resumed", "another scene", "--set"]);
    refused("--checkpoint none", &["--resume does not go with --checkpoint none"]);
    refused("--checkpoint soon", &["soon", "seconds"]);
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
        refused("", &[part, "--resume"]);
    }
    std::fs::write(&path, &whole).expect("a file");
    place.succeeds(&format!("{RUN_VTK} killed --resume"));
}
