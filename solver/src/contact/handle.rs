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

use crate::spline::MAX_ORDER;
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

/// Sums of weights, and of weights times arms and products of arms.
#[derive(Default)]
struct Moments {
    weight: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Handle {
    /// Stands for `position` (m), near the point `inside` (m) of the body; `None` if it has no material there.
    pub fn new(field: &DiscreteField, position: [f64; 2], inside: [f64; 2]) -> Option<Self> {
        let (patch, nodes) = (field.patch(), field.nodes());
        let [(column, nx), (row, ny)] = Follower::nearest(inside, patch, field.cells())?.shape_functions(patch);
        let [kx, ky] = [0, 1].map(|d| patch.spaces[d].degree() + 1);
        let arms = |d: usize, first: usize, count: usize| {
            let per_span = 1.0 / patch.spaces[d].spans()[0].length();
            let mut arms = [0.0; MAX_ORDER];
            for (arm, x) in arms.iter_mut().zip(&nodes.greville[d][first..first + count]) {
                *arm = (x - position[d]) * per_span;
            }
            arms
        };
        let (x, y) = (arms(0, column, kx), arms(1, row, ky));
        let mut weights = [0.0; MAX_FUNCTIONS];
        let mut moments = Moments::default();
        for l in 0..ky {
            for k in 0..kx {
                let at = nodes.grid.index(column + k, row + l);
                if nodes.inverse_mass[at] > 0.0 {
                    let weight = (nx.value[k] * ny.value[l]).max(0.0) * nodes.mass[at];
                    weights[l * kx + k] = weight;
                    moments.add(weight, x[k], y[l]);
                }
            }
        }
        let fit = moments.fit()?;
        let mut handle = Self { weights: [(0, 0.0); MAX_FUNCTIONS], count: 0 };
        for l in 0..ky {
            for k in 0..kx {
                let weight = weights[l * kx + k];
                if weight > 0.0 {
                    let at = nodes.grid.index(column + k, row + l);
                    handle.weights[handle.count] = (at, weight * (fit[0] + fit[1] * x[k] + fit[2] * y[l]));
                    handle.count += 1;
                }
            }
        }
        let rounded: f64 = handle.weights().iter().map(|(_, weight)| weight).sum();
        handle.weights[..handle.count].iter_mut().for_each(|(_, weight)| *weight /= rounded);
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

impl Moments {
    #[inline]
    fn add(&mut self, weight: f64, x: f64, y: f64) {
        self.weight += weight;
        self.x += weight * x;
        self.y += weight * y;
        self.xx += weight * x * x;
        self.xy += weight * x * y;
        self.yy += weight * y * y;
    }

    /// `a` and b of the fit `a + b · arm`, from the mean and the covariance of the arms; `None` if they lie on a line.
    fn fit(&self) -> Option<[f64; 3]> {
        let [x, y] = [self.x, self.y].map(|sum| sum / self.weight);
        let (xx, xy, yy) = (self.xx - self.x * x, self.xy - self.x * y, self.yy - self.y * y);
        let determinant = xx * yy - xy * xy;
        let b = [xy * y - yy * x, xy * x - xx * y].map(|b| b / determinant);
        (determinant > 0.0).then(|| [1.0 / self.weight - b[0] * x - b[1] * y, b[0], b[1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_stands_for_the_position_of_no_arm() {
        let points = [(2.0, 0.5, -0.5), (1.0, -0.25, 1.0), (3.0, -1.0, 0.25), (0.5, 1.0, 1.5)];
        let mut moments = Moments::default();
        points.iter().for_each(|&(weight, x, y)| moments.add(weight, x, y));
        let [a, bx, by] = moments.fit().unwrap();
        let sum = |value: fn(f64, f64) -> f64| -> f64 {
            points.iter().map(|&(weight, x, y)| weight * (a + bx * x + by * y) * value(x, y)).sum()
        };
        assert!((sum(|_, _| 1.0) - 1.0).abs() < 1e-14);
        assert!(sum(|x, _| x).abs() < 1e-14 && sum(|_, y| y).abs() < 1e-14);
        let mut line = Moments::default();
        [0.0, 1.0, 2.0].iter().for_each(|&x| line.add(1.0, x, 0.0));
        assert!(line.fit().is_none() && Moments::default().fit().is_none());
    }
}
