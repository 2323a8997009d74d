//! Incomplete Cholesky factorisation `A ≈ L D Lᵀ` without fill, in the stencil of the matrix.
//!
//! The factor keeps couplings within blocks of rows only, so blocks are factored and solved independently
//! (block Jacobi between them). Blocks come from the number of rows, never from the number of threads.
//!
//! A matrix that is assembled anew for every solve is scaled to a diagonal of ones first, and the factor is
//! applied with the scale of the matrix as it is then: `A ≈ S⁻¹ L D Lᵀ S⁻¹`. Material that comes to a control
//! point and leaves it changes its diagonal most, so an old factor stays a good one for long.
//!
//! It is made in double precision, kept in single precision, and applied in that of the vectors. It stays
//! symmetric and positive definite, and applying it takes as long as reading it. It stands for `unit A` with
//! a power of two that makes the largest diagonal entry about one ([`IncompleteCholesky::unit`]): nothing
//! underflows, whatever the units of a scene.

mod solve;

use rayon::prelude::*;

use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::{Scalar, dispatch};
use crate::linear_algebra::stencil::{Offset, Stencil};
use crate::linear_algebra::terms::Terms;
use solve::{SolveBlock, SolvePair};

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
    /// S, one over the root of the diagonal of the matrix now; none for a matrix that is factored as it is.
    scale: Option<Vec<f32>>,
    /// Power of two by which the matrix is multiplied before it is factored.
    pub unit: f64,
}

impl IncompleteCholesky {
    /// Factors `matrix`, scaled or as it is.
    pub fn new(matrix: &Stencil, scaled: bool) -> Self {
        let offsets = matrix.offsets().to_vec();
        let updates = updates(&offsets, matrix.degree());
        let factor = vec![0.0; matrix.coefficients().len()];
        let scale = scaled.then(|| vec![0.0; matrix.grid.len()]);
        let mut factor = Self { grid: matrix.grid, offsets, updates, factor, shift: 0.0, scale, unit: 1.0 };
        factor.refactor(matrix);
        factor
    }

    /// Factors `matrix` again in the same memory.
    pub fn refactor(&mut self, matrix: &Stencil) {
        let block = BLOCK_ROWS * matrix.row_length();
        self.unit = unit(matrix);
        self.rescale_on(&ActiveColumns::all(self.grid), matrix); // neighbours of those that take part, too
        let Self { offsets, updates, factor, scale, unit, .. } = self;
        let shifts = factor.par_chunks_mut(block).enumerate().map(|(index, factor)| {
            let (first, scale) = (index * BLOCK_ROWS, scale.as_deref());
            if scale.is_none() && !matrix.active().any_in(first..(first + BLOCK_ROWS).min(matrix.grid.rows)) {
                return 0.0; // of a matrix that is assembled once: the factor is made anew where that changes
            }
            let rows = Rows { matrix, first, unit: *unit, scale, offsets, updates };
            let (mut block, mut shift) = (vec![0.0; factor.len()], 0.0);
            while !rows.factor(shift, &mut block) && shift < LARGEST_SHIFT {
                shift = (SHIFT_GROWTH * shift).max(FIRST_SHIFT);
            }
            factor.iter_mut().zip(block).for_each(|(single, double)| *single = double as f32);
            shift
        });
        self.shift = shifts.reduce(|| 0.0, larger);
    }

    /// Takes the scale from the diagonal of `matrix`, if there is one to take.
    pub(crate) fn rescale(&mut self, matrix: &Stencil) {
        if self.scale.is_some() {
            self.unit = unit(matrix);
            self.rescale_on(matrix.active(), matrix);
        }
    }

    fn rescale_on(&mut self, active: &ActiveColumns, matrix: &Stencil) {
        let Some(scale) = &mut self.scale else { return };
        for (row, scale) in scale.chunks_mut(self.grid.stride).enumerate() {
            for range in active.row(row) {
                let range = self.grid.index(range.start, 0)..self.grid.index(range.end, 0);
                for (scale, diagonal) in scale[range.clone()].iter_mut().zip(&matrix.row(row, 0)[range]) {
                    *scale = if *diagonal > 0.0 { 1.0 / (self.unit * diagonal).sqrt() as f32 } else { 0.0 };
                }
            }
        }
    }

    /// `out = (unit M)⁻¹ r` on the `active` control points, for an `out` that is zero elsewhere; returns
    /// `rᵀ out`.
    pub fn apply<T: Scalar>(&self, active: &ActiveColumns, r: &[T], out: &mut [T]) -> f64 {
        let rows = BLOCK_ROWS * self.grid.stride;
        let length = self.offsets.len() * rows;
        let parts: Vec<f64> = out
            .par_chunks_mut(2 * rows)
            .zip(r.par_chunks(2 * rows))
            .zip(self.factor.par_chunks(2 * length))
            .enumerate()
            .map(|(pair, ((out, r), factor))| {
                let (out, other_out) = out.split_at_mut(rows.min(out.len()));
                let (r, other_r) = r.split_at(out.len());
                let (factor, other_factor) = factor.split_at(length.min(factor.len()));
                let one = self.block(active, 2 * pair, factor, r, out);
                dispatch(SolvePair([one, self.block(active, 2 * pair + 1, other_factor, other_r, other_out)]))
            })
            .collect();
        parts.iter().sum()
    }

