//! Passes over the strips of points: each strip reads the control values of its cells, and writes its own
//! points or a window of nodal fields.

use std::ops::Range;

use rayon::prelude::*;

use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::lane::each;
use crate::material::hencky::Gradient;
use crate::particles::points::{Cell, Strip};
use crate::splines::spline::{MAX_REACH, MeanFunctions};

/// Control points that the domains of the points of a cell may reach in a direction: those of its span and
/// one on either side, which is where the cell's numbers of control columns and rows begin.
const MAX_CELL: usize = MAX_REACH + 1;

/// Factors of the columns and of the rows of control points that a point reaches.
pub(super) type Slopes = [[f64; MAX_REACH]; 2];

/// One value for each control point of a cell, row by row.
pub type OfCell<T> = [T; MAX_CELL * MAX_CELL];

/// Values of zero for the control points of a cell.
#[inline(always)]
pub fn zeros<const N: usize>() -> OfCell<[f64; N]> {
    [[0.0; N]; MAX_CELL * MAX_CELL]
}

/// Number in an [`OfCell`] of the first of some functions of a row, in a cell of spans with `kx` functions.
#[inline(always)]
pub(super) fn in_cell([sx, sy]: &[MeanFunctions; 2], l: usize, kx: usize) -> usize {
    (sy.start + l) * (kx + 2) + sx.start
}

/// The control rows a strip may write, in `N` fields.
#[derive(Debug)]
pub struct Window<'a, const N: usize> {
    /// Control row the fields begin with.
    pub first_row: usize,
    /// The fields.
    pub fields: [&'a mut [f64]; N],
}

impl<const N: usize> Window<'_, N> {
    /// Adds the sums over the points of a cell, whose spans have `kx` by `ky` functions. Rows of fields have
    /// room for a column too many at either end.
    #[inline(always)]
    pub fn add(&mut self, grid: ControlGrid, cell: &Cell, sums: &OfCell<[f64; N]>, kx: usize, ky: usize) {
        for l in rows_of_cell(grid, cell, ky) {
            let base = grid.index(cell.first[0], cell.first[1] + l - 1 - self.first_row) - 1;
            for k in 0..kx + 2 {
                for component in 0..N {
                    self.fields[component][base + k] += sums[l * (kx + 2) + k][component];
                }
            }
        }
    }
}

/// The rows of a cell that the grid has.
#[inline(always)]
fn rows_of_cell(grid: ControlGrid, cell: &Cell, ky: usize) -> Range<usize> {
    usize::from(cell.first[1] == 0)..(ky + 2).min(grid.rows + 1 - cell.first[1])
}

/// Values of fields at the control points of a cell, whose spans have `kx` by `ky` functions; zero beyond the
/// grid.
#[inline(always)]
pub fn control_values<const N: usize>(
    fields: [&[f64]; N],
    grid: ControlGrid,
    cell: &Cell,
    kx: usize,
    ky: usize,
) -> OfCell<[f64; N]> {
    let mut values = zeros();
    for l in rows_of_cell(grid, cell, ky) {
        let base = grid.index(cell.first[0], cell.first[1] + l - 1) - 1;
        for k in 0..kx + 2 {
            values[l * (kx + 2) + k] = fields.map(|field| field[base + k]);
        }
    }
    values
}

/// Sums over control points with shape functions and slopes.
#[derive(Debug, Clone, Copy)]
pub(super) struct ControlSums {
    pub value: [f64; 4],
    pub along_x: [f64; 4],
    pub along_y: [f64; 4],
}

impl ControlSums {
    /// Velocity gradient of the last two fields.
    #[inline(always)]
    pub(super) fn affine(&self) -> Gradient {
        each!(c in [0, 1] => [self.along_x[2 + c], self.along_y[2 + c]])
    }
}

/// Sums of four fields: values with the means of the shape functions, slopes of the first two fields with the
/// means of their derivatives and of the last two with given ones.
#[inline(always)]
pub(super) fn control_sums(
    functions: &[MeanFunctions; 2],
    slopes: &Slopes,
    local: &OfCell<[f64; 4]>,
    [kx, ky]: [usize; 2],
) -> ControlSums {
    let [sx, sy] = functions;
    let mut sums = ControlSums { value: [0.0; 4], along_x: [0.0; 4], along_y: [0.0; 4] };
    for l in 0..=ky {
        let first = in_cell(functions, l, kx);
        let (mut row_value, mut row_slope) = ([0.0; 4], [0.0; 4]);
        for k in 0..=kx {
            let slope = [sx.derivative[k], sx.derivative[k], slopes[0][k], slopes[0][k]];
            for c in 0..4 {
                row_value[c] += sx.value[k] * local[first + k][c];
                row_slope[c] += slope[c] * local[first + k][c];
            }
        }
        let slope = [sy.derivative[l], sy.derivative[l], slopes[1][l], slopes[1][l]];
        for c in 0..4 {
            sums.value[c] += sy.value[l] * row_value[c];
            sums.along_x[c] += sy.value[l] * row_slope[c];
            sums.along_y[c] += slope[c] * row_value[c];
        }
    }
    sums
}

/// Runs `work` once per strip with its window of `fields`, rows of `row_lengths` numbers; results in the
/// order of strips.
///
/// Strips of one colour (even or odd) share no control row and run side by side, first the even, then the
/// odd: the order of additions at a control point does not depend on the number of threads.
pub fn scatter<const N: usize, R: Send>(
    strips: &[Strip],
    mut fields: [&mut [f64]; N],
    row_lengths: [usize; N],
    work: impl Fn(&Strip, Window<N>) -> R + Sync,
) -> Vec<R> {
    let mut results: Vec<(usize, R)> = Vec::with_capacity(strips.len());
    for colour in 0..2 {
        let mut rest = fields.each_mut().map(|field| &mut **field);
        let mut passed = 0;
        let mut windows = Vec::new();
        for strip in strips.iter().filter(|s| s.index % 2 == colour) {
            let rows = strip.control_rows.clone();
            let fields = std::array::from_fn(|f| {
                let length = row_lengths[f];
                let (_, tail) = std::mem::take(&mut rest[f]).split_at_mut((rows.start - passed) * length);
                let (window, tail) = tail.split_at_mut(rows.len() * length);
                rest[f] = tail;
                window
            });
            passed = rows.end;
            windows.push((strip, Window { first_row: rows.start, fields }));
        }
        let part = windows.into_par_iter().map(|(strip, window)| (strip.index, work(strip, window)));
        results.extend(part.collect::<Vec<_>>());
    }
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}

/// Cuts a slice into neighbouring ranges that cover it.
pub fn cut<T>(mut items: &mut [T], ranges: impl Iterator<Item = Range<usize>>) -> Vec<&mut [T]> {
    ranges
        .map(|range| {
            let (part, rest) = std::mem::take(&mut items).split_at_mut(range.len());
            items = rest;
            part
        })
        .collect()
}
