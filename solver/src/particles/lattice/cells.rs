//! The cells of a lattice: a span of each lane over the points of a span, which sums and state are cut into.

use std::ops::Range;

use super::Lattice;
use crate::linear_algebra::lane::LANES;

impl Lattice {
    /// Number of cells.
    pub(crate) fn cells(&self) -> usize {
        self.batches() / self.points_per_span()
    }

    /// The strip of a row of spans, if it is one of the patch: behind them are those of slits and cut spans.
    pub(crate) fn patch_strip_of(&self, row: usize) -> Option<usize> {
        (row < self.patch_rows).then_some(row / self.strip_rows)
    }

    /// Control points of the phase field whose functions the points of a cell see, as rows of their indices.
    pub(crate) fn functions_of_cell(&self, cell: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        let (span, tiles) = (self.points_per_span(), self.tiles.len());
        let row = self.rows.get(cell / tiles);
        let of_table = row.map(|row| ([self.tiles[cell % tiles].first, row.first - row.lift], LANES)).into_iter();
        let cut = if row.is_some() { 0..0 } else { cell * span..(cell + 1) * span };
        let of_cut = cut.filter_map(|batch| self.cut_batch(batch)).map(|batch| (batch.first, 1));
        let blocks = of_table.chain(of_cut).map(move |([column, row], spans)| {
            (column..(column + spans + self.degree[0]).min(self.patch_grid.columns), row)
        });
        blocks.flat_map(move |(columns, row)| {
            let grid = self.patch_grid;
            (row..row + self.degree[1] + 1).map(move |row| grid.index(columns.start, row)..grid.index(columns.end, row))
        })
    }
}
