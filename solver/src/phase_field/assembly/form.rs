//! What a matrix of the phase field integrates, with which coefficients: among them the changes of the
//! energies of the points that are to be added to it.

use crate::linear_algebra::lane::Lane;

/// What is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrand {
    /// Product `N_I N_J` of the values of two shape functions.
    Mass,
    /// `grad N_I · grad N_J`.
    Diffusion,
    /// `grad N_I · A grad N_J` with a tensor A, `[xx, yy, xy]`.
    Anisotropic([f64; 3]),
}

/// Coefficients of the points of a strip, batch by batch from the start of the strip.
pub trait PointCoefficients: Sync {
    /// Coefficient times weight of as many batches as one span row of a tile has, beginning at batch `first`
    /// of the whole lattice; `false` if they are all zero.
    fn span(&self, first: usize, weights: &[Lane], out: &mut [Lane]) -> bool;
}

/// Values at the points times a number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scaled<'a>(pub &'a [Lane], pub f64);

impl PointCoefficients for Scaled<'_> {
    #[inline(always)]
    fn span(&self, first: usize, weights: &[Lane], out: &mut [Lane]) -> bool {
        for ((out, weight), value) in out.iter_mut().zip(weights).zip(&self.0[first..]) {
            *out = *weight * *value * self.1;
        }
        true
    }
}

/// The same coefficient everywhere.
#[derive(Debug, Clone, Copy)]
pub struct Constant(pub f64);

impl PointCoefficients for Constant {
    #[inline(always)]
    fn span(&self, _first: usize, weights: &[Lane], out: &mut [Lane]) -> bool {
        for (out, weight) in out.iter_mut().zip(weights) {
            *out = *weight * self.0;
        }
        true
    }
}

/// Whether the energy of a span row of a tile changed by more than the threshold.
#[inline(always)]
pub(crate) fn changed(assembled: &[Lane], history: &[Lane], threshold: f64) -> bool {
    let mut most = Lane::ZERO;
    for (assembled, history) in assembled.iter().zip(history) {
        most = (*history - *assembled).at_least(*assembled - *history).at_least(most);
    }
    most.0.iter().any(|&change| change > threshold)
}

/// What the energies of the points changed by since they were added, as reactions.
pub(crate) struct Increments<'a, F> {
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
