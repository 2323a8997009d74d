//! Where a body is taken hold of on its boundary: weights of control points that stand for a position.
//!
//! The shape functions at the boundary would do, but for control points of next to no mass: a span that the outermost points
//! have only just entered has some, and they would take up an impulse and keep it from the body. The weights
//!
//! ```text
//! W_I = N_I(y) m_I [a + b · (x_I − x)],        Σ W_I = 1,   Σ W_I x_I = x
//! ```
//!
//! with y half a span below x and the masses m are a linear fit weighted with mass: they give affine velocity fields at x
//! exactly, spread an impulse with neither momentum nor torque lost, and let a control point take part as far as it has mass.

use nalgebra::{Matrix3, Vector3};

use crate::updated_frame::field::DiscreteField;
use crate::updated_frame::follower::Follower;
use crate::updated_frame::grid::VectorField;
use crate::updated_frame::transfer::MAX_FUNCTIONS;

/// Depth of y under the boundary, in spans: that of the outermost points where there are two in a span.
pub const DEPTH: f64 = 0.5;

/// Weights of control points that stand for a position of a body.
#[derive(Debug, Clone, Copy)]
pub struct Handle {
    weights: [(usize, f64); MAX_FUNCTIONS],
    count: usize,
}

impl Handle {
    /// Stands for `position` (m), near the point `inside` (m) of the body; `None` if it has no material there.
    pub fn new(field: &DiscreteField, position: [f64; 2], inside: [f64; 2]) -> Option<Self> {
        let (patch, nodes) = (field.patch(), field.nodes());
        let [x, y] = Follower::nearest(inside, patch, field.cells())?.shape_functions(patch);
        let per_span = [0, 1].map(|d| 1.0 / patch.spaces[d].spans()[0].length());
        let mut handle = Self { weights: [(0, 0.0); MAX_FUNCTIONS], count: 0 };
        let mut arms = [Vector3::zeros(); MAX_FUNCTIONS];
        let mut moments = Matrix3::zeros();
        for (row, ny) in y {
            let arm_y = (nodes.greville[1][row] - position[1]) * per_span[1];
            for (column, nx) in x.clone() {
                let at = nodes.grid.index(column, row);
                let weight = (nx * ny).max(0.0) * nodes.mass[at];
                if weight > 0.0 && nodes.inverse_mass[at] > 0.0 {
                    let arm = Vector3::new(1.0, (nodes.greville[0][column] - position[0]) * per_span[0], arm_y);
                    moments.ger(weight, &arm, &arm, 1.0);
                    arms[handle.count] = arm;
                    handle.weights[handle.count] = (at, weight);
                    handle.count += 1;
                }
            }
        }
        let fit = moments.cholesky()?.solve(&Vector3::x());
        let weights = &mut handle.weights[..handle.count];
        for ((_, weight), arm) in weights.iter_mut().zip(&arms) {
            *weight *= fit.dot(arm);
        }
        let rounded: f64 = weights.iter().map(|(_, weight)| weight).sum();
        weights.iter_mut().for_each(|(_, weight)| *weight /= rounded);
        Some(handle)
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
