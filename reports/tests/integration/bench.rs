//! A small set of benchmarks is rendered as a whole: files, readings computed from the numbers, the same
//! bytes twice.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use fisura_reports::bench::{is_bench, read, render, store};
use fisura_verification::bench::record::{AnswerError, BenchRecord, BenchSet, Clock, NamedPeer, SCHEMA, Sample};
use fisura_verification::output::OutputFolder;
use fisura_verification::record::Environment;
use serde::Deserialize;
use tempfile::TempDir;

/// A record of the fixture.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    id: String,
    label: String,
    seconds: f64,
    amount: f64,
    unit: Option<String>,
    memory_bytes: Option<u64>,
    #[serde(default)]
    parameters: BTreeMap<String, serde_json::Value>,
    error: Option<f64>,
    energies: Option<f64>,
    /// Of a record that is measured in wall time.
    threads: Option<usize>,
}

impl From<Row> for BenchRecord {
    fn from(row: Row) -> Self {
        let mut record = Self::new(row.id, row.label, row.amount, row.unit.as_deref().unwrap_or("particle-step"));
        let sample = |factor| Sample { wall_s: 2.0 * factor * row.seconds, cpu_s: factor * row.seconds };
        record.samples = [0.9, 1.0, 1.2].map(sample).to_vec();
        record.memory_bytes = row.memory_bytes.unwrap_or(1_000_000);
        record.parameters.extend(row.parameters);
        if let Some(threads) = row.threads {
            (record.threads, record.clock) = (threads, Clock::Wall);
        }
        record.verify(true, "it holds");
        record.summarise();
        record.error =
            row.error.map(|error| AnswerError::relative("displacement error in L2", error, "exact solution"));
        if let Some(error) = row.energies {
            let of = |quantity: &str, value: f64| AnswerError {
                uncertainty: 0.004,
                ..AnswerError::relative(quantity, value, "curve")
            };
            record.note_errors(Some(vec![of("kinetic energy, rms", error), of("elastic energy, rms", 2.0 * error)]));
        }
        record
    }
}

fn set() -> BenchSet {
    let peer = |quantity: &str, value| NamedPeer {
        code: "Warp".into(),
        degree: 2,
        quantity: quantity.into(),
        value,
        remark: "a | script".into(),
        conditions: "2026; a machine".into(),
    };
    let mut rows: BTreeMap<String, Vec<Row>> = toml::from_str(include_str!("fixture/bench.toml")).unwrap();
    BenchSet {
        schema: SCHEMA.into(),
        environment: Environment { cpu: "a <processor>".into(), threads: 2, ..Environment::default() },
        quick: true,
        records: rows.remove("record").unwrap().into_iter().map(BenchRecord::from).collect(),
        peers: vec![peer("over-tuned-kernel", 3.2), peer("over-naive-kernel", 1.03)],
        fem_unbuilt: None,
    }
}

/// A folder with a set and its report, and the files of that.
fn rendered(set: &BenchSet) -> (TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let out = OutputFolder::open(folder.path(), "bench").unwrap();
    store(&out, set).unwrap();
    let files = render(folder.path(), &out).unwrap();
    (folder, files)
}

fn read_file(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn everything_is_written_and_says_what_the_numbers_say() {
    let (folder, files) = rendered(&set());
    assert!(is_bench(folder.path()));
    assert_eq!(read(folder.path()).unwrap(), set());
    for figure in
        ["work-precision-lumped-mass-time", "plate-error-against-time", "stages", "steps", "solves-l2", "threads"]
    {
        let name = format!("figures/timing/{figure}.svg");
        assert!(files.iter().any(|f| f == Path::new(&name)), "{name} is missing from {files:?}");
    }
    insta::assert_snapshot!("bench-summary", read_file(folder.path(), "summary.md"));
    let page = read_file(folder.path(), "bench.html");
    assert!(
        page.contains("a &lt;processor&gt;") && page.matches("<svg ").count() == 12,
        "{}",
        page.matches("<svg ").count()
    );
    assert_eq!(read_file(folder.path(), "samples.csv").lines().count(), 1 + 3 * set().records.len());
    let (again, names) = rendered(&set());
    assert_eq!(names, files);
    for file in files {
        let [a, b] = [&folder, &again].map(|folder| fs::read(folder.path().join(&file)).unwrap());
        assert!(a == b, "{} differs", file.display());
    }
}

#[test]
fn what_does_not_hold_is_neither_drawn_nor_passed_over() {
    let mut set = set();
    for record in set.records.iter_mut().filter(|r| r.label == "p = 3, gauss" || r.id == "stages/p2/minimal-step") {
        record.verify(false, "the ledger is open");
    }
    set.records.retain(|record| record.id != "plate/elements/h0.5");
    set.fem_unbuilt = Some("no cargo".into());
    let (folder, _) = rendered(&set);
    let summary = read_file(folder.path(), "summary.md");
    for part in [
        "4 of 51 records are NOT verified",
        "NOT verified: the ledger is open",
        "updated frame, p = 2 | 1.2 | 1.2 to 1.2 | ≤ 1.4 | not verified |",
        "Only fisura reached: kinetic energy to 2 %, kinetic energy to 1 %",
        "could not be built here: no cargo.",
    ] {
        assert!(summary.contains(part), "{part} is missing in {summary}");
    }
    let figure = read_file(folder.path(), "figures/timing/work-precision-lumped-mass-time.svg");
    assert!(!figure.contains("p = 3"));
    let (nothing, _) = rendered(&BenchSet { records: Vec::new(), ..set });
    assert_eq!(read_file(nothing.path(), "summary.md").matches("\n## ").count(), 2, "other codes, and no records");
}

#[test]
fn a_foreign_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let other = tempfile::tempdir().unwrap();
    let out = OutputFolder::open(other.path(), "bench").unwrap();
    fs::write(folder.path().join("bench.json"), "{\"schema\": \"other/1\"}").unwrap();
    let refused = || render(folder.path(), &out).unwrap_err().to_string();
    assert!(refused().contains("schema \"other/1\" is not \"fisura.bench/1\""), "{}", refused());
    fs::write(folder.path().join("bench.json"), "{").unwrap();
    assert!(refused().contains("line 1 column 1"), "{}", refused());
}
