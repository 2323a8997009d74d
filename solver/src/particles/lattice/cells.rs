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

    /// Strip and tile of the patch where a cell of points lies; those of each span if a boundary cuts them.
    pub(crate) fn tiles_of_cell(&self, cell: usize) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.blocks_of_cell(cell).map(|([column, row], _)| {
            let row_of_spans = self.rows[..self.patch_rows].partition_point(|of| of.first <= row).saturating_sub(1);
            let tile = self.tiles.partition_point(|tile| tile.first <= column).saturating_sub(1);
            [row_of_spans / self.strip_rows, tile]
        })
    }

    /// The first control point of the patch, by column and row, that the points of a cell see, and the number
    /// of spans from there on; of each span if a boundary cuts them.
    fn blocks_of_cell(&self, cell: usize) -> impl Iterator<Item = ([usize; 2], usize)> + '_ {
        let (span, tiles) = (self.points_per_span(), self.tiles.len());
        let row = self.rows.get(cell / tiles);
        let of_table = row.map(|row| ([self.tiles[cell % tiles].first, row.first - row.lift], LANES)).into_iter();
        let cut = if row.is_some() { 0..0 } else { cell * span..(cell + 1) * span };
        let of_cut = cut.filter_map(|batch| self.cut_batch(batch)).map(|batch| (batch.first, 1));
        of_table.chain(of_cut)
    }

    /// Control points of the phase field whose functions the points of a cell see, as rows of their indices.
    pub(crate) fn functions_of_cell(&self, cell: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        self.blocks_of_cell(cell).flat_map(move |([column, row], spans)| {
            let grid = self.patch_grid;
            let columns = column..(column + spans + self.degree[0]).min(grid.columns);
            (row..row + self.degree[1] + 1).map(move |row| grid.index(columns.start, row)..grid.index(columns.end, row))
        })
    }
}
