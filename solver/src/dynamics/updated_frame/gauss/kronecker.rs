//! The mass matrix of the whole patch as a Kronecker product, for preconditioning (Loli, Sangalli & Tani
//! 2022, *Easy and efficient preconditioning of the isogeometric mass matrix*, Computers & Mathematics with
//! Applications 116).
//!
//! ```text
//! P⁻¹ = S (Bx⁻¹ ⊗ By⁻¹) S,      B = ∫ N_i N_j dx + ε h Jᵀ J per direction,      S² = diag(Bx ⊗ By)/diag(A)
//! ```
//!
//! A is the matrix of the present points, with its penalty ([`super::penalty`]). Iterations then depend
//! little on degree, mesh and cut spans.

use super::penalty::jumps;
use crate::linear_algebra::control_grid::ControlGrid;
use crate::scene::Layout;
use crate::splines::patch::Patch;
use crate::splines::quadrature::Rule;
use crate::splines::spline::SplineSpace;

/// Factored product, and its diagonal.
#[derive(Debug, Clone)]
pub(crate) struct Kronecker {
    grid: ControlGrid,
    factors: [BandFactor; 2],
    diagonals: [Vec<f64>; 2],
}

/// Cholesky factor of a symmetric band matrix; row i has its couplings with `i − width` to `i`, the inverse
/// of the pivot in place of the last.
#[derive(Debug, Clone, Default)]
pub(crate) struct BandFactor {
    width: usize,
    rows: Vec<f64>,
}

impl Kronecker {
    /// For a patch and a penalty of weight ε.
    pub(crate) fn new(patch: &Patch, penalty: f64) -> Self {
        let bands = [0, 1].map(|d| band(&patch.spaces[d], penalty));
        let diagonals = bands.each_ref().map(|b| b.rows.chunks(b.width + 1).map(|row| row[b.width]).collect());
        Self { grid: patch.control_grid(), factors: bands.map(BandFactor::factored), diagonals }
    }

    /// S for a matrix with this `diagonal`, of which `mass` is the part without penalty: zero where that is
    /// less than `threshold` times the diagonal of the product. Control points for which it is, and which
    /// are not held, are returned.
    pub(crate) fn scale(
        &self,
        [mass, diagonal]: [&[f64]; 2],
        threshold: f64,
        held: &[Vec<usize>; 2],
        scale: &mut [f64],
    ) -> Vec<usize> {
        let mut weak = Vec::new();
        for at in self.grid.indices().filter(|&at| diagonal[at] > 0.0) {
            let own = self.diagonals[0][self.grid.column_of(at)] * self.diagonals[1][self.grid.row_of(at)];
            let is_weak = mass[at] <= threshold * own && !held.iter().any(|held| held.binary_search(&at).is_ok());
            scale[at] = if is_weak { 0.0 } else { (own / diagonal[at]).sqrt() };
            if is_weak {
                weak.push(at);
            }
        }
        weak
    }

    /// `z ← P⁻¹ z`, zero where S is.
    pub(crate) fn apply(&self, scale: &[f64], z: &mut [f64]) {
        z.iter_mut().zip(scale).for_each(|(z, s)| *z *= s);
        let Self { grid, factors: [x, y], .. } = self;
        for row in z.chunks_mut(grid.stride) {
            x.solve_line(&mut row[grid.index(0, 0)..][..grid.columns]);
        }
        y.solve_rows(z, grid.stride);
        z.iter_mut().zip(scale).for_each(|(z, s)| *z *= s);
    }
}

