//! `compare`: two results folders side by side.

use super::support::Place;
use super::verify::{case, workspace_with};

fn workspace() -> Place {
    let of = |name: &str, claim: &str| (format!("energy/{name}"), case(claim, "quick", 1e-12));
    let place = workspace_with(&[of("block", "The ledger closes"), of("twin", "Its ledger closes, too")]);
    place.succeeds("verify --out base");
    place
}

#[test]
fn two_runs_of_one_state_show_no_change() {
    let place = workspace();
    place.succeeds("verify --out again");
    place.succeeds("compare base again --out compared").says(&["No change: 2 records unchanged"]);
    assert_eq!(place.files("compared"), ["comparison.json", "comparison.md"]);
    let json = place.succeeds("compare base again --format json").json();
    assert_eq!((json["counts"]["unchanged"].as_u64(), json["major_losses"].as_u64()), (Some(2), Some(0)));
}

#[test]
fn a_lost_claim_ends_with_1_and_is_annotated_on_github() {
    let mut place = workspace();
    place.write("verification/cases/energy/twin.toml", &case("Its ledger closes, too", "quick", 1e-30));
    place.variables = vec![("GITHUB_ACTIONS", "true")];
    let outcome = place.xtask("verify --quiet --out new").with_status(1);
    outcome.complains_of(&["::error file=verification/cases/energy/twin.toml,title=energy/twin/"]);
    place.xtask("compare base new").with_status(1).says(&["✗ major    energy/twin/", "pass → fail"]);
    place.succeeds("compare new base");
    assert!(place.read("target/fisura/compare/comparison.md").contains("bounds changed"), "looser bounds are no gain");
}

#[test]
fn a_check_that_is_gone_ends_with_1_and_nothing_in_common_with_4() {
    let place = workspace();
    place.succeeds("verify --out one --case energy/block");
    place.succeeds("verify --out other --case energy/twin");
    place.xtask("compare base one").with_status(1).says(&["✗ missing  energy/twin/", "the check is missing"]);
    place.succeeds("compare one base");
    place.xtask("compare one other").with_status(4).complains_of(&["no record in common"]);
    place.refuses("compare one absent", &["absent/results.json"]);
}
