//! Errors of a run of the plate, by its energies.

use super::record::AnswerError;
use crate::extremes::{larger, largest};
use crate::output::history::Table;
use crate::reference::{ReferenceCurve, relative_rms};

/// Window of the comparison, s.
const WINDOW: [f64; 2] = [5e-6, 80e-6];
/// Tolerance of the phase field against which others are held.
pub const TIGHT_TOLERANCE: f64 = 2e-8;

/// Kinetic energy, times a factor, against the finite elements.
pub fn error_of_kinetic(
    seconds: &[f64],
    kinetic: &[f64],
    factor: f64,
    reference: &ReferenceCurve,
) -> Option<AnswerError> {
    let kinetic: Vec<f64> = kinetic.iter().map(|k| factor * k).collect();
    let value = (kinetic.len() == seconds.len())
        .then(|| relative_rms(reference, seconds, &kinetic, WINDOW[0], WINDOW[1]))??;
    Some(AnswerError {
        quantity: "kinetic energy, relative rms from 5 to 80 µs".into(),
        value,
        reference: reference.label.clone(),
        uncertainty: reference.uncertainty_relative,
    })
}

/// Largest difference of kinetic, elastic and fracture energy from those of another run, over the largest
/// value of each.
pub fn difference_of_energies(history: &Table, other: &Table) -> Option<AnswerError> {
    let mut value = 0.0;
    for name in ["kinetic_j", "elastic_j", "fracture_j"] {
        let (ours, theirs) = (history.column(name)?, other.column(name)?);
        let size = largest(theirs.iter().map(|x| x.abs()));
        let pairs = (ours.len() == theirs.len() && size > 0.0).then(|| ours.iter().zip(theirs))?;
        value = larger(value, largest(pairs.map(|(a, b)| (a - b).abs() / size)));
    }
    Some(AnswerError {
        quantity: "largest relative difference of an energy".into(),
        value,
        reference: format!("tolerance {TIGHT_TOLERANCE:e}"),
        uncertainty: 0.0,
    })
}
