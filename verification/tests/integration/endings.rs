//! However a case ends, its records are there, and the other cases run.

use std::time::Duration;

use crate::support::{CLOSURE, SCENE, Silent, run, run_watched, write_case};
use fisura_verification::record::{Environment, Record, Status};

/// Two runs, of which the second is unstable, and a difference between them.
fn with_an_unstable_variant(check: &str) -> String {
    let steps = |step: &str| format!("set = {{ \"analysis.time_step\" = {step} }}\n");
    let variants = format!(
        "[[variant]]\nname = \"stable\"\n{}[[variant]]\nname = \"unstable\"\n{}",
        steps("\"auto\""),
        steps("0.2")
    );
    let difference = "[[check]]\nid = \"apart\"\nquantity = \"difference of the kinetic energy\"\n\
                      measure = \"difference\"\ncolumn = \"kinetic_j\"\n";
    format!("{variants}{difference}{check}\n{CLOSURE}")
}

fn ids(records: &[Record]) -> Vec<(&str, Status)> {
    records.iter().map(|record| (record.id.as_str(), record.status)).collect()
}

#[test]
fn a_breakdown_of_the_variant_that_is_compared_with_is_a_record() {
    let root = tempfile::tempdir().unwrap();
    let scene = SCENE.replace("end_time = 1.0", "end_time = 100.0");
    write_case(root.path(), "a", &scene, &with_an_unstable_variant("against = \"unstable\""));
    write_case(root.path(), "b", SCENE, CLOSURE);
    let results = run(root.path(), Environment::default()).unwrap();
    let expected = [
        ("trial/a/stable/apart", Status::Error),
        ("trial/a/stable/closure", Status::Pass),
        ("trial/a/unstable/closure", Status::Error),
        ("trial/b/closure", Status::Pass),
    ];
    assert_eq!(ids(&results.records), expected);
    let message = results.records[0].message.as_deref().unwrap();
    assert!(message.contains("variant \"unstable\"") && message.contains("at step"), "{message}");
}

#[test]
fn a_case_beyond_its_time_is_a_record_and_the_others_run() {
    let root = tempfile::tempdir().unwrap();
    let endless = SCENE.replace("end_time = 1.0", "end_time = 1e7").replace("degree = 2", "degree = [2, 3]");
    write_case(root.path(), "a", &endless, CLOSURE);
    let short = endless.replace("degree = [2, 3]", "degree = 2");
    let variant = "[[variant]]\nname = \"short\"\nset = { \"analysis.end_time\" = 1.0 }\n\
                   [[variant]]\nname = \"endless\"\nset = { \"mesh.degree\" = 2 }\n";
    write_case(root.path(), "d", &short, &format!("{variant}{CLOSURE}"));
    let apart = "study = \"contact-onset\"\n".to_string() + APART;
    let force = "[[check]]\nid = \"force\"\n\
                 quantity = \"force of contact in the end over the momentum per second\"";
    write_case(root.path(), "b", &apart, force);
    write_case(root.path(), "c", SCENE, CLOSURE);
    let limit = Some(Duration::from_secs(1));
    let results = run_watched(root.path(), Environment::default(), limit, &Silent).unwrap();
    let expected = [
        ("trial/a/degree=2/closure", Status::Error),
        ("trial/a/degree=3/closure", Status::Error),
        ("trial/b/force", Status::Error),
        ("trial/c/closure", Status::Pass),
        ("trial/d/short/closure", Status::Pass),
        ("trial/d/endless/closure", Status::Error),
    ];
    assert_eq!(ids(&results.records), expected);
    for record in results.records.iter().filter(|record| record.status == Status::Error) {
        let message = record.message.as_deref().unwrap();
        assert!(message.contains("limit of 1 s") && message.contains("--case-timeout"), "{message}");
        assert!(!message.contains("runs on"), "it stopped when asked: {message}");
    }
    assert!(root.path().join("out/results.json").exists());
}

/// Two blocks that never meet.
const APART: &str = r#"
[scene.mesh]
degree = 2
origin = [0.0, 0.0]
size = [2.0, 1.0]
cells = [16, 8]

[scene.analysis]
end_time = 1e7
frame = "updated"
gravity = [0.0, -1e-12]

[scene.material.solid]
young_modulus = 1.0
poisson_ratio = 0.0
density = 1.0

[scene.contact]
friction = 0.3

[[scene.body]]
name = "block"
material = "solid"
shape = { rectangle = { min = [0.5, 0.25], max = [1.0, 0.5] } }
velocity = [1e-12, 0.0]

[[scene.body]]
name = "other"
material = "solid"
shape = { rectangle = { min = [1.25, 0.25], max = [1.75, 0.5] } }
"#;
