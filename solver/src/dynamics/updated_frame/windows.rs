//! Passes over the strips of points: each strip reads the control values of its cells, and writes its own
//! points or a window of nodal fields.

use std::ops::Range;

use rayon::prelude::*;

use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::lane::each;
use crate::material::hencky::Gradient;
use crate::particles::points::{Cell, Strip};
use crate::splines::spline::{MAX_REACH, MeanFunctions};

/// Factors of the columns and of the rows of control points that a point reaches.
pub(super) type Slopes = [[f64; MAX_REACH]; 2];

/// Puts fields side by side: for each control point an array of their values.
pub fn side_by_side<const N: usize>(fields: [&[f64]; N], together: &mut Vec<[f64; N]>) {
    together.clear();
    together.extend((0..fields[0].len()).map(|at| fields.map(|field| field[at])));
}

/// The control rows a strip may write, in `N` fields.
#[derive(Debug)]
pub struct Window<'a, T, const N: usize> {
    /// Control row the fields begin with.
    pub first_row: usize,
    /// Rows of each field that the strip may write, from that row on.
    pub fields: [&'a mut [T]; N],
}

/// The control points that a point reaches, in fields that begin with a control row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    at: usize,
    columns: usize,
    stride: usize,
    /// Rows; the one beyond the grid, whose function is zero, is left out.
    pub(super) rows: usize,
}

impl Reach {
    /// Those of a point of a cell with these functions, `kx + 1` by `ky + 1`. The first span of a patch has
    /// no neighbour, and in that of a part no point lies, so no row lies before the grid.
    #[inline(always)]
    pub(super) fn new(
        grid: ControlGrid,
        cell: &Cell,
        [sx, sy]: &[MeanFunctions; 2],
        [kx, ky]: [usize; 2],
        first_row: usize,
    ) -> Self {
        let row = cell.first[1] + sy.start - 1;
        let at = grid.index(cell.first[0], row - first_row) + sx.start - 1;
        Self { at, columns: kx + 1, stride: grid.stride, rows: (ky + 1).min(grid.rows - row) }
    }

    /// Indices of those in a row.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> Range<usize> {
        let at = self.at + row * self.stride;
        at..at + self.columns
    }
}

/// Sums over control points with shape functions and slopes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ControlSums {
    pub value: [f64; 4],
    pub along_x: [f64; 4],
    pub along_y: [f64; 4],
    /// Of the field of each direction: average over the two ends of the domain there, less the mean.
    pub ends_less_mean: [f64; 2],
}

impl ControlSums {
    /// Velocity gradient of the last two fields.
    #[inline(always)]
    pub(super) fn affine(&self) -> Gradient {
        each!(c in [0, 1] => [self.along_x[2 + c], self.along_y[2 + c]])
    }
}

/// Sums of four fields, less a reference: values with the means of the shape functions, slopes of the first
/// two fields with the means of their derivatives and of the last two with given ones.
#[inline(always)]
pub(super) fn control_sums(
    [sx, sy]: &[MeanFunctions; 2],
    slopes: &Slopes,
    fields: &[[f64; 4]],
    reference: [f64; 4],
    reach: Reach,
) -> ControlSums {
    let mut sums = ControlSums::default();
    for l in 0..reach.rows {
        let (mut row_value, mut row_slope, mut row_ends) = ([0.0; 4], [0.0; 4], 0.0);
        for (k, values) in fields[reach.row(l)].iter().enumerate() {
            let slope = [sx.derivative[k], sx.derivative[k], slopes[0][k], slopes[0][k]];
            for c in 0..4 {
                let value = values[c] - reference[c];
                row_value[c] += sx.value[k] * value;
                row_slope[c] += slope[c] * value;
            }
            row_ends += sx.ends_less_mean[k] * values[0];
        }
        let slope = [sy.derivative[l], sy.derivative[l], slopes[1][l], slopes[1][l]];
        for c in 0..4 {
            sums.value[c] += sy.value[l] * row_value[c];
            sums.along_x[c] += sy.value[l] * row_slope[c];
            sums.along_y[c] += slope[c] * row_value[c];
        }
        sums.ends_less_mean[0] += sy.value[l] * row_ends;
        sums.ends_less_mean[1] += sy.ends_less_mean[l] * row_value[1];
    }
    sums
}

/// Runs `work` once per strip with its window of `fields`, rows of `row_lengths` items.
///
/// Strips of one colour (even or odd) share no control row and run side by side, first the even, then the
/// odd: the order of additions at a control point does not depend on the number of threads.
pub fn scatter<T: Send, const N: usize>(
    strips: &[Strip],
    mut fields: [&mut [T]; N],
    row_lengths: [usize; N],
    work: impl Fn(&Strip, Window<T, N>) + Sync,
) {
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
        windows.into_par_iter().for_each(|(strip, window)| work(strip, window));
    }
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
