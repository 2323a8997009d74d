//! `check`: what it tells, and what it refuses.

use super::support::{BLOCK, NOTCHED, Place, keys};

#[test]
fn the_keys_of_its_json_stay() {
    let place = Place::with("notched.toml", NOTCHED);
    let found = place.succeeds("check notched.toml --format json").json();
    insta::assert_snapshot!("check-keys", keys(&found));
    assert_eq!(found["models"], serde_json::json!(["momentum", "phase field"]));
    assert_eq!(found["particles"], 200);
    let glass = &found["materials"]["glass"];
    assert!((glass["length_scale_over_span"].as_f64().unwrap() - 1.0).abs() < 1e-12);
    assert!((glass["wave_speed_m_per_s"].as_f64().unwrap() - 3809.5).abs() < 0.1);
    assert!(place.files(".") == ["notched.toml"], "nothing is written");
}

#[test]
fn an_elastic_scene_has_no_memory_for_a_phase_field_and_set_changes_what_is_checked() {
    let place = Place::with("block.toml", BLOCK);
    let found = place.succeeds("check block.toml --format json").json();
    assert_eq!(found["phase_field_memory_mb"], 0.0);
    assert!(found["materials"]["glass"].get("length_scale_over_span").is_none());
    let text = place.succeeds("check block.toml").out;
    assert!(!text.contains("phase field") && text.contains(" here, with "), "{text}");
    let sets = "--set mesh.cells=[20,10] --set body.0.particles_per_cell=[3,3]";
    let finer = place.succeeds(&format!("check block.toml --format json {sets}")).json();
    assert_eq!(finer["particles"], 1800);
}

/// At all sides of a block; not where the side that a crack comes from bounds the step, or where ends are
/// long already.
#[test]
fn it_says_where_long_ends_would_pay() {
    let check = |scene: &str, set: &str| {
        let place = Place::with("s.toml", scene);
        place.succeeds(&format!("check s.toml --format json --set mesh.cells=[20,10] {set}")).json()
    };
    let sides = ["left", "right", "bottom", "top"];
    let (found, set) = (check(BLOCK, ""), format!("--set 'mesh.long_ends={sides:?}'"));
    assert_eq!(found["long_ends"]["sides"], serde_json::json!(sides));
    let long = check(BLOCK, &set);
    let step = |found: &serde_json::Value| found["critical_step_s"].as_f64().unwrap();
    let times = found["long_ends"]["times"].as_f64().unwrap();
    assert!(times > 1.4 && (step(&long) / step(&found) / times - 1.0).abs() < 1e-6, "{times}");
    assert!(long.get("long_ends").is_none() && check(NOTCHED, "").get("long_ends").is_none());
}

/// What `check` foretells and the peak of the process that runs the scene, 10⁶ bytes.
fn memory(scene: &str, sets: &str) -> [f64; 2] {
    let place = Place::with("s.toml", scene);
    let found = place.succeeds(&format!("check s.toml --threads 1 --format json {sets}")).json();
    place.succeeds(&format!("run s.toml --threads 1 --out out --quiet {sets}"));
    [&found["memory_mb"], &place.json("out/summary.json")["peak_memory_mb"]].map(|mb| mb.as_f64().unwrap())
}

/// Within a fifth: scenes that are prepared to be checked, and larger ones, for which a coarser mesh stands.
#[cfg(target_os = "linux")]
#[test]
fn the_memory_of_a_run_is_foretold_within_a_fifth() {
    let cracked = NOTCHED.replace("\"1 mm\"", "\"0.1 mm\"");
    let [small, medium, large] = ["[20,10]", "[400,200]", "[600,300]"];
    for (what, scene, cells, frame) in [
        ("small and cracked", NOTCHED, small, "total"),
        ("cracked", &cracked, medium, "total"),
        ("elastic, moving", BLOCK, medium, "updated"),
        ("cracked, 7e5 points", &cracked, large, "total"),
        ("elastic, 7e5 points", BLOCK, large, "total"),
        ("elastic, 7e5 moving points", BLOCK, large, "updated"),
    ] {
        let short = "--set 'analysis.end_time=0.02 us' --set output.frames=[] --set output.samples=2";
        let [foretold, peak] = memory(scene, &format!("{short} --set mesh.cells={cells} --set analysis.frame={frame}"));
        assert!((foretold / peak - 1.0).abs() < 0.2, "{what}: {foretold} MB foretold, {peak} MB at the peak");
    }
}

