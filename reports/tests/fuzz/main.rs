//! Reports, comparisons and merges of mutated results and parts: no panic, no hang, no flood of memory,
//! nothing written elsewhere.
//!
//! `FISURA_FUZZ=1000000 cargo test -p fisura-reports --test fuzz` takes a million inputs, new ones every
//! time; otherwise a few hundred, always the same.

#[path = "../integration/fixture/mod.rs"]
mod fixture;
#[path = "../../../verification/tests/fuzz/harness.rs"]
mod harness;
#[path = "../../../verification/tests/fuzz/mutation.rs"]
mod mutation;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use fisura_reports::annotations::render_annotations;
use fisura_reports::compare::{compare, render_markdown, render_text};
use fisura_reports::{ReportError, bundle, read_results};
use fisura_verification::output::OutputFolder;
use fisura_verification::output::fingerprint::{fingerprint, folder_fingerprint};
use fisura_verification::output::foreign::{series_files, steers};
use fisura_verification::record::{Environment, FigureBody, ResultSet};
use fisura_verification::suite::CaseOutcome;
use fisura_verification::suite::merge::merge;
use fisura_verification::suite::part::{PART_SCHEMA, Part, Plan};
use fisura_verification::suite::partition::Slice;
use harness::{LONGEST, files, fuzz, watched};
use tempfile::TempDir;

const SOURCES: &str = "0123456789abcdef";
const SERIES: [&str; 4] = ["plate", "reference", "order", "phase"];

/// A folder with results in `results/`, and with something beside it that nobody may touch.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().expect("a folder"));
        fs::create_dir(place.path("outside")).expect("a folder");
        fs::write(place.path("outside/plate.csv"), "time_s,elastic_j\n0,1\n1,2\n").expect("a file");
        place.fill();
        place
    }

    /// Results as they were written, in place of what became of them.
    fn fill(&self) {
        let _ = fs::remove_dir_all(self.path("results")); // at first there are none
        fixture::write(&self.path("results"));
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Nothing is there but what was, and `more`.
    fn check(&self, more: &[&str]) {
        let names = |folder: &Path| -> Vec<String> {
            let entries = fs::read_dir(folder).expect("a folder");
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
        };
        let mut all = names(self.0.path());
        all.retain(|name| !["outside", "results"].iter().chain(more).any(|known| known == name));
        assert_eq!(all, [""; 0], "beside the results");
        assert_eq!(names(&self.path("outside")), ["plate.csv"]);
    }
}

/// Renders results beside themselves; names the files.
fn render(folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let out = OutputFolder::reopen(folder).expect("a folder of ours");
    fisura_reports::render(folder, &out).map(|rendered| rendered.files)
}

/// A report of `results/` that is made or refused in words, twice the same.
fn report(place: &Place, base: &ResultSet) {
    let folder = place.path("results");
    match render(&folder) {
        Ok(files) => assert!(files.iter().all(|file| folder.join(file).is_file())),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    place.check(&[]);
    let Ok(set) = read_results(&folder) else { return };
    let page = fs::read_to_string(folder.join("report.html")).expect("a page");
    assert!(page.len() < 5_000_000 && !page.contains("javascript:alert(1)\">"), "{} bytes", page.len());
    let compared = [compare(base, &set), compare(&set, base), compare(&set, &set)];
    assert!(compared.iter().all(|c| c.counts.values().sum::<usize>() == c.records.len()));
    assert_eq!(compared[2].records.len(), set.records.len(), "every record has found itself");
    let texts = compared.iter().flat_map(|c| [render_text(c), render_markdown(c)]);
    for text in texts.chain([fisura_reports::text::render_text(&set), render_annotations(&set)]) {
        assert!(!text.chars().any(|c| c != '\n' && steers(c)), "{text:?}");
    }
}

/// The results as text, and the series behind them.
fn corpus() -> Vec<Vec<u8>> {
    let place = Place::new();
    let read = |name: &str| fs::read(place.path("results").join(name)).expect("a file");
    let mut corpus = vec![read("results.json"); SERIES.len()];
    corpus.extend(SERIES.map(|name| read(&format!("series/{name}.csv"))));
    corpus
}

#[test]
fn reports_survive_any_results() {
    let (place, base) = (Place::new(), fixture::results());
    fuzz(0.02, &corpus(), |bytes| {
        place.fill();
        if bytes.starts_with(b"{") {
            fs::write(place.path("results/results.json"), bytes).expect("a file");
        } else {
            for name in SERIES {
                fs::write(place.path(&format!("results/series/{name}.csv")), bytes).expect("a file");
            }
        }
        report(&place, &base);
    });
}

#[test]
fn figures_survive_any_bundle() {
    let gallery = Path::new(env!("CARGO_MANIFEST_DIR")).join("gallery");
    let place = Place::new();
    fuzz(0.01, &files(&["gallery"], "json"), |bytes| {
        fs::write(place.path("results/figure.json"), bytes).expect("a file");
        let Ok(bundle) = bundle::read(&place.path("results"), "figure") else { return };
        if let Ok(svg) = bundle::redraw(&gallery, &bundle) {
            assert!(svg.ends_with("</svg>\n"), "{svg}");
        }
        let again = bundle::write(
            (&place.path("results"), &bundle.figure),
            (&OutputFolder::reopen(&place.path("results")).expect("a folder of ours"), "again"),
            &bundle.environment,
            bundle.inputs,
        );
        assert!(again.is_err() || matches!(bundle.figure.body, FigureBody::Chart { .. }), "no series is there");
        place.check(&[]);
    });
}

/// Reference data; a small part of those there are.
fn references() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../reference-data/plate-events")
}

