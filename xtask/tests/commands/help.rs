//! What can be said on the command line is part of the contract.

use super::support::Place;

#[test]
fn help_says_what_there_is() {
    let place = Place::new();
    insta::assert_snapshot!("help", place.succeeds("--help").out);
    for command in
        ["verify", "merge", "compare", "list", "demo", "run", "check", "figures", "report", "bench", "faults", "judge"]
    {
        insta::assert_snapshot!(format!("help-{command}"), place.succeeds(&format!("{command} --help")).out);
    }
}

#[test]
fn misuse_ends_with_2_and_says_why() {
    let place = Place::new();
    place.refuses("", &["Usage"]);
    place.refuses("runn scene.toml", &["runn", "run"]);
    place.refuses("run", &["SCENE.toml"]);
    place.refuses("list --threads 0", &["--threads"]);
    place.refuses("list --format xml", &["text", "json"]);
    place.refuses("verify --tier huge", &["huge", "quick, full"]);
    place.refuses("verify --partition slice:4/3", &["slice 4 of 3"]);
    place.refuses("verify --partition 1/3", &["slice:K/N"]);
    place.refuses("merge", &["DIR"]);
}

#[test]
fn outside_the_workspace_the_cases_are_missed() {
    Place::new().refuses("list", &["verification/cases", "help:"]);
    Place::new().refuses("demo", &["verification/scenes/plate.toml", "help:"]);
}
