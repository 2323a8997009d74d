//! Symmetric matrices on the control points of a patch, as half a stencil per control point.
//!
//! Basis functions of a tensor-product patch overlap only within `p` columns and `q` rows, so a symmetric
//! matrix has the couplings of each control point with itself and the ones after it: `(2 p + 1) q + p + 1`
//! numbers, kept row of control points by row of control points. Applying it reads every coefficient once
//! from memory.
//!
//! Iterations read a copy in single precision, half as many bytes, which is written where the residual is
//! taken in double precision ([`Stencil::residual`]).

use rayon::prelude::*;

use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::control_grid::{CHUNK_ROWS, ControlGrid};
use crate::linear_algebra::extremes::largest;
use crate::linear_algebra::lane::{LANES, Lane, Scalar, Vectorised, dispatch};
use crate::linear_algebra::terms::Terms;

/// Couplings that are worth waking another thread for: some ten microseconds.
const LEAST_WORK: usize = 50_000;

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
pub struct Stencil<T = f64> {
    /// Layout of the control points.
    pub grid: ControlGrid,
    degree: [usize; 2],
    offsets: Vec<Offset>,
    coefficients: Vec<T>,
    active: ActiveColumns,
}

impl Stencil {
    /// The zero matrix for a patch of `degree`.
    pub fn zeros(grid: ControlGrid, degree: [usize; 2]) -> Self {
        let offsets = half_stencil(degree);
        let coefficients = vec![0.0; offsets.len() * grid.len()];
        Self { grid, degree, offsets, coefficients, active: ActiveColumns::all(grid) }
    }

    /// Position of a coupling in [`Self::offsets`].
    #[inline(always)]
    pub fn offset_index(degree: [usize; 2], columns: isize, rows: usize) -> usize {
        let p = degree[0] as isize;
        if rows == 0 { columns as usize } else { (p + 1 + (rows as isize - 1) * (2 * p + 1) + columns + p) as usize }
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
    pub fn coefficients_mut(&mut self) -> &mut Vec<f64> {
        &mut self.coefficients
    }

    /// Place of the diagonal entry of a control point among the coefficients.
    fn place_of_diagonal(&self, at: usize) -> usize {
        self.grid.row_of(at) * self.row_length() + at % self.grid.stride
    }

    /// Diagonal entry of a control point, by its index.
    pub fn diagonal(&self, at: usize) -> f64 {
        self.coefficients[self.place_of_diagonal(at)]
    }

    /// Sets the diagonal entry of a control point, by its index.
    pub fn set_diagonal(&mut self, at: usize, value: f64) {
        let place = self.place_of_diagonal(at);
        self.coefficients[place] = value;
    }

    /// The largest diagonal entry, and the control points that have at most a share of it.
    pub(crate) fn bare(&self, share: f64) -> (f64, Vec<usize>) {
        let largest = largest(self.grid.indices().map(|at| self.diagonal(at)));
        (largest, self.grid.indices().filter(|&at| self.diagonal(at) <= share * largest).collect())
    }

    /// `unit (b − A x)` at the control points that take part, in a field that is zero elsewhere, and a copy
    /// of `unit A`, both in the precision of iterations; `image` is `A x`.
    pub(crate) fn residual<T: Scalar>(
        &self,
        unit: f64,
        b: &[f64],
        x: &[f64],
        image: &mut [f64],
        residual: &mut [T],
        copy: &mut Stencil<T>,
    ) {
        if copy.active != self.active {
            copy.active = self.active.clone();
        }
        let chunk = CHUNK_ROWS * self.grid.stride;
        let rows = image.par_chunks_mut(chunk).zip(residual.par_chunks_mut(chunk)).zip(b.par_chunks(chunk));
        let length = self.row_length();
        let coefficients = CHUNK_ROWS * length;
        rows.zip(self.coefficients.par_chunks(coefficients))
            .zip(copy.coefficients.par_chunks_mut(coefficients))
            .with_min_len(self.least_chunks())
            .enumerate()
            .filter(|(index, _)| self.active.any_in(index * CHUNK_ROWS..((index + 1) * CHUNK_ROWS).min(self.grid.rows)))
            .for_each(|(index, ((((image, residual), b), coefficients), copy))| {
                dispatch(ApplyRows { matrix: self, x, out: image, first_row: index * CHUNK_ROWS });
                for (local, (values, copy)) in coefficients.chunks(length).zip(copy.chunks_mut(length)).enumerate() {
                    let row = self.active.row(index * CHUNK_ROWS + local);
                    let (Some(first), Some(last)) = (row.first(), row.last()) else { continue };
                    let used = self.grid.index(first.start, 0)..self.grid.index(last.end, 0);
                    for (values, copy) in values.chunks(self.grid.stride).zip(copy.chunks_mut(self.grid.stride)) {
                        let (values, out) = (&values[used.clone()], &mut copy[used.clone()]);
                        dispatch(Rounded { unit, values, subtract: None, out });
                    }
                }
                dispatch(Rounded { unit, values: b, subtract: Some(image), out: residual });
            });
        for (index, residual) in residual.chunks_mut(chunk).enumerate() {
            let first = index * CHUNK_ROWS;
            if self.active.any_in(first..(first + CHUNK_ROWS).min(self.grid.rows)) {
                self.active.clear_outside(self.grid, residual, first);
            }
        }
    }
}

impl<T: Scalar> Stencil<T> {
    /// A matrix of zeros of another precision.
    pub(crate) fn empty<S: Scalar>(&self) -> Stencil<S> {
        let Self { grid, degree, offsets, coefficients, active } = self;
        let coefficients = vec![S::ZERO; coefficients.len()];
        let (offsets, active) = (offsets.clone(), active.clone());
        Stencil { grid: *grid, degree: *degree, offsets, coefficients, active }
    }
}

impl<T: Scalar> Stencil<T> {
    /// Couplings of the half stencil; the first is the diagonal.
    pub fn offsets(&self) -> &[Offset] {
        &self.offsets
    }

