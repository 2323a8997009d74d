//! Benchmarks that ask for a few numbers instead of curves: closed forms, problems whose reference is
//! independent finite elements with AT1 (`reference-data/at1-benchmarks`), and values that decide nothing,
//! because their uncertainty or the geometry behind them is not known.

use std::f64::consts::FRAC_2_PI;

use super::curves::decide;
use super::elements::{ARREST, Elements, RING, STRIP, differences};
use super::model::Plane;
use super::submission::Submission;
use super::table::Curve;
use super::verdict::{Comparison, Outcome, QuantityVerdict, ReferenceUsed, Verdict};
use super::{BENCHMARKS, Judged, explained_by_difference};
use crate::reference::Library;
use crate::scene::SceneFileError;
use crate::scene::units::Dimension;

/// Material of the closed forms.
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

/// Why a value decides nothing.
const ASSUMED: &str = "the geometry is assumed: no reference decides";
const PUBLISHED: &str = "a published run of PF-CZM (Mandal, Nguyen and Wu 2020), whose uncertainty is not stated";

/// A number that a benchmark asks for.
#[derive(Debug, Clone)]
pub struct Asked {
    /// Key in `[values]`.
    pub name: String,
    /// What it is.
    pub what: String,
    /// Its dimension.
    pub dimension: Dimension,
    /// Its unit.
    pub unit: &'static str,
    /// What it is held against.
    pub basis: Basis,
}

