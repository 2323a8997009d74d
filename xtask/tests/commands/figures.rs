//! `figures`: drawn from stored results, with numbers, caption and provenance.

use super::merge::workspace;

#[test]
fn a_figure_of_the_results_is_written_with_all_it_needs() {
    let place = workspace();
    place.xtask("verify --out results --case plate/*").with_status(1);
    let draw = "figures --from results --figure plate-elastic-energy,plate-phase-a-5us --out drawn";
    place.succeeds(draw).says(&["drawn/plate-elastic-energy.svg"]);
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
    let provenance = place.json("drawn/plate-elastic-energy.json");
    assert_eq!(provenance["inputs"].as_object().unwrap().len(), 4, "{provenance}");
    let first = place.read("drawn/plate-phase-a-5us.svg");
    place.succeeds(draw);
    assert_eq!(place.read("drawn/plate-phase-a-5us.svg"), first);
}

#[test]
fn what_cannot_be_drawn_ends_with_2() {
    let place = workspace();
    place.refuses("figures --figure 9z", &["9z", "3a, 3b, 4, 5b, 6"]);
    place.refuses("figures --paper nobody1900", &["estrada2024"]);
    place.refuses("figures --from absent", &["absent/results.json"]);
    place.succeeds("verify --out results --suite energy");
    place.refuses("figures --from results --figure 3a", &["contain no figure 3a", "plate/paper-p2-262144"]);
}

#[cfg(unix)]
#[test]
fn results_are_not_written_through_a_link() {
    let place = workspace();
    place.write("mine/f", "mine");
    std::fs::create_dir(place.path("drawn")).unwrap();
    std::os::unix::fs::symlink(place.path("mine"), place.path("drawn/results")).unwrap();
    place.write("drawn/fisura.sha256", "# fisura.manifest/1 figures\n");
    place.refuses("figures --figure 3a --out drawn", &["drawn/results is a symbolic link", "--out"]);
    assert_eq!(place.files("mine"), ["f"]);
}
