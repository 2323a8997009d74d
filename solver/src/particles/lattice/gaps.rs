//! Gaps of a shape, which part what lies on both sides of them.

use std::collections::BTreeMap;

use super::sheets::FunctionIndex;
use crate::scene::Shape;
use crate::scene::edges::BoundaryEdge;
use crate::scene::shape::Segment;

/// What bars the step from a point to another one, beside slits.
pub(super) enum Gaps<'a> {
    /// Nothing.
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
