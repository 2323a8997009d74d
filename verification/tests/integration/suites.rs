//! Suites end to end on small cases: verdicts, breakdowns, wrong checks, resuming, reference curves in
//! figures.

use std::collections::BTreeSet;
use std::path::Path;

use fisura_verification::record::{Environment, FigureBody, ResultSet, Status, Timing};
use fisura_verification::reference::Library;
use fisura_verification::study::scene::RunInfo;
use fisura_verification::suite::figures;
use fisura_verification::suite::prepare::prepare;
use fisura_verification::suite::{CaseOutcome, Selection, Tier, load_cases, select};

use crate::support::{CLOSURE, Killed, SCENE, repository, run, run_watched, write_case};

#[test]
fn bounds_decide_between_pass_and_fail() {
    let root = tempfile::tempdir().unwrap();
    let hopeless = "[[check]]\nid = \"kinetic-energy\"\nquantity = \"kinetic energy\"\nmeasure = \"initial\"\ncolumn = \"kinetic_j\"\nmax = 0.0\nwhy = \"never\"";
    write_case(root.path(), "a", SCENE, CLOSURE);
    write_case(root.path(), "b", SCENE, hopeless);
    let results = run(root.path(), Environment::default()).unwrap();
    let statuses: Vec<_> = results.records.iter().map(|r| (r.id.as_str(), r.status)).collect();
    assert_eq!(statuses, [("trial/a/closure", Status::Pass), ("trial/b/kinetic-energy", Status::Fail)]);
    let stored: ResultSet =
        serde_json::from_slice(&std::fs::read(root.path().join("out/results.json")).unwrap()).unwrap();
    assert_eq!(stored, results);
    assert!(root.path().join("out/series/trial-a.csv").exists());
}

#[test]
fn a_record_carries_the_ids_it_had_before() {
    let root = tempfile::tempdir().unwrap();
    let renamed = CLOSURE.replace("id = \"closure\"", "id = \"ledger\"\nformerly = [\"closure\", \"balance\"]");
    write_case(root.path(), "a", &SCENE.replace("degree = 2", "degree = [1, 2]"), &renamed);
    let records = run(root.path(), Environment::default()).unwrap().records;
    assert_eq!(records[1].id, "trial/a/degree=2/ledger");
    assert_eq!(records[1].formerly, ["trial/a/degree=2/closure", "trial/a/degree=2/balance"]);
}

#[test]
fn lists_where_a_scene_has_one_value_are_axes() {
    let root = tempfile::tempdir().unwrap();
    let axes =
        SCENE.replace("degree = 2", "degree = [1, 2]").replace("cells = [8, 4]", "cells = [[4, 2], [8, 4], [16, 8]]");
    write_case(root.path(), "axes", &axes, CLOSURE);
    let results = run(root.path(), Environment::default()).unwrap();
    assert_eq!(results.records.len(), 6);
    assert_eq!(results.records[5].parameters["degree"], serde_json::json!([2, 2]));
    assert_eq!(results.records[5].parameters["cells"], serde_json::json!([16, 8]));
}

const ORDER: &str = "[[check]]\nid = \"order-of-the-initial-energy\"\nquantity = \"order of the initial energy\"\nmeasure = \"initial\"\ncolumn = \"kinetic_j\"\nmeshes = \"observed-order\"";

/// The scene on three meshes, and a check that combines them.
fn three_meshes() -> String {
    SCENE.replace("cells = [8, 4]", "cells = [[4, 2], [8, 4], [16, 8]]")
}

#[test]
fn a_check_over_meshes_is_one_record_of_the_finest() {
    let root = tempfile::tempdir().unwrap();
    let constant = ORDER.replace("initial-energy", "elastic-energy").replace("kinetic_j", "elastic_j");
    write_case(root.path(), "meshes", &three_meshes(), &format!("{ORDER}\n{constant}"));
    let results = run(root.path(), Environment::default()).unwrap();
    let [order, none] = results.records.as_slice() else { panic!("two records: {:?}", results.records) };
    assert_eq!(order.id, "trial/meshes/order-of-the-initial-energy");
    assert_eq!(order.parameters["cells"], serde_json::json!([16, 8]));
    // the control points of the roller side do not move: a strip of mass as wide as a span is missing
    assert!((order.value.unwrap() - 1.0).abs() < 1e-9, "{order:?}");
    assert_eq!((none.value, none.status), (None, Status::Info));
    assert!(none.message.as_ref().unwrap().contains("from coarse to fine"), "{none:?}");
}

