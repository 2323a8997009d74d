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
    let different = with("phase_field = \"AT1\"", "phase_field = \"PF-CZM\"").unwrap();
    assert_eq!(different.outcome, Outcome::Pass); // a difference is no error
    let silent = with("phase_field = \"AT1\"\n", "").unwrap_err().to_string();
    assert!(silent.contains("model.phase_field: missing"), "{silent}");
    let other = judged(&of("raibagi-kalthoff-at2"), None).verdict;
    assert!(other.outcome == Outcome::Incomplete && other.differences.len() == 1, "{other:?}"); // no work, no kinetic energy
}

#[test]
fn a_file_of_moose_needs_no_table_of_columns() {
    let runs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reference-data/kalthoff/runs");
    let run = std::fs::read_to_string(runs.join("at1-plane-strain-h0.25.csv")).unwrap();
    let names = [
        ("time_us", "time"),
        ("kinetic_j_per_m", "kinetic_energy"),
        ("elastic_j_per_m", "strain_energy"),
        ("external_work_j_per_m", "external_work"),
        ("fracture_j_per_m", "fracture_energy"),
    ];
    let ours: String = names.iter().fold(run.clone(), |text, (ours, theirs)| text.replacen(ours, theirs, 1));
    let head = "benchmark = \"kalthoff\"\ncode = { name = \"x\" }\nmodel = { plane = \"strain\", phase_field = \"AT1\" }\n\
                discretisation = { spacing = \"0.25 mm\" }\n";
    let with = |csv: &str, curves: &str| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("out.csv"), csv).unwrap();
        std::fs::write(folder.path().join("submission.toml"), format!("{head}curves = {{ {curves} }}\n")).unwrap();
        judge(folder.path(), &library(), &data(), None).map(|judged| judged.verdict)
    };
    let by_names = "time = { column = \"time_us\", unit = \"us\" }, \
                    kinetic = { file = \"out.csv\", column = \"kinetic_j_per_m\", unit = \"J/m\" }, \
                    elastic = { file = \"out.csv\", column = \"elastic_j_per_m\", unit = \"J/m\" }, \
                    work = { file = \"out.csv\", column = \"external_work_j_per_m\", unit = \"J/m\" }, \
                    fracture = { file = \"out.csv\", column = \"fracture_j_per_m\", unit = \"J/m\" }";
    let moose = "format = \"moose\", file = \"out.csv\", time_unit = \"us\", energy_unit = \"J/m\"";
    let (named, known) = (with(&run, by_names).unwrap(), with(&ours, moose).unwrap());
    assert!(known.quantities.iter().any(|q| q.outcome == Outcome::Pass), "{known:?}");
    assert_eq!(named.quantities, known.quantities);
    let part = with(&ours.replacen("strain_energy", "other", 1), moose).unwrap();
    assert!(part.quantities.iter().any(|q| q.outcome == Outcome::Incomplete), "{part:?}");
    let refused = [
        (&run, moose, "curves.file: "),
        (&ours, "format = \"moose\", file = \"out.csv\", time_unit = \"us\"", "curves.energy_unit: missing"),
        (
            &ours,
            "format = \"moose\", file = \"../out.csv\", time_unit = \"us\", energy_unit = \"J/m\"",
            "curves.file: ",
        ),
        (&ours, "file = \"out.csv\"", "curves.file: this key belongs to a format"),
        (&ours, "format = \"mose\", file = \"out.csv\", time_unit = \"us\", energy_unit = \"J/m\"", "curves.format: "),
    ];
    for (csv, curves, says) in refused {
        let error = with(csv, curves).unwrap_err().to_string();
        assert!(error.contains(says), "{curves}: {error}");
    }
}