    fn block<'a, T>(
        &'a self,
        active: &'a ActiveColumns,
        number: usize,
        factor: &'a [f32],
        r: &'a [T],
        out: &'a mut [T],
    ) -> SolveBlock<'a, T> {
        let first = number * BLOCK_ROWS;
        let scale = self.scale.as_ref().filter(|_| !r.is_empty());
        let scale = scale.map(|scale| &scale[first * self.grid.stride..][..r.len()]);
        SolveBlock {
            grid: self.grid,
            offsets: &self.offsets,
            active,
            first,
            factor,
            scale,
            terms: Terms::none(),
            r,
            out,
        }
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
        let Self { grid: _, offsets: _, updates: _, factor, shift, scale: _, unit } = self;
        archive.list(factor)?;
        archive.value(unit)?;
        archive.value(shift)
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<f32>() * (self.factor.len() + self.scale.as_ref().map_or(0, Vec::len))
    }
}

/// The power of two that brings the largest diagonal entry of a control point that takes part next to one;
/// one for a matrix without any.
pub(crate) fn unit(matrix: &Stencil) -> f64 {
    let grid = matrix.grid;
    let active = |row: usize| matrix.active().row(row).iter().map(move |range| (row, range));
    let diagonals = (0..grid.rows)
        .flat_map(active)
        .flat_map(|(row, range)| &matrix.row(row, 0)[grid.index(range.start, 0)..grid.index(range.end, 0)]);
    let largest = diagonals.copied().fold(0.0, larger);
    if largest > 0.0 && largest.is_finite() { (-largest.log2().round()).exp2() } else { 1.0 }
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

/// The rows of a block.
struct Rows<'a> {
    matrix: &'a Stencil,
    first: usize,
    unit: f64,
    scale: Option<&'a [f32]>,
    offsets: &'a [Offset],
    updates: &'a [Update],
}

impl Rows<'_> {
    /// Copies the matrix times the unit, scaled if it is to be, into `block`. Control points without a part
    /// are left out.
    fn copy(&self, block: &mut [f64]) {
        let grid = self.matrix.grid;
        let row_length = self.matrix.row_length();
        let Some(scale) = self.scale else {
            let coefficients = &self.matrix.coefficients()[self.first * row_length..];
            return block.iter_mut().zip(coefficients).for_each(|(block, value)| *block = self.unit * value);
        };
        block.fill(0.0);
        for (local, block) in block.chunks_mut(row_length).enumerate() {
            let row = self.first + local;
            for (index, offset) in self.offsets.iter().enumerate().filter(|(_, o)| row + o.rows < grid.rows) {
                let coefficients = self.matrix.row(row, index);
                let there = ((row + offset.rows) * grid.stride).wrapping_add_signed(offset.columns);
                for column in self.matrix.active().row(row).iter().cloned().flatten() {
                    let at = grid.index(column, 0);
                    let scales = f64::from(scale[row * grid.stride + at]) * f64::from(scale[there + at]);
                    block[index * grid.stride + at] = self.unit * coefficients[at] * scales;
                }
            }
        }
    }

    /// Factors the rows, their diagonal times `1 + shift`, into `block`; false as soon as a pivot falls to
    /// nothing beside the diagonal: dropped couplings can leave nothing of it (Manteuffel 1980).
    fn factor(&self, shift: f64, block: &mut [f64]) -> bool {
        let Self { matrix, offsets, updates, .. } = *self;
        self.copy(block);
        let (grid, row_length) = (matrix.grid, matrix.row_length());
        let rows = block.len() / row_length;
        if shift > 0.0 {
            let diagonals = (0..rows).map(|row| row * row_length);
            diagonals.for_each(|start| block[start..start + grid.stride].iter_mut().for_each(|d| *d *= 1.0 + shift));
        }
        for row in 0..rows {
            let reachable = offsets.iter().take_while(|o| row + o.rows < rows).count();
            for column in matrix.active().row(self.first + row).iter().cloned().flatten() {
                let at = row * row_length + grid.index(column, 0);
                let own = self.unit * matrix.row(self.first + row, 0)[grid.index(column, 0)];
                let diagonal = if self.scale.is_some() && own > 0.0 { 1.0 } else { own };
                if block[at] <= LEAST_PIVOT * diagonal && shift < LARGEST_SHIFT && diagonal > 0.0 {
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
        self.complete(block);
        true
    }

    /// Unit rows where no control point takes part: one that does in a later solve stands for itself.
    fn complete(&self, block: &mut [f64]) {
        let grid = self.matrix.grid;
        for (local, block) in block.chunks_mut(self.matrix.row_length()).enumerate() {
            for (index, entries) in block.chunks_mut(grid.stride).enumerate() {
                let unit = if index == 0 { 1.0 } else { 0.0 };
                let mut end = 0;
                for range in self.matrix.active().row(self.first + local) {
                    entries[grid.index(end, 0)..grid.index(range.start, 0)].fill(unit);
                    end = range.end;
                }
                entries[grid.index(end, 0)..grid.index(grid.columns, 0)].fill(unit);
            }
        }
    }
}
