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

/// Depth of y under the boundary, in spans: that of the outermost points where there are two in a span.
pub const DEPTH: f64 = 0.5;

/// Weights of control points (index in the nodal fields) that stand for `position` (m), near the point `inside` (m) of the
/// body; `None` if it has no material there.
pub fn handle(field: &DiscreteField, position: [f64; 2], inside: [f64; 2]) -> Option<Vec<(usize, f64)>> {
    let (patch, nodes) = (field.patch(), field.nodes());
    let place = Follower::continued(inside, inside, patch, field.cells())?;
    let mut weights = Vec::new();
    place.for_each_function(patch, nodes.grid, |at, n| {
        let weight = n.max(0.0) * nodes.mass[at];
        if weight > 0.0 && nodes.inverse_mass[at] > 0.0 {
            weights.push((at, weight));
        }
    });
    let scale = [0, 1].map(|d| patch.spaces[d].spans()[0].length());
    let arm = |at: usize| {
        let [x, y] = nodes.position(at);
        Vector3::new(1.0, (x - position[0]) / scale[0], (y - position[1]) / scale[1])
    };
    let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let mut moments = Matrix3::zeros();
    for (at, weight) in &mut weights {
        *weight /= total;
        moments += *weight * arm(*at) * arm(*at).transpose();
    }
    let fit = moments.cholesky()?.solve(&Vector3::x());
    for (at, weight) in &mut weights {
        *weight *= fit.dot(&arm(*at));
    }
    let rounded: f64 = weights.iter().map(|(_, weight)| weight).sum();
    weights.iter_mut().for_each(|(_, weight)| *weight /= rounded);
    Some(weights)
}