/// What a number is held against, SI.
#[derive(Debug, Clone, PartialEq)]
pub enum Basis {
    /// A closed form, and what a sound mesh may be off by, relative.
    ClosedForm(f64, f64),
    /// An upper bound.
    Below(f64),
    /// A value that decides nothing, and why.
    Undecided(f64, &'static str),
    /// A value of independent finite elements, and its name.
    Elements(&'static Elements, String),
}

/// What a benchmark asks for; nothing for those that ask for curves.
pub fn values(benchmark: &str) -> Vec<Asked> {
    let (e, nu, gc, l0) = (YOUNG_MODULUS, POISSON_RATIO, ENERGY_RELEASE_RATE, LENGTH_SCALE);
    let closed = Basis::ClosedForm;
    match benchmark {
        "patch-bar" => {
            let (length, height, stress) = (10e-3, 5e-3, 1e6);
            let strain = stress * (1.0 - nu * nu) / e;
            let contraction = stress * nu * (1.0 + nu) / e * height;
            let energy = 0.5 * stress * strain * length * height;
            vec![
                asked("elongation", "growth in length", "m", closed(strain * length, 1e-6)),
                asked("contraction", "loss of height", "m", closed(contraction, 1e-6)),
                asked("elastic_energy", "elastic energy per thickness", "J/m", closed(energy, 1e-6)),
            ]
        }
        "homogeneous-bar" => {
            let strain = (gc / (6.0 * l0 * e)).sqrt();
            vec![
                asked("peak_stress", "largest stress", "Pa", closed(9.0 / 16.0 * e * strain, 1e-3)),
                asked("strain_at_peak", "strain there", "1", closed(strain, 1e-2)),
                asked("phase_field_at_peak", "phase field there", "1", closed(0.75, 1e-2)),
            ]
        }
        "seeded-crack" => {
            let what = "fracture energy per area, half width";
            vec![
                asked("half_width_l0_2", format!("{what} l0/2"), "J/m^2", closed(1.1298 * gc, 5e-3)),
                asked("half_width_l0", format!("{what} l0"), "J/m^2", closed(1.3465 * gc, 5e-3)),
            ]
        }
        "plane-waves" => {
            let modulus = e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
            let speed = (modulus / DENSITY).sqrt();
            let work = 2.0 * 0.1 * 1e12 * 5e-6 / (DENSITY * speed);
            vec![
                asked("work", "external work at 5 us", "J/m", closed(work, 1e-2)),
                asked("kinetic", "kinetic energy at 5 us", "J/m", closed(0.5 * work, 1e-2)),
                asked("elastic", "elastic energy at 5 us", "J/m", closed(0.5 * work, 1e-2)),
            ]
        }
        "crack-speed" => vec![asked("largest_speed", "largest speed of the tip", "m/s", Basis::Below(RAYLEIGH))],
        "rings" => {
            let event = |name, what, time| asked(name, what, "s", Basis::Undecided(time, ASSUMED));
            vec![
                event("inner_cracks", "cracks at the inner edge towards the contact", 30e-6),
                event("contact_zone", "they reach the contact zone", 60e-6),
                event("rear_cracks", "cracks at the rear, from inside outwards", 100e-6),
                event("split", "split along the diameter; the fracture energy levels off", 150e-6),
                event("contact_end", "contact ends", 400e-6),
            ]
        }
        "brazilian-disc" => {
            let half_angle = 10f64.to_radians();
            let [tension, compression] =
                [-1.0, 1.0].map(|sign| FRAC_2_PI * ((2.0 * half_angle).sin() + sign * half_angle));
            let failure = (3.0 * 20e9 * 40.0 / (16.0 * 0.5e-3_f64)).sqrt() / tension;
            let over = |stress: &str| format!("{stress} at the centre over the pressure");
            vec![
                asked("tension_over_pressure", over("tension"), "1", closed(tension, 5e-3)),
                asked("compression_over_pressure", over("compression"), "1", closed(compression, 5e-3)),
                asked("pressure_at_failure", "least pressure that splits the disc", "Pa", closed(failure, 2e-2)),
            ]
        }
        "pmma-strip" => {
            let loads = [(35, 610.0), (40, 603.0), (50, 656.0), (60, 684.0)];
            let loads = loads.into_iter().chain([(80, 755.0), (100, 816.0), (140, 896.0), (160, 934.0)]);
            let speed = |(load, speed)| {
                let what = format!("speed of the crack from 8 to 25.6 mm, grips displaced by {load} um");
                asked(&format!("speed_{load}_um"), what, "m/s", Basis::Undecided(speed, PUBLISHED))
            };
            loads.map(speed).collect()
        }
        _ => computed(benchmark),
    }
}

/// What benchmarks ask for whose reference is independent finite elements.
fn computed(benchmark: &str) -> Vec<Asked> {
    match benchmark {
        "strip" => {
            let per_length = |name: &str| {
                let what = format!("{name} energy per length of the crack");
                asked(name, what, "J/m^2", Basis::Elements(&STRIP, name.into()))
            };
            let speed = asked("speed", "speed of the crack", "m/s", Basis::Elements(&STRIP, "speed".into()));
            [speed].into_iter().chain(["fracture", "kinetic", "elastic"].map(per_length)).collect()
        }
        "ring" => {
            let at = |(seed, time)| {
                let reference = format!("seed-{seed}/fracture-energy-{time}-us");
                let what = format!("fracture energy at {time} us, seed {seed}");
                asked(&format!("seed_{seed}_{time}_us"), what, "J/m", Basis::Elements(&RING, reference))
            };
            [1, 2].into_iter().flat_map(|seed| [60, 70, 80, 100].map(|time| (seed, time))).map(at).collect()
        }
        "arrest" => {
            let passes = |length: u32| {
                let what = format!("time at which x of the tip is {length} mm from the end of the slot");
                let reference = Basis::Elements(&ARREST, format!("time-at-{length}-mm"));
                asked(&format!("time_{length}_mm"), what, "s", reference)
            };
            let energy = Basis::Elements(&ARREST, "fracture-energy-200-us".into());
            let length = "x of the arrested tip, from the end of the slot";
            let mut all = vec![
                asked("length", length, "m", Basis::Elements(&ARREST, "length".into())),
                asked("fracture", "fracture energy at 200 us", "J/m", energy),
            ];
            all.extend([5, 10, 15].map(passes));
            all
        }
        _ => Vec::new(),
    }
}

/// The elements behind the numbers of a benchmark, if there are any.
pub fn elements(benchmark: &str) -> Option<&'static Elements> {
    values(benchmark).into_iter().find_map(|asked| match asked.basis {
        Basis::Elements(elements, _) => Some(elements),
        _ => None,
    })
}

fn asked(name: &str, what: impl Into<String>, unit: &'static str, basis: Basis) -> Asked {
    let dimension = match unit {
        "m" => Dimension::LENGTH,
        "s" => Dimension::TIME,
        "m/s" => Dimension::VELOCITY,
        "Pa" => Dimension::STRESS,
        "J/m" => Dimension::FORCE,
        "J/m^2" => Dimension::ENERGY_PER_AREA,
        _ => Dimension::NONE,
    };
    Asked { name: name.into(), what: what.into(), dimension, unit, basis }
}

/// Judges the numbers of a benchmark.
///
/// # Errors
/// No number of the benchmark is there, or the reference is not.
pub fn judge(
    folder: &str,
    submission: &Submission,
    curves: [Option<Curve>; 6],
    library: &Library,
) -> Result<Judged, SceneFileError> {
    let asked = values(&submission.benchmark);
    if submission.values.is_empty() {
        let names: Vec<&str> = asked.iter().map(|a| a.name.as_str()).collect();
        let remedy = format!("add [values] with {}", names.join(", "));
        return Err(submission.key_error("benchmark", "nothing to judge", remedy));
    }
    let elements = elements(&submission.benchmark);
    let differences = match elements {
        Some(elements) => differences(submission, elements),
        None => submission.model.differences.clone(),
    };
    let mut quantities = Vec::new();
    for asked in &asked {
        let find = |all: &[(String, f64)]| all.iter().find(|v| v.0 == asked.name).map(|v| v.1);
        let value = find(&submission.values);
        let mut row = Comparison { name: asked.name.clone(), unit: asked.unit.into(), value, ..Comparison::default() };
        match &asked.basis {
            Basis::Elements(elements, name) => {
                let Some(reference) = elements.value(library, &submission.benchmark, name) else {
                    let message = format!("no reference {}/{}/{name}", elements.folder, submission.benchmark);
                    return Err(submission.key_error("benchmark", message, "restore reference-data"));
                };
                let stated = find(&submission.stated_values);
                elements.compare(&mut row, reference, submission.spacing, stated, "not given");
                if !differences.is_empty() {
                    explained_by_difference(&mut row, true);
                }
            }
            Basis::ClosedForm(known, tolerance) => {
                hold(&mut row, *known);
                decide(&mut row, 0.0, Some(tolerance * known.abs()));
            }
            Basis::Below(bound) => {
                hold(&mut row, *bound);
                let below = value.is_some_and(|v| v > 0.0 && v < *bound);
                row.outcome = if below { Outcome::Diagnostic } else { Outcome::Fail };
                row.why = "an upper bound shows no agreement".into();
            }
            Basis::Undecided(known, why) => {
                hold(&mut row, *known);
                row.why = (*why).into();
            }
        }
        quantities.push(QuantityVerdict { quantity: asked.what.clone(), outcome: row.outcome, comparisons: vec![row] });
    }
    let (uncertainty, numerical) = match (elements, &asked[0].basis) {
        (Some(_), _) => (
            "distance of the finest of three meshes from the limit h to 0; a quarter of their spread at least, all of it \
             below order 1",
            "stated for each number, else 1.25 times what elements of the same spacing are off by",
        ),
        (None, Basis::Undecided(..)) => ("unknown: diagnostic only", "nothing is decided"),
        _ => ("a closed form", "what a sound mesh may be off by, stated with the benchmark"),
    };
    let id = submission.benchmark.clone();
    let label = BENCHMARKS.iter().find(|b| b.name == id).map_or("", |b| b.what).into();
    let reference = ReferenceUsed { id, label, uncertainty: uncertainty.into() };
    let base = Verdict::of(folder, submission, reference, numerical);
    let unknown = elements.is_some() && submission.model.plane == Plane::Unknown;
    let notes = unknown.then(|| "the plane state is unknown; plane stress is assumed".into()).into_iter().collect();
    let mut verdict = Verdict { differences, notes, quantities, ..base };
    verdict.conclude();
    Ok(Judged { verdict, curves, references: Default::default() })
}

fn hold(row: &mut Comparison, known: f64) {
    row.reference = Some(known);
    row.error = row.value.map(|value| value - known);
}
