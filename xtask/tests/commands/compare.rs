//! `compare`: two results folders side by side.

use super::support::Place;
use super::verify::{case, workspace_with};

fn workspace() -> Place {
    let of = |name: &str, claim: &str| (format!("energy/{name}"), case(claim, "quick", 1e-12));
    let place = workspace_with(&[of("block", "The ledger closes"), of("twin", "Its ledger closes, too")]);
    place.xtask(&["verify", "--out", "base"]).with_status(0);
    place
}

#[test]
fn two_runs_of_one_state_show_no_change() {
    let place = workspace();
    place.xtask(&["verify", "--out", "again"]).with_status(0);
    let outcome = place.xtask(&["compare", "base", "again", "--out", "compared"]).with_status(0);
    assert!(outcome.out.contains("No change: 2 records unchanged"), "{outcome:?}");
    assert_eq!(place.files("compared"), ["comparison.json", "comparison.md"]);
    let json = place.xtask(&["compare", "base", "again", "--format", "json"]).with_status(0).json();
    assert_eq!((json["counts"]["unchanged"].as_u64(), json["major_losses"].as_u64()), (Some(2), Some(0)));
}

#[test]
fn a_lost_claim_ends_with_1() {
    let place = workspace();
    place.write("verification/cases/energy/twin.toml", &case("Its ledger closes, too", "quick", 1e-30));
    place.xtask(&["verify", "--out", "new"]).with_status(1);
    let outcome = place.xtask(&["compare", "base", "new"]).with_status(1);
    assert!(outcome.out.contains("✗ major    energy/twin/") && outcome.out.contains("pass → fail"), "{outcome:?}");
    place.xtask(&["compare", "new", "base"]).with_status(0);
    assert!(place.read("target/fisura/compare/comparison.md").contains("bounds changed"), "looser bounds are no gain");
}

#[test]
fn a_check_that_is_gone_ends_with_1_and_nothing_in_common_with_4() {
    let place = workspace();
    place.xtask(&["verify", "--out", "one", "--case", "energy/block"]).with_status(0);
    place.xtask(&["verify", "--out", "other", "--case", "energy/twin"]).with_status(0);
    let outcome = place.xtask(&["compare", "base", "one"]).with_status(1);
    assert!(
        outcome.out.contains("✗ missing  energy/twin/") && outcome.out.contains("the check is missing"),
        "{outcome:?}"
    );
    place.xtask(&["compare", "one", "base"]).with_status(0);
    place.xtask(&["compare", "one", "other"]).with_status(4).complains_of(&["no record in common"]);
    place.xtask(&["compare", "one", "absent"]).with_status(2).complains_of(&["absent/results.json"]);
}

#[test]
fn failed_checks_are_annotated_on_github() {
    let mut place = workspace();
    place.write("verification/cases/energy/twin.toml", &case("Its ledger closes, too", "quick", 1e-30));
    place.variables = vec![("GITHUB_ACTIONS", "true")];
    let outcome = place.xtask(&["verify", "--quiet", "--out", "new"]).with_status(1);
    outcome.complains_of(&["::error file=verification/cases/energy/twin.toml,title=energy/twin/"]);
}