/// The fixture with the records of a case side by side.
fn by_case() -> ResultSet {
    let mut results = fixture::results();
    results.records.sort_by(|a, b| (&a.suite, &a.case).cmp(&(&b.suite, &b.case)));
    results
}

/// The only slice of a plan, as `verify --partition` leaves it in `results/`.
fn part(place: &Place) -> Part {
    let results = by_case();
    let mut outcomes: Vec<(String, CaseOutcome)> = Vec::new();
    for records in results.records.chunk_by(|a, b| a.case == b.case) {
        let id = format!("{}/{}", records[0].suite, records[0].case);
        outcomes.push((id, CaseOutcome { records: records.to_vec(), figures: Vec::new(), runs: Vec::new() }));
    }
    outcomes[0].1.figures = results.figures;
    outcomes[0].1.runs = serde_json::from_str(include_str!("runs.json")).expect("runs");
    let plan = Plan {
        commit: String::new(),
        sources: SOURCES.into(),
        tier: "quick".into(),
        suites: Vec::new(),
        case_glob: None,
        set: Vec::new(),
        slices: 1,
        reference_data: folder_fingerprint(&references()).expect("a fingerprint"),
        cases: outcomes.iter().map(|(id, _)| (id.clone(), fingerprint([id]))).collect(),
    };
    let print =
        |name: String| (name.clone(), fingerprint([fs::read(place.path("results").join(&name)).expect("a file")]));
    let files = series_files(&place.path("results")).expect("names").into_iter().map(print).collect();
    let inputs: BTreeMap<String, String> = BTreeMap::from([("plate/impact".into(), fingerprint(["impact"]))]);
    let (environment, slice) = (Environment::default(), Slice { index: 1, count: 1 });
    let (schema, digest) = (PART_SCHEMA.to_string(), String::new());
    Part { schema, slice, plan, environment, inputs, outcomes, files, digest }.sealed()
}

/// What is merged of `results/` with this part.
fn merged(place: &Place, part: &[u8]) -> Result<ResultSet, String> {
    fs::write(place.path("results/part.json"), part).expect("a file");
    let out = place.path("merged");
    let _ = fs::remove_dir_all(&out); // of the input before; the first has none
    let out = OutputFolder::open(&out, "merge").expect("a new folder");
    let result = merge(&[place.path("results")], &out, &references(), SOURCES);
    place.check(&["merged"]);
    result.map_err(|error| error.to_string())
}

#[test]
fn merges_survive_any_part() {
    let place = Place::new();
    let whole = part(&place);
    let text = serde_json::to_vec_pretty(&whole).expect("JSON");
    assert!(text.len() < LONGEST, "{} bytes", text.len());
    assert_eq!(merged(&place, &text).map(|set| set.records), Ok(by_case().records));
    fuzz(0.02, &[text], |bytes| {
        let found = merged(&place, bytes);
        let Ok(part) = serde_json::from_slice::<Part>(bytes) else { return assert!(found.is_err()) };
        assert!(found.is_err() || part == whole || part.is_whole(), "an edited part is refused");
        // what a forger can do as well: seal it anew
        let sealed = serde_json::to_vec(&part.sealed()).expect("JSON");
        match merged(&place, &sealed) {
            Ok(set) => {
                assert!(!set.records.is_empty());
                let _ = render(&place.path("merged")); // may name figures that cannot be drawn
                place.check(&["merged"]);
            }
            Err(error) => assert!(!error.is_empty()),
        }
    });
}

/// Results made to be slow or large.
#[test]
fn reports_survive_what_is_made_to_hurt_them() {
    let (place, base) = (Place::new(), fixture::results());
    let many = |edit: &dyn Fn(&mut ResultSet)| {
        let mut set = fixture::results();
        edit(&mut set);
        serde_json::to_vec(&set).expect("JSON")
    };
    let records = |name: fn(usize) -> [String; 2]| {
        move |set: &mut ResultSet| {
            for i in 0..2000 {
                let mut record = set.records[i % 5].clone();
                [record.suite, record.case] = name(i);
                record.id = format!("{}/{}/x", record.suite, record.case);
                set.records.push(record);
            }
        }
    };
    let curves = |set: &mut ResultSet| {
        for _ in 0..8 {
            if let FigureBody::Chart { curves, .. } = &mut set.figures[0].body {
                curves.extend(curves.clone());
            }
        }
    };
    let figures = |set: &mut ResultSet| {
        for i in 0..50 {
            let mut figure = set.figures[0].clone();
            figure.id = format!("more/{i}");
            set.figures.push(figure);
        }
    };
    let times = |set: &mut ResultSet| {
        for record in &mut set.records {
            (record.timing.wall_s, record.timing.particle_steps) = (1e308, u64::MAX);
        }
    };
    let texts = [
        many(&records(|i| [format!("suite-{i}"), "case".into()])),
        many(&records(|i| ["suite".into(), format!("case-{i}")])),
        many(&curves),
        many(&figures),
        many(&times),
        [b"{\"schema\": \"fisura.results/1\", \"records\": ", &b"[".repeat(20_000)[..]].concat(),
    ];
    for (at, text) in texts.iter().enumerate() {
        let outcome = watched(text, &|bytes: &[u8]| {
            place.fill();
            fs::write(place.path("results/results.json"), bytes).expect("a file");
            report(&place, &base);
        });
        outcome.unwrap_or_else(|what| panic!("input {at}: {what}"));
    }
}
