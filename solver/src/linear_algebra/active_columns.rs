//! Which control points of a grid take part in a system.

use std::ops::Range;

use super::control_grid::ControlGrid;
use super::lane::{LANES, Scalar};

/// Ranges of columns in each row of control points. Between two ranges lie at least [`LANES`] control points:
/// shorter gaps take part, which costs less than to begin anew.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ActiveColumns {
    ranges: Vec<Range<usize>>,
    /// Number of the first range of each row, and of all.
    starts: Vec<usize>,
}

impl ActiveColumns {
    /// All control points.
    pub fn all(grid: ControlGrid) -> Self {
        Self { ranges: vec![0..grid.columns; grid.rows], starts: (0..=grid.rows).collect() }
    }

    /// Those that are marked in a field.
    pub(crate) fn marked(grid: ControlGrid, marks: &[bool]) -> Self {
        let mut active = Self { ranges: Vec::new(), starts: vec![0] };
        for row in 0..grid.rows {
            let first = active.ranges.len();
            for column in (0..grid.columns).filter(|&column| marks[grid.index(column, row)]) {
                match active.ranges[first..].last_mut() {
                    Some(last) if column < last.end + LANES => last.end = column + 1,
                    _ => active.ranges.push(column..column + 1),
                }
            }
            active.starts.push(active.ranges.len());
        }
        active
    }

    /// The ranges of a row.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[Range<usize>] {
        &self.ranges[self.starts[row]..self.starts[row + 1]]
    }

    /// Sets a field to zero outside.
    pub(crate) fn clear_outside<T: Scalar>(&self, grid: ControlGrid, field: &mut [T]) {
        for (row, values) in field.chunks_mut(grid.stride).enumerate() {
            let mut end = 0;
            for range in self.row(row) {
                values[end..grid.index(range.start, 0)].fill(T::ZERO);
                end = grid.index(range.end, 0);
            }
            values[end..].fill(T::ZERO);
        }
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
        active.clear_outside(grid, &mut field);
        assert_eq!(field.iter().sum::<f64>(), 9.0);
        let inside = [(0, 0), (3, 0), (5, 0), (39, 0), (3, 2), (4, 2)];
        assert!(inside.into_iter().all(|(column, row)| field[grid.index(column, row)] == 1.0));
        assert_eq!(ActiveColumns::all(grid).row(1), std::slice::from_ref(&(0..40)));
    }
}
