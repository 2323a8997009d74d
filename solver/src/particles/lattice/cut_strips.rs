//! Batches and strips of the spans that the boundary cuts: they follow those of the tables.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::Lattice;
use super::cut::PointBox;
use super::cut_batch::{CutBatch, CutPoint, first_function};
use super::sheets::FunctionIndex;
use crate::linear_algebra::lane::{LANES, Lane};
use crate::splines::patch::Patch;

impl Lattice {
    /// Batches of tables.
    fn table_batches(&self) -> usize {
        self.rows.len() * self.tiles.len() * self.points_per_span()
    }

    /// Batches (eight points of eight spans, or of one) in the lattice; point state has this many [`Lane`]s.
    pub fn batches(&self) -> usize {
        self.table_batches() + self.cut.len()
    }

    /// Number of strips.
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
}
