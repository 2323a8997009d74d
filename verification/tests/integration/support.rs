//! A small scene, and suites of cases with it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use fisura_verification::output::OutputFolder;
use fisura_verification::record::{Environment, ResultSet};
use fisura_verification::scene::SceneFile;
use fisura_verification::suite::{Case, Options, Progress, Seconds, VerifyError, load_cases, verify};
use serde::Deserialize;

pub const SCENE: &str = r#"
[scene.mesh]
degree = 2
origin = [0.0, 0.0]
size = [1.0, 0.5]
cells = [8, 4]

[scene.analysis]
end_time = 1.0

[scene.material.solid]
young_modulus = 1.0
poisson_ratio = 0.3
density = 1.0

[[scene.body]]
name = "block"
material = "solid"
shape = { rectangle = { min = [0.0, 0.0], max = [1.0, 0.5] } }
velocity = [0.01, 0.0]

[[scene.boundary]]
side = "left"
fix = ["x"]

[scene.output]
samples = 10
"#;

pub struct Silent;

impl Progress for Silent {}

pub fn repository(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder)
}

pub fn write_case(root: &Path, name: &str, scene: &str, check: &str) {
    let folder = root.join("cases/trial");
    std::fs::create_dir_all(&folder).unwrap();
    let text = format!("claim = \"a trial\"\nseconds = 1\n{scene}\n{check}\n");
    std::fs::write(folder.join(format!("{name}.toml")), text).unwrap();
}

/// Ends the program, as it were, when a case of this name starts.
pub struct Killed(pub &'static str);

impl Progress for Killed {
    fn started(&self, case: &Case) {
        assert!(case.name != self.0, "killed at {}", self.0);
    }
}

/// Runs all cases below `root`.
pub fn run(root: &Path, environment: Environment) -> Result<ResultSet, VerifyError> {
    run_watched(root, environment, None, &Silent)
}

/// The same with a limit for the time of a case, told to `progress`.
pub fn run_watched(
    root: &Path,
    environment: Environment,
    case_timeout: Option<Duration>,
    progress: &dyn Progress,
) -> Result<ResultSet, VerifyError> {
    let cases = load_cases(&root.join("cases"), &[])?;
    let reference_data = repository("reference-data");
    let out = Arc::new(OutputFolder::open(&root.join("out"), "verify")?);
    let (program, reference_data) = (environment.commit.clone(), &*reference_data);
    let seconds = Seconds::default();
    let options =
        Options { out, reference_data, environment, program: &program, resume: true, case_timeout, seconds: &seconds };
    verify(&cases, &options, progress)
}

pub const CLOSURE: &str =
    "[[check]]\nid = \"closure\"\nquantity = \"closure\"\nmeasure = \"closure\"\nmax = 1e-12\nwhy = \"round-off\"";

/// A row of `broken_scenes.toml`.
#[derive(Deserialize)]
pub struct Broken {
    pub from: String,
    pub to: String,
    line: usize,
    key: String,
    words: Vec<String>,
}

/// Asserts that the scenes of a table are refused, each on a line of its own with place, key and words.
#[track_caller]
pub fn refused_where(table: &str, text: impl Fn(&Broken) -> String) {
    let mut tables: BTreeMap<String, Vec<Broken>> = toml::from_str(include_str!("broken_scenes.toml")).unwrap();
    let mut missed = Vec::new();
    for row in tables.remove(table).unwrap() {
        let Broken { to, line, key, words, .. } = &row;
        let error = SceneFile::parse("broken.toml", &text(&row), &[]).expect_err(to).to_string();
        let place = if *line == 0 { "broken.toml:".to_string() } else { format!("broken.toml:{line}:") };
        let subject = if key.is_empty() { String::new() } else { format!(" {key}: ") };
        let says = |l: &str| l.starts_with(&place) && l.contains(&subject) && words.iter().all(|w| l.contains(w));
        if !error.lines().any(says) {
            missed.push(format!("{to:?}: expected {place} {key} {words:?}, found\n{error}"));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n\n"));
}