#[test]
fn meshes_that_cannot_be_combined_are_refused_before_they_are_run() {
    let with = |from: &str, to: &str| (three_meshes(), ORDER.replace(from, to));
    let scene = |from: &str, to: &str| (three_meshes().replace(from, to), ORDER.to_string());
    for ((scene, check), expected, remedy) in [
        (with("observed-order", "richardsons"), "unknown value \"richardsons\"", "did you mean \"richardson\"?"),
        (scene("[4, 2], ", ""), "too few meshes", "three or more values"),
        (scene("[4, 2], [8, 4]", "[16, 4], [8, 4]"), "by one factor in both directions", "cells = [["),
        (scene("degree = 2", "degree = [2, 3]"), "differ in more than the mesh", "one case per degree"),
        (with("\nmeshes", "\nagainst = \"cells=4x2\"\nmeshes"), "combines all variants", "remove variant, against"),
        (with("meshes = \"observed-order\"", "order = 2"), "order of theory without meshes", "add meshes"),
        (with("observed-order\"", "richardson\"\norder = -1"), "not positive", "order = 2"),
    ] {
        let root = tempfile::tempdir().unwrap();
        write_case(root.path(), "wrong", &scene, &check);
        let error = run(root.path(), Environment::default()).unwrap_err().to_string();
        for part in ["wrong.toml:", expected, remedy] {
            assert!(error.contains(part), "{part} is missing in {error}");
        }
        assert!(!root.path().join("out/series/trial-wrong-cells-8x4.csv").exists(), "nothing is run");
    }
}

/// Results without measured time.
fn timeless(mut results: ResultSet) -> ResultSet {
    for record in &mut results.records {
        record.timing = Timing::default();
    }
    results
}

#[test]
fn two_runs_agree_and_a_clean_commit_takes_up_finished_cases() {
    let root = tempfile::tempdir().unwrap();
    write_case(root.path(), "a", SCENE, CLOSURE);
    let clean = || Environment { commit: "c0ffee".into(), ..Environment::default() };
    let first = run(root.path(), clean()).unwrap();
    let second = run(root.path(), clean()).unwrap();
    assert_eq!(timeless(first), timeless(second));
    assert!(!root.path().join("out/partial").exists(), "a complete run leaves nothing to take up");

    write_case(root.path(), "b", SCENE, CLOSURE);
    let killed = || run_watched(root.path(), clean(), None, &Killed("b"));
    std::panic::catch_unwind(killed).unwrap_err();
    let kept = std::fs::read_dir(root.path().join("out/partial")).unwrap().count();
    assert_eq!(kept, 1, "case a was finished before case b started");
    let unfinished = std::fs::read_to_string(root.path().join("out/results.json")).unwrap();
    assert!(unfinished.contains("0 of 2 cases are finished"), "nothing of the complete run before is left");
    let stored = root.path().join("out/partial").read_dir().unwrap().next().unwrap().unwrap().path();
    let text = std::fs::read_to_string(&stored).unwrap();
    std::fs::write(&stored, text.replace("a trial", "no trial")).unwrap();
    let error = run(root.path(), clean()).unwrap_err().to_string();
    assert!(error.contains("changed after they were written: partial/trial-a-"), "{error}");
    std::fs::write(&stored, &text).unwrap();
    let resumed = run(root.path(), clean()).unwrap();
    let finished: CaseOutcome = serde_json::from_str(&text).unwrap();
    assert_eq!(resumed.records[0].timing, finished.records[0].timing, "case a is taken up, not run again");
    assert_eq!(resumed.records.len(), 2);
}

