//! Changes of the energies of the points that are to be added to the matrix of the phase field.

use crate::linear_algebra::lane::Lane;
use crate::phase_field::assembly::PointCoefficients;

/// Whether the energy of a span row of a tile changed by more than the threshold.
#[inline(always)]
pub(super) fn changed(assembled: &[Lane], history: &[Lane], threshold: f64) -> bool {
    let mut most = Lane::ZERO;
    for (assembled, history) in assembled.iter().zip(history) {
        most = (*history - *assembled).at_least(*assembled - *history).at_least(most);
    }
    most.0.iter().any(|&change| change > threshold)
}

/// What the energies of the points changed by since they were added, as reactions.
pub(super) struct Increments<'a, F> {
    /// Energies now, and those that are in the matrix, J/m³.
    pub history: &'a [Lane],
    pub assembled: &'a [Lane],
    /// Reaction per energy, m³/J.
    pub reaction: f64,
    /// Whether a cell with these energies, assembled and now, is to be added.
    pub takes: &'a F,
}

impl<F: Fn(usize, &[Lane], &[Lane]) -> bool + Sync> PointCoefficients for Increments<'_, F> {
    #[inline(always)]
    fn span(&self, first: usize, weights: &[Lane], out: &mut [Lane]) -> bool {
        let range = first..first + weights.len();
        let (history, assembled) = (&self.history[range.clone()], &self.assembled[range]);
        if !(self.takes)(first / weights.len(), assembled, history) {
            return false;
        }
        for i in 0..weights.len() {
            out[i] = (history[i] - assembled[i]) * weights[i] * self.reaction;
        }
        true
    }
}
