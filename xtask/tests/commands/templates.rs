//! Templates for runs over machines: those whose program is installed really run.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::merge::workspace;
use super::support::{Outcome, Place};

fn template(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("templates").join(name)
}

fn installed(program: &str) -> bool {
    let there = Command::new(program).arg("--version").output().is_ok_and(|o| o.status.success());
    if !there {
        eprintln!("{program} is not installed: its template is not run");
    }
    there
}

/// A workspace in which templates start the binary under test in place of `cargo xtask`.
fn place() -> Place {
    let mut place = workspace();
    place.variables = vec![("FISURA", env!("CARGO_BIN_EXE_xtask"))];
    place
}

/// Whether the merged results hold the records of all five cases.
#[track_caller]
fn is_merged(place: &Place, folder: &str, outcome: &Outcome) {
    assert!(place.path(folder).join("report.html").is_file(), "{outcome:?}");
    let results = place.json(&format!("{folder}/results.json"));
    assert_eq!(results["records"].as_array().unwrap().len(), 5, "{outcome:?}");
}

#[test]
fn gnu_parallel_runs_slices_and_merges_them() {
    if !installed("parallel") {
        return;
    }
    let place = place();
    let outcome = place.start(Path::new("bash"), "", &format!("{} 3 out", template("parallel.sh").display()));
    is_merged(&place, "out/merged", &outcome.with_status(1));
}

#[test]
fn snakemake_runs_slices_and_merges_them() {
    if !installed("snakemake") {
        return;
    }
    let place = place();
    let (file, binary) = (template("Snakefile"), env!("CARGO_BIN_EXE_xtask"));
    let line = format!("-s {} --cores 2 --config slices=3 out=out fisura={binary}", file.display());
    is_merged(&place, "out/merged", &place.start(Path::new("snakemake"), "", &line).with_status(0));
}

/// The script as the tasks of an array would run it; one of its cases breaks down.
#[test]
fn tasks_of_a_slurm_array_leave_parts() {
    let mut place = place();
    let unstable =
        place.read("verification/cases/plate/b.toml").replace("end_time = ", "time_step = \"1 us\"\nend_time = ");
    place.write("verification/cases/plate/b.toml", &unstable.replace("end_time = \"5 us\"", "end_time = \"500 us\""));
    let script = template("slurm.sh").display().to_string();
    for task in ["1", "2", "3"] {
        place.variables.extend([("SLURM_ARRAY_TASK_ID", task), ("SLURM_ARRAY_TASK_COUNT", "3")]);
        place.start(Path::new("bash"), "", &script).with_status(0);
    }
    let parts = [1, 2, 3].map(|k| format!("target/fisura/array/part-{k}")).join(" ");
    let merged = place.xtask(&format!("merge {parts} --out merged"));
    is_merged(&place, "merged", &merged.with_status(3));
}

#[test]
fn the_workflow_is_the_template() {
    let workflow = template("../../.github/workflows/full-verification.yml");
    let [workflow, template] =
        [workflow, template("github-matrix.yml")].map(|path| std::fs::read_to_string(path).unwrap());
    assert!(workflow == template, "copy xtask/templates/github-matrix.yml to .github/workflows/full-verification.yml");
}
