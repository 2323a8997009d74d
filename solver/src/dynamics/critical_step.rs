//! The critical time step of explicit dynamics, from the operator itself.
//!
//! Velocity Verlet is stable up to `2/ω_max` of `M⁻¹ K`. The largest eigenvalue of `M^(−1/2) K M^(−1/2)` of
//! the undamaged body comes from a Lanczos iteration, which approaches it from below; the residual norm of
//! the Ritz vector is added. That puts the value on the safe side but for clusters of eigenvalues, where it
//! was seen 4e-7 too low.
//!
//! Here is ω_max. The step is `critical_step` of each frame, in its file `stiffness.rs`.
//!
//! A formula in the span length alone is not safe: free edges, Poisson's ratio and cut spans all lower the
//! step.

use nalgebra::{DMatrix, SymmetricEigen};

/// Stop when the residual is this fraction of the eigenvalue: half of it in the frequency.
const RESIDUAL: f64 = 0.005;
/// Iterations between two looks at the Ritz values, and most of them.
const STRIDE: usize = 10;
const MOST: usize = 300;

/// A stiffness `K` and a mass `M` on packed degrees of freedom, both symmetric, M positive definite.
pub trait StiffnessOperator {
    /// Number of free degrees of freedom.
    fn size(&self) -> usize;
    /// Writes `K x` to `out`: the forces that answer a displacement x.
    fn stiffness(&mut self, x: &[f64], out: &mut [f64]);
    /// Writes `M⁻¹ x` to `out`: the accelerations under forces x.
    fn divide_by_mass(&mut self, x: &[f64], out: &mut [f64]);
}

/// Bound of the largest angular frequency, rad per unit time (see the module); zero if there is no stiffness,
/// not a number if that is none.
///
/// Lanczos iteration on `M⁻¹ K` in the inner product of M: of every vector q its image `M q` is kept, so M is
/// never applied.
pub fn highest_frequency(operator: &mut impl StiffnessOperator) -> f64 {
    let n = operator.size();
    let mut image = pseudo_random(n); // M times the vector
    let mut vector = vec![0.0; n];
    operator.divide_by_mass(&image, &mut vector);
    let norm = dot(&vector, &image).sqrt();
    for i in 0..n {
        vector[i] /= norm;
        image[i] /= norm;
    }
    let (mut previous, mut residual_image) = (vec![0.0; n], vec![0.0; n]);
    let (mut diagonal, mut off_diagonal) = (Vec::new(), Vec::<f64>::new());
    loop {
        operator.stiffness(&vector, &mut residual_image);
        let beta = off_diagonal.last().copied().unwrap_or(0.0);
        let alpha = dot(&residual_image, &vector);
        for i in 0..n {
            residual_image[i] -= alpha * image[i] + beta * previous[i];
        }
        diagonal.push(alpha);
        operator.divide_by_mass(&residual_image, &mut vector);
        let next = dot(&vector, &residual_image);
        if !(alpha.is_finite() && next.is_finite()) {
            return f64::NAN;
        }
        let next = next.max(0.0).sqrt();
        let exhausted = next <= 1e-12 * diagonal[0].abs() || diagonal.len() == MOST.min(n);
        if exhausted || diagonal.len().is_multiple_of(STRIDE) {
            let (value, residual) = largest_ritz(&diagonal, &off_diagonal, next);
            if exhausted || (residual <= RESIDUAL * value && diagonal.len() >= 4 * STRIDE) {
                return (value + residual).max(0.0).sqrt();
            }
        }
        off_diagonal.push(next);
        std::mem::swap(&mut previous, &mut image);
        for i in 0..n {
            image[i] = residual_image[i] / next;
            vector[i] /= next;
        }
    }
}

/// Largest Ritz value and the residual norm of its vector.
fn largest_ritz(diagonal: &[f64], off_diagonal: &[f64], next: f64) -> (f64, f64) {
    let k = diagonal.len();
    let matrix = DMatrix::from_fn(k, k, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off_diagonal[i.min(j)],
        _ => 0.0,
    });
    let eigen = SymmetricEigen::new(matrix);
    let largest = eigen.eigenvalues.imax();
    (eigen.eigenvalues[largest], next * eigen.eigenvectors[(k - 1, largest)].abs())
}

/// The same start for the same size: a linear congruential sequence in [−1, 1).
fn pseudo_random(n: usize) -> Vec<f64> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..n).map(|_| next()).collect()
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
