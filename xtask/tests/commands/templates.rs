//! Templates for runs over machines: those whose program is installed really run.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use super::merge::workspace;
use super::support::Place;

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

/// Runs a command in a workspace, with the binary under test in place of `cargo xtask`.
fn run(place: &Place, program: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(place.path("")).env("FISURA", env!("CARGO_BIN_EXE_xtask"));
    command.env("CARGO_MANIFEST_DIR", place.path("xtask")).env_remove("GITHUB_ACTIONS");
    command.output().expect("the program starts")
}

/// Whether the merged results hold the records of all five cases.
#[track_caller]
fn is_merged(place: &Place, folder: &str, output: &Output) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(place.path(folder).join("report.html").is_file(), "{said}");
    let results: serde_json::Value = serde_json::from_str(&place.read(&format!("{folder}/results.json"))).unwrap();
    assert_eq!(results["records"].as_array().unwrap().len(), 5, "{said}");
}

#[test]
fn gnu_parallel_runs_slices_and_merges_them() {
    if !installed("parallel") {
        return;
    }
    let place = workspace();
    let script = template("parallel.sh");
    let output = run(&place, "bash", &[script.to_str().unwrap(), "3", "out"]);
    assert_eq!(output.status.code(), Some(1), "one check fails, and the merge says so: {output:?}");
    is_merged(&place, "out/merged", &output);
}

#[test]
fn snakemake_runs_slices_and_merges_them() {
    if !installed("snakemake") {
        return;
    }
    let place = workspace();
    let (file, binary) = (template("Snakefile"), format!("fisura={}", env!("CARGO_BIN_EXE_xtask")));
    let arguments = ["-s", file.to_str().unwrap(), "--cores", "2", "--config", "slices=3", "out=out", &binary];
    let output = run(&place, "snakemake", &arguments);
    assert!(output.status.success(), "{output:?}");
    is_merged(&place, "out/merged", &output);
}

/// The script as the tasks of an array would run it; one of its cases breaks down.
#[test]
fn tasks_of_a_slurm_array_leave_parts() {
    let place = workspace();
    let unstable =
        place.read("verification/cases/plate/b.toml").replace("end_time = ", "time_step = \"1 us\"\nend_time = ");
    place.write("verification/cases/plate/b.toml", &unstable.replace("end_time = \"5 us\"", "end_time = \"500 us\""));
    let script = template("slurm.sh");
    for task in ["1", "2", "3"] {
        let mut command = Command::new("bash");
        command.arg(&script).current_dir(place.path("")).env("FISURA", env!("CARGO_BIN_EXE_xtask"));
        command.env("CARGO_MANIFEST_DIR", place.path("xtask")).env_remove("GITHUB_ACTIONS");
        command.envs([("SLURM_ARRAY_TASK_ID", task), ("SLURM_ARRAY_TASK_COUNT", "3")]);
        let output = command.output().expect("bash starts");
        assert!(output.status.success(), "{output:?}");
    }
    let parts = ["1", "2", "3"].map(|k| format!("target/fisura/array/part-{k}"));
    let output =
        run(&place, env!("CARGO_BIN_EXE_xtask"), &["merge", &parts[0], &parts[1], &parts[2], "--out", "merged"]);
    assert_eq!(output.status.code(), Some(3), "a case broke down, and the merge says so: {output:?}");
    is_merged(&place, "merged", &output);
}

#[test]
fn the_workflow_is_the_template() {
    let workflow = template("../../.github/workflows/full-verification.yml");
    let [workflow, template] =
        [workflow, template("github-matrix.yml")].map(|path| std::fs::read_to_string(path).unwrap());
    assert!(workflow == template, "copy xtask/templates/github-matrix.yml to .github/workflows/full-verification.yml");
}
