//! `verify --partition` and `merge`: slices joined are the run of the whole plan.

use std::fs;
use std::path::Path;

use fisura_verification::output::fingerprint::fingerprint;
use fisura_verification::suite::part::Part;
use serde_json::Value;

use super::support::{NOTCHED, Place};
use super::verify::{case, case_of, workspace_with};

/// Five cases in two suites; those of the plate have pictures and curves that several runs share.
pub fn workspace() -> Place {
    let mut cases = vec![("energy/block".to_string(), case("The ledger closes", "quick", 1e-12))];
    for (name, seconds) in [("a", 5), ("b", 3), ("c", 2), ("d", 1)] {
        let largest = if name == "c" { -1.0 } else { 1e-2 };
        let text = case_of(NOTCHED, "The ledger closes", "quick", largest);
        let text = text.replace("seconds = 1\n", &format!("seconds = {seconds}\nlabel = \"block {name}\"\n"));
        cases.push((format!("plate/{name}"), text));
    }
    workspace_with(&cases)
}

/// Runs all three slices into `part-1` to `part-3`.
fn slices(place: &Place) {
    for slice in 1..=3 {
        place.xtask(&format!("verify --partition slice:{slice}/3 --out part-{slice}"));
    }
}

/// Files below a folder with their bytes, what is exempt of `results.json` left out.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let paths = glob::glob(&format!("{}/**/*", folder.display())).unwrap().map(Result::unwrap);
    let name = |path: &Path| path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
    paths.filter(|path| path.is_file()).map(|path| (name(&path), fs::read(&path).unwrap())).collect()
}

/// `results.json` as text, without environment and timing.
fn without_times(text: &str) -> String {
    let mut results: Value = serde_json::from_str(text).unwrap();
    results["environment"] = Value::Null;
    results["records"].as_array_mut().unwrap().iter_mut().for_each(|record| record["timing"] = Value::Null);
    serde_json::to_string_pretty(&results).unwrap()
}

#[test]
fn three_slices_are_balanced_and_joined_they_are_the_whole_run() {
    let place = workspace();
    place.xtask("verify --out whole").with_status(1);
    slices(&place);
    let cases = |slice: usize| -> Vec<String> {
        let part = place.json(&format!("part-{slice}/part.json"));
        part["outcomes"].as_array().unwrap().iter().map(|o| o[0].as_str().unwrap().to_string()).collect()
    };
    assert_eq!(cases(1), ["plate/a"], "5 s");
    assert_eq!(cases(2), ["plate/b", "plate/d"], "3 + 1 s");
    assert_eq!(cases(3), ["energy/block", "plate/c"], "1 + 2 s");
    place.xtask("merge part-3 part-1 part-2 --out merged").with_status(1).says(&["FAIL", "plate/c"]);
    let (whole, merged) = (contents(&place.path("whole")), contents(&place.path("merged")));
    let names = |all: &[(String, Vec<u8>)]| all.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&merged), names(&whole));
    let exempt = ["metrics.json", "junit.xml", "report.html", "summary.md", "fisura.sha256", ".fisura.lock"];
    // times of a run, or when it was
    let dated = |name: &str| name.starts_with("metrics/timing/");
    let compared = |name: &str| !exempt.contains(&name) && !dated(name);
    for ((name, merged), (_, whole)) in merged.iter().zip(&whole).filter(|((name, _), _)| compared(name)) {
        if name == "results.json" {
            let text = |bytes: &[u8]| without_times(std::str::from_utf8(bytes).unwrap());
            assert_eq!(text(merged), text(whole));
        } else {
            assert_eq!(merged, whole, "{name}");
        }
    }
    assert!(whole.iter().any(|(name, _)| name == "series/plate-a.csv"), "{:?}", names(&whole));
}

#[test]
fn an_empty_slice_is_a_part_as_well() {
    let place = workspace();
    for slice in [1, 2] {
        place.succeeds(&format!("verify --suite energy --partition slice:{slice}/2 --out part-{slice}"));
    }
    place.succeeds("merge part-1 part-2");
    assert!(place.path("target/fisura/merge/report.html").is_file());
}

