//! `bench`: what it refuses, and the exchange with a program of the user.

use fisura_verification::bench::peer::block::PeerBlock;
use fisura_verification::bench::peer::cells;

use super::support::{Place, wait_until};
use super::verify::workspace_with;

/// A workspace without cases.
pub fn workspace() -> Place {
    workspace_with(&[])
}

#[test]
fn unknown_families_and_a_peer_without_a_program_end_with_2() {
    let place = workspace();
    place.refuses("bench --family stages,speed", &["unknown family: speed", "work-precision", "ceilings"]);
    place.refuses("bench --family peer", &["--peer CMD"]);
    let unstarted = "bench --quick --family ceilings,peer --peer 'no-such-program --fast' --out out";
    let ended = place.refuses(unstarted, &["no-such-program", "cannot be started", "status 0"]);
    ended.says(&["FAIL unfinished/run: 1 of 2 families are measured"]);
    assert!(place.read("out/bench.json").contains("\"ceilings/"), "what is measured is kept");
    assert!(place.read("out/fisura.sha256").contains("# unfinished"));
}

#[test]
#[cfg(unix)]
fn the_time_of_a_peer_is_valid_only_with_its_answer() {
    let place = workspace();
    let outcome = place.xtask("bench --quick --family peer --peer true --out silent").with_status(1);
    outcome.says(&["FAIL peer/command: its answer differs from that of the block", "result.csv"]);
    assert!(place.read("silent/peer/long/particles.csv").starts_with("x,y,volume,vx,vy\n"));
    assert!(place.read("silent/peer/short/block.json").contains("\"steps\""));
    assert!(place.read("silent/summary.md").contains("its time is not valid"));

    place.write("copy.sh", "for last; do :; done\ncp \"$last/particles.csv\" \"$last/result.csv\"\n");
    let bench = |script: &str, more: &str| {
        let path = place.path(script).display().to_string();
        place.xtask(&format!("bench --quick --family peer --peer \"sh '{path}'\" {more}"))
    };
    let off = "differs from that of the block: row 1 lies at";
    bench("copy.sh", "--out copied").with_status(1).says(&[off]);

    // our own answer in its place, from a program that takes no time, and from one that takes some
    let answer = PeerBlock::new(cells(true)).unwrap().answer();
    std::fs::write(place.path("answer.csv"), answer.to_csv().unwrap()).unwrap();
    let give = format!("for last; do :; done\ncp '{}' \"$last/result.csv\"\n", place.path("answer.csv").display());
    place.write("hasty.sh", &give);
    bench("hasty.sh", "--out hasty").with_status(1).says(&["too short to separate from start and end"]);
    let steps = "case $last in */long) i=0; while [ $i -lt 1000000 ]; do i=$((i + 1)); done;; esac\n";
    place.write("patient.sh", &format!("{give}{steps}"));
    let set = bench("patient.sh", "--format json").with_status(0).json();
    assert_eq!(set["schema"], "fisura.bench/1");
    let answers: Vec<&str> = set["records"].as_array().unwrap().iter().map(|r| r["id"].as_str().unwrap()).collect();
    assert_eq!(answers, ["peer/fisura", "peer/command"]);
    // an answer in the first round alone, and one that is wrong in the first round alone
    let count = format!("n=$(cat '{0}' 2>/dev/null || echo 0); echo $((n + 1)) > '{0}'\n", place.path("n").display());
    place.write(
        "once.sh",
        &format!("{count}{steps}[ $n -gt 1 ] && exit 0\n{give}").replacen("case", "for last; do :; done\ncase", 1),
    );
    let once = bench("once.sh", "--out once").with_status(1);
    once.says(&["its answer differs from that of the block", "result.csv"]);
    std::fs::remove_file(place.path("n")).unwrap();
    place.write(
        "late.sh",
        &format!("{count}{give}[ $n -lt 2 ] && cp \"$last/particles.csv\" \"$last/result.csv\"; true\n"),
    );
    bench("late.sh", "--out late").with_status(1).says(&[off]);
    place.succeeds("report target/fisura/bench --out again");
    assert_eq!(place.read("again/summary.md"), place.read("target/fisura/bench/summary.md"));
}

#[test]
#[cfg(target_os = "linux")]
fn a_peer_has_a_limit_of_time_and_does_not_outlive_the_command() {
    let place = workspace();
    let slow = "sh -c 'echo $$ > pid; exec sleep 600'";
    let bench = format!("bench --quick --family peer --peer \"{slow}\" --out slow");
    let words = ["sleep 600", "ended after 1 s", "--peer-timeout"];
    place.refuses(&format!("{bench} --peer-timeout 1"), &words);

    std::fs::remove_file(place.path("pid")).unwrap();
    let mut command = place.begin(&bench);
    let pid = || std::fs::read_to_string(place.path("pid")).unwrap_or_default().trim().to_string();
    assert!(wait_until(|| !pid().is_empty()), "the peer did not start");
    command.kill().unwrap(); // no handler can help
    command.wait().unwrap();
    let state = || std::fs::read_to_string(format!("/proc/{}/stat", pid())).unwrap_or_default();
    assert!(wait_until(|| state().is_empty() || state().contains(") Z")), "the peer lives on");
}
