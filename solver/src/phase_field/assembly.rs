//! Matrices `Σ_p f_p N_I N_J` and `Σ_p f_p grad N_I · A grad N_J` from the material points of a lattice (E
//! 19–24).
//!
//! Over a rectangle by sum factorisation: points of a span form a grid, so the sum over them is done first
//! along x, for every pair of functions in x, then along y. On a patch with a geometry, in spans that the
//! boundary cuts and with a tensor A, pair by pair (`assembly/pairs.rs`).
//!
//! Strips are assembled in two colours: strips of one colour share no control row, and the order in which
//! contributions meet does not depend on the number of threads.

mod form;
mod pairs;

use rayon::prelude::*;

pub use form::{Constant, Integrand, PointCoefficients};
pub(crate) use form::{Increments, Scaled, changed};

use crate::linear_algebra::lane::{Lane, Vectorised, dispatch};
use crate::linear_algebra::stencil::Stencil;
use crate::particles::lattice::{Lattice, Row, Tile};
use crate::splines::quadrature::MAX_POINTS;
use crate::splines::spline::MAX_ORDER;

/// Which function of a direction enters a product.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ShapeFactor {
    Value,
    Derivative,
}

/// Adds `Σ_p f_p N_I N_J` or `Σ_p f_p grad N_I · grad N_J` to `matrix`.
pub fn add_form<C: PointCoefficients>(matrix: &mut Stencil, lattice: &Lattice, form: Integrand, coefficients: &C) {
    use ShapeFactor::{Derivative, Value};
    let by_pairs = lattice.mapping.is_some() || matches!(form, Integrand::Anisotropic(_));
    if by_pairs {
        for_each_strip(matrix, lattice, |strip, first_row, window| {
            pairs::assemble(lattice, form, coefficients, strip, first_row, window);
        });
    }
    for strip in lattice.table_strips()..lattice.strips() {
        let rows = lattice.strip_patch_rows(strip);
        let row_length = matrix.row_length();
        let window = &mut matrix.coefficients_mut()[rows.start * row_length..rows.end * row_length];
        pairs::assemble_cut(lattice, form, coefficients, strip, rows.start, window);
    }
    let products: &[[ShapeFactor; 2]] = match form {
        _ if by_pairs => &[],
        Integrand::Mass => &[[Value, Value]],
        Integrand::Diffusion => &[[Derivative, Value], [Value, Derivative]],
        Integrand::Anisotropic(_) => &[],
    };
    for &factors in products {
        for_each_strip(matrix, lattice, |strip, first_row, window| {
            dispatch(AssembleLattice { lattice, factors, coefficients, strip, first_row, window });
        });
    }
}

/// Calls `assemble` with every strip, its first control row, and the part of the matrix it contributes to;
/// strips of one colour in parallel, those of sheets one by one.
fn for_each_strip(matrix: &mut Stencil, lattice: &Lattice, assemble: impl Fn(usize, usize, &mut [f64]) + Sync) {
    let row_length = matrix.row_length();
    for colour in 0..2 {
        let mut windows = Vec::new();
        let (mut rest, mut passed) = (&mut matrix.coefficients_mut()[..], 0);
        for strip in (colour..lattice.patch_strips()).step_by(2) {
            let rows = lattice.strip_control_rows(strip);
            let (_, tail) = std::mem::take(&mut rest).split_at_mut((rows.start - passed) * row_length);
            let (window, tail) = tail.split_at_mut(rows.len() * row_length);
            windows.push((strip, rows.start, window));
            (rest, passed) = (tail, rows.end);
        }
        windows.into_par_iter().for_each(|(strip, first_row, window)| assemble(strip, first_row, window));
    }
    for strip in lattice.patch_strips()..lattice.table_strips() {
        let rows = lattice.strip_patch_rows(strip);
        let window = &mut matrix.coefficients_mut()[rows.start * row_length..rows.end * row_length];
        assemble(strip, rows.start, window);
    }
}

struct AssembleLattice<'a, C> {
    lattice: &'a Lattice,
    factors: [ShapeFactor; 2],
    coefficients: &'a C,
    strip: usize,
    first_row: usize,
    window: &'a mut [f64],
}

