//! Values of independent finite elements as references, extrapolated to h = 0, and their uncertainty.

use serde::Deserialize;

use super::curves::{AGREES, DECIDES, SAFETY, decide, doubt};
use super::model::Plane;
use super::submission::Submission;
use super::verdict::Comparison;
use crate::reference::{Library, ReferenceValue};

/// What the elements of a benchmark computed.
#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Elements {
    /// Folder of the values.
    pub folder: String,
    /// Phase-field models.
    models: Vec<String>,
    /// Whether all is in plane stress.
    plane_stress: bool,
    /// Split of the energy.
    pub split: String,
    /// l0, half of b of AT1, m.
    pub length_scale: f64,
    /// Spacing of the finest elements, m.
    finest: f64,
}

impl Elements {
    /// The value called `part/name`.
    pub fn value<'a>(&self, library: &'a Library, part: &str, name: &str) -> Option<&'a ReferenceValue> {
        library.value(&self.folder, &format!("{part}/{name}"))
    }

    /// Holds a value against its reference; without a `stated` uncertainty with that of elements of the
    /// spacing, in proportion to their size. `missing` says why there may be no value.
    pub fn compare(
        &self,
        row: &mut Comparison,
        reference: &ReferenceValue,
        spacing: Option<f64>,
        stated: Option<f64>,
        missing: &str,
    ) {
        row.reference = Some(reference.value);
        row.error = row.value.map(|value| value - reference.value);
        let u_ref = reference.uncertainty.unwrap_or(0.0);
        decide(row, u_ref, stated.or(spacing.map(|spacing| SAFETY * u_ref * spacing / self.finest)));
        match row.value {
            Some(_) => doubt(row, [DECIDES[0], AGREES[0]].map(|part| part * reference.value.abs())),
            None => row.why = missing.into(),
        }
    }
}

/// What the declared model has that the reference has not.
pub fn differences(submission: &Submission, elements: &Elements) -> Vec<String> {
    let model = &submission.model;
    let mut out = model.differences.clone();
    if !elements.models.contains(&model.phase_field) {
        out.push(format!("phase-field model {} instead of {}", model.crack_model(), elements.models[0]));
    }
    if elements.plane_stress && model.plane == Plane::Strain {
        out.push("plane strain instead of plane stress".into());
    }
    if model.phase_field == "none" {
        return out;
    }
    if ![elements.split.as_str(), "unknown"].contains(&model.split.as_str()) {
        out.push(format!("split {:?} instead of {:?}", model.split, elements.split));
    }
    let ours = elements.length_scale;
    if let Some(l) = model.length_scale.filter(|l| (l / ours - 1.0).abs() > 0.01) {
        out.push(format!("l0 = {} mm in Borden's convention instead of {} mm", l * 1e3, ours * 1e3));
    }
    out
}
