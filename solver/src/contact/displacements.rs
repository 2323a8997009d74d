//! Displacements of vertices in a step.

use crate::linear_algebra::extremes::around;

/// Least and largest displacement of vertices in each direction, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range([[f64; 2]; 2]);

impl Range {
    /// Of some displacements, m.
    pub fn of(displacements: impl Iterator<Item = [f64; 2]>) -> Self {
        Self(around(displacements.map(|displacement| [displacement; 2])))
    }

    /// Bound of the relative displacement of two vertices, m; zero if there are none.
    pub fn past(&self, other: &Self) -> f64 {
        let along = |d: usize| (self.0[1][d] - other.0[0][d]).max(other.0[1][d] - self.0[0][d]).max(0.0);
        along(0).hypot(along(1))
    }
}
