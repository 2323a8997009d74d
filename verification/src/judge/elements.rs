//! Values of independent finite elements as references, extrapolated to h = 0, and their uncertainty.

use super::curves::{AGREES, DECIDES, SAFETY, decide, doubt};
use super::model::Plane;
use super::submission::Submission;
use super::verdict::Comparison;
use crate::reference::{Library, ReferenceValue};

/// What the elements of a benchmark computed.
#[derive(Debug)]
pub struct Elements {
    benchmark: &'static str,
    /// Folder of the values.
    pub folder: &'static str,
    /// Phase-field models.
    models: &'static [&'static str],
    /// Whether all is in plane stress.
    plane_stress: bool,
    /// Split of the energy.
    split: &'static str,
    /// l0, half of b of AT1, m.
    length_scale: f64,
    /// Spacing of the finest elements, whose distance from the limit is the uncertainty, m.
    finest: f64,
}

const ALL: [Elements; 4] = [
    Elements {
        folder: "kalthoff",
        models: &["AT1", "AT2", "none"],
        plane_stress: false,
        finest: 0.125e-3,
        ..at1("kalthoff", "spectral", 0.75e-3)
    },
    Elements { finest: 31.25e-6, ..at1("strip", "spectral", 0.25e-3) },
    Elements { finest: 0.5e-3, ..at1("ring", "rankine", 0.75e-3) },
    Elements { finest: 18.75e-6, ..at1("arrest", "rankine", 18.75e-6) },
];

const fn at1(benchmark: &'static str, split: &'static str, length_scale: f64) -> Elements {
    let (folder, models) = ("at1-benchmarks", &["AT1"]);
    Elements { benchmark, folder, models, plane_stress: true, split, length_scale, finest: 0.0 }
}

impl Elements {
    /// Those of a benchmark, if it has any.
    pub fn of(benchmark: &str) -> Option<&'static Self> {
        ALL.iter().find(|elements| elements.benchmark == benchmark)
    }

    /// The value called `part/name`.
    pub fn value<'a>(&self, library: &'a Library, part: &str, name: &str) -> Option<&'a ReferenceValue> {
        library.value(self.folder, &format!("{part}/{name}"))
    }

    /// Holds a value against its reference; without a `stated` uncertainty with that of elements of the
    /// spacing, in proportion to their size.
    pub fn compare(&self, row: &mut Comparison, reference: &ReferenceValue, spacing: Option<f64>, stated: Option<f64>) {
        row.reference = Some(reference.value);
        row.error = row.value.map(|value| value - reference.value);
        let u_ref = reference.uncertainty.unwrap_or(0.0);
        decide(row, u_ref, stated.or(spacing.map(|spacing| SAFETY * u_ref * spacing / self.finest)));
        match row.value {
            Some(_) => doubt(row, [DECIDES[0], AGREES[0]].map(|part| part * reference.value.abs())),
            None => row.why = "not given, not reached, or between rows more than 2 µs apart".into(),
        }
    }
}

/// What the declared model has that the reference has not.
pub fn differences(submission: &Submission, elements: &Elements) -> Vec<String> {
    let model = &submission.model;
    let mut out = model.differences.clone();
    if !elements.models.contains(&model.phase_field.as_str()) {
        out.push(format!("phase-field model {} instead of {}", model.crack_model(), elements.models[0]));
    }
    if elements.plane_stress && model.plane == Plane::Strain {
        out.push("plane strain instead of plane stress".into());
    }
    if ![elements.split, "unknown"].contains(&model.split.as_str()) {
        out.push(format!("split {:?} instead of {:?}", model.split, elements.split));
    }
    let ours = elements.length_scale;
    if let Some(l) = model.length_scale.filter(|l| (l / ours - 1.0).abs() > 0.01) {
        out.push(format!("l0 = {} mm in Borden's convention instead of {} mm", l * 1e3, ours * 1e3));
    }
    out
}
