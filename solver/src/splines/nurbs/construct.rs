//! Ready-made patches: affine rectangles and exact circular sectors.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::{Form, NurbsError, NurbsPatch, check};
use crate::splines::spline::SplineSpace;

impl NurbsPatch {
    /// The rectangle from `low` to `high` (m), mapped from the knots without distortion: control points at
    /// the Greville abscissae, weights one, [`Form::Affine`].
    ///
    /// # Errors
    /// For bad knots, or a rectangle without area.
    pub fn rectangle(
        degree: [usize; 2],
        knots: [&[f64]; 2],
        low: [f64; 2],
        high: [f64; 2],
    ) -> Result<Self, NurbsError> {
        for d in 0..2 {
            check::knots(d, degree[d], knots[d])?;
            if !(high[d] > low[d] && (high[d] - low[d]).is_finite()) {
                return Err(NurbsError::Empty(format!("a rectangle from {low:?} to {high:?} has no area")));
            }
        }
        let first = [0, 1].map(|d| knots[d][0]);
        let slope = [0, 1].map(|d| (high[d] - low[d]) / (knots[d][knots[d].len() - 1] - first[d]));
        let origin = [0, 1].map(|d| low[d] - slope[d] * first[d]);
        let [x, y] = [0, 1].map(|d| {
            let greville = SplineSpace::new(degree[d], knots[d]).greville();
            greville.into_iter().map(|g| origin[d] + slope[d] * g).collect::<Vec<_>>()
        });
        let control_points: Vec<_> = y.iter().flat_map(|&y| x.iter().map(move |&x| [x, y])).collect();
        let weights = vec![1.0; control_points.len()];
        Self::with_form(degree, knots, control_points, weights, Form::Affine { origin, slope })
    }

    /// The annular sector between two radii (m) about the origin, `angles` from first to last in radians,
    /// counter-clockwise.
    ///
    /// The first direction is radial, linear on knots from 0 to 1; the second is angular, rational quadratic
    /// on knots from 0 to 1, with one piece per quarter turn begun: arcs are exact circles. A full turn is a
    /// patch whose ends touch. With inner radius zero it is a sector of a disc, whose edge `ξ = 0` is
    /// collapsed to the centre; points at the centre itself cannot be located, since the Jacobian vanishes
    /// there.
    ///
    /// # Errors
    /// If not 0 ≤ inner < outer, or the angles do not grow or differ by more than a turn.
    pub fn annular_sector(inner: f64, outer: f64, angles: [f64; 2]) -> Result<Self, NurbsError> {
        ring(inner, outer)?;
        let turn = angles[1] - angles[0];
        if !(turn > 0.0 && turn <= TAU * (1.0 + 1e-15)) {
            let [start, end] = angles;
            return Err(NurbsError::Empty(format!("angles {start} to {end}: the second is larger, by a turn at most")));
        }
        // A quarter turn computed with round-off is still one piece.
        let pieces = ((turn / FRAC_PI_2 - 1e-12).ceil() as usize).max(1);
        let half = turn / (2 * pieces) as f64;
        let mut knots = vec![0.0; 3];
        knots.extend((1..pieces).flat_map(|i| [i as f64 / pieces as f64; 2]));
        knots.extend([1.0; 3]);
        let (mut control_points, mut weights) = (vec![], vec![]);
        for row in 0..=2 * pieces {
            let (sin, cos) = (angles[0] + half * row as f64).sin_cos();
            // Between two points of the circle the control point is where the tangents meet.
            let weight = if row % 2 == 1 { half.cos() } else { 1.0 };
            for radius in [inner, outer] {
                control_points.push([radius * cos / weight, radius * sin / weight]);
                weights.push(weight);
            }
        }
        Self::new([1, 2], [&[0.0, 0.0, 1.0, 1.0], &knots], control_points, weights)
    }

    /// The quarter of an annulus in the first quadrant, one exact rational quadratic piece.
    ///
    /// # Errors
    /// If not 0 ≤ inner < outer.
    pub fn quarter_annulus(inner: f64, outer: f64) -> Result<Self, NurbsError> {
        ring(inner, outer)?;
        let control_points =
            [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].iter().flat_map(|e| [inner, outer].map(|r| [r * e[0], r * e[1]]));
        let weights = [1.0, 1.0, 0.5, 0.5, 1.0, 1.0].map(f64::sqrt).to_vec();
        let arc = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        Self::new([1, 2], [&[0.0, 0.0, 1.0, 1.0], &arc], control_points.collect(), weights)
    }
}

/// Whether radii (m) are those of a ring.
fn ring(inner: f64, outer: f64) -> Result<(), NurbsError> {
    let holds = inner >= 0.0 && outer > inner && outer.is_finite();
    let what = || format!("radii {inner} and {outer}: the inner one is at least 0 and less than the outer one");
    if holds { Ok(()) } else { Err(NurbsError::Empty(what())) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn arcs_of_any_angle_are_circles() {
        for turn in [0.1, 1.0, FRAC_PI_2, 2.0, 3.0, 4.0, 5.5, TAU] {
            let sector = NurbsPatch::annular_sector(0.5, 1.0, [-0.3, turn - 0.3]).unwrap();
            for n in 0..=200 {
                for (xi, radius) in [(0.0, 0.5), (1.0, 1.0)] {
                    let parameters = [xi, n as f64 / 200.0];
                    let functions = sector.shape_functions(sector.find_span(parameters).unwrap(), parameters);
                    let [x, y] = sector.map(&functions).position;
                    assert_abs_diff_eq!(x.hypot(y), radius, epsilon = 1e-14);
                }
            }
            assert_eq!(sector.spaces()[1].spans().len(), (turn / FRAC_PI_2).ceil() as usize);
        }
    }

    #[test]
    fn the_quarter_annulus_is_the_sector_of_a_quarter_turn() {
        let quarter = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap();
        let sector = NurbsPatch::annular_sector(1.0, 2.0, [0.0, FRAC_PI_2]).unwrap();
        for (a, b) in quarter.control_points().iter().zip(sector.control_points()) {
            assert_abs_diff_eq!(a[0], b[0], epsilon = 1e-15);
            assert_abs_diff_eq!(a[1], b[1], epsilon = 1e-15);
        }
        for (a, b) in quarter.weights().iter().zip(sector.weights()) {
            assert_abs_diff_eq!(a, b, epsilon = 1e-15);
        }
    }

    #[test]
    fn impossible_shapes_are_refused() {
        assert!(matches!(NurbsPatch::quarter_annulus(2.0, 1.0), Err(NurbsError::Empty(_))));
        assert!(matches!(NurbsPatch::quarter_annulus(-1.0, 1.0), Err(NurbsError::Empty(_))));
        assert!(matches!(NurbsPatch::annular_sector(0.0, f64::NAN, [0.0, 1.0]), Err(NurbsError::Empty(_))));
        assert!(matches!(NurbsPatch::annular_sector(0.0, 1.0, [1.0, 1.0]), Err(NurbsError::Empty(_))));
        assert!(matches!(NurbsPatch::annular_sector(0.0, 1.0, [0.0, 7.0]), Err(NurbsError::Empty(_))));
        let knots: &[f64] = &[0.0, 0.0, 1.0, 1.0];
        let flat = NurbsPatch::rectangle([1, 1], [knots, knots], [0.0, 1.0], [1.0, 1.0]);
        assert!(matches!(flat, Err(NurbsError::Empty(_))));
    }
}
