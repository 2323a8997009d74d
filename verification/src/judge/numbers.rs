//! Benchmarks that ask for a few numbers instead of curves: closed forms, and the times of the rings, which
//! decide nothing because the geometry behind them is assumed.

use super::curves::decide;
use super::submission::Submission;
use super::table::Curve;
use super::verdict::{Comparison, Outcome, QuantityVerdict, ReferenceUsed, Verdict};
use super::{BENCHMARKS, Judged};
use crate::scene::SceneFileError;
use crate::scene::units::Dimension;

/// Material of all benchmarks.
pub const YOUNG_MODULUS: f64 = 32e9;
/// Of all but the homogeneous bar, where it is 0.
pub const POISSON_RATIO: f64 = 0.2;
/// kg/m³.
pub const DENSITY: f64 = 2450.0;
/// J/m².
pub const ENERGY_RELEASE_RATE: f64 = 3.0;
/// l0 in Borden's convention, m.
pub const LENGTH_SCALE: f64 = 0.25e-3;
/// Speed of Rayleigh waves in plane strain, m/s.
const RAYLEIGH: f64 = 2125.2;

/// A number that a benchmark asks for.
#[derive(Debug, Clone)]
pub struct Known {
    /// Key in `[values]`.
    pub name: &'static str,
    /// What it is.
    pub what: &'static str,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its unit.
    pub unit: &'static str,
    /// The closed form; an upper bound for `crack-speed`.
    pub value: f64,
    /// What a sound mesh may be off by, relative; absent where there is no reference that decides.
    pub tolerance: Option<f64>,
    /// The formula.
    pub formula: &'static str,
}

/// What a benchmark asks for; nothing for the plate.
pub fn values(benchmark: &str) -> Vec<Known> {
    let known = |name, what, dimension, unit, value, tolerance, formula| Known {
        name,
        what,
        dimension,
        unit,
        value,
        tolerance: Some(tolerance),
        formula,
    };
    let (e, nu, gc, l0) = (YOUNG_MODULUS, POISSON_RATIO, ENERGY_RELEASE_RATE, LENGTH_SCALE);
    match benchmark {
        "patch-bar" => {
            let (length, height, stress) = (10e-3, 5e-3, 1e6);
            let strain = stress * (1.0 - nu * nu) / e;
            vec![
                known(
                    "elongation",
                    "growth in length",
                    Dimension::LENGTH,
                    "m",
                    strain * length,
                    1e-6,
                    "sigma (1 - nu^2) L/E",
                ),
                known(
                    "contraction",
                    "loss of height",
                    Dimension::LENGTH,
                    "m",
                    stress * nu * (1.0 + nu) / e * height,
                    1e-6,
                    "sigma nu (1 + nu) H/E",
                ),
                known(
                    "elastic_energy",
                    "elastic energy per thickness",
                    Dimension::FORCE,
                    "J/m",
                    0.5 * stress * strain * length * height,
                    1e-6,
                    "sigma^2 (1 - nu^2) L H/(2 E)",
                ),
            ]
        }
        "homogeneous-bar" => {
            let strain = (gc / (6.0 * l0 * e)).sqrt();
            let stress = 9.0 / 16.0 * e * strain;
            vec![
                known(
                    "peak_stress",
                    "largest stress",
                    Dimension::STRESS,
                    "Pa",
                    stress,
                    1e-3,
                    "(9/16) sqrt(E Gc/(6 l0))",
                ),
                known("strain_at_peak", "strain there", Dimension::NONE, "1", strain, 1e-2, "sqrt(Gc/(6 l0 E))"),
                known("phase_field_at_peak", "phase field there", Dimension::NONE, "1", 0.75, 1e-2, "3/4"),
            ]
        }
        "seeded-crack" => {
            let what = ["fracture energy per area, half width l0/2", "fracture energy per area, half width l0"];
            let energy = Dimension::ENERGY_PER_AREA;
            vec![
                known("half_width_l0_2", what[0], energy, "J/m^2", 1.1298 * gc, 5e-3, "1.1298 Gc, h to 0"),
                known("half_width_l0", what[1], energy, "J/m^2", 1.3465 * gc, 5e-3, "1.3465 Gc, h to 0"),
            ]
        }
        "plane-waves" => {
            let modulus = e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
            let speed = (modulus / DENSITY).sqrt();
            let work = 2.0 * 0.1 * 1e12 * 5e-6 / (DENSITY * speed);
            let force = Dimension::FORCE;
            vec![
                known("work", "external work at 5 us", force, "J/m", work, 1e-2, "2 W sigma^2 t/(rho c_d)"),
                known("kinetic", "kinetic energy at 5 us", force, "J/m", 0.5 * work, 1e-2, "W sigma^2 t/(rho c_d)"),
                known("elastic", "elastic energy at 5 us", force, "J/m", 0.5 * work, 1e-2, "W sigma^2 t/(rho c_d)"),
            ]
        }
        "crack-speed" => {
            let formula = "below the Rayleigh speed";
            vec![known("largest_speed", "largest speed of the tip", Dimension::VELOCITY, "m/s", RAYLEIGH, 0.0, formula)]
        }
        "rings" => {
            let words = "about, in words, of the source paper; its geometry is in a picture only";
            let event = |name, what, value| Known {
                tolerance: None,
                ..known(name, what, Dimension::TIME, "s", value, 0.0, words)
            };
            vec![
                event("inner_cracks", "cracks at the inner edge towards the contact", 30e-6),
                event("contact_zone", "they reach the contact zone", 60e-6),
                event("rear_cracks", "cracks at the rear, from inside outwards", 100e-6),
                event("split", "split along the diameter; the fracture energy levels off", 150e-6),
                event("contact_end", "contact ends", 400e-6),
            ]
        }
        _ => Vec::new(),
    }
}

