//! The fit of control points to a position on the boundary of a body: weights that stand for it.
//!
//! The shape functions at the boundary would do, but for control points of next to no mass: a span that the
//! outermost points have only just entered has some, and they would take up an impulse and keep it from the
//! body. The weights
//!
//! ```text
//! W_I = N_I(y) m_I [a + b · (x_I − x)],        Σ W_I = 1,   Σ W_I x_I = x
//! ```
//!
//! with y half a span below x and the masses m are a linear fit weighted with mass: they give affine velocity
//! fields at x exactly, spread an impulse with neither momentum nor torque lost, and let a control point take
//! part as far as it has mass.
//!
//! Where the control points that have mass lie on a line or at one place, or nearly so, there is no such fit,
//! or one that hangs on control points of next to no mass: its answer to an impulse, `Σ W²/m`, is then many
//! times that of the mean motion. There the fit leaves out the direction across the line (b along it), or
//! both (b = 0). The weights still sum to one, so momentum is kept; they stand for the place on the line
//! nearest to x, and the torque of the distance between both is lost.

use super::view::BodyView;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::vectors::dot;
use crate::particles::follower::Follower;
use crate::splines::spline::MAX_FUNCTIONS;
use crate::splines::spline::MAX_ORDER;

/// Depth of y under the boundary, in spans: that of the outermost points where there are two in a span.
pub const DEPTH: f64 = 0.5;

/// Weights of control points that stand for a position of a body.
#[derive(Debug, Clone, Copy, Default)]
pub struct BoundaryFit {
    weights: [(usize, f64); MAX_FUNCTIONS],
    count: usize,
}

/// Largest answer of a fit over that of the mean motion.
const MOST_ANSWER: f64 = 1e3;
/// Least `1 − r²` for a correlation r of both arms: round-off in the fit is that of numbers over it.
const LEAST_INDEPENDENCE: f64 = 1e-8;

/// A control point as a fit sees it.
#[derive(Clone, Copy, Default)]
struct Part {
    /// Index in the nodal fields.
    at: usize,
    weight: f64,
    inverse_mass: f64,
    /// Position from that stood for, in spans.
    arm: [f64; 2],
}

/// Centre of parts, and mean products of their arms from there.
struct Spread {
    weight: f64,
    center: [f64; 2],
    xx: f64,
    xy: f64,
    yy: f64,
}

