//! Copies of control points, so that material on both sides of a slit shares no shape function (see
//! [`parting`](super::parting)).
//!
//! Copies are rows of control points behind those of the patch (a *sheet*), and the points that use them are
//! rows of spans of the same lattice, or batches of cut spans: kernels and threads do not know of slits. A
//! copy of a function that is whole is *tied* to its original. The phase field has no copies: it is
//! continuous across a slit. Gaps of a shape part what lies on both sides of them as slits do.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::scene::Shape;
use crate::scene::edges::BoundaryEdge;
use crate::scene::shape::{Segment, cross};

/// Column and row of a control point of the patch.
pub(super) type FunctionIndex = [usize; 2];

/// Sheets of control points behind those of the patch.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sheets {
    /// Control points that copy another one, and that one.
    pub(super) ties: Vec<(usize, usize)>,
    /// Control rows of each sheet, and the rows by which they lie behind those of the patch.
    pub(super) rows: Vec<(Range<usize>, usize)>,
    /// Of the spans with copies, by their first control point: positions of points (m), and the rows by which
    /// their control points lie behind those of the patch.
    pub(super) points: BTreeMap<FunctionIndex, Vec<([f64; 2], usize)>>,
    /// Straight parts of the slits, m.
    pub(super) slits: Vec<Segment>,
    /// The shape, if it may have gaps.
    pub(super) shape: Option<Shape>,
}

impl Sheets {
    /// Whether no control point is there twice.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Rows by which the control points of a position (m) lie behind those of the patch, in the span with
    /// this first control point: those of the nearest point on its side of slits and gaps, if one is there.
    pub(crate) fn lift(&self, first: FunctionIndex, position: [f64; 2]) -> usize {
        let Some(points) = self.points.get(&first) else { return 0 };
        let distance = |point: &[f64; 2]| (point[0] - position[0]).hypot(point[1] - position[1]);
        let apart = |point: &[f64; 2]| !self.on_one_side(*point, position);
        let order = |a: &[f64; 2], b: &[f64; 2]| apart(a).cmp(&apart(b)).then(distance(a).total_cmp(&distance(b)));
        points.iter().min_by(|a, b| order(&a.0, &b.0)).map_or(0, |(_, lift)| *lift)
    }

    /// Whether the span with this first control point has a point on the side of a position (m).
    pub(crate) fn has_side(&self, first: FunctionIndex, position: [f64; 2]) -> bool {
        self.points.get(&first).is_none_or(|points| points.iter().any(|point| self.on_one_side(point.0, position)))
    }

    fn on_one_side(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        let in_gap = self.shape.as_ref().is_some_and(|shape| shape.is_left_on([a, b]));
        !in_gap && !self.slits.iter().any(|slit| cross([a, b], *slit))
    }

    /// The control point that one copies, or itself.
    pub(crate) fn original(&self, at: usize) -> usize {
        self.ties.binary_search_by_key(&at, |tie| tie.0).map_or(at, |i| self.ties[i].1)
    }

    /// Moves what is at copies to their originals: forces, masses.
    pub(crate) fn fold(&self, field: &mut [f64]) {
        for &(copy, original) in &self.ties {
            let value = std::mem::take(&mut field[copy]);
            field[original] += fault!("copies-lose-their-share", value => 0.0);
        }
    }

    /// Gives copies what is at their originals: displacements, velocities.
    pub(crate) fn spread(&self, field: &mut VectorField) {
        for component in field {
            for &(copy, original) in &self.ties {
                component[copy] = fault!("slit-without-ties", component[original] => component[copy]);
            }
        }
    }

    /// A field without copies: what is there belongs to the control points of the patch.
    pub(super) fn onto_patch(&self, patch: ControlGrid, mut field: Vec<f64>) -> Vec<f64> {
        for (rows, lift) in &self.rows {
            for at in rows.start * patch.stride..rows.end * patch.stride {
                field[at - lift * patch.stride] += field[at];
            }
        }
        field.truncate(patch.len());
        field
    }

    /// Adds the rows of the sheets to a field of the patch, equal to those that they copy.
    pub(super) fn extend(&self, patch: ControlGrid, field: &mut Vec<f64>) {
        for (rows, lift) in &self.rows {
            let copied = (rows.start - lift) * patch.stride..(rows.end - lift) * patch.stride;
            field.extend_from_within(copied);
        }
    }
}

/// What bars the step from a point to another one, beside slits.
pub(super) enum Gaps<'a> {
    /// Nothing beside slits.
    None,
    /// What lies outside a shape.
    Of(&'a Shape),
    /// The edges of a shape, by the first functions of the spans that they run through.
    Between(BTreeMap<FunctionIndex, Vec<BoundaryEdge>>),
}

impl Gaps<'_> {
    /// Whether they bar a step (m) between two spans, given by their first functions, that touch.
    pub(super) fn bar(&self, step: Segment, [a, b]: [FunctionIndex; 2]) -> bool {
        match self {
            Self::None => false,
            Self::Of(shape) => shape.is_left_on(step),
            Self::Between(edges) => {
                let spans = [a, [a[0], b[1]], [b[0], a[1]], b];
                let spans = if a == b { &spans[..1] } else { &spans };
                spans.iter().filter_map(|span| edges.get(span)).flatten().any(|edge| edge.is_crossed(step))
            }
        }
    }
}
