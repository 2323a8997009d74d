//! Which parts of the boundary of a body may meet each other.
//!
//! The two faces of a thin part look as if they overlapped by its thickness: each is behind the other. They
//! do not meet, since there is material between them. So two arcs may meet only if the straight line between
//! their middles leaves the body at t = 0.

use super::arc::Arc;

/// Places along the line between two arcs that are looked at.
const LOOKS: usize = 9;

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
            let looks = (1..=LOOKS).map(|i| i as f64 / (LOOKS + 1) as f64);
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
