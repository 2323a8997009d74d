//! How thick a body is beneath its boundary.
//!
//! Beyond the middle of a thin part, the nearest place of its boundary is on the far face, and contact would
//! pull another body through it. So what is on the far face does not count where a part is thinner than
//! [`THICK`] spans, and contact follows most of the thickness. A wedge has no far face.

use super::arc::Arc;
use crate::linear_algebra::extremes::smaller;

/// Thickness, in spans, from which on the middle is deeper than contact follows.
pub(crate) const THICK: f64 = 2.0;
/// Depths that are looked at up to there.
const LOOKS: usize = 32;
/// Distance from the ends of an arc, in arcs: a corner has no normal.
const BESIDE: f64 = 0.02;
/// Change of the thickness along an arc, in spans, from which on the part is a wedge.
const TAPER: f64 = 0.5;
/// Part of the thickness that a boundary may be deep. A step may move it by what is left.
const FOLLOWED: f64 = 0.75;

/// Thickness beneath both ends of every arc of a boundary at t = 0, m; infinite beneath those of thick parts
/// and of wedges.
#[derive(Debug, Clone)]
pub(crate) struct Thickness(Vec<[f64; 2]>);

impl Thickness {
    /// Of a body that `contains` some positions, m, on a mesh whose shortest span has this length, m.
    pub(crate) fn new(arcs: &[Arc], span: f64, contains: impl Fn([f64; 2]) -> bool) -> Self {
        let beneath = |arc: &Arc, t: f64| {
            let (place, normal) = (arc.position(t), arc.normal(t));
            let mut looks = (1..LOOKS).map(|i| i as f64 / LOOKS as f64 * THICK * span);
            let left = |depth: &f64| !contains([0, 1].map(|d| place[d] - depth * normal[d]));
            looks.find(left).unwrap_or(f64::INFINITY)
        };
        let thickness = |arc: &Arc| {
            let [start, end] = [BESIDE, 1.0 - BESIDE].map(|t| beneath(arc, t));
            if (end - start).abs() < TAPER * span { [start, end] } else { [f64::INFINITY; 2] }
        };
        Self(arcs.iter().map(thickness).collect())
    }

    /// Whether the body is thin beneath an arc.
    pub(crate) fn is_thin(&self, arc: usize) -> bool {
        fault!("far-faces-count", self.0[arc][0].is_finite() => false)
    }

    /// Depth beneath a place, by its label, that contact follows, m, where it follows `most` if the body is
    /// thick.
    pub(crate) fn followed(&self, (arc, t): (usize, f64), most: f64) -> f64 {
        let [start, end] = self.0[arc];
        if self.is_thin(arc) { smaller(FOLLOWED * (start + t * (end - start)), most) } else { most }
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.0.len() * size_of::<[f64; 2]>()
    }
}
