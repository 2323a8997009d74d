//! Displacements of vertices in a step.

use crate::linear_algebra::extremes::{larger, smaller};

/// Least and largest displacement of vertices in each direction, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range([[f64; 2]; 2]);

impl Range {
    /// Of some displacements, m.
    pub fn of(displacements: impl Iterator<Item = [f64; 2]>) -> Self {
        Self(displacements.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], displacement| {
            [[0, 1].map(|d| smaller(low[d], displacement[d])), [0, 1].map(|d| larger(high[d], displacement[d]))]
        }))
    }

    /// Bound of the relative displacement of two vertices, m; zero if there are none.
    pub fn past(&self, other: &Self) -> f64 {
        let along = |d: usize| (self.0[1][d] - other.0[0][d]).max(other.0[1][d] - self.0[0][d]).max(0.0);
        along(0).hypot(along(1))
    }
}
