//! The part of the patch that the nodal fields of a body cover: the spans its points are in, and a margin.

use std::ops::Range;

use super::field::DiscreteField;
use super::grid::NodalFields;
use super::held_sides::constraints;
use super::velocity_transfer::VelocityTransfer;
use crate::particles::points::{Cells, OutsidePatch, Point};
use crate::splines::patch::Patch;

/// Spans around those with points, so that the part need not follow every step.
const MARGIN: usize = 4;

/// Spans with points in each direction, and the margin.
///
/// # Errors
/// A point outside the patch.
pub(crate) fn spans_around(whole: &Patch, points: &[Point]) -> Result<[Range<usize>; 2], OutsidePatch> {
    let mut ends = [[usize::MAX, 0]; 2];
    for point in points {
        for d in 0..2 {
            let span = whole.spaces[d].find_span(point.position[d]).ok_or(OutsidePatch(point.position))?;
            ends[d] = [ends[d][0].min(span), ends[d][1].max(span)];
        }
    }
    Ok([0, 1].map(|d| {
        let [first, last] = ends[d];
        first.saturating_sub(MARGIN)..(last + 1 + MARGIN).min(whole.spaces[d].spans().len())
    }))
}

/// First control column and row of a part.
pub(crate) fn origin(whole: &Patch, spans: &[Range<usize>; 2]) -> [usize; 2] {
    [0, 1].map(|d| whole.spaces[d].spans()[spans[d].start].first)
}

impl DiscreteField {
    /// Moves the part of the patch to where the points are, and sorts them. Nodal fields are rebuilt at every
    /// step; the phase field moves with the part.
    ///
    /// # Errors
    /// A point outside the patch.
    pub(super) fn follow(&mut self) -> Result<(), OutsidePatch> {
        let spans = spans_around(&self.whole, &self.points)?;
        self.occupy(&spans);
        self.cells.sort(&self.patch, &mut self.points)
    }

    /// Spans of the patch that the part consists of.
    pub(super) fn covered_spans(&self) -> [Range<usize>; 2] {
        [0, 1].map(|d| {
            let (whole, part) = (self.whole.spaces[d].spans(), self.patch.spaces[d].spans());
            let first = whole.partition_point(|span| span.left < part[0].left);
            first..first + part.len()
        })
    }

    /// Whether a point is in an outermost span of the part where the patch goes on: its domain may reach
    /// further.
    pub(super) fn reaches_beyond(&self) -> bool {
        let covered = self.covered_spans();
        let inner = [0, 1].map(|d| {
            let spans = self.patch.spaces[d].spans();
            let left = if covered[d].start > 0 { spans[0].right } else { f64::NEG_INFINITY };
            let ends = covered[d].end == self.whole.spaces[d].spans().len();
            left..if ends { f64::INFINITY } else { spans[spans.len() - 1].left }
        });
        self.points.iter().any(|point| (0..2).any(|d| !inner[d].contains(&point.position[d])))
    }

    /// Makes some spans of the patch the part; the points are to be sorted anew.
    pub(super) fn occupy(&mut self, spans: &[Range<usize>; 2]) {
        let (patch, origin) = (self.whole.part(spans), origin(&self.whole, spans));
        let constraints = constraints(&self.whole, &patch, origin, &self.sides);
        let shift = [0, 1].map(|d| origin[d] as isize - self.origin[d] as isize);
        self.nodes = NodalFields::new(&patch, constraints);
        self.velocity_transfer = VelocityTransfer::new(patch.control_grid(), self.velocity_transfer.transfer);
        if let Some(affine) = &mut self.affine {
            affine.follow(&patch);
        }
        if let Some(fracture) = &mut self.fracture {
            fracture.relocate(&patch, shift);
        }
        (self.patch, self.origin) = (patch, origin);
        self.cells = Cells::default();
    }
}