impl BoundaryFit {
    /// Stands for `position` (m), near the point `inside` (m) of the body; `None` if it has no material
    /// there.
    pub fn new(body: &BodyView, position: [f64; 2], inside: [f64; 2]) -> Option<Self> {
        let patch = body.patch;
        let [(column, nx), (row, ny)] = Follower::nearest(inside, patch, body.cells)?.shape_functions(patch);
        let [kx, ky] = [0, 1].map(|d| patch.spaces[d].degree() + 1);
        let arms = |d: usize, first: usize, count: usize| {
            let per_span = 1.0 / patch.spaces[d].spans()[0].length();
            let mut arms = [0.0; MAX_ORDER];
            for (arm, x) in arms.iter_mut().zip(&body.greville[d][first..first + count]) {
                *arm = (x - position[d]) * per_span;
            }
            arms
        };
        let (x, y) = (arms(0, column, kx), arms(1, row, ky));
        let (mut parts, mut count) = ([Part::default(); MAX_FUNCTIONS], 0);
        for l in 0..ky {
            for k in 0..kx {
                let at = body.grid.index(column + k, row + l);
                let mass = fault!("impulse-not-mass-weighted", body.mass[at] => 1.0);
                let weight = nx.value[k] * ny.value[l] * mass;
                if body.inverse_mass[at] > 0.0 && weight > 0.0 {
                    parts[count] = Part { at, weight, inverse_mass: body.inverse_mass[at], arm: [x[k], y[l]] };
                    count += 1;
                }
            }
        }
        let weights = fit(&parts[..count])?;
        let mut boundary_fit = Self { weights: [(0, 0.0); MAX_FUNCTIONS], count };
        for ((entry, part), weight) in boundary_fit.weights.iter_mut().zip(&parts[..count]).zip(weights) {
            *entry = (part.at, weight);
        }
        let rounded: f64 = boundary_fit.weights().iter().map(|(_, weight)| weight).sum();
        boundary_fit.weights[..count].iter_mut().for_each(|(_, weight)| *weight /= rounded);
        Some(boundary_fit)
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

/// Weights of parts from the fit of highest order that is sound; `None` if there is no part.
fn fit(parts: &[Part]) -> Option<[f64; MAX_FUNCTIONS]> {
    let spread = Spread::of(parts)?;
    let weights = |slope: [f64; 2]| {
        let mut weights = [0.0; MAX_FUNCTIONS];
        for (weight, part) in weights.iter_mut().zip(parts) {
            let lever = fault!("impulse-beside-its-place", dot(slope, spread.off_center(part)) => 0.0);
            *weight = part.weight / spread.weight * (1.0 + lever);
        }
        weights
    };
    let answer = |weights: &[f64; MAX_FUNCTIONS]| -> f64 {
        weights.iter().zip(parts).map(|(weight, part)| weight * weight * part.inverse_mass).sum()
    };
    let mean = weights([0.0; 2]);
    let most = MOST_ANSWER * answer(&mean);
    let slopes = [spread.slope(), spread.slope_along()].into_iter().flatten();
    Some(slopes.map(weights).find(|weights| answer(weights) <= most).unwrap_or(mean))
}

impl Spread {
    fn of(parts: &[Part]) -> Option<Self> {
        let weight: f64 = parts.iter().map(|part| part.weight).sum();
        let center = [0, 1].map(|d| parts.iter().map(|part| part.weight * part.arm[d]).sum::<f64>() / weight);
        let spread = Self { weight, center, xx: 0.0, xy: 0.0, yy: 0.0 };
        let products = parts.iter().fold([0.0; 3], |[xx, xy, yy], part| {
            let ([x, y], share) = (spread.off_center(part), part.weight / weight);
            [xx + share * x * x, xy + share * x * y, yy + share * y * y]
        });
        let [xx, xy, yy] = products;
        (weight > 0.0).then_some(Self { xx, xy, yy, ..spread })
    }

    fn off_center(&self, part: &Part) -> [f64; 2] {
        [0, 1].map(|d| part.arm[d] - self.center[d])
    }

    /// Slope of the fit in both directions; `None` if the parts lie on a line to round-off.
    fn slope(&self) -> Option<[f64; 2]> {
        let Self { center: [x, y], xx, xy, yy, .. } = *self;
        let determinant = xx * yy - xy * xy;
        let sound = determinant > LEAST_INDEPENDENCE * xx * yy;
        sound.then(|| [(xy * y - yy * x) / determinant, (xy * x - xx * y) / determinant])
    }

    /// Slope of the fit in the direction in which the parts spread most; `None` if they are at one place.
    fn slope_along(&self) -> Option<[f64; 2]> {
        let Self { center, xx, xy, yy, .. } = *self;
        let difference = 0.5 * (xx - yy);
        let root = difference.hypot(xy);
        let along = if difference >= 0.0 { [difference + root, xy] } else { [xy, root - difference] };
        let most = 0.5 * (xx + yy) + root;
        let scale = most * dot(along, along);
        (scale > 0.0).then(|| along.map(|a| -a * dot(along, center) / scale))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(weight: f64, x: f64, y: f64) -> Part {
        Part { at: 0, weight, inverse_mass: 1.0 / weight, arm: [x, y] }
    }

    /// `Σ W`, `Σ W x`, `Σ W y`.
    fn sums(parts: &[Part]) -> [f64; 3] {
        let weights = fit(parts).unwrap();
        weights.iter().zip(parts).fold([0.0; 3], |[one, x, y], (w, p)| [one + w, x + w * p.arm[0], y + w * p.arm[1]])
    }

    #[test]
    fn the_fit_stands_for_the_position_of_no_arm() {
        let [one, x, y] =
            sums(&[part(2.0, 0.5, -0.5), part(1.0, -0.25, 1.0), part(3.0, -1.0, 0.25), part(0.5, 1.0, 1.5)]);
        assert!((one - 1.0).abs() < 1e-14 && x.abs() < 1e-14 && y.abs() < 1e-14, "{one} {x} {y}");
        assert!(fit(&[]).is_none());
    }

    /// On the line x + y = 1 no fit knows anything of the way across: the nearest place on it to the origin
    /// is (0.5, 0.5).
    #[test]
    fn parts_on_a_line_are_held_along_it() {
        for off in [0.0, 1e-17, 1e-12, 1e-7] {
            let line =
                [part(1.0, 0.0, 1.0), part(2.0, 0.25 + off, 0.75), part(1.0, 1.0, 0.0), part(0.5, -0.5, 1.5 + off)];
            let [one, x, y] = sums(&line);
            let error = (one - 1.0).abs().max((x - 0.5).abs()).max((y - 0.5).abs());
            assert!(error < 1e-6, "{off:e}: {one} {x} {y}");
        }
        let [one, x, y] = sums(&[part(1.0, 0.0, 0.5), part(3.0, 1.0, 0.5)]);
        assert!((one - 1.0).abs() < 1e-15 && x.abs() < 1e-15 && (y - 0.5).abs() < 1e-15, "{one} {x} {y}");
        assert_eq!(sums(&[part(2.0, 0.25, -0.5)]), [1.0, 0.25, -0.5], "one control point");
    }

    /// A control point of a billionth of the mass would carry half of the impulse.
    #[test]
    fn next_to_no_mass_is_not_taken_hold_of() {
        let parts =
            |light: f64| [part(1.0, -0.5, -0.5), part(1.0, 0.5, -0.5), part(light, -0.5, 0.5), part(light, 0.5, 0.5)];
        let [_, x, y] = sums(&parts(0.1));
        assert!(x.abs() < 1e-15 && y.abs() < 1e-15);
        let light = parts(1e-9);
        let [one, x, y] = sums(&light);
        assert!((one - 1.0).abs() < 1e-15 && x.abs() < 1e-15 && (y + 0.5).abs() < 1e-8, "{one} {x} {y}");
        assert!(fit(&light).unwrap().iter().all(|weight| weight.abs() <= 0.5 + 1e-8));
    }
}
