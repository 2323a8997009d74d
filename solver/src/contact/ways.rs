//! Ways of vertices in a step.

use crate::linear_algebra::extremes::{larger, smaller};

/// Least and largest way of vertices in each direction, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range([[f64; 2]; 2]);

impl Range {
    /// Of some ways, m.
    pub fn of(ways: impl Iterator<Item = [f64; 2]>) -> Self {
        Self(ways.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], way| {
            [[0, 1].map(|d| smaller(low[d], way[d])), [0, 1].map(|d| larger(high[d], way[d]))]
        }))
    }

    /// Bound of the relative way of two vertices, m; zero if there are none.
    pub fn past(&self, other: &Self) -> f64 {
        let along = |d: usize| (self.0[1][d] - other.0[0][d]).max(other.0[1][d] - self.0[0][d]).max(0.0);
        along(0).hypot(along(1))
    }
}
