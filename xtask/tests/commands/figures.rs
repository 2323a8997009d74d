//! `figures`: drawn from stored results, with numbers, caption and provenance.

use super::merge::workspace;
use super::support::Place;

#[test]
fn a_figure_of_the_results_is_written_with_all_it_needs() {
    let place = workspace();
    place.xtask(&["verify", "--out", "results", "--case", "plate/*"]).with_status(1);
    let arguments =
        ["figures", "--from", "results", "--figure", "plate-elastic-energy,plate-phase-a-5us", "--out", "drawn"];
    let outcome = place.xtask(&arguments).with_status(0);
    assert!(outcome.out.contains("drawn/plate-elastic-energy.svg"), "{outcome:?}");
    let files = place.files("drawn");
    let expected = [
        "plate-elastic-energy-plate-a.csv",
        "plate-elastic-energy.caption.txt",
        "plate-elastic-energy.json",
        "plate-phase-a-5us.csv",
        "plate-phase-a-5us.svg",
    ];
    for name in expected {
        assert!(files.contains(&name.to_string()), "{name} is missing in {files:?}");
    }
    assert!(place.read("drawn/plate-elastic-energy-plate-a.csv").starts_with("time_s,elastic_j\n"));
    let provenance: serde_json::Value = serde_json::from_str(&place.read("drawn/plate-elastic-energy.json")).unwrap();
    assert_eq!(provenance["inputs"].as_object().unwrap().len(), 4, "{provenance}");
    let first = place.read("drawn/plate-phase-a-5us.svg");
    place.xtask(&arguments).with_status(0);
    assert_eq!(place.read("drawn/plate-phase-a-5us.svg"), first);
}

#[test]
fn what_cannot_be_drawn_ends_with_2() {
    let place = Place::new();
    place.xtask(&["figures", "--figure", "9z"]).with_status(2).complains_of(&["9z", "3a, 3b, 4, 5b, 6"]);
    place.xtask(&["figures", "--paper", "nobody1900"]).with_status(2).complains_of(&["estrada2024"]);
    place.xtask(&["figures", "--from", "absent"]).with_status(2).complains_of(&["absent/results.json"]);
    let place = workspace();
    place.xtask(&["verify", "--out", "results", "--suite", "energy"]).with_status(0);
    let outcome = place.xtask(&["figures", "--from", "results", "--figure", "3a"]).with_status(2);
    outcome.complains_of(&["contain no figure 3a", "plate/paper-p2-262144"]);
}

#[cfg(unix)]
#[test]
fn results_are_not_written_through_a_link() {
    let place = workspace();
    place.write("mine/f", "mine");
    std::fs::create_dir(place.path("drawn")).unwrap();
    std::os::unix::fs::symlink(place.path("mine"), place.path("drawn/results")).unwrap();
    place.write("drawn/fisura.sha256", "# fisura.manifest/1 figures\n");
    let refused = place.xtask(&["figures", "--figure", "3a", "--out", "drawn"]).with_status(2);
    refused.complains_of(&["drawn/results is a symbolic link", "--out"]);
    assert_eq!(place.files("mine"), ["f"]);
}
