//! What a matrix of the phase field integrates, with which coefficients.

use crate::linear_algebra::lane::Lane;

/// What is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrand {
    /// `N_I N_J`.
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
