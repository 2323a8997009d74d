//! Points of a patch with a geometry.
//!
//! The lattice is one of parameters, and each point has a [`MappedPoint`]. A rational field is a quotient of
//! two spline fields, `u = A/W` with `A = Σ N_a w_a u_a` and `W = Σ N_b w_b`, so that sums still factor:
//!
//! ```text
//! ∂u/∂ξ_d = (∂A/∂ξ_d − A ∂W/∂ξ_d / W)/W,   ∂u/∂x_j = Σ_d ∂u/∂ξ_d ∂ξ_d/∂x_j
//! ```

use crate::linear_algebra::lane::Lane;

/// Points of a patch with a geometry.
#[derive(Debug, Clone)]
pub(crate) struct Mapping {
    /// Weights of the control points, as a field.
    pub weights: Vec<f64>,
    /// One entry per batch.
    pub points: Vec<MappedPoint>,
}

impl Mapping {
    /// Heap memory, bytes.
    pub(super) fn bytes(&self) -> usize {
        8 * self.weights.len() + size_of::<MappedPoint>() * self.points.len()
    }
}

/// The weight function W and the geometry map at a batch of points.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct MappedPoint {
    /// 1/W.
    pub inverse_weight: Lane,
    /// `∂W/∂ξ_d / W`.
    pub weight_slope: [Lane; 2],
    /// `[∂ξ/∂x, ∂ξ/∂y, ∂η/∂x, ∂η/∂y]`, 1/m.
    pub inverse_jacobian: [Lane; 4],
    /// Position, m.
    pub position: [Lane; 2],
}

impl MappedPoint {
    /// Value and physical gradient of a rational field from the sum `A` and its parametric slopes.
    #[inline(always)]
    pub(crate) fn field(&self, sum: Lane, slopes: [Lane; 2]) -> (Lane, [Lane; 2]) {
        let value = sum * self.inverse_weight;
        let [u, v] = [0, 1].map(|d| slopes[d] * self.inverse_weight - value * self.weight_slope[d]);
        let [ux, uy, vx, vy] = self.inverse_jacobian;
        (value, [u * ux + v * vx, u * uy + v * vy])
    }

    /// The adjoint of [`Self::field`] for a force and a stress: factors of the spline and of its two
    /// parametric slopes.
    #[inline(always)]
    pub(crate) fn adjoint(&self, force: Lane, [x, y]: [Lane; 2]) -> (Lane, [Lane; 2]) {
        let [ux, uy, vx, vy] = self.inverse_jacobian;
        let [u, v] = [(x * ux + y * uy) * self.inverse_weight, (x * vx + y * vy) * self.inverse_weight];
        (force * self.inverse_weight - u * self.weight_slope[0] - v * self.weight_slope[1], [u, v])
    }
}
