//! Batches and strips of the spans that the boundary cuts, which follow those of the tables, and the cells of
//! a lattice: a span of each lane over the points of a span, which sums and state are cut into.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::Lattice;
use super::cut::PointBox;
use super::sheets::FunctionIndex;
use super::tables::{CutBatch, CutPoint, first_function};
use crate::linear_algebra::lane::{LANES, Lane};
use crate::splines::patch::Patch;

impl Lattice {
    /// Number of batches that tables describe; those of cut spans follow.
    fn table_batches(&self) -> usize {
        self.rows.len() * self.tiles.len() * self.points_per_span()
    }

    /// Batches (eight points of eight spans, or of one) in the lattice; point state has this many [`Lane`]s.
    pub fn batches(&self) -> usize {
        self.table_batches() + self.cut.len()
    }

    /// Number of strips: those of tables and, behind them, those of cut spans.
    pub fn strips(&self) -> usize {
        self.table_strips() + self.cut.len().div_ceil(self.strip_batches())
    }

    /// Whether the boundary cuts spans.
    pub(crate) fn has_cut_spans(&self) -> bool {
        !self.cut.is_empty()
    }

    /// A batch of a span that the boundary cuts.
    #[inline(always)]
    pub(crate) fn cut_batch(&self, batch: usize) -> Option<&CutBatch> {
        if self.cut.is_empty() { None } else { self.cut.get(batch.checked_sub(self.table_batches())?) }
    }

    /// Batches of a strip of spans that the boundary cuts; none of any other.
    #[inline(always)]
    pub(crate) fn cut_strip(&self, strip: usize) -> &[CutBatch] {
        let Some(number) = strip.checked_sub(self.table_strips()) else { return &[] };
        let length = self.strip_batches();
        &self.cut[number * length..((number + 1) * length).min(self.cut.len())]
    }

    /// Control rows a strip contributes to.
    pub(crate) fn strip_control_rows(&self, strip: usize) -> Range<usize> {
        if strip < self.table_strips() {
            let rows = self.strip_rows(strip);
            return self.rows[rows.start].first..self.rows[rows.end - 1].first + self.degree[1] + 1;
        }
        self.cut_control_rows(strip, |batch| batch.lift)
    }

    /// Control rows that a strip of cut spans contributes to, so many rows behind those of the patch.
    pub(super) fn cut_control_rows(&self, strip: usize, lift: impl Fn(&CutBatch) -> usize) -> Range<usize> {
        let rows = self.cut_strip(strip).iter().map(|batch| batch.first[1] + lift(batch));
        let (low, high) = rows.fold((usize::MAX, 0), |(low, high), row| (low.min(row), high.max(row)));
        low..high + self.degree[1] + 1
    }

    /// Takes over the points of cut spans, in batches up to a whole number of spans of a tile, behind whole
    /// strips of tables.
    pub(super) fn append_cut(&mut self, patch: &Patch, points: Vec<CutPoint>) {
        let mut spans: BTreeMap<(usize, [usize; 2]), Vec<PointBox>> = BTreeMap::new();
        for CutPoint { span: [i, j], lift, point, .. } in points {
            spans.entry((lift, [j, i])).or_default().push(point);
        }
        let cut: BTreeSet<FunctionIndex> = spans.keys().map(|(_, [j, i])| first_function(patch, [*i, *j])).collect();
        let mut factor = self.factor.take().unwrap_or_else(|| vec![Lane::splat(1.0); self.table_batches()]);
        for (batch, factor) in factor.iter_mut().enumerate() {
            for lane in 0..LANES {
                if cut.contains(&self.first_of(batch, lane)) {
                    factor[lane] = fault!("points-of-cut-spans-twice", 0.0 => 1.0);
                }
            }
        }
        self.fill_strip(&mut Vec::new());
        factor.resize(self.table_batches(), Lane::ZERO);
        self.factor = Some(factor);
        let batches =
            spans.iter().flat_map(|((lift, [j, i]), points)| CutBatch::of_span(patch, [*i, *j], *lift, points));
        let mut batches: Vec<CutBatch> = batches.collect();
        let last = batches[batches.len() - 1].clone();
        batches.resize(batches.len().next_multiple_of(self.points_per_span()), CutBatch { weight: Lane::ZERO, ..last });
        self.cut = batches;
    }

    /// Number of cells; each has as many batches as a span has points.
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
