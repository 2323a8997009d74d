//! `judge`: verdicts on results of any code.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::support::Place;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A place that finds the reference data of this project.
fn place() -> Place {
    let mut place = Place::new();
    place.manifest = Some(root().join("xtask"));
    place
}

/// Judges a result that passes.
fn judge_sound() -> String {
    format!("judge --out out {}", root().join("reference-data/submissions/fisura-p2-h2").display())
}

#[test]
fn a_sound_result_passes_and_leaves_page_verdict_and_export() {
    let place = place();
    let outcome = place.succeeds(&judge_sound());
    assert!(
        outcome.out.starts_with("PASS ")
            && outcome.out.ends_with("1 judged: 1 pass, 0 fail, 0 incomplete, 0 diagnostic\n")
    );
    assert_eq!(place.files("out"), ["judge.html", "verdict.json"]);
    let page = place.read("out/judge.html");
    assert!(page.contains("<svg") && !page.contains("<script") && !page.contains("src=\"http"));
    let json = place.succeeds(&format!("{} --format json", judge_sound()));
    assert_eq!(json.json(), place.json("out/verdict.json"));
    assert_eq!(json.json()["schema"], "fisura.verdict/1");
}

#[test]
fn the_references_are_found_from_any_folder() {
    // above the program
    let mut place = Place::new();
    place.succeeds(&judge_sound());
    // a project of somebody else that cargo runs, with a folder of the same name
    place.write("theirs/Cargo.toml", "[package]\n");
    place.write("reference-data/theirs/curve.csv", "x,y\n0,1\n");
    place.manifest = Some(place.path("theirs"));
    place.xtask_in("theirs", &judge_sound()).with_status(0);
}

#[test]
#[cfg(unix)]
fn the_references_are_those_of_the_current_workspace_or_missed_with_all_places() {
    let mut place = Place::new();
    place.write("elsewhere/deep/er/note.txt", "");
    std::fs::create_dir(place.path("bin")).unwrap();
    let program = place.path("bin/xtask");
    // by another process: a file that this one has open for writing cannot be started meanwhile
    let copied = Command::new("cp").arg(env!("CARGO_BIN_EXE_xtask")).arg(&program).status().unwrap();
    assert!(copied.success());
    let judge = |place: &Place| place.start(&program, "elsewhere/deep/er", &judge_sound());
    let places = ["elsewhere/deep/er and above, the current folder", "bin and above, the program", "cargo xtask"];
    judge(&place).with_status(2).complains_of(&places);
    place.manifest = Some(place.path("package"));
    judge(&place).with_status(2).complains_of(&["the workspace of cargo"]).complains_of(&places);
    std::os::unix::fs::symlink(root().join("reference-data"), place.path("elsewhere/reference-data")).unwrap();
    judge(&place).with_status(0);
}

#[test]
fn several_folders_are_judged_at_once_and_one_that_fails_ends_with_1() {
    let place = place();
    let wrong = root().join("verification/tests/judge/length-scale");
    let outcome = place.xtask(&format!("{} {}", judge_sound(), wrong.display())).with_status(1);
    outcome.says(&["FOUND length-scale-convention", "2 judged: 1 pass, 1 fail"]);
}

#[test]
fn the_template_is_taken_and_what_is_missing_is_named() {
    let place = place();
    let template = place.succeeds("judge --new plate").out;
    place.write("mine/submission.toml", &template);
    place.refuses("judge mine --out out", &["submission.toml:", "history.csv", "cannot be read"]);
    place.refuses("judge", &["FOLDER"]);
    place.refuses("judge nowhere --out out", &["judge --new plate"]);
    place.refuses("judge --new plates", &["plates", "plane-waves"]);
    let line = template.replace("plane    =", "plan     =");
    place.write("mine/submission.toml", &line);
    place.refuses("judge mine --out out", &["did you mean \"plane\"?"]);
}

#[test]
fn markup_in_names_stays_text() {
    let place = place();
    let text = "benchmark = \"crack-speed\"\n[code]\nname = \"<script>alert(1)</script>\\u001b[2J\"\n[values]\nlargest_speed = 900\n";
    place.write("mine/submission.toml", text);
    let outcome = place.succeeds("judge mine --out out");
    assert!(!outcome.out.contains('\u{1b}'));
    let page = place.read("out/judge.html");
    assert!(!page.contains("<script") && page.contains("&lt;script&gt;"), "{page}");
}

#[test]
fn the_board_says_what_the_numbers_say() {
    let place = place();
    let parts = ["kinetic energy: error against spacing\n  Of ", "Costs are not shown: ", "The references differ"];
    place.succeeds("judge --board --out out").says(&parts);
    assert_eq!(
        place.files("out"),
        ["board-elastic.svg", "board-fracture.svg", "board-kinetic.svg", "board.html", "board.md", "verdict.json"]
    );
    let gallery = root().join("reports/gallery/judge");
    for name in ["board-elastic.svg", "board-fracture.svg", "board-kinetic.svg", "board.md"] {
        let committed = std::fs::read_to_string(gallery.join(name)).expect("a file of the gallery");
        let remedy =
            "copy it anew: cargo xtask judge --board && cp target/fisura/judge/board[-.][kefm]* reports/gallery/judge";
        assert!(place.read(&format!("out/{name}")) == committed, "{name}: {remedy}");
    }
}
