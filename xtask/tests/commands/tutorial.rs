//! The second part of the tutorial, run as written.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;

#[test]
fn judge_your_own_code_runs_as_written() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let tutorial = fs::read_to_string(root.join("reports/book/src/tutorial.md")).unwrap();
    let (_, part) = tutorial.split_once("# Judge your own code\n").unwrap();
    let blocks = part.split("```sh\n").skip(1).map(|text| text.split("```").next().unwrap());

    // `cargo xtask …` is the binary, in a folder that has the reference data and nothing else.
    let folder = tempfile::tempdir().unwrap();
    symlink(root.join("reference-data"), folder.path().join("reference-data")).unwrap();
    let cargo = folder.path().join("cargo");
    fs::write(&cargo, format!("#!/bin/sh\nshift\nexec '{}' \"$@\"\n", env!("CARGO_BIN_EXE_xtask"))).unwrap();
    fs::set_permissions(&cargo, fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap());

    let run = |block: &str| {
        let mut command = Command::new("sh");
        command.args(["-ec", block]).current_dir(folder.path()).env("PATH", &path);
        let output = command.env("CARGO_MANIFEST_DIR", folder.path().join("xtask")).output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
    };
    let outcomes: Vec<(i32, String)> = blocks.map(run).collect();
    assert_eq!(outcomes.iter().map(|(status, _)| *status).collect::<Vec<_>>(), [0, 0, 1, 0, 1, 0], "{outcomes:?}");
    let says = |block: usize, parts: &[&str]| {
        for part in parts {
            assert!(outcomes[block].1.contains(part), "{part} is missing in {:?}", outcomes[block]);
        }
    };
    says(2, &["FOUND half-model-factor", "FOUND tip-origin", "0 pass, 7 fail, 3 incomplete, 1 diagnostic"]);
    says(3, &["|E| 2.9, U_val 3.6 %", "needs tip_y", "3 pass, 0 fail, 3 incomplete, 5 diagnostic"]);
    says(4, &["FOUND unexplained", "2 pass, 1 fail, 3 incomplete, 5 diagnostic"]);
    assert!(fs::read_to_string(folder.path().join("target/fisura/judge/board.html")).unwrap().contains("my code"));
}
