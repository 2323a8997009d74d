//! `bench`: what it refuses, and the exchange with a program of the user.

use super::support::Place;

/// The least that reference data can be.
const SOURCE: &str = "citation = \"Nobody (1900)\"\nobtained = \"text\"\nkind = \"literature\"\nmodel = \"none\"\n\
                      resolution = \"none\"\n";

pub fn workspace() -> Place {
    let mut place = Place::with("Cargo.toml", "[workspace]\n");
    place.write("reference-data/nobody-1900/source.toml", SOURCE);
    place.manifest = Some(place.path("xtask"));
    place
}

#[test]
fn unknown_families_and_a_peer_without_a_program_end_with_2() {
    let place = workspace();
    let refused = place.xtask(&["bench", "--family", "stages,speed"]).with_status(2);
    refused.complains_of(&["unknown family: speed", "work-precision", "ceilings"]);
    place.xtask(&["bench", "--family", "peer"]).with_status(2).complains_of(&["--peer CMD"]);
    let arguments = ["bench", "--quick", "--family", "peer", "--peer", "no-such-program --fast", "--out", "out"];
    place.xtask(&arguments).with_status(2).complains_of(&["no-such-program", "cannot be started", "status 0"]);
}

#[test]
#[cfg(unix)]
fn the_answer_of_a_peer_is_verified_before_its_time_is_believed() {
    let place = workspace();
    let silent = ["bench", "--quick", "--family", "peer", "--peer", "true", "--out", "silent"];
    let outcome = place.xtask(&silent).with_status(1);
    let unknown = "FAIL peer/command: its answer is unknown";
    assert!(outcome.out.contains(unknown) && outcome.out.contains("result.csv"), "{outcome:?}");
    assert!(place.read("silent/peer/long/particles.csv").starts_with("x,y,volume,vx,vy\n"));
    assert!(place.read("silent/peer/short/block.json").contains("\"steps\": 20"));
    assert!(place.read("silent/summary.md").contains("do not believe its time"));

    // a body that spins freely keeps its kinetic energy: the start is nearly the answer
    let copy = "for last; do :; done\ncp \"$last/particles.csv\" \"$last/result.csv\"\n";
    place.write("copy.sh", copy);
    let command = format!("sh {}", place.path("copy.sh").display());
    let hasty = place.xtask(&["bench", "--quick", "--family", "peer", "--peer", &command, "--out", "hasty"]);
    assert!(hasty.with_status(1).out.contains("too little to be told from start and end"));

    let steps = "case $last in */long) i=0; while [ $i -lt 1000000 ]; do i=$((i + 1)); done;; esac\n";
    place.write("copy.sh", &format!("{copy}{steps}"));
    let outcome = place.xtask(&["bench", "--quick", "--family", "peer", "--peer", &command, "--format", "json"]);
    let set = outcome.with_status(0).json();
    assert_eq!(set["schema"], "fisura.bench/1");
    let answers: Vec<&str> = set["records"].as_array().unwrap().iter().map(|r| r["id"].as_str().unwrap()).collect();
    assert_eq!(answers, ["peer/fisura", "peer/command"]);
    place.xtask(&["report", "target/fisura/bench", "--out", "again"]).with_status(0);
    assert_eq!(place.read("again/summary.md"), place.read("target/fisura/bench/summary.md"));
}
