//! What can be said on the command line is part of the contract.

use super::support::Place;

#[test]
fn help_says_what_there_is() {
    let place = Place::new();
    insta::assert_snapshot!("help", place.xtask(&["--help"]).with_status(0).out);
    for command in
        ["verify", "merge", "compare", "list", "demo", "run", "check", "figures", "report", "bench", "faults", "judge"]
    {
        insta::assert_snapshot!(format!("help-{command}"), place.xtask(&[command, "--help"]).with_status(0).out);
    }
}

#[test]
fn misuse_ends_with_2_and_says_why() {
    let place = Place::new();
    place.xtask(&[]).with_status(2).complains_of(&["Usage"]);
    place.xtask(&["runn", "scene.toml"]).with_status(2).complains_of(&["runn", "run"]);
    place.xtask(&["run"]).with_status(2).complains_of(&["SCENE.toml"]);
    place.xtask(&["list", "--threads", "0"]).with_status(2).complains_of(&["--threads"]);
    place.xtask(&["list", "--format", "xml"]).with_status(2).complains_of(&["text", "json"]);
    place.xtask(&["verify", "--tier", "huge"]).with_status(2).complains_of(&["huge", "quick, full"]);
}

#[test]
fn outside_the_workspace_the_cases_are_missed() {
    Place::new().xtask(&["list"]).with_status(2).complains_of(&["verification/cases", "help:"]);
    Place::new().xtask(&["demo"]).with_status(2).complains_of(&["verification/scenes/plate.toml", "help:"]);
}
