//! Symmetric matrices on the control points of a patch, as half a stencil per control point.
//!
//! Basis functions of a tensor-product patch overlap only within `p` columns and `q` rows, so a symmetric
//! matrix has the couplings of each control point with itself and the ones after it: `(2 p + 1) q + p + 1`
//! numbers, kept row of control points by row of control points. Applying it reads every coefficient once
//! from memory.

use rayon::prelude::*;

use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::lane::{LANES, Lane, Vectorised, dispatch};

/// Rows of control points whose partial sums are formed together.
pub(crate) const CHUNK_ROWS: usize = 8;

/// A coupling within the half stencil.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Offset {
    /// Columns ahead, −p to p; at least zero in the same row.
    pub columns: isize,
    /// Rows ahead, 0 to q.
    pub rows: usize,
}

/// Symmetric matrix on a control grid.
#[derive(Debug, Clone)]
pub struct Stencil {
    /// Layout of the control points.
    pub grid: ControlGrid,
    degree: [usize; 2],
    offsets: Vec<Offset>,
    coefficients: Vec<f64>,
}

impl Stencil {
    /// The zero matrix for a patch of `degree`.
    pub fn zeros(grid: ControlGrid, degree: [usize; 2]) -> Self {
        let offsets = half_stencil(degree);
        let coefficients = vec![0.0; offsets.len() * grid.len()];
        Self { grid, degree, offsets, coefficients }
    }

    /// Couplings of the half stencil; the first is the diagonal.
    pub fn offsets(&self) -> &[Offset] {
        &self.offsets
    }

    /// Degree in x and y.
    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// Position of a coupling in [`Self::offsets`].
    #[inline(always)]
    pub fn offset_index(degree: [usize; 2], columns: isize, rows: usize) -> usize {
        let p = degree[0] as isize;
        if rows == 0 { columns as usize } else { (p + 1 + (rows as isize - 1) * (2 * p + 1) + columns + p) as usize }
    }

    /// Numbers per row of control points.
    pub fn row_length(&self) -> usize {
        self.offsets.len() * self.grid.stride
    }

    /// Coefficients of coupling `offset` along a row of control points, with the room of a field row around
    /// them.
    #[inline(always)]
    pub fn row(&self, row: usize, offset: usize) -> &[f64] {
        let start = row * self.row_length() + offset * self.grid.stride;
        &self.coefficients[start..start + self.grid.stride]
    }

    /// All coefficients, [`Self::row_length`] for each row of control points.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// All coefficients, for assembly.
    pub fn coefficients_mut(&mut self) -> &mut [f64] {
        &mut self.coefficients
    }

    pub(crate) fn values_mut(&mut self) -> &mut Vec<f64> {
        &mut self.coefficients
    }

    /// Diagonal entry of a control point.
    pub fn diagonal(&self, column: usize, row: usize) -> f64 {
        self.row(row, 0)[self.grid.index(column, 0)]
    }

    /// Sets the diagonal entry of a control point.
    pub fn set_diagonal(&mut self, column: usize, row: usize, value: f64) {
        let at = row * self.row_length() + self.grid.index(column, 0);
        self.coefficients[at] = value;
    }

    /// `out = A x`; returns `xᵀ A x`.
    pub fn apply(&self, x: &[f64], out: &mut [f64]) -> f64 {
        let chunk = CHUNK_ROWS * self.grid.stride;
        let parts: Vec<f64> = out
            .par_chunks_mut(chunk)
            .enumerate()
            .map(|(index, out)| dispatch(ApplyRows { matrix: self, x, out, first_row: index * CHUNK_ROWS }))
            .collect();
        parts.iter().sum()
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        8 * self.coefficients.len()
    }
}

fn half_stencil([p, q]: [usize; 2]) -> Vec<Offset> {
    let p = p as isize;
    let same_row = (0..=p).map(|columns| Offset { columns, rows: 0 });
    let rows_ahead = (1..=q).flat_map(|rows| (-p..=p).map(move |columns| Offset { columns, rows }));
    same_row.chain(rows_ahead).collect()
}

struct ApplyRows<'a> {
    matrix: &'a Stencil,
    x: &'a [f64],
    out: &'a mut [f64],
    first_row: usize,
}

impl Vectorised for ApplyRows<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FMA: bool>(self) -> f64 {
        let grid = self.matrix.grid;
        let mut product = Lane::ZERO;
        for (local, out) in self.out.chunks_exact_mut(grid.stride).enumerate() {
            let row = self.first_row + local;
            for column in (0..grid.columns).step_by(LANES) {
                let at = grid.index(column, 0);
                let mut sum = Lane::ZERO;
                for (index, offset) in self.matrix.offsets.iter().enumerate() {
                    if row + offset.rows < grid.rows {
                        let there = (at + (row + offset.rows) * grid.stride).wrapping_add_signed(offset.columns);
                        let coefficient = Lane::load(self.matrix.row(row, index), at);
                        sum = sum.add_product::<FMA>(coefficient, Lane::load(self.x, there));
                    }
                    if index > 0 && row >= offset.rows {
                        let here = at.wrapping_add_signed(-offset.columns);
                        let coefficient = Lane::load(self.matrix.row(row - offset.rows, index), here);
                        let there = here + (row - offset.rows) * grid.stride;
                        sum = sum.add_product::<FMA>(coefficient, Lane::load(self.x, there));
                    }
                }
                let used = (grid.columns - column).min(LANES);
                out[at..at + used].copy_from_slice(&sum.0[..used]);
                product += sum * Lane::load(self.x, at + row * grid.stride);
            }
        }
        product.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;
    use crate::splines::patch::Patch;

    #[test]
    fn applying_the_half_stencil_equals_the_full_matrix() {
        let patch = Patch::new(&Mesh::uniform([2, 3], [0.0; 2], [1.0; 2], [11, 9]));
        let grid = patch.control_grid();
        let mut matrix = Stencil::zeros(grid, [2, 3]);
        let n = grid.columns * grid.rows;
        let mut full = nalgebra::DMatrix::<f64>::zeros(n, n);
        for row in 0..grid.rows {
            for column in 0..grid.columns {
                for (index, offset) in matrix.offsets.clone().into_iter().enumerate() {
                    let (c, r) = (column as isize + offset.columns, row + offset.rows);
                    if c < 0 || c as usize >= grid.columns || r >= grid.rows {
                        continue;
                    }
                    let value = ((row * 31 + column * 17 + index * 7) % 13) as f64 - 5.0;
                    let at = row * matrix.row_length() + index * grid.stride + grid.index(column, 0);
                    matrix.coefficients[at] = value;
                    let (i, j) = (row * grid.columns + column, r * grid.columns + c as usize);
                    full[(i, j)] = value;
                    full[(j, i)] = value;
                }
            }
        }
        let mut x = grid.zeros();
        for (i, at) in grid.indices().enumerate() {
            x[at] = ((i * i) % 7) as f64 - 3.0;
        }
        let mut out = grid.zeros();
        let product = matrix.apply(&x, &mut out);
        let packed = nalgebra::DVector::from_iterator(n, grid.indices().map(|at| x[at]));
        let expected = &full * &packed;
        for (i, at) in grid.indices().enumerate() {
            assert_eq!(out[at], expected[i], "integers are summed exactly");
        }
        assert_eq!(product, packed.dot(&expected));
    }
}