#[test]
fn a_broken_scene_ends_with_2_and_names_place_key_and_remedy() {
    let broken = |from: &str, to: &str| {
        assert!(NOTCHED.contains(from), "no {from:?} in the scene");
        NOTCHED.replacen(from, to, 1)
    };
    for (text, parts) in [
        (broken("poisson_ratio", "poison_ratio"), &["s.toml:14:1: material.glass.poison_ratio: ", "poisson_ratio"][..]),
        (broken("\"5 us\"", "\"5 m\""), &["s.toml:10:12: analysis.end_time: ", "us"]),
        (broken("[mesh]", "[mesh"), &["s.toml:3:"]),
        (String::new(), &["s.toml:1:1: ", "[mesh]"]),
    ] {
        let place = Place::with("s.toml", &text);
        for command in ["check", "run"] {
            let outcome = place.refuses(&format!("{command} s.toml"), parts);
            assert!(outcome.out.is_empty() && !outcome.err.contains("panicked"), "{outcome:?}");
            assert!(outcome.err.lines().all(|l| l.starts_with("error: ") && l.contains("; ")), "{}", outcome.err);
        }
    }
}

/// A stress field without a value, which only the beginning of a run can tell.
#[test]
fn what_would_not_happen_is_refused_before_anything_runs() {
    let stress = BLOCK.lines().find(|line| line.starts_with("stress")).expect("the block is pulled");
    let text = BLOCK.replacen(stress, "stress_field = { yy = \"sqrt(-1 - x)\" }", 1);
    for frame in ["total", "updated"] {
        let text = text.replacen("[analysis]", &format!("[analysis]\nframe = \"{frame}\""), 1);
        let place = Place::with("s.toml", &text);
        for command in ["check", "run"] {
            let parts = ["s.toml:", "body.0.traction.0: ", "the stress field is not finite"];
            let outcome = place.refuses(&format!("{command} s.toml"), &parts);
            assert!(outcome.out.is_empty() && !outcome.err.contains("panicked"), "{outcome:?}");
        }
    }
}

#[test]
fn what_cannot_be_read_and_bad_arguments_end_with_2_before_anything_is_written() {
    let place = Place::with("block.toml", BLOCK);
    std::fs::write(place.path("bytes.toml"), [0xff, 0xfe, 0x00]).unwrap();
    place.write("folder/x", "");
    for command in ["check", "run"] {
        for (arguments, parts) in [
            ("absent.toml", &["absent.toml"][..]),
            ("folder", &["folder"]),
            ("bytes.toml", &["bytes.toml", "UTF-8"]),
            ("block.toml --set mesh.cells", &["no '='"]),
            ("block.toml --set 'mesh.cells=[1, '", &["mesh.cells", "TOML"]),
            ("block.toml --set mesh.colour=1", &["mesh.colour", "unknown key"]),
            ("block.toml --set body.3.velocity=[0,1]", &["--set:1:1: body.3.velocity: ", "the only one is 0"]),
            ("block.toml --threads 0", &["--threads"]),
        ] {
            assert_eq!(place.refuses(&format!("{command} {arguments}"), parts).out, "");
        }
    }
    let checkpoint = place.xtask("run block.toml --checkpoint=-1").with_status(2);
    assert_eq!(checkpoint.complains_of(&["--checkpoint", "seconds"]).out, "");
    assert_eq!(place.files("."), ["block.toml", "bytes.toml", "folder"], "nothing is written");
}

#[test]
fn warnings_go_to_standard_error_and_into_the_json() {
    let place = Place::with("block.toml", BLOCK);
    let check = "check block.toml --format json --set 'analysis.time_step=1 us'";
    let outcome = place.succeeds(check).complains_of(&["warning: ", "critical step"]);
    assert!(outcome.json()["warnings"].as_array().unwrap().iter().any(|w| w.as_str().unwrap().contains("critical")));
    assert_eq!(place.xtask(&format!("{check} --quiet")).err, "");
}

#[test]
fn the_example_scenes_are_valid_and_say_what_is_coarse() {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../verification/scenes");
    let place = Place::new();
    for entry in std::fs::read_dir(scenes).unwrap() {
        let path = entry.unwrap().path();
        let outcome = place.succeeds(&format!("check {}", path.display()));
        // Two have coarse meshes, so that they run in half a minute.
        let warnings =
            [("kalthoff.toml", "the crack is resolved coarsely"), ("ring.toml", "the crack is resolved coarsely")];
        let expected = |line: &str| warnings.iter().any(|(name, words)| path.ends_with(name) && line.contains(words));
        assert!(outcome.err.lines().all(expected), "{}: {}", path.display(), outcome.err);
    }
    let outcome = place.succeeds(&format!("run {scenes}/bar.toml --out bar"));
    assert_eq!(outcome.err, "");
    assert_eq!(place.read("bar/history.csv").lines().count(), 1 + 201);
}
