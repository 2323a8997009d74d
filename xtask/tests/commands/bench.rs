//! `bench`: what it refuses, and the exchange with a program of the user.

use fisura_verification::bench::peer::block::PeerBlock;
use fisura_verification::bench::peer::cells;

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
    let arguments =
        ["bench", "--quick", "--family", "ceilings,peer", "--peer", "no-such-program --fast", "--out", "out"];
    let words = ["no-such-program", "cannot be started", "status 0"];
    let ended = place.xtask(&arguments).with_status(2).complains_of(&words);
    assert!(ended.out.contains("FAIL unfinished/run: 1 of 2 families are measured"), "{ended:?}");
    assert!(place.read("out/bench.json").contains("\"ceilings/"), "what is measured is kept");
    assert!(place.read("out/fisura.sha256").contains("# unfinished"));
}

#[test]
#[cfg(unix)]
fn the_time_of_a_peer_is_valid_only_with_its_answer() {
    let place = workspace();
    let silent = ["bench", "--quick", "--family", "peer", "--peer", "true", "--out", "silent"];
    let outcome = place.xtask(&silent).with_status(1);
    let unknown = "FAIL peer/command: its answer differs from that of the block";
    assert!(outcome.out.contains(unknown) && outcome.out.contains("result.csv"), "{outcome:?}");
    assert!(place.read("silent/peer/long/particles.csv").starts_with("x,y,volume,vx,vy\n"));
    assert!(place.read("silent/peer/short/block.json").contains("\"steps\""));
    assert!(place.read("silent/summary.md").contains("its time is not valid"));

    let copy = "for last; do :; done\ncp \"$last/particles.csv\" \"$last/result.csv\"\n";
    place.write("copy.sh", copy);
    let command = |name: &str| format!("sh '{}'", place.path(name).display());
    let bench = |script: &str, more: &[&str]| {
        let command = command(script);
        place.xtask(&[&["bench", "--quick", "--family", "peer", "--peer", command.as_str()], more].concat())
    };
    let copied = bench("copy.sh", &["--out", "copied"]).with_status(1);
    assert!(copied.out.contains("differs from that of the block: row 1 lies at"), "{copied:?}");

    // our own answer in its place, from a program that takes no time, and from one that takes some
    let answer = PeerBlock::new(cells(true)).unwrap().answer();
    std::fs::write(place.path("answer.csv"), answer.to_csv().unwrap()).unwrap();
    let give = format!("for last; do :; done\ncp '{}' \"$last/result.csv\"\n", place.path("answer.csv").display());
    place.write("hasty.sh", &give);
    assert!(
        bench("hasty.sh", &["--out", "hasty"]).with_status(1).out.contains("too short to separate from start and end")
    );
    let steps = "case $last in */long) i=0; while [ $i -lt 1000000 ]; do i=$((i + 1)); done;; esac\n";
    place.write("patient.sh", &format!("{give}{steps}"));
    let set = bench("patient.sh", &["--format", "json"]).with_status(0).json();
    assert_eq!(set["schema"], "fisura.bench/1");
    let answers: Vec<&str> = set["records"].as_array().unwrap().iter().map(|r| r["id"].as_str().unwrap()).collect();
    assert_eq!(answers, ["peer/fisura", "peer/command"]);
    // an answer in the first round alone, and one that is wrong in the first round alone
    let count = format!("n=$(cat '{0}' 2>/dev/null || echo 0); echo $((n + 1)) > '{0}'\n", place.path("n").display());
    place.write(
        "once.sh",
        &format!("{count}{steps}[ $n -gt 1 ] && exit 0\n{give}").replacen("case", "for last; do :; done\ncase", 1),
    );
    let once = bench("once.sh", &["--out", "once"]).with_status(1);
    assert!(
        once.out.contains("its answer differs from that of the block") && once.out.contains("result.csv"),
        "{once:?}"
    );
    std::fs::remove_file(place.path("n")).unwrap();
    place.write(
        "late.sh",
        &format!("{count}{give}[ $n -lt 2 ] && cp \"$last/particles.csv\" \"$last/result.csv\"; true\n"),
    );
    let late = bench("late.sh", &["--out", "late"]).with_status(1);
    assert!(late.out.contains("differs from that of the block: row 1 lies at"), "{late:?}");
    place.xtask(&["report", "target/fisura/bench", "--out", "again"]).with_status(0);
    assert_eq!(place.read("again/summary.md"), place.read("target/fisura/bench/summary.md"));
}

#[test]
#[cfg(target_os = "linux")]
fn a_peer_has_a_limit_of_time_and_does_not_outlive_the_command() {
    let place = workspace();
    let slow = "sh -c 'echo $$ > pid; exec sleep 600'";
    let bench = ["bench", "--quick", "--family", "peer", "--peer", slow, "--out", "slow"];
    let ended = place.xtask(&[&bench[..], &["--peer-timeout", "1"]].concat()).with_status(2);
    ended.complains_of(&["sleep 600", "ended after 1 s", "--peer-timeout"]);

    std::fs::remove_file(place.path("pid")).unwrap();
    let mut command = place.command(&bench).spawn().unwrap();
    let wait_until = |holds: &dyn Fn() -> bool| {
        (0..1200).any(|_| {
            std::thread::sleep(std::time::Duration::from_millis(50));
            holds()
        })
    };
    let pid = || std::fs::read_to_string(place.path("pid")).unwrap_or_default().trim().to_string();
    assert!(wait_until(&|| !pid().is_empty()), "the peer did not start");
    command.kill().unwrap(); // no handler can help
    command.wait().unwrap();
    let state = || std::fs::read_to_string(format!("/proc/{}/stat", pid())).unwrap_or_default();
    assert!(wait_until(&|| state().is_empty() || state().contains(") Z")), "the peer lives on");
}