#[test]
fn finished_cases_are_not_lost_to_another_selection_and_may_be_removed_by_hand() {
    let root = tempfile::tempdir().unwrap();
    write_case(root.path(), "a", SCENE, CLOSURE);
    write_case(root.path(), "b", SCENE, CLOSURE);
    let environment = Environment::default;
    std::panic::catch_unwind(|| run_watched(root.path(), environment(), None, &Killed("b"))).unwrap_err();
    let kept = || std::fs::read_dir(root.path().join("out/partial")).map_or(0, Iterator::count);
    assert_eq!(kept(), 1);
    let own = std::fs::read_to_string(root.path().join("cases/trial/a.toml")).unwrap();
    write_case(root.path(), "a", SCENE, &format!("{CLOSURE}\n# changed\n"));
    let refused = run(root.path(), environment()).unwrap_err().to_string();
    assert!(refused.contains("1 finished cases of an interrupted run in partial/"), "{refused}");
    assert_eq!(kept(), 1, "what the other selection finished is there");
    std::fs::write(root.path().join("cases/trial/a.toml"), own).unwrap();
    let resumed = run(root.path(), environment()).unwrap();
    assert_eq!((resumed.records.len(), kept()), (2, 0));

    std::panic::catch_unwind(|| run_watched(root.path(), environment(), None, &Killed("b"))).unwrap_err();
    std::fs::remove_dir_all(root.path().join("out/partial")).unwrap();
    write_case(root.path(), "a", SCENE, &format!("{CLOSURE}\n# changed\n"));
    assert_eq!(run(root.path(), environment()).unwrap().records.len(), 2, "the advice helps");
}

#[test]
fn every_committed_case_is_sound_and_ids_are_unique() {
    let cases = load_cases(&repository("verification/cases"), &[]).unwrap();
    assert!(cases.len() >= 20);
    let library = Library::load(&repository("reference-data")).unwrap();
    let mut ids = BTreeSet::new();
    for case in &cases {
        let prepared = prepare(case, &library).unwrap_or_else(|e| panic!("{e}"));
        for planned in &prepared.records {
            let id = planned.id(case);
            assert!(ids.insert(id.clone()), "{id} is there twice");
        }
    }
    assert!(ids.len() >= 1500, "{} records", ids.len());
    let quick = Selection { suites: vec!["plate".into()], case_glob: None, tier: Tier::Quick };
    let full = Selection { tier: Tier::Full, ..quick.clone() };
    assert_eq!(select(cases.clone(), &quick).len(), 2);
    assert_eq!(select(cases, &full).len(), 17);
}

#[test]
fn a_curve_that_a_reader_digitises_appears_in_the_figure_without_a_change_of_code() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("estrada-2024/figure-3a");
    std::fs::create_dir_all(&folder).unwrap();
    let source = repository("reference-data/estrada-2024/figure-3a/source.toml");
    std::fs::copy(source, folder.join("source.toml")).unwrap();
    let runs = [plate_run()];
    let before = curves_of_elastic_energy(&runs, root.path());
    std::fs::write(folder.join("curve.csv"), "time_us,elastic_j_per_m\n0,0\n10,0.11\n20,0.07\n").unwrap();
    let after = curves_of_elastic_energy(&runs, root.path());
    assert_eq!(after.len(), before.len() + 1);
    assert!(after.iter().any(|label| label.contains("Estrada")), "{after:?}");
}

fn curves_of_elastic_energy(runs: &[RunInfo], references: &Path) -> Vec<String> {
    let library = Library::load(references).unwrap();
    let (figures, tables) = figures::of_runs(runs, &library);
    let figure = figures.into_iter().find(|f| f.id == "plate-elastic-energy").unwrap();
    let FigureBody::Chart { curves, .. } = figure.body else { panic!("a chart") };
    for curve in curves.iter().filter(|c| c.series.contains("reference-")) {
        let stem = curve.series.trim_start_matches("series/").trim_end_matches(".csv");
        assert!(tables.iter().any(|(name, _)| name == stem), "{stem} is stored beside the figure");
    }
    curves.into_iter().map(|c| c.label).collect()
}

fn plate_run() -> RunInfo {
    RunInfo {
        suite: "plate".into(),
        case: "trial".into(),
        variant: String::new(),
        label: "trial".into(),
        series: "series/plate-trial.csv".into(),
        columns: vec!["time_s".into(), "elastic_j".into()],
        energy_factor: 1.0,
        resolution: "p = 2".into(),
        deviations: Vec::new(),
        pictures: Vec::new(),
    }
}
