//! The status of a record from the keys of its check: uncertainties, bounds of regression, known limits.

use fisura_verification::record::{Environment, Record, ReferenceKind, Status};
use fisura_verification::suite::VerifyError;

use crate::support::{SCENE, run, write_case};

/// A block in free flight: its kinetic energy is ½ · 1 m · 0.5 m · 1 kg/m³ · (0.01 m/s)² = 2.5e-5 J
/// throughout.
fn flight() -> String {
    let scene = SCENE.replace("cells = [8, 4]", "cells = [[2, 1], [4, 2], [8, 4]]");
    scene
        .replace("end_time = 1.0", "end_time = 0.1")
        .replace("[[scene.boundary]]\nside = \"left\"\nfix = [\"x\"]\n", "")
}

const CHECK: &str =
    "[[check]]\nid = \"kinetic\"\nquantity = \"kinetic energy in 10 μJ\"\nscale = 1e5\ncolumn = \"kinetic_j\"\n";

fn records(check: &str) -> Result<Vec<Record>, VerifyError> {
    let root = tempfile::tempdir().unwrap();
    let measure = if check.contains("measure =") { "" } else { "measure = \"initial\"\n" };
    write_case(root.path(), "flight", &flight(), &format!("{CHECK}{measure}{check}"));
    Ok(run(root.path(), Environment::default())?.records)
}

fn one(check: &str) -> Record {
    records(check).unwrap().swap_remove(0)
}

#[test]
fn the_uncertainty_of_the_reference_bounds_the_value() {
    for (uncertainty, status) in [(2e-7, Status::Pass), (5e-8, Status::Fail)] {
        let record = one(&format!("expect = 2.51e-5\nexpect_kind = \"independent-code\"\nuncertainty = {uncertainty}"));
        assert_eq!(record.status, status, "{record:?}");
        assert!((record.uncertainty().unwrap() - 1e5 * uncertainty).abs() < 1e-12);
        assert!((record.accept.max.unwrap() - 2.51 - 1e5 * uncertainty).abs() < 1e-9, "{record:?}");
    }
}

#[test]
fn the_mesh_adds_its_part_of_the_uncertainty() {
    let record = one("meshes = \"finest-mesh\"\norder = 2\nexpect = 2.5e-5\nuncertainty = 1e-7");
    let error = record.discretisation.as_ref().unwrap();
    assert!(error.value < 1e-9 && error.from.contains("meshes"), "every mesh has the mass of the block: {error:?}");
    assert_eq!((record.status, record.id.as_str()), (Status::Pass, "trial/flight/kinetic"));
}

#[test]
fn an_order_and_a_constant_give_the_discretisation_error() {
    for (constant, status) in [(0.05, Status::Pass), (0.003, Status::Fail)] {
        let record = one(&format!("expect = 2.51e-5\ndiscretisation = \"= {constant}*2.51e-5\"\nwhy = \"order 0\""));
        let error = record.discretisation.as_ref().unwrap();
        assert!((error.value - 2.51 * constant).abs() < 1e-9, "{error:?}");
        assert_eq!(record.status, status, "{record:?}");
    }
}

#[test]
fn numbers_of_the_library_bring_their_uncertainty() {
    let record = one("reference = \"plate-family/plane-stress/branching-time\"");
    let reference = record.reference.unwrap();
    assert_eq!(reference.kind, ReferenceKind::IndependentCode);
    assert!((reference.value.unwrap() - 32.5e-6 * 1e5).abs() < 1e-12, "{reference:?}");
    assert!((reference.uncertainty.unwrap() - 0.25e-6 * 1e5).abs() < 1e-12, "{reference:?}");
    let record = one("measure = \"value-at\"\nat = \"60 us\"\nreference = \"plate-family/plate/kinetic-energy\"");
    let reference = record.reference.unwrap();
    assert!((0.001..0.01).contains(&(reference.uncertainty.unwrap() / reference.value.unwrap())), "{reference:?}");
    assert_eq!(record.status, Status::Fail, "it is far from the curve");
}

#[test]
fn a_value_within_a_documented_limit_is_a_known_limit() {
    let limited = |limit: &str| {
        one(&format!(
            "expect = 3e-5\nmin = 2.99\nmax = 3.01\nwhy = \"theory\"\nlimit = {{ {limit}, why = \"a cause\" }}"
        ))
    };
    let within = limited("min = 2.4, max = 2.6");
    assert!(within.status == Status::KnownLimit && within.limit.is_some(), "{within:?}");
    assert_eq!(limited("min = 2.6").status, Status::Fail);
    let of_uncertainty = one("expect = 3e-5\nuncertainty = 1e-7\nlimit = { min = 2.4, max = 2.6, why = \"a cause\" }");
    assert_eq!(of_uncertainty.status, Status::KnownLimit);
}

#[test]
fn keys_that_say_nothing_are_refused() {
    for (check, expected) in [
        ("expect = 1.0\nuncertainty = 0.1\nmax = 1.0\nwhy = \"w\"", "bounds in addition to those of the uncertainty"),
        ("bounds = \"regression\"\nwhy = \"w\"", "without bounds"),
        ("bounds = \"validation\"", "validation"),
        ("max = 1.0", "bounds without a reason"),
        ("expect = 1.0\ndiscretisation = 0.1", "bounds without a reason"),
        ("expect = 1.0\nuncertainty = 0.0", "not a valid uncertainty"),
        ("uncertainty = 0.1", "uncertainty without expect"),
        ("expect_side = \"at-least\"", "expect_side without expect"),
        ("limit = { max = 1.0 }", "a limit without a cause"),
        ("limit = { why = \"a cause\" }", "a limit without bounds"),
        ("limit = { min = 2.0, max = 1.0, why = \"a cause\" }", "min is above max"),
        ("reference = \"plate-family/none\"", "no reference value or curve"),
    ] {
        let error = records(check).unwrap_err().to_string();
        assert!(error.contains("flight.toml:") && error.contains(expected), "{check}: {error}");
    }
}
