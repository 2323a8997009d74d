//! A small set of benchmarks is rendered as a whole: files, readings computed from the numbers, the same
//! bytes twice.

use std::fs;
use std::path::Path;

use fisura_reports::bench::{is_bench, read, render, store};
use fisura_verification::bench::record::{AnswerError, BenchRecord, BenchSet, Clock, NamedPeer, SCHEMA, Sample};
use fisura_verification::output::OutputFolder;
use fisura_verification::record::Environment;

/// A verified record whose samples are 0.9, 1 and 1.2 times `seconds`.
fn record(id: &str, label: &str, seconds: f64, amount: f64, unit: &str) -> BenchRecord {
    let mut record = BenchRecord::new(id, label, amount, unit);
    record.samples =
        [0.9, 1.0, 1.2].map(|factor| Sample { wall_s: 2.0 * factor * seconds, cpu_s: factor * seconds }).to_vec();
    record.memory_bytes = 1_000_000;
    record.verify(true, "it holds");
    record.summarise();
    record
}

fn with_error(record: BenchRecord, value: f64, uncertainty: f64) -> BenchRecord {
    let error = AnswerError::relative("displacement error in L2", value, "exact solution");
    BenchRecord { error: Some(AnswerError { uncertainty, ..error }), ..record }
}

/// Linear, quadratic and cubic convergence, the higher the degree the dearer a step.
fn work_precision() -> Vec<BenchRecord> {
    let point = |degree: i32, level: i32| {
        let (seconds, error) = (0.01 * f64::from(degree) * 8f64.powi(level), 0.1 * 0.5f64.powi(level * (degree + 1)));
        let id = format!("work-precision/lumped-mass/p{degree}/h{level}");
        let steps = 1e4 * f64::from(degree) * 8f64.powi(level);
        let record = record(&id, &format!("p = {degree}, gauss"), seconds, steps, "particle-step");
        with_error(record.with("group", "lumped mass"), error, 0.0)
    };
    (1..=3).flat_map(|degree| (0..3).map(move |level| point(degree, level))).collect()
}

fn plate() -> Vec<BenchRecord> {
    let run = |way: &str, h: f64, seconds: f64, error: f64| {
        let mut record = record(&format!("plate/{way}/h{h}"), way, seconds, 1e8, "particle-step").with("h_over_l0", h);
        let of = |quantity: &str, value: f64| AnswerError {
            uncertainty: 0.004,
            ..AnswerError::relative(quantity, value, "curve")
        };
        record.note_errors(Some(vec![of("kinetic energy, rms", error), of("elastic energy, rms", 2.0 * error)]));
        record
    };
    let share = |name: &str, seconds| record(&format!("plate/share/{name}"), name, seconds, 1e6, "particle-step");
    vec![
        run("equal/p2", 2.0, 4.0, 0.08),
        run("graded/p2", 1.0, 5.0, 0.02),
        run("graded/p2", 0.7, 10.0, 0.01),
        run("elements", 1.0, 10.0, 0.04),
        run("elements", 0.5, 40.0, 0.01),
        share("step", 0.1),
        share("phase-field", 0.04),
    ]
}

fn stages() -> Vec<BenchRecord> {
    let phases = [
        ("elastic-sweep", 20.0),
        ("history-sweep", 15.0),
        ("stress-sweep", 30.0),
        ("history-sweep-no-split", 12.0),
        ("stress-sweep-no-split", 26.0),
        ("assembly", 45.0),
        ("elastic-step", 30.0),
        ("elastic-step-updated", 60.0),
        ("minimal-step", 50.0),
    ];
    let of = |p: usize| {
        phases.map(|(phase, ns)| {
            let seconds = ns * 1e-3 * if p == 3 { 1.25 } else { 1.0 };
            record(&format!("stages/p{p}/{phase}"), phase, seconds, 1e6, "particle-step").with("cells", 128)
        })
    };
    [of(2), of(3)].concat()
}

