//! Points of the spans that the boundary cuts, eight points of one span side by side.

use super::cut::PointBox;
use super::sheets::FunctionIndex;
use crate::linear_algebra::lane::{LANES, Lane};
use crate::splines::patch::Patch;
use crate::splines::spline::MAX_ORDER;

/// A point of a span that the boundary cuts.
pub(super) struct CutPoint {
    /// Column and row of the span.
    pub span: [usize; 2],
    /// Column and row of its first function.
    pub first: FunctionIndex,
    /// Position and box, m.
    pub point: PointBox,
    /// Rows by which its control points lie behind those of the patch.
    pub lift: usize,
}

impl CutPoint {
    /// The points of a span.
    pub(super) fn of_span(patch: &Patch, span: [usize; 2], points: Vec<PointBox>) -> impl Iterator<Item = Self> {
        let first = first_function(patch, span);
        points.into_iter().map(move |point| Self { span, first, point, lift: 0 })
    }
}

/// Eight points of one span.
#[derive(Debug, Clone, Default)]
pub(crate) struct CutBatch {
    /// Column and row of the first function of the span.
    pub first: FunctionIndex,
    /// Rows by which its control points lie behind those of the patch.
    pub lift: usize,
    /// Weights, m²; zero where there is no point.
    pub weight: Lane,
    /// Positions, m.
    pub position: [Lane; 2],
    /// Values of the basis functions in x and in y.
    pub value: [[Lane; MAX_ORDER]; 2],
    /// Their derivatives, 1/m.
    pub derivative: [[Lane; MAX_ORDER]; 2],
}

impl CutBatch {
    /// Batches of the points of a span.
    pub(super) fn of_span(
        patch: &Patch,
        span: [usize; 2],
        lift: usize,
        points: &[PointBox],
    ) -> impl Iterator<Item = Self> {
        let first = first_function(patch, span);
        points.chunks(LANES).map(move |points| {
            let mut batch = Self { first, lift, ..Self::default() };
            for lane in 0..LANES {
                let (position, [width, height]) = points.get(lane).copied().unwrap_or((points[0].0, [0.0; 2]));
                batch.weight[lane] = width * height;
                for d in 0..2 {
                    let functions = patch.spaces[d].shape_functions(span[d], position[d]);
                    batch.position[d][lane] = position[d];
                    for k in 0..MAX_ORDER {
                        batch.value[d][k][lane] = functions.value[k];
                        batch.derivative[d][k][lane] = functions.derivative[k];
                    }
                }
            }
            batch
        })
    }
}

/// Column and row of the first function of a span.
pub(super) fn first_function(patch: &Patch, span: [usize; 2]) -> FunctionIndex {
    [0, 1].map(|d| patch.spaces[d].spans()[span[d]].first)
}
