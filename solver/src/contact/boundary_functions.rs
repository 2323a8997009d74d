//! The control points that stand for a position on the boundary of a body.
//!
//! They are those of its shape functions there, as for loads and conditions on edges (`particles::follower`):
//! affine velocity fields have their values at the position, and an impulse is spread with neither momentum
//! nor torque lost.

use super::view::BodyView;
use crate::linear_algebra::control_grid::VectorField;
use crate::particles::follower::Follower;
use crate::splines::spline::MAX_FUNCTIONS;

/// Weights of control points that stand for a position of a body.
#[derive(Debug, Clone, Copy, Default)]
pub struct BoundaryFunctions {
    weights: [(usize, f64); MAX_FUNCTIONS],
    count: usize,
}

impl BoundaryFunctions {
    /// Stands for `position` (m); `None` if there is no material of the body within a span of it.
    pub fn new(body: &BodyView, position: [f64; 2]) -> Option<Self> {
        let place = Follower::carried(position, body.patch, body.inverse_mass, body.density)?;
        let mut functions = Self { weights: [(0, 0.0); MAX_FUNCTIONS], count: 0 };
        place.for_each_function(body.patch, body.grid, |at, n| {
            functions.weights[functions.count] = (at, fault!("impulse-beside-its-place", n => n * n));
            functions.count += 1;
        });
        Some(functions)
    }

    /// Index in the nodal fields and weight of every control point.
    pub fn weights(&self) -> &[(usize, f64)] {
        &self.weights[..self.count]
    }

    /// Value of a field on the control points at the position.
    pub fn value(&self, field: &VectorField) -> [f64; 2] {
        [0, 1].map(|c| self.weights().iter().map(|&(at, weight)| weight * field[c][at]).sum())
    }
}