/// The one-dimensional matrix, not factored.
fn band(space: &SplineSpace, penalty: f64) -> BandFactor {
    let (p, jumps) = (space.degree(), jumps(space));
    let width = jumps.iter().map(|jump| jump.factors.len() - 1).fold(p, usize::max);
    let mut band = BandFactor { width, rows: vec![0.0; space.dimension() * (width + 1)] };
    let rule = Rule::new(Layout::Gauss, p + 1);
    for (number, span) in space.spans().iter().enumerate() {
        for (t, weight) in rule.points.iter().zip(&rule.weights) {
            let values = space.shape_functions(number, span.left + t * span.length()).value;
            band.add(span.first, weight * span.length(), &values[..=p]);
        }
    }
    for (jump, spans) in jumps.iter().zip(space.spans().windows(2)) {
        band.add(jump.first, 0.5 * penalty * (spans[0].length() + spans[1].length()), &jump.factors);
    }
    band
}

impl BandFactor {
    /// A matrix of zeros.
    pub(crate) fn zeros(width: usize, order: usize) -> Self {
        Self { width, rows: vec![0.0; order * (width + 1)] }
    }

    /// Sets an entry of the lower half.
    pub(crate) fn set(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row * (self.width + 1) + self.width - (row - column)] = value;
    }

    /// Adds `weight v vᵀ` from `first` on.
    fn add(&mut self, first: usize, weight: f64, vector: &[f64]) {
        for (i, a) in vector.iter().enumerate() {
            for (j, b) in vector[..=i].iter().enumerate() {
                self.rows[(first + i) * (self.width + 1) + self.width - (i - j)] += weight * a * b;
            }
        }
    }

    /// The factor.
    pub(crate) fn factored(mut self) -> Self {
        let (w, order) = (self.width, self.rows.len() / (self.width + 1));
        for i in 0..order {
            for j in i.saturating_sub(w)..=i {
                let common = j - i.saturating_sub(w).max(j.saturating_sub(w));
                let [left, right] = [i, j].map(|r| &self.rows[r * (w + 1) + w + j - r - common..][..common]);
                let known: f64 = left.iter().zip(right).map(|(a, b)| a * b).sum();
                let rest = self.rows[i * (w + 1) + w + j - i] - known;
                let pivot = self.rows[j * (w + 1) + w];
                self.rows[i * (w + 1) + w + j - i] = if i == j { 1.0 / rest.sqrt() } else { rest * pivot };
            }
        }
        self
    }

    /// Solves in place.
    pub(crate) fn solve_line(&self, x: &mut [f64]) {
        let w = self.width;
        for i in 0..x.len() {
            let row = &self.rows[i * (w + 1)..][..=w];
            let reach = i.min(w);
            let sum: f64 = (1..=reach).map(|k| row[w - k] * x[i - k]).sum();
            x[i] = (x[i] - sum) * row[w];
        }
        for i in (0..x.len()).rev() {
            let row = &self.rows[i * (w + 1)..][..=w];
            x[i] *= row[w];
            for k in 1..=i.min(w) {
                x[i - k] -= row[w - k] * x[i];
            }
        }
    }

    /// The same along columns, a row of control points at a time.
    fn solve_rows(&self, x: &mut [f64], stride: usize) {
        let (w, order) = (self.width, x.len() / stride);
        for i in 0..order {
            let row = &self.rows[i * (w + 1)..][..=w];
            let (before, here) = x.split_at_mut(i * stride);
            let here = &mut here[..stride];
            for k in 1..=i.min(w) {
                let other = &before[(i - k) * stride..][..stride];
                here.iter_mut().zip(other).for_each(|(x, o)| *x -= row[w - k] * o);
            }
            here.iter_mut().for_each(|x| *x *= row[w]);
        }
        for i in (0..order).rev() {
            let row = &self.rows[i * (w + 1)..][..=w];
            let (before, here) = x.split_at_mut(i * stride);
            let here = &mut here[..stride];
            here.iter_mut().for_each(|x| *x *= row[w]);
            for k in 1..=i.min(w) {
                let other = &mut before[(i - k) * stride..][..stride];
                other.iter_mut().zip(here.iter()).for_each(|(o, x)| *o -= row[w - k] * x);
            }
        }
    }
}
