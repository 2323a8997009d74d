//! Passes over the strips of points: each strip reads the control values of its cells, and writes its own
//! points or a window of nodal fields.

use std::ops::Range;

use rayon::prelude::*;

use crate::linear_algebra::control_grid::ControlGrid;
use crate::particles::points::{Cell, Strip};
use crate::splines::spline::MAX_FUNCTIONS;

/// The control rows a strip may write, in `N` fields.
#[derive(Debug)]
pub struct Window<'a, const N: usize> {
    /// Control row the fields begin with.
    pub first_row: usize,
    /// The fields.
    pub fields: [&'a mut [f64]; N],
}

impl<const N: usize> Window<'_, N> {
    /// Adds the sums over the points of a cell with `kx` by `ky` control points, row by row.
    #[inline(always)]
    pub fn add(&mut self, grid: ControlGrid, cell: &Cell, sums: &[[f64; N]; MAX_FUNCTIONS], kx: usize, ky: usize) {
        for l in 0..ky {
            let base = grid.index(cell.first[0], cell.first[1] + l - self.first_row);
            for k in 0..kx {
                for component in 0..N {
                    self.fields[component][base + k] += sums[l * kx + k][component];
                }
            }
        }
    }
}

/// Values of fields at the `kx` by `ky` control points of a cell, row by row.
#[inline(always)]
pub fn control_values<const N: usize>(
    fields: [&[f64]; N],
    grid: ControlGrid,
    cell: &Cell,
    kx: usize,
    ky: usize,
) -> [[f64; N]; MAX_FUNCTIONS] {
    let mut values = [[0.0; N]; MAX_FUNCTIONS];
    for l in 0..ky {
        let base = grid.index(cell.first[0], cell.first[1] + l);
        for k in 0..kx {
            values[l * kx + k] = fields.map(|field| field[base + k]);
        }
    }
    values
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