fn conditions() -> Vec<BenchRecord> {
    let mut records = Vec::new();
    for (name, seconds, iterations) in [("incomplete-cholesky", 0.1, 16), ("jacobi", 0.4, 155), ("cholesky", 0.5, 1)] {
        let record = record(&format!("solves/p2/l2/{name}"), name, seconds, 1.0, "solve");
        records.push(record.with("iterations", iterations).with("unknowns", 16900));
    }
    for threads in [1, 2] {
        let mut of = record(&format!("threads/plate/{threads}"), "plate", 0.2 / threads as f64, 1e6, "particle-step");
        (of.threads, of.clock) = (threads, Clock::Wall);
        of.summarise();
        records.push(of);
    }
    records.push(record("ceilings/triad", "memory bandwidth", 0.01, 1e8, "byte"));
    records.push(record("ceilings/multiply-add", "arithmetic", 0.01, 4e8, "flop"));
    let sweep = record("ceilings/elastic-sweep/p2", "elastic sweep, p = 2", 0.02, 1e6, "particle-step");
    records.push(sweep.with("degree", 2).with("flops_per_point", 100.0).with("bytes_per_point", 16.0));
    for (name, seconds, bytes) in [("elastic", 0.02, 0), ("fracture", 0.1, 600_000)] {
        let scene = record(&format!("scenes/total/{name}"), name, seconds, 1e5, "particle-step");
        records.push(scene.with("frame", "total").with("particles", 10_000).with("phase_field_bytes", bytes));
    }
    records
}

fn set() -> BenchSet {
    let conditions_of = "2026; a machine";
    let peer = |quantity: &str, value| NamedPeer {
        code: "Warp".into(),
        degree: 2,
        quantity: quantity.into(),
        value,
        remark: "a | script".into(),
        conditions: conditions_of.into(),
    };
    BenchSet {
        schema: SCHEMA.into(),
        environment: Environment { cpu: "a <processor>".into(), threads: 2, ..Environment::default() },
        quick: true,
        records: [work_precision(), plate(), stages(), conditions()].concat(),
        peers: vec![peer("over-tuned-kernel", 3.2), peer("over-naive-kernel", 1.03)],
        fem_unbuilt: None,
    }
}

fn out_in(folder: &tempfile::TempDir) -> OutputFolder {
    OutputFolder::open(folder.path(), "bench").unwrap()
}

fn read_file(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn everything_is_written_and_says_what_the_numbers_say() {
    let folder = tempfile::tempdir().unwrap();
    let out = out_in(&folder);
    store(&out, &set()).unwrap();
    assert!(is_bench(folder.path()));
    assert_eq!(read(folder.path()).unwrap(), set());
    let files = render(folder.path(), &out).unwrap();
    for figure in
        ["work-precision-lumped-mass-time", "plate-error-against-time", "stages", "steps", "solves-l2", "threads"]
    {
        let name = format!("figures/timing/{figure}.svg");
        assert!(files.iter().any(|f| f == Path::new(&name)), "{name} is missing from {files:?}");
    }
    insta::assert_snapshot!("bench-summary", read_file(folder.path(), "summary.md"));
    let page = read_file(folder.path(), "bench.html");
    assert!(
        page.contains("a &lt;processor&gt;") && page.matches("<svg ").count() == 9,
        "{}",
        page.matches("<svg ").count()
    );
    assert_eq!(read_file(folder.path(), "samples.csv").lines().count(), 1 + 3 * set().records.len());
}

#[test]
fn two_renderings_are_the_same_bytes() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let files = folders.each_ref().map(|folder| {
        let out = out_in(folder);
        store(&out, &set()).unwrap();
        render(folder.path(), &out).unwrap()
    });
    assert_eq!(files[0], files[1]);
    for file in &files[0] {
        let [a, b] = folders.each_ref().map(|folder| fs::read(folder.path().join(file)).unwrap());
        assert!(a == b, "{} differs", file.display());
    }
}

#[test]
fn what_does_not_hold_is_neither_drawn_nor_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let mut set = set();
    for record in set.records.iter_mut().filter(|r| r.label == "p = 3, gauss") {
        record.verify(false, "the ledger is open");
    }
    let out = out_in(&folder);
    store(&out, &set).unwrap();
    render(folder.path(), &out).unwrap();
    let summary = read_file(folder.path(), "summary.md");
    assert!(summary.contains("3 of 44 records are NOT verified"), "{summary}");
    assert!(summary.contains("NOT verified: the ledger is open"));
    let figure = read_file(folder.path(), "figures/timing/work-precision-lumped-mass-time.svg");
    assert!(!figure.contains("p = 3"));
}

#[test]
fn a_foreign_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let other = tempfile::tempdir().unwrap();
    let out = out_in(&other);
    fs::write(folder.path().join("bench.json"), "{\"schema\": \"other/1\"}").unwrap();
    let refused = || render(folder.path(), &out).unwrap_err().to_string();
    assert!(refused().contains("schema \"other/1\" is not \"fisura.bench/1\""), "{}", refused());
    fs::write(folder.path().join("bench.json"), "{").unwrap();
    assert!(refused().contains("line 1 column 1"), "{}", refused());
}
