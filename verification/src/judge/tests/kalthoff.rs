//! The test of Kalthoff and Winkler: a sound result passes, wrong ones fail, another model is named.

use super::*;

const KALTHOFF: &str = "fisura-kalthoff-at1";

#[test]
fn the_test_of_kalthoff_and_winkler_is_judged() {
    let sound = judged(&of(KALTHOFF), None).verdict;
    assert_eq!(sound.outcome, Outcome::Pass, "{sound:?}");
    assert_eq!(sound.quantities.len(), 16);
    assert!(sound.quantities.iter().all(|q| q.outcome != Outcome::Fail && q.outcome != Outcome::Incomplete));
    let with = |from: &str, to: &str| {
        let folder = changed(KALTHOFF, |text| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        });
        judge(folder.path(), &library(), &data(), None).map(|judged| judged.verdict)
    };
    let mistakes = [
        ("plane = \"strain\"", "plane = \"stress\""),
        ("phase_field = \"AT1\"", "phase_field = \"none\""),
        ("column = \"kinetic_j\", unit = \"J/m\"", "column = \"kinetic_j\", unit = \"J/m\", factor = 2"),
        ("column = \"time_s\", unit = \"s\"", "column = \"time_s\", unit = \"s\", offset = 1e-6"),
        ("column = \"crack_tip_x_m\", unit = \"m\"", "column = \"crack_tip_x_m\", unit = \"m\", offset = 2e-3"),
    ];
    for (from, to) in mistakes {
        let verdict = with(from, to).unwrap();
        assert!(verdict.outcome == Outcome::Fail && verdict.findings.is_empty(), "{to}: {verdict:?}");
    }
    let different = with("phase_field = \"AT1\"", "phase_field = \"AT2\"").unwrap();
    assert_eq!(different.outcome, Outcome::Pass); // a difference is no error
    let silent = with("phase_field = \"AT1\"\n", "").unwrap_err().to_string();
    assert!(silent.contains("model.phase_field: missing"), "{silent}");
    let other = judged(&of("raibagi-kalthoff-at2"), None).verdict;
    assert!(other.outcome == Outcome::Incomplete && other.differences.len() == 2, "{other:?}"); // no work, no kinetic energy
}