#[test]
fn parts_that_do_not_belong_together_end_with_2() {
    let place = workspace();
    slices(&place);
    let refused = |folders: &str, words: &[&str]| {
        place.refuses(&format!("merge --out merged {folders}"), words);
        assert!(!place.path("merged/results.json").exists());
    };
    refused("part-1 part-3", &["of 3 slices", "missing: 2", "help:"]);
    refused("part-1 part-2 part-2 part-3", &["slice 2 is a duplicate", "part-2"]);
    refused("part-1 absent", &["absent/part.json"]);
    place.xtask("merge part-1 part-2 part-3 --out joined").with_status(1);
    place.xtask("merge part-1 part-2 --out joined").with_status(2);
    assert_eq!(place.files("joined"), [""; 0], "the verdict of before is not that of these parts");
    assert!(place.read("joined/fisura.sha256").contains("# unfinished"));
    let itself = "joined/../joined cannot be merged into itself";
    place.refuses("merge part-1 joined/../joined --out joined", &[itself, "--out"]);
    place.refuses("merge part-1 part-2 part-3 --out part-2", &["part-2 contains the output of `verify`", "--out"]);

    let other = |arguments: &str, words: &[&str]| {
        place.xtask(&format!("verify --out other --partition {arguments}"));
        refused("part-1 other part-3", &[&["part-1 and other differ"][..], words].concat());
    };
    other("slice:2/4", &["number of slices", "3 and 4"]);
    other("slice:2/3 --tier full", &["tier", "quick and full"]);
    other("slice:2/3 --suite plate", &["suites", "none and plate"]);
    other("slice:2/3 --case */*", &["pattern"]);
    other("slice:2/3 --set mesh.degree=1", &["--set", "mesh.degree=1"]);

    place.write("verification/cases/plate/d.toml", &case("Another claim", "quick", 1e-12));
    other("slice:2/3", &["cases", "plate/d"]);
    place.write("part-2/part.json", "{\"schema\": \"fisura.part/9\"}");
    refused("part-1 part-2 part-3", &["fisura.part/9"]);
}

/// A part with changes, sealed anew.
fn change(place: &Place, name: &str, edit: impl FnOnce(&mut Part)) {
    let mut part: Part = serde_json::from_str(&place.read(name)).unwrap();
    edit(&mut part);
    place.write(name, &serde_json::to_string(&part.sealed()).unwrap());
}

#[test]
fn parts_of_another_commit_or_program_or_other_references_end_with_2() {
    let place = workspace();
    slices(&place);
    let text = place.read("part-2/part.json");
    let joined = |place: &Place| place.xtask("merge part-1 part-2 part-3").with_status(2);
    change(&place, "part-2/part.json", |part| part.plan.commit = "0123abcd".into());
    joined(&place).complains_of(&["commit", "and 0123abcd"]);
    place.write("part-2/part.json", &text);
    change(&place, "part-2/part.json", |part| part.plan.sources = "feed".into());
    joined(&place).complains_of(&["sources of the program", "feed", "help:"]);
    let all: Vec<String> = (1..=3).map(|slice| format!("part-{slice}/part.json")).collect();
    let originals: Vec<String> = all.iter().map(|name| place.read(name)).collect();
    all.iter().for_each(|name| change(&place, name, |part| part.plan.sources = "feed".into()));
    joined(&place).complains_of(&["this program was built from the sources", "feed", "build it again"]);
    all.iter().zip(&originals).for_each(|(name, text)| place.write(name, text));
    place.write("part-2/part.json", &text);
    place.write("reference-data/nobody-1900/more.csv", "x\n1\n");
    joined(&place).complains_of(&["reference data"]);
}

#[test]
fn emptied_and_edited_parts_end_with_2() {
    let place = workspace();
    slices(&place);
    let refused = |words: &[&str]| {
        place.refuses("merge part-1 part-2 part-3 --out merged", words);
        assert!(!place.path("merged/results.json").exists());
    };
    let text = place.read("part-3/part.json");
    let status = text.replace("\"status\": \"fail\"", "\"status\": \"pass\"");
    assert_ne!(status, text, "a check fails there");
    place.write("part-3/part.json", &status);
    refused(&["part-3/part.json was changed after it was written", "run the slice again"]);
    place.write("part-3/part.json", &text);
    change(&place, "part-3/part.json", |part| part.outcomes.clear());
    refused(&["no part contains the result of energy/block"]);
    place.write("part-3/part.json", &text);
    change(&place, "part-3/part.json", |part| part.outcomes[0].1.records.clear());
    refused(&["no part contains the result of energy/block"]);
    place.write("part-3/part.json", &text);
    change(&place, "part-2/part.json", |part| part.outcomes.push(("plate/a".into(), part.outcomes[0].1.clone())));
    refused(&["a result of plate/a, which is not in the plan"]);
    slices(&place);

    let series = place.read("part-2/series/plate-b.csv");
    place.write("part-2/series/plate-b.csv", &series.replacen('1', "2", 1));
    refused(&["part-2/series/plate-b.csv was changed", "fingerprint"]);
    std::fs::remove_file(place.path("part-2/series/plate-b.csv")).unwrap();
    refused(&["part-2/series/plate-b.csv was changed"]);
    place.write("part-2/series/plate-b.csv", &series);
    let (other, name) = ("time_s,elastic_j\n0,1\n", "series/plate-a.csv");
    place.write(&format!("part-2/{name}"), other);
    change(&place, "part-2/part.json", |part| drop(part.files.insert(name.into(), fingerprint([other]))));
    refused(&["series/plate-a.csv differs in part-1 and part-2"]);
    change(&place, "part-2/part.json", |part| drop(part.files.insert("../plate-b.csv".into(), "feed".into())));
    refused(&["only CSV files below series/"]);
}
