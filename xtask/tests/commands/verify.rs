//! `verify` and `list` on a workspace with two small cases.

use super::support::{BLOCK, Place};

/// The least that reference data can be.
const SOURCE: &str = "citation = \"Nobody (1900)\"\nobtained = \"text\"\nkind = \"literature\"\nmodel = \"none\"\n\
                      resolution = \"none\"\n";

/// The block as the scene of a case.
pub fn case(claim: &str, tier: &str, largest_closure: f64) -> String {
    case_of(BLOCK, claim, tier, largest_closure)
}

/// A scene as that of a case that bounds the closure of its ledger.
pub fn case_of(scene: &str, claim: &str, tier: &str, largest_closure: f64) -> String {
    let scene = format!("[scene]\n{scene}").replace("\n[", "\n[scene.").replace("[scene.[", "[[scene.");
    format!(
        "claim = \"{claim}\"\ntier = \"{tier}\"\nseconds = 1\n\n{scene}\n[[check]]\n\
         id = \"closure-of-the-energy-ledger-over-the-largest-energy\"\n\
         quantity = \"closure of the energy ledger over the largest energy\"\nmeasure = \"closure\"\n\
         max = {largest_closure:e}\nwhy = \"round-off\"\n"
    )
}

/// A workspace with these cases.
pub fn workspace_with(cases: &[(String, String)]) -> Place {
    let mut place = Place::with("Cargo.toml", "[workspace]\n");
    for (id, text) in cases {
        place.write(&format!("verification/cases/{id}.toml"), text);
    }
    place.write("reference-data/nobody-1900/source.toml", SOURCE);
    place.manifest = Some(place.path("xtask"));
    place
}

fn workspace() -> Place {
    workspace_with(&[
        ("energy/block".to_string(), case("The ledger closes", "quick", 1e-12)),
        ("strict/block".to_string(), case("The ledger closes exactly", "full", -1.0)),
    ])
}

#[test]
fn cases_are_listed() {
    let place = workspace();
    let text = place.succeeds("list").out;
    assert!(text.contains("energy/block") && text.contains("The ledger closes"), "{text}");
    let cases = place.succeeds("list --format json").json();
    insta::assert_json_snapshot!("list", cases);
    let one = place.succeeds("list --case strict/*").out;
    let record = "  strict/block/closure-of-the-energy-ledger-over-the-largest-energy: closure of the energy ledger";
    assert!(one.contains(record) && !one.contains("energy/block:"), "{one}");
    place.xtask("list --case nope/*").with_status(4).complains_of(&["no case matches"]);
    place.refuses("list --case [a", &["--case [a"]);
}

#[test]
fn checks_that_hold_end_with_0_and_leave_a_report() {
    let place = workspace();
    place.succeeds("verify").complains_of(&["[1/1] energy/block pass"]).says(&["PASS"]);
    for name in ["results.json", "report.html", "summary.md", "junit.xml", "metrics.json"] {
        assert!(place.path("target/fisura/verify").join(name).is_file(), "{name} is missing");
    }
    let results = place.succeeds("verify --suite energy --format json --quiet");
    assert_eq!((results.json()["schema"].as_str(), results.err.as_str()), (Some("fisura.results/1"), ""));
}

#[test]
fn a_check_that_fails_ends_with_1() {
    let place = workspace();
    let outcome = place.xtask("verify --tier full --out out").with_status(1);
    outcome.complains_of(&["2 cases, estimated 2 s", "/2] strict/block fail"]).says(&["FAIL"]);
    assert!(place.path("out/report.html").is_file());
}

#[test]
fn a_run_that_breaks_down_ends_with_3() {
    let place = workspace();
    let unstable = "verify --set 'analysis.time_step=1 us' --set 'analysis.end_time=500 us'";
    place.xtask(unstable).with_status(3).says(&["ERROR", "critical step"]);
}

#[test]
fn nothing_selected_ends_with_4_and_a_bad_selection_or_change_with_2_before_anything_runs() {
    let place = workspace();
    place.xtask("verify --case energy/absent*").with_status(4).complains_of(&["no case", "list"]);
    place.xtask("verify --suite strict").with_status(4).complains_of(&["quick tier"]);
    place.refuses("verify --suite energy,nope", &["nope", "energy, strict"]);
    place.refuses("verify --case [a", &["--case [a"]);
    place.refuses("verify --set mesh.degree=9", &["mesh.degree", "between 1 and 4"]);
    assert!(!place.path("target/fisura/verify/results.json").exists());
}

#[test]
fn a_malformed_case_stops_only_what_would_run_it() {
    let place = workspace();
    let misspelt = case("The ledger closes", "quick", 1e-12).replace("measure =", "mesure =");
    place.write("verification/cases/energy/misspelt.toml", &misspelt);
    let ignored = case("The ledger closes", "quick", 1e-12).replace("why =", "against = \"block\"\nwhy =");
    place.write("verification/cases/strict/ignored.toml", &ignored);
    for lock in [".#block.toml", "block.toml~", ".block.toml.swp"] {
        place.write(&format!("verification/cases/energy/{lock}"), "nobody");
    }
    let named = place.succeeds("verify --case energy/block");
    assert_eq!(
        named.complains_of(&["energy/misspelt is not valid and not selected"]).err.matches("not valid").count(),
        1
    );
    place.refuses("verify --out all", &["misspelt.toml:", "mesure", "did you mean \"measure\""]);
    place.refuses("verify --suite strict --tier full --out all", &["ignored.toml:", "does not read \"against\""]);
    assert!(!place.path("all/results.json").exists(), "nothing has run");
    let list = place.refuses("list", &["misspelt.toml:", "ignored.toml:", "does not read \"against\""]);
    assert!(!list.says(&["energy/block"]).out.contains("strict/ignored"));
}

#[test]
fn a_case_beyond_its_time_ends_with_3_and_the_others_are_there() {
    let place = workspace();
    let endless = case("It ends", "quick", 1.0).replace("end_time = \"5 us\"", "end_time = \"100 s\"");
    place.write("verification/cases/energy/aeon.toml", &endless);
    let outcome = place.xtask("verify --case-timeout 1 --out out").with_status(3);
    let outcome = outcome.complains_of(&["energy/aeon exceeded its timeout of 1 s", "/2] energy/block pass"]);
    outcome.says(&["ERROR", "--case-timeout"]);
    for wrong in ["0", "-1", "nan", "soon"] {
        place.refuses(&format!("verify --case-timeout={wrong}"), &["case-timeout"]);
    }
}