    /// Degree of the splines in x and y: couplings reach as many columns and rows.
    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// Numbers per row of control points.
    pub fn row_length(&self) -> usize {
        self.offsets.len() * self.grid.stride
    }

    /// The control points that take part: all, unless it was said otherwise.
    pub fn active(&self) -> &ActiveColumns {
        &self.active
    }

    /// Leaves others than these out of the system: fields keep their values there.
    pub(crate) fn restrict(&mut self, active: ActiveColumns) {
        self.active = active;
    }

    /// `out = A x` at the control points that take part, zero elsewhere; returns `xᵀ A x` for an x that is
    /// zero elsewhere, too.
    pub fn apply(&self, x: &[T], out: &mut [T]) -> f64 {
        let chunk = CHUNK_ROWS * self.grid.stride;
        let parts: Vec<f64> = out
            .par_chunks_mut(chunk)
            .with_min_len(self.least_chunks())
            .enumerate()
            .map(|(index, out)| dispatch(ApplyRows { matrix: self, x, out, first_row: index * CHUNK_ROWS }))
            .collect();
        parts.iter().sum()
    }

    fn least_chunks(&self) -> usize {
        LEAST_WORK.div_ceil(CHUNK_ROWS * self.row_length())
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<T>() * self.coefficients.len()
    }
}

fn half_stencil([p, q]: [usize; 2]) -> Vec<Offset> {
    let p = p as isize;
    let same_row = (0..=p).map(|columns| Offset { columns, rows: 0 });
    let rows_ahead = (1..=q).flat_map(|rows| (-p..=p).map(move |columns| Offset { columns, rows }));
    same_row.chain(rows_ahead).collect()
}

/// `out = unit (values − subtract)`, rounded.
struct Rounded<'a, T> {
    unit: f64,
    values: &'a [f64],
    subtract: Option<&'a [f64]>,
    out: &'a mut [T],
}

impl<T: Scalar> Vectorised for Rounded<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { unit, values, subtract, out } = self;
        match subtract {
            None => out.iter_mut().zip(values).for_each(|(out, value)| *out = T::of(unit * value)),
            Some(subtract) => {
                let differences = values.iter().zip(subtract).map(|(value, subtract)| value - subtract);
                out.iter_mut().zip(differences).for_each(|(out, value)| *out = T::of(unit * value));
            }
        }
    }
}

struct ApplyRows<'a, T> {
    matrix: &'a Stencil<T>,
    x: &'a [T],
    out: &'a mut [T],
    first_row: usize,
}

impl<T: Scalar> ApplyRows<'_, T> {
    /// The couplings of a row with itself and with those after and before it.
    #[inline(always)]
    fn find_terms(&self, row: usize, terms: &mut Terms) {
        let Self { matrix: Stencil { grid, degree, offsets, .. }, .. } = self;
        let (before, after) = (row.min(degree[1]), (grid.rows - 1 - row).min(degree[1]));
        if !terms.begin([before, after]) {
            return;
        }
        let [stride, row_length] = [grid.stride, self.matrix.row_length()].map(|length| length as isize);
        for (index, offset) in offsets.iter().enumerate() {
            let (coefficients, rows) = (index as isize * stride, offset.rows as isize);
            if offset.rows <= after {
                terms.push(coefficients, rows * stride + offset.columns);
            }
            if index > 0 && offset.rows <= before {
                terms.push(coefficients - rows * row_length - offset.columns, -rows * stride - offset.columns);
            }
        }
    }
}

impl<T: Scalar> Vectorised for ApplyRows<'_, T> {
    type Output = f64;

    #[inline(always)]
    fn run<const FMA: bool>(self) -> f64 {
        let Self { matrix, x, .. } = self;
        let grid = matrix.grid;
        let mut total = 0.0;
        let mut terms = Terms::none();
        for local in 0..self.out.len() / grid.stride {
            let row = self.first_row + local;
            self.find_terms(row, &mut terms);
            let (x_of_row, out) = (&x[row * grid.stride..], &mut self.out[local * grid.stride..][..grid.stride]);
            let mut product = Lane::ZERO;
            for range in matrix.active.row(row) {
                let (at, used) = (grid.index(range.start, 0), range.len());
                out[at..at + used].fill(T::ZERO);
                let coefficients = (&matrix.coefficients[..], row * matrix.row_length() + at);
                terms.add::<FMA, false, T, T>(&mut out[at..], used, coefficients, (x, row * grid.stride + at));
                for at in (at..at + used).step_by(LANES) {
                    product = product.add_product::<FMA>(Lane::load(out, at), Lane::load(x_of_row, at));
                }
            }
            total += product.sum().into();
        }
        matrix.active.clear_left_out(self.out, self.first_row * grid.stride);
        total
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
