//! A body looked at position by position.

use std::cell::Cell;

use super::geometry::complexity;
use super::ground::Ground;
use crate::scene::{Analysis, Body, Frame};
use crate::splines::nurbs::NurbsPatch;

/// Relative tolerance of "inside", of the size of the mesh or body.
pub(super) const TOLERANCE: f64 = crate::splines::spline::ROUND_OFF;
/// Most positions along a line.
pub(super) const MOST_POSITIONS: usize = 10_000;
/// Most tests of a position against a corner or circle, over all lines of a body: a tenth of a second.
const MOST_LOOKS: usize = 10_000_000;
/// Such tests that cost as much as to find a position on a general patch.
const COST_OF_LOCATING: usize = 200;

/// A body looked at position by position.
pub(super) struct Look<'a> {
    pub body: &'a Body,
    pub ground: &'a Ground<'a>,
    /// End of the simulated time, s.
    pub end_time: f64,
    pub frame: Frame,
    tolerance: f64,
    /// Parameters of the last position found on the patch.
    last: Cell<Option<[f64; 2]>>,
    /// Most positions along one line: the more lines and corners, the fewer.
    pub most: usize,
}

impl<'a> Look<'a> {
    pub(super) fn new(body: &'a Body, ground: &'a Ground<'a>, analysis: &Analysis) -> Self {
        let (min, max) = ground.mesh.extent(&body.shape);
        let lines = body.cracks.len() + body.tractions.len() + body.conditions.len();
        let cost = lines * (complexity(&body.shape) + if ground.patch.is_some() { COST_OF_LOCATING } else { 0 });
        Self {
            body,
            ground,
            end_time: analysis.end_time,
            frame: analysis.frame,
            tolerance: TOLERANCE * (max[0] - min[0]).max(max[1] - min[1]),
            last: Cell::new(None),
            most: (MOST_LOOKS / cost.max(1)).clamp(2, MOST_POSITIONS),
        }
    }

    pub(super) fn is_outside(&self, position: [f64; 2]) -> bool {
        let off_patch = || self.ground.patch.as_ref().is_some_and(|patch| !self.is_on(patch, position));
        !self.body.shape.contains_within(position, self.tolerance) || off_patch()
    }

    /// Whether a position (m) is on a patch; searched from the one before, which is near.
    fn is_on(&self, patch: &NurbsPatch, position: [f64; 2]) -> bool {
        let found = patch.locate(position, self.last.get());
        found.map(|location| self.last.set(Some(location.parameters))).is_ok()
    }

    /// First of about `intervals + 1` equally spaced positions (m) between two ends, both included, that is
    /// not in the closure of the body.
    pub(super) fn first_outside(&self, [from, to]: [[f64; 2]; 2], intervals: usize) -> Option<[f64; 2]> {
        let intervals = intervals.min(self.most - 1);
        let position = |i: usize| {
            let t = i as f64 / intervals as f64;
            [0, 1].map(|d| (1.0 - t) * from[d] + t * to[d])
        };
        (0..=intervals).map(position).find(|p| self.is_outside(*p))
    }
}
