//! Verdicts from the keys of a check to the record: uncertainty, bounds of regression, expectations.

use fisura_verification::record::{Agreement, BoundKind, Environment, Record, ReferenceKind, Status};
use fisura_verification::suite::VerifyError;

use crate::support::{run, write_case};

/// A block in free flight: its kinetic energy is ½ · 1 m · 0.5 m · 1 kg/m³ · (0.01 m/s)² = 2.5e-5 J
/// throughout.
const SCENE: &str = r#"
[scene.mesh]
degree = 2
origin = [0.0, 0.0]
size = [1.0, 0.5]
cells = [[2, 1], [4, 2], [8, 4]]

[scene.analysis]
end_time = 0.1

[scene.material.solid]
young_modulus = 1.0
poisson_ratio = 0.3
density = 1.0

[[scene.body]]
name = "block"
material = "solid"
shape = { rectangle = { min = [0.0, 0.0], max = [1.0, 0.5] } }
velocity = [0.01, 0.0]

[scene.output]
samples = 2
"#;

const CHECK: &str =
    "[[check]]\nid = \"kinetic\"\nquantity = \"kinetic energy in 10 μJ\"\nscale = 1e5\ncolumn = \"kinetic_j\"\n";

fn records(check: &str) -> Result<Vec<Record>, VerifyError> {
    let root = tempfile::tempdir().unwrap();
    let measure = if check.contains("measure =") { "" } else { "measure = \"initial\"\n" };
    write_case(root.path(), "flight", SCENE, &format!("{CHECK}{measure}{check}"));
    Ok(run(root.path(), Environment::default())?.records)
}

fn one(check: &str) -> Record {
    records(check).unwrap().swap_remove(0)
}

#[test]
fn the_uncertainty_of_the_reference_decides_where_a_check_says_so() {
    for (uncertainty, status, verdict) in
        [(2e-7, Status::Pass, Agreement::Agrees), (5e-8, Status::Fail, Agreement::Differs)]
    {
        let record = one(&format!(
            "expect = 2.51e-5\nexpect_kind = \"independent-code\"\nuncertainty = {uncertainty}\nbounds = \"validation\"\n\
             why = \"half a unit of the last digit\""
        ));
        let validation = record.validation.as_ref().unwrap();
        assert_eq!((record.status, validation.verdict), (status, verdict), "{record:?}");
        assert!((validation.error + 0.01).abs() < 1e-9 && (validation.u_val - 1e5 * uncertainty).abs() < 1e-12);
        assert_eq!(record.accept.kind, Some(BoundKind::Validation));
    }
}

#[test]
fn the_mesh_adds_its_part_of_the_uncertainty() {
    let record =
        one("meshes = \"finest-mesh\"\norder = 2\nexpect = 2.5e-5\nuncertainty = 1e-7\nbounds = \"validation\"\n\
                      why = \"as far as both reach\"");
    let validation = record.validation.unwrap();
    assert!(validation.u_num.is_some_and(|u| u < 1e-9), "every mesh has the mass of the block: {validation:?}");
    assert_eq!((record.status, record.id.as_str()), (Status::Pass, "trial/flight/kinetic"));
}

#[test]
fn numbers_of_the_library_bring_their_uncertainty() {
    let record = one("reference = \"independent-fem/branching-time\"");
    let reference = record.reference.unwrap();
    assert_eq!(reference.kind, ReferenceKind::IndependentCode);
    assert!((reference.value.unwrap() - 31e-6 * 1e5).abs() < 1e-12, "{reference:?}");
    assert!((reference.uncertainty.unwrap() - 0.3e-6 * 1e5).abs() < 1e-12, "{reference:?}");
    let record = one("measure = \"value-at\"\nat = \"60 us\"\nreference = \"independent-fem/plate/kinetic-energy\"");
    let reference = record.reference.unwrap();
    assert!((reference.uncertainty.unwrap() / reference.value.unwrap() - 0.004).abs() < 1e-9, "{reference:?}");
    assert_eq!(record.validation.unwrap().verdict, Agreement::Differs);
    assert_eq!(record.status, Status::Info, "without bounds it is shown");
}

#[test]
fn an_expectation_that_is_not_met_stands_beside_the_bounds_of_the_limit() {
    let limit = "bounds = \"regression\"\nmin = 2.4\nmax = 2.6\nwhy = \"a known limit\"\n";
    let expecting = |band: &str| one(&format!("{limit}expectation = {{ {band} }}"));
    let met = expecting("min = 2.0, max = 3.0, source = \"a plan\"");
    assert!(met.status == Status::Pass && !met.misses_expectation(), "{met:?}");
    for band in
        ["min = 3.0, source = \"a plan\"", "max = 2.0, source = \"a plan\"", "band = \"plate-events/branching-x\""]
    {
        let missed = expecting(band);
        assert!(missed.status == Status::Pass && missed.misses_expectation() && missed.is_regression(), "{missed:?}");
        assert_eq!(missed.reference.unwrap().kind, ReferenceKind::Regression);
    }
}

#[test]
fn keys_that_say_nothing_are_refused() {
    for (check, expected) in [
        ("bounds = \"validation\"\nmax = 1.0\nwhy = \"w\"", "bounds of its own beside those of the uncertainty"),
        ("bounds = \"regression\"\nwhy = \"w\"", "without bounds"),
        ("bounds = \"validation\"", "bounds without a reason"),
        ("expect = 1.0\nbounds = \"validation\"\nwhy = \"w\"", "an uncertainty that is not given"),
        ("expect = 1.0\nuncertainty = 0.0", "no uncertainty"),
        ("uncertainty = 0.1", "uncertainty without expect"),
        ("expectation = { max = 1.0 }", "an expectation without a source"),
        ("expectation = { source = \"a plan\" }", "band of the reference data or has bounds"),
        ("expectation = { min = 2.0, max = 1.0, source = \"a plan\" }", "min is above max"),
        ("expectation = { band = \"plate-events/none\" }", "no reference band"),
        ("reference = \"independent-fem/none\"", "no reference value or curve"),
    ] {
        let error = records(check).unwrap_err().to_string();
        assert!(error.contains("flight.toml:") && error.contains(expected), "{check}: {error}");
    }
}
