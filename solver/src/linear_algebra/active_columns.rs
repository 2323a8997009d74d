//! Which control points of a grid take part in a system.

use std::ops::Range;

use rayon::prelude::*;

use super::control_grid::{CHUNK_ROWS, ControlGrid};
use super::lane::{LANES, Scalar};

/// Ranges of columns in each row of control points. Between two ranges lie at least [`LANES`] control points:
/// shorter gaps take part, which costs less than to begin anew.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ActiveColumns {
    ranges: Vec<Range<usize>>,
    /// Number of the first range of each row, and of all.
    starts: Vec<usize>,
    /// Indices in a field of control points within the ranges that do not take part, in order.
    left_out: Vec<usize>,
}

impl ActiveColumns {
    /// All control points.
    pub fn all(grid: ControlGrid) -> Self {
        Self { ranges: vec![0..grid.columns; grid.rows], starts: (0..=grid.rows).collect(), left_out: Vec::new() }
    }

    /// Those with these indices in a field, which come in order, without those of short gaps.
    pub(crate) fn exactly(grid: ControlGrid, indices: impl Iterator<Item = usize>) -> Self {
        let mut active = Self { ranges: Vec::new(), starts: vec![0], left_out: Vec::new() };
        for at in indices {
            let (column, row) = (grid.column_of(at), grid.row_of(at));
            active.end_rows(row);
            match active.ranges[active.starts[row]..].last_mut() {
                Some(last) if column < last.end + LANES => {
                    active.left_out.extend(grid.index(last.end, row)..at);
                    last.end = column + 1;
                }
                _ => active.ranges.push(column..column + 1),
            }
        }
        active.end_rows(grid.rows);
        active
    }

    /// Ends all rows before this one.
    fn end_rows(&mut self, row: usize) {
        self.starts.resize(row + 1, self.ranges.len());
    }

    /// Those that are marked in a field.
    pub(crate) fn marked(grid: ControlGrid, marks: &[bool]) -> Self {
        let active = Self::exactly(grid, grid.indices().filter(|&at| marks[at]));
        Self { left_out: Vec::new(), ..active }
    }

    /// The ranges of a row.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[Range<usize>] {
        &self.ranges[self.starts[row]..self.starts[row + 1]]
    }

    /// The ranges of some rows as places in a part of a field that begins at the first of them.
    pub(crate) fn within(&self, grid: ControlGrid, rows: Range<usize>) -> impl Iterator<Item = Range<usize>> {
        let first = rows.start;
        let of_row = move |row: usize| {
            let place = move |column: usize| grid.index(column, row - first);
            self.row(row).iter().map(move |range| place(range.start)..place(range.end))
        };
        rows.flat_map(of_row)
    }

    /// Calls `f` for every range (several at once) with its part of each of some fields.
    pub(crate) fn for_each_part<const N: usize>(
        &self,
        grid: ControlGrid,
        fields: [&mut Vec<f64>; N],
        f: impl Fn(Range<usize>, [&mut [f64]; N]) + Sync,
    ) {
        let chunk = CHUNK_ROWS * grid.stride;
        let mut chunks = fields.map(|field| field.chunks_mut(chunk));
        let parts =
            (0..grid.rows.div_ceil(CHUNK_ROWS)).map(|_| chunks.each_mut().map(|c| c.next().unwrap_or_default()));
        parts.collect::<Vec<_>>().into_par_iter().enumerate().for_each(|(number, mut part)| {
            let (first, rows) = (number * chunk, number * CHUNK_ROWS..((number + 1) * CHUNK_ROWS).min(grid.rows));
            for used in self.within(grid, rows) {
                let fields = part.each_mut().map(|field| &mut field[used.clone()]);
                f(first + used.start..first + used.end, fields);
            }
        });
    }

    /// Whether there are any in some rows.
    pub(crate) fn any_in(&self, rows: Range<usize>) -> bool {
        self.starts[rows.start] < self.starts[rows.end]
    }

    /// Sets rows of a field, from row `first` on, to zero outside.
    pub(crate) fn clear_outside<T: Scalar>(&self, grid: ControlGrid, rows: &mut [T], first: usize) {
        for (row, values) in rows.chunks_mut(grid.stride).enumerate() {
            let mut end = 0;
            for range in self.row(first + row) {
                values[end..grid.index(range.start, 0)].fill(T::ZERO);
                end = grid.index(range.end, 0);
            }
            values[end..].fill(T::ZERO);
        }
        self.clear_left_out(rows, first * grid.stride);
    }

    /// Sets a field to zero where they are.
    pub(crate) fn clear_inside<T: Scalar>(&self, grid: ControlGrid, field: &mut [T]) {
        for row in 0..grid.rows {
            let ranges = self.row(row).iter();
            ranges.for_each(|range| field[grid.index(range.start, row)..grid.index(range.end, row)].fill(T::ZERO));
        }
    }

    /// Sets to zero what lies within the ranges and does not take part, in a part of a field that begins at
    /// index `first`.
    pub(crate) fn clear_left_out<T: Scalar>(&self, part: &mut [T], first: usize) {
        let [from, to] = [first, first + part.len()].map(|end| self.left_out.partition_point(|&at| at < end));
        self.left_out[from..to].iter().for_each(|at| part[at - first] = T::ZERO);
    }

    /// Control points that do not take part.
    pub(crate) fn others(&self, grid: ControlGrid) -> Vec<usize> {
        let mut takes_part = vec![1.0; grid.len()];
        self.clear_outside(grid, &mut takes_part, 0);
        grid.indices().filter(|&at| takes_part[at] == 0.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_gaps_take_part_and_long_ones_do_not() {
        let grid = ControlGrid::new(40, 3);
        let mut marks = vec![false; grid.len()];
        for (column, row) in [(0, 0), (5, 0), (39, 0), (3, 2), (4, 2)] {
            marks[grid.index(column, row)] = true;
        }
        let active = ActiveColumns::marked(grid, &marks);
        assert_eq!(active.row(0), [0..6, 39..40]);
        assert_eq!(active.row(1), []);
        assert_eq!(active.row(2), std::slice::from_ref(&(3..5)));
        let mut field = vec![1.0; grid.len()];
        active.clear_outside(grid, &mut field, 0);
        assert_eq!(field.iter().sum::<f64>(), 9.0);
        let inside = [(0, 0), (3, 0), (5, 0), (39, 0), (3, 2), (4, 2)];
        assert!(inside.into_iter().all(|(column, row)| field[grid.index(column, row)] == 1.0));
        assert_eq!(ActiveColumns::all(grid).row(1), std::slice::from_ref(&(0..40)));
    }
}