impl<C: PointCoefficients> Vectorised for AssembleLattice<'_, C> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Lattice { degree: [p, q], points: [nx, ny], .. } = *self.lattice;
        match (p, q, nx, ny) {
            (2, 2, 2, 2) => self.walk::<FMA>(3, 3, 2, 2),
            (3, 3, 2, 2) => self.walk::<FMA>(4, 4, 2, 2),
            (3, 3, 3, 3) => self.walk::<FMA>(4, 4, 3, 3),
            _ => self.walk::<FMA>(p + 1, q + 1, nx, ny),
        }
    }
}

/// Pairs of functions `k <= l` of one direction.
const PAIRS: usize = MAX_ORDER * (MAX_ORDER + 1) / 2;

impl<C: PointCoefficients> AssembleLattice<'_, C> {
    #[inline(always)]
    fn walk<const FMA: bool>(mut self, kx: usize, ky: usize, nx: usize, ny: usize) {
        let lattice = self.lattice;
        let mut weights = [Lane::ZERO; MAX_POINTS * MAX_POINTS];
        let mut scaled = [Lane::ZERO; MAX_POINTS * MAX_POINTS];
        let mut sums = [Lane::ZERO; MAX_POINTS * PAIRS];
        for row_index in lattice.strip_rows(self.strip) {
            let row = &lattice.rows[row_index];
            for (tile_index, tile) in lattice.tiles.iter().enumerate() {
                if !lattice.is_occupied(self.strip, tile_index) {
                    continue;
                }
                for b in 0..ny {
                    for a in 0..nx {
                        weights[b * nx + a] = lattice.weight(row_index, tile_index, b, a);
                    }
                }
                let first = lattice.batch(row_index, tile_index, 0, 0);
                if self.coefficients.span(first, &weights[..nx * ny], &mut scaled[..nx * ny]) {
                    self.sum_in_x::<FMA>(tile, &scaled, &mut sums, kx, nx, ny);
                    self.sum_in_y::<FMA>(row, tile, &sums, kx, ky, ny);
                }
            }
        }
    }

    /// Per pair of functions in x and point row b: `Σ_a f_ab X_k(a) X_l(a)`.
    #[inline(always)]
    fn sum_in_x<const FMA: bool>(
        &self,
        tile: &Tile,
        scaled: &[Lane],
        sums: &mut [Lane],
        kx: usize,
        nx: usize,
        ny: usize,
    ) {
        let table = match self.factors[0] {
            ShapeFactor::Value => &tile.value,
            ShapeFactor::Derivative => &tile.derivative,
        };
        let mut pair = 0;
        for k in 0..kx {
            for l in k..kx {
                let mut sum = [Lane::ZERO; MAX_POINTS];
                for a in 0..nx {
                    let product = table[a * kx + k] * table[a * kx + l];
                    for b in 0..ny {
                        sum[b] = sum[b].add_product::<FMA>(product, scaled[b * nx + a]);
                    }
                }
                sums[pair * ny..(pair + 1) * ny].copy_from_slice(&sum[..ny]);
                pair += 1;
            }
        }
    }

    /// Per pair of functions in y, into the couplings of the half stencil.
    #[inline(always)]
    fn sum_in_y<const FMA: bool>(&mut self, row: &Row, tile: &Tile, sums: &[Lane], kx: usize, ky: usize, ny: usize) {
        let table = match self.factors[1] {
            ShapeFactor::Value => &row.value,
            ShapeFactor::Derivative => &row.derivative,
        };
        let stride = self.lattice.grid.stride;
        let (p, half) =
            (kx - 1, self.lattice.degree[0] + 1 + self.lattice.degree[1] * (2 * self.lattice.degree[0] + 1));
        for lower in 0..ky {
            let control_row = row.first - row.lift + lower - self.first_row;
            let base = control_row * half * stride + self.lattice.grid.index(tile.first, 0);
            for upper in lower..ky {
                let mut products = [0.0; MAX_POINTS];
                for b in 0..ny {
                    products[b] = table[b][lower] * table[b][upper];
                }
                let mut pair = 0;
                for k in 0..kx {
                    for l in k..kx {
                        let mut sum = Lane::ZERO;
                        for b in 0..ny {
                            sum = sum.add_scaled::<FMA>(sums[pair * ny + b], products[b]);
                        }
                        pair += 1;
                        let ahead = Stencil::offset_index([p, ky - 1], (l - k) as isize, upper - lower);
                        sum.add_to(self.window, base + ahead * stride + k);
                        if upper > lower && l > k {
                            let behind = Stencil::offset_index([p, ky - 1], k as isize - l as isize, upper - lower);
                            sum.add_to(self.window, base + behind * stride + l);
                        }
                    }
                }
            }
        }
    }
}
