//! Cells, what they say of each fault, and the matrix.

use std::collections::BTreeMap;

use fisura_verification::output::OutputFolder;
use fisura_verification::record::Status;
use tempfile::TempDir;

use super::cells::Store;
use super::matrix::Matrix;
use super::results::Results;
use super::runner::{Ending, Report};
use super::table::{Fault, faults as all};

/// A folder for cells, which is gone with its guard.
fn folder() -> (OutputFolder, TempDir) {
    let guard = tempfile::tempdir().unwrap();
    (OutputFolder::open(&guard.path().join("out"), "faults").unwrap(), guard)
}

/// The same key for all cases.
fn keys(cases: &[&str], key: &str) -> BTreeMap<String, String> {
    cases.iter().map(|case| (case.to_string(), key.to_string())).collect()
}

/// What a process says of a case with these records, which passes the sites of these faults.
fn report(case: &str, records: &[(&str, Status)], passed: &[&str]) -> Ending {
    let records = records.iter().map(|(name, status)| (format!("{case}/{name}"), *status)).collect();
    Ok(Report { case: case.into(), seconds: 1.0, records, passed: passed.iter().map(|id| id.to_string()).collect() })
}

#[test]
fn cells_are_taken_up_until_program_case_or_data_change() {
    let (folder, _guard) = folder();
    let open = |key: &str| Store::open(&folder, &keys(&["a/b"], key)).unwrap();
    let report = |status| report("a/b", &[("x", Status::Pass), ("y", status)], &["sign"]);
    let store = open("one");
    store.put(None, "a/b", report(Status::Info)).unwrap();
    store.put(Some("sign"), "a/b", report(Status::Error)).unwrap();
    let again = open("one");
    let sound = again.get(None, "a/b").unwrap();
    assert!(sound.holds() && sound.green == ["a/b/x"] && sound.passed == ["sign"]);
    let planted = again.get(Some("sign"), "a/b").unwrap();
    assert!(planted.red == ["a/b/y"] && planted.green.is_empty());
    for fault in [None, Some("sign")] {
        again.put(fault, "a/b", Err("it was not done after 30 s".into())).unwrap();
        assert!(again.get(fault, "a/b").unwrap().ended.is_some());
        assert_eq!(open("one").get(fault, "a/b"), None, "it is tried again");
    }
    again.put(None, "a/b", report(Status::Info)).unwrap();
    assert_eq!(open("two").get(None, "a/b"), None);
}

#[test]
fn a_fault_is_caught_by_what_turns_red_and_survives_what_ends_without_records() {
    let (folder, _guard) = folder();
    let store = Store::open(&folder, &keys(&["a/b"], "key")).unwrap();
    let cases = ["a/b".to_string()];
    let fault = |id: &str| -> &'static Fault {
        Box::leak(Box::new(Fault { id: id.into(), what: format!("a {id}"), cases: vec!["a/b".into()] }))
    };
    let [sign, root] = ["sign", "root"].map(fault);
    let report = |last| report("a/b", &[("0", Status::Pass), ("1", Status::Info), ("2", last)], &["sign", "root"]);
    store.put(None, "a/b", report(Status::Pass)).unwrap();
    store.put(Some("sign"), "a/b", report(Status::Error)).unwrap();
    store.put(Some("root"), "a/b", Err("exit status: 101".into())).unwrap();
    let results = Results::new(&[sign, root], &cases, &store, false);
    let expected = "sign  caught      1 of   2 checks: a/b/2\nroot  SURVIVES    0 of   2 checks: a/b\n      ended without \
                    records: a/b: exit status: 101\n1 of 2 faults are caught\n";
    assert!(results.lacking() && results.text() == expected, "{}", results.text());
    results.write(&folder, None).unwrap();
    let table = String::from_utf8(folder.read("faults.md").unwrap()).unwrap();
    assert!(
        table.contains("| 1 | sign | a sign | a/b | 1 of 2: `a/b/2` |\n| 2 | root | a root | a/b | **none** of 2 |\n")
    );
    assert!(!Results::new(&[sign], &cases, &store, true).lacking());
    store.put(None, "a/b", report(Status::Fail)).unwrap();
    let unsound = Results::new(&[sign], &cases, &store, true);
    assert!(unsound.lacking() && unsound.text().contains("a/b does not hold without a fault"));
}

#[test]
fn every_cell_says_whether_it_was_run_and_idle_checks_are_found() {
    let (folder, _guard) = folder();
    let ids = ["a/b", "a/c", "a/d"];
    let store = Store::open(&folder, &keys(&ids, "key")).unwrap();
    let (faults, cases) = (all().iter().collect::<Vec<_>>(), ids.map(String::from));
    let [first, second] = [0, 1].map(|fault| all()[fault].id.as_str());
    let report = |case, status| report(case, &[("h=1/2/error", status), ("drift", Status::Pass)], &[first, second]);
    for case in ["a/b", "a/c"] {
        store.put(None, case, report(case, Status::Pass)).unwrap();
        store.put(Some(first), case, report(case, Status::Fail)).unwrap();
    }
    store.put(Some(second), "a/b", report("a/b", Status::Pass)).unwrap();
    let matrix = Matrix::new(&faults, &cases, &store);
    for row in ["\n| a/b | 1 | · | |", "\n| a/c | 1 | ? | |", "\n| a/d | ? | ? | ? |", "\n| a | 3 | 1 |\n"] {
        assert!(matrix.markdown().contains(row), "{row} is missing in {}", matrix.markdown());
    }
    let idle = "passes with every fault, and no reason is given: ";
    assert!(matrix.lacking() && matrix.text().contains(&format!("{idle}a/b/drift\n")), "{}", matrix.text());
    assert_eq!(matrix.text().matches(idle).count(), 1, "a/c is not finished");
    for (faults, cases, expected) in [
        (&faults[..], &cases[1..], (true, true)),
        (&faults, &cases[..1], (false, true)),
        (&faults[..2], &cases, (false, false)), // of some faults nothing more is known
    ] {
        let matrix = Matrix::new(faults, cases, &store);
        assert_eq!((matrix.text().contains("not complete"), matrix.lacking()), expected, "{}", matrix.text());
    }
}
