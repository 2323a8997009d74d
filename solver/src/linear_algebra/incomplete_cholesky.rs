//! Incomplete Cholesky factorisation `A ≈ L D Lᵀ` without fill, in the stencil of the matrix.
//!
//! The factor keeps couplings within blocks of rows only, so blocks are factored and solved independently
//! (block Jacobi between them). Blocks come from the number of rows, never from the number of threads.
//!
//! It is kept in single precision: what it is applied with takes as long as reading it, it stays symmetric
//! and positive definite, and conjugate gradients work in double precision around it.

use rayon::prelude::*;

use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::{LANES, Lane, Vectorised, add_product, dispatch};
use crate::linear_algebra::stencil::{Offset, Stencil};

/// Rows of control points in a block.
const BLOCK_ROWS: usize = 24;
/// Least pivot beside the diagonal of the matrix; with a smaller one the diagonal of the block is raised.
const LEAST_PIVOT: f64 = 1e-3;
/// Relative shifts of the diagonal: the first that is tried, how it grows, and the last.
const FIRST_SHIFT: f64 = 1e-3;
const SHIFT_GROWTH: f64 = 4.0;
const LARGEST_SHIFT: f64 = 1e3;
/// Shift up to which a factor still stands for its matrix.
const MODERATE_SHIFT: f64 = 0.1;

/// A product of two factor entries that falls into the stencil: `A[i + first, i + second] −= L L D`.
#[derive(Debug, Clone, Copy)]
struct Update {
    first: usize,
    second: usize,
    target: usize,
}

/// Factor of the blocks of a stencil matrix.
#[derive(Debug, Clone)]
pub struct IncompleteCholesky {
    grid: ControlGrid,
    offsets: Vec<Offset>,
    updates: Vec<Update>,
    /// Like the coefficients of the matrix: 1/D in place of the diagonal, L elsewhere.
    factor: Vec<f32>,
    /// Largest shift of a block.
    shift: f64,
}

impl IncompleteCholesky {
    /// Factors `matrix`.
    pub fn new(matrix: &Stencil) -> Self {
        let offsets = matrix.offsets().to_vec();
        let updates = updates(&offsets, matrix.degree());
        let factor = vec![0.0; matrix.coefficients().len()];
        let mut factor = Self { grid: matrix.grid, offsets, updates, factor, shift: 0.0 };
        factor.refactor(matrix);
        factor
    }

    /// Factors `matrix` again in the same memory.
    pub fn refactor(&mut self, matrix: &Stencil) {
        let block = BLOCK_ROWS * matrix.row_length();
        let Self { grid, offsets, updates, factor, .. } = self;
        let blocks = factor.par_chunks_mut(block).zip(matrix.coefficients().par_chunks(block));
        let shifts = blocks.map(|(factor, matrix)| {
            let (mut block, mut shift) = (vec![0.0; matrix.len()], 0.0);
            while !factor_block(*grid, offsets, updates, shift, matrix, &mut block) && shift < LARGEST_SHIFT {
                shift = (SHIFT_GROWTH * shift).max(FIRST_SHIFT);
            }
            factor.iter_mut().zip(block).for_each(|(single, double)| *single = double as f32);
            shift
        });
        self.shift = shifts.reduce(|| 0.0, larger);
    }

    /// `out = (L D Lᵀ)⁻¹ r`; returns `rᵀ out`.
    pub fn apply(&self, r: &[f64], out: &mut [f64]) -> f64 {
        let rows = BLOCK_ROWS * self.grid.stride;
        let length = self.offsets.len() * rows;
        let parts: Vec<f64> = out
            .par_chunks_mut(rows)
            .zip(r.par_chunks(rows))
            .zip(self.factor.par_chunks(length))
            .map(|((out, r), factor)| dispatch(SolveBlock { grid: self.grid, offsets: &self.offsets, factor, r, out }))
            .collect();
        parts.iter().sum()
    }

    /// Whether the diagonal of the matrix had to be raised so much that the factor is that of another one.
    pub(crate) fn is_raised(&self) -> bool {
        self.shift > MODERATE_SHIFT
    }

    /// Stores or takes up the factor.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { grid: _, offsets: _, updates: _, factor, shift } = self;
        archive.list(factor)?;
        archive.value(shift)
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<f32>() * self.factor.len()
    }
}

/// Pairs of couplings whose difference is a coupling too.
fn updates(offsets: &[Offset], degree: [usize; 2]) -> Vec<Update> {
    let p = degree[0] as isize;
    let mut updates = Vec::new();
    for first in 1..offsets.len() {
        for second in first..offsets.len() {
            let rows = offsets[second].rows - offsets[first].rows;
            let columns = offsets[second].columns - offsets[first].columns;
            if columns.abs() <= p {
                updates.push(Update { first, second, target: Stencil::offset_index(degree, columns, rows) });
            }
        }
    }
    updates
}

