//! Where a body is thin beneath its boundary, and which parts of that may meet each other.
//!
//! Beyond the middle of a thin part, the nearest place of its boundary is on the far face, and contact would
//! pull another body through it. So what is on the far face does not count where a part is thinner than
//! [`THICK`] spans, and contact follows most of the thickness. A wedge has no far face.
//!
//! The back of a body that is thin itself may follow its front into the other one. It enters by a face that
//! its normal does not tell from a far one. So a face that is very near counts, whichever it is.
//!
//! # A body that meets itself
//!
//! The two faces of a thin part look as if they overlapped by its thickness: each is behind the other. They
//! do not meet, since there is material between them. So two arcs may meet only if the straight line between
//! their middles leaves the body at t = 0.

use super::arc::Arc;

/// Thickness, in spans, from which on the middle is deeper than contact follows.
const THICK: f64 = 2.0;

/// Depths that are looked at up to there.
const LOOKS: usize = 32;

/// Distance from the ends of an arc, in arcs: a corner has no normal.
const BESIDE: f64 = 0.02;

/// Change of the thickness along an arc, in spans, from which on the part is a wedge.
const TAPER: f64 = 0.5;

/// Places along the line between two arcs that are looked at.
const PLACES: usize = 9;

/// Whether the body was thin beneath an arc of its boundary at t = 0, for each.
#[derive(Debug, Clone)]
pub(crate) struct ThinParts(Vec<bool>);

impl ThinParts {
    /// Those of a body that `contains` some positions, m, on a mesh whose shortest span has this length, m.
    pub(crate) fn new(arcs: &[Arc], span: f64, contains: impl Fn([f64; 2]) -> bool) -> Self {
        let thickness = |arc: &Arc, t: f64| {
            let (place, normal) = (arc.position(t), arc.normal(t));
            let mut looks = (1..LOOKS).map(|i| i as f64 / LOOKS as f64 * THICK * span);
            looks.find(|depth| !contains([0, 1].map(|d| place[d] - depth * normal[d])))
        };
        let is_thin = |arc: &Arc| {
            let [start, end] = [BESIDE, 1.0 - BESIDE].map(|t| thickness(arc, t));
            start.zip(end).is_some_and(|(start, end)| (end - start).abs() < TAPER * span)
        };
        Self(arcs.iter().map(is_thin).collect())
    }

    /// Whether the body is thin beneath an arc.
    pub(crate) fn is_thin(&self, arc: usize) -> bool {
        fault!("far-faces-count", self.0[arc] => false)
    }
}

/// For every pair of arcs of a boundary, whether they may meet.
#[derive(Debug, Clone)]
pub(crate) struct OwnPairs {
    arcs: usize,
    may_meet: Vec<bool>,
}

impl OwnPairs {
    /// Those of a boundary at t = 0 around a body that `contains` some positions, m.
    pub(crate) fn new(arcs: &[Arc], contains: impl Fn([f64; 2]) -> bool) -> Self {
        let middles: Vec<_> = arcs.iter().map(|arc| arc.position(0.5)).collect();
        let leaves = |a: [f64; 2], b: [f64; 2]| {
            let looks = (1..=PLACES).map(|i| i as f64 / (PLACES + 1) as f64);
            looks.map(|t| [0, 1].map(|d| a[d] + t * (b[d] - a[d]))).any(|place| !contains(place))
        };
        let mut may_meet = vec![false; arcs.len() * arcs.len()];
        for i in 0..arcs.len() {
            for j in 0..i {
                let meets = leaves(middles[i], middles[j]);
                (may_meet[i * arcs.len() + j], may_meet[j * arcs.len() + i]) = (meets, meets);
            }
        }
        Self { arcs: arcs.len(), may_meet }
    }

    /// Whether two arcs may meet.
    pub(crate) fn may_meet(&self, one: usize, other: usize) -> bool {
        self.may_meet[one * self.arcs + other]
    }
}
