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
use crate::linear_algebra::lane::{LANES, Lane, Vectorised, add_product, dispatch};
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
        dispatch(ApplyProduct { product: self, scale, z });
    }
}

/// `z ← P⁻¹ z`.
struct ApplyProduct<'a> {
    product: &'a Kronecker,
    scale: &'a [f64],
    z: &'a mut [f64],
}

impl Vectorised for ApplyProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { product: Kronecker { grid, factors: [x, y], .. }, scale, z } = self;
        z.iter_mut().zip(scale).for_each(|(z, s)| *z *= s);
        let mut lines = vec![0.0; grid.columns * LANES];
        for rows in z.chunks_mut(LANES * grid.stride) {
            for (l, row) in rows.chunks(grid.stride).enumerate() {
                let row = &row[grid.index(0, 0)..][..grid.columns];
                lines.iter_mut().skip(l).step_by(LANES).zip(row).for_each(|(line, value)| *line = *value);
            }
            x.solve_rows::<FMA>(&mut lines, LANES);
            for (l, row) in rows.chunks_mut(grid.stride).enumerate() {
                let row = &mut row[grid.index(0, 0)..][..grid.columns];
                row.iter_mut().zip(lines.iter().skip(l).step_by(LANES)).for_each(|(value, line)| *value = *line);
            }
        }
        y.solve_rows::<FMA>(z, grid.stride);
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
        dispatch(SolveLine { factor: self, x });
    }

    /// Couplings of a row with the unknowns before it, as far as there are any, and the inverse of its pivot.
    #[inline(always)]
    fn row(&self, i: usize) -> (&[f64], f64) {
        let w = self.width;
        let row = &self.rows[i * (w + 1)..][..=w];
        (&row[w - i.min(w)..w], row[w])
    }

    /// Solves as many lines side by side as a row of `x` is long.
    #[inline(always)]
    fn solve_rows<const FMA: bool>(&self, x: &mut [f64], stride: usize) {
        let order = x.len() / stride;
        for i in 0..order {
            let (couplings, pivot) = self.row(i);
            let (before, here) = x.split_at_mut(i * stride);
            let here = &mut here[..stride];
            let others = before[(i - couplings.len()) * stride..].chunks_exact(stride);
            for (coupling, other) in couplings.iter().zip(others) {
                here.iter_mut().zip(other).for_each(|(x, o)| *x = add_product::<FMA, _>(*x, -coupling, *o));
            }
            here.iter_mut().for_each(|x| *x *= pivot);
        }
        for i in (0..order).rev() {
            let (couplings, pivot) = self.row(i);
            let (before, here) = x.split_at_mut(i * stride);
            let here = &mut here[..stride];
            here.iter_mut().for_each(|x| *x *= pivot);
            let others = before[(i - couplings.len()) * stride..].chunks_exact_mut(stride);
            for (coupling, other) in couplings.iter().zip(others) {
                other.iter_mut().zip(&*here).for_each(|(o, x)| *o = add_product::<FMA, _>(*o, -coupling, *x));
            }
        }
    }
}

/// Solves one line in place: the couplings of a row side by side.
struct SolveLine<'a> {
    factor: &'a BandFactor,
    x: &'a mut [f64],
}

impl Vectorised for SolveLine<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { factor, x } = self;
        for i in 0..x.len() {
            let (couplings, pivot) = factor.row(i);
            let (before, here) = x.split_at_mut(i);
            here[0] = (here[0] - product::<FMA>(couplings, &before[i - couplings.len()..])) * pivot;
        }
        for i in (0..x.len()).rev() {
            let (couplings, pivot) = factor.row(i);
            let (before, here) = x.split_at_mut(i);
            here[0] *= pivot;
            let others = &mut before[i - couplings.len()..];
            for (other, coupling) in others.iter_mut().zip(couplings) {
                *other = add_product::<FMA, _>(*other, -coupling, here[0]);
            }
        }
    }
}

/// `a · b`.
#[inline(always)]
fn product<const FMA: bool>(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = Lane::ZERO;
    let whole = a.len() / LANES * LANES;
    for at in (0..whole).step_by(LANES) {
        sums = sums.add_product::<FMA>(Lane::load(a, at), Lane::load(b, at));
    }
    let mut sum = sums.sum();
    for (a, b) in a[whole..].iter().zip(&b[whole..]) {
        sum = add_product::<FMA, _>(sum, *a, *b);
    }
    sum
}