/// Factors the rows of `matrix`, their diagonal times `1 + shift`, into `block`; false as soon as a pivot
/// falls to nothing beside the diagonal: dropped couplings can leave nothing of it (Manteuffel 1980).
fn factor_block(
    grid: ControlGrid,
    offsets: &[Offset],
    updates: &[Update],
    shift: f64,
    matrix: &[f64],
    block: &mut [f64],
) -> bool {
    block.copy_from_slice(matrix);
    let row_length = offsets.len() * grid.stride;
    let rows = block.len() / row_length;
    if shift > 0.0 {
        let diagonals = (0..rows).map(|row| row * row_length);
        diagonals.for_each(|start| block[start..start + grid.stride].iter_mut().for_each(|d| *d *= 1.0 + shift));
    }
    for row in 0..rows {
        let reachable = offsets.iter().take_while(|o| row + o.rows < rows).count();
        for column in 0..grid.columns {
            let at = row * row_length + grid.index(column, 0);
            if block[at] <= LEAST_PIVOT * matrix[at] && shift < LARGEST_SHIFT && matrix[at] > 0.0 {
                return false;
            }
            let inverse = if block[at] > 0.0 { 1.0 / block[at] } else { 1.0 };
            let mut entries = [0.0; 64];
            for (index, entry) in entries.iter_mut().enumerate().take(reachable).skip(1) {
                *entry = block[at + index * grid.stride];
                block[at + index * grid.stride] *= inverse;
            }
            for index in reachable..offsets.len() {
                block[at + index * grid.stride] = 0.0;
            }
            for update in updates.iter().filter(|u| u.second < reachable) {
                let product = entries[update.first] * entries[update.second] * inverse;
                if product != 0.0 {
                    let offset = offsets[update.first];
                    let there = (at + offset.rows * row_length + update.target * grid.stride)
                        .wrapping_add_signed(offset.columns);
                    block[there] -= product;
                }
            }
            block[at] = inverse;
        }
    }
    true
}

struct SolveBlock<'a> {
    grid: ControlGrid,
    offsets: &'a [Offset],
    factor: &'a [f32],
    r: &'a [f64],
    out: &'a mut [f64],
}

impl SolveBlock<'_> {
    #[inline(always)]
    fn row(&self, row: usize, offset: usize) -> &[f32] {
        let start = (row * self.offsets.len() + offset) * self.grid.stride;
        &self.factor[start..start + self.grid.stride]
    }

    /// `L z = r`: earlier rows side by side, then along the row.
    #[inline(always)]
    fn forward<const FMA: bool>(&mut self, row: usize, same_row: usize) {
        let grid = self.grid;
        for column in (0..grid.columns).step_by(LANES) {
            let at = grid.index(column, 0);
            let mut sum = Lane::load(self.r, at + row * grid.stride);
            for (index, offset) in self.offsets.iter().enumerate().skip(same_row) {
                if row >= offset.rows {
                    let here = at.wrapping_add_signed(-offset.columns);
                    let earlier = Lane::load(self.out, here + (row - offset.rows) * grid.stride);
                    let coefficient = Lane::load_single(self.row(row - offset.rows, index), here);
                    sum = sum.add_product::<FMA>(coefficient * -1.0, earlier);
                }
            }
            let used = (grid.columns - column).min(LANES);
            self.out[at + row * grid.stride..][..used].copy_from_slice(&sum.0[..used]);
        }
        let start = (row * self.offsets.len()) * grid.stride;
        let out = &mut self.out[row * grid.stride..(row + 1) * grid.stride];
        for at in grid.index(0, 0)..grid.index(grid.columns, 0) {
            let mut value = out[at];
            for index in (1..same_row).rev() {
                let coefficient = -f64::from(self.factor[start + index * grid.stride + at - index]);
                value = add_product::<FMA>(value, coefficient, out[at - index]);
            }
            out[at] = value;
        }
    }

    /// `Lᵀ x = D⁻¹ z`: later rows side by side, then back along the row.
    #[inline(always)]
    fn backward<const FMA: bool>(&mut self, row: usize, rows: usize, same_row: usize) {
        let grid = self.grid;
        for column in (0..grid.columns).step_by(LANES) {
            let at = grid.index(column, 0);
            let mut sum = Lane::load(self.out, at + row * grid.stride) * Lane::load_single(self.row(row, 0), at);
            for (index, offset) in self.offsets.iter().enumerate().skip(same_row) {
                if row + offset.rows < rows {
                    let there = (at + (row + offset.rows) * grid.stride).wrapping_add_signed(offset.columns);
                    let coefficient = Lane::load_single(self.row(row, index), at);
                    sum = sum.add_product::<FMA>(coefficient * -1.0, Lane::load(self.out, there));
                }
            }
            let used = (grid.columns - column).min(LANES);
            self.out[at + row * grid.stride..][..used].copy_from_slice(&sum.0[..used]);
        }
        let start = (row * self.offsets.len()) * grid.stride;
        let out = &mut self.out[row * grid.stride..(row + 1) * grid.stride];
        for at in (grid.index(0, 0)..grid.index(grid.columns, 0)).rev() {
            let mut value = out[at];
            for index in (1..same_row).rev() {
                let coefficient = -f64::from(self.factor[start + index * grid.stride + at]);
                value = add_product::<FMA>(value, coefficient, out[at + index]);
            }
            out[at] = value;
        }
    }
}

impl Vectorised for SolveBlock<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FMA: bool>(mut self) -> f64 {
        let stride = self.grid.stride;
        let rows = self.r.len() / stride;
        let same_row = self.offsets.iter().take_while(|o| o.rows == 0).count();
        for row in 0..rows {
            self.forward::<FMA>(row, same_row);
        }
        for row in (0..rows).rev() {
            self.backward::<FMA>(row, rows, same_row);
        }
        let mut product = Lane::ZERO;
        for (r, out) in self.r.chunks_exact(LANES).zip(self.out.chunks_exact(LANES)) {
            product = product.add_product::<FMA>(Lane::load(r, 0), Lane::load(out, 0));
        }
        product.sum()
    }
}