/// Judges the numbers of a closed-form benchmark.
///
/// # Errors
/// No number of the benchmark is there.
pub fn judge(folder: &str, submission: &Submission, curves: [Option<Curve>; 6]) -> Result<Judged, SceneFileError> {
    let known = values(&submission.benchmark);
    if submission.values.is_empty() {
        let names: Vec<&str> = known.iter().map(|k| k.name).collect();
        let remedy = format!("add [values] with {}", names.join(", "));
        return Err(submission.key_error("benchmark", "nothing to judge", remedy));
    }
    let decides = known.iter().any(|k| k.tolerance.is_some());
    let quantities = known.iter().map(|k| {
        let value = submission.values.iter().find(|v| v.0 == k.name).map(|v| v.1);
        let mut row = Comparison { name: k.name.into(), unit: k.unit.into(), value, ..Comparison::default() };
        row.reference = Some(k.value);
        row.error = value.map(|v| v - k.value);
        match k.tolerance {
            Some(tolerance) => decide(&mut row, 0.0, Some(tolerance * k.value.abs())),
            None => row.why = "the geometry is assumed: no reference decides".into(),
        }
        if k.tolerance == Some(0.0) && value.is_some() {
            let below = value.is_some_and(|v| v > 0.0 && v < k.value);
            row.outcome = if below { Outcome::Diagnostic } else { Outcome::Fail };
            row.why = k.formula.into();
        }
        QuantityVerdict { quantity: k.what.into(), outcome: row.outcome, comparisons: vec![row] }
    });
    let quantities = quantities.collect();
    let (uncertainty, numerical) = if decides {
        ("a closed form", "what a sound mesh may be off by, stated with the benchmark")
    } else {
        ("unknown: diagnostic only", "nothing is decided")
    };
    let id = submission.benchmark.clone();
    let label = BENCHMARKS.iter().find(|b| b.name == id).map_or("", |b| b.what).into();
    let reference = ReferenceUsed { id, label, uncertainty: uncertainty.into() };
    let differences = submission.model.differences.clone();
    let base = Verdict::of(folder, submission, reference, numerical);
    let mut verdict = Verdict { differences, quantities, ..base };
    verdict.conclude();
    Ok(Judged { verdict, curves, references: Default::default() })
}
