//! The same geometry on more control points: knot insertion in homogeneous coordinates, and degree elevation.
//!
//! # Degree elevation by polar forms (Ramshaw 1989)
//!
//! The geometry is one degree higher and as smooth as before.
//! Raising the degree p by one repeats every distinct knot once more. With f the polar form (blossom) of a
//! polynomial piece, symmetric and affine in each of its p arguments, the polar form of the same piece as a
//! polynomial of degree p + 1 is `F(t_1 … t_(p+1)) = Σ_j f(all t but t_j)/(p + 1)`, and the new control point
//! i is F at the new knots `i + 1 … i + p + 1`. Any piece in the support of the new basis function i gives
//! the same number; taking the widest span among those knots bounds the extrapolation, hence round-off,
//! whatever the ratio of the spans.

use super::{NurbsError, NurbsPatch};
use crate::splines::insertion;
use crate::splines::spline::{MAX_DEGREE, MAX_ORDER};

impl NurbsPatch {
    /// The same geometry one degree higher in a direction (0 or 1).
    ///
    /// # Errors
    /// If the degree is already the highest.
    pub fn elevate(&self, direction: usize) -> Result<Self, NurbsError> {
        let space = &self.spaces[direction];
        let (degree, old) = (space.degree(), space.knot_vector());
        if degree == MAX_DEGREE {
            return Err(NurbsError::Knots { direction, what: format!("degree {} is too high", degree + 1) });
        }
        let raised: Vec<f64> = old.chunk_by(|a, b| a == b).flat_map(|group| [group, &group[..1]].concat()).collect();
        self.with_direction_changed(direction, degree + 1, &raised, |line| {
            (0..raised.len() - degree - 2)
                .map(|i| elevated_point(degree, old, line, &raised[i + 1..=i + degree + 1]))
                .collect()
        })
    }

    /// The same geometry with `new` knots inserted in a direction (0 or 1), in any order and repeated as
    /// given.
    ///
    /// # Errors
    /// If a knot is not strictly inside the patch, or appears more often than the degree afterwards.
    pub fn insert_knots(&self, direction: usize, new: &[f64]) -> Result<Self, NurbsError> {
        let space = &self.spaces[direction];
        let (degree, old) = (space.degree(), space.knot_vector());
        let mut all = [old, new].concat();
        all.sort_by(f64::total_cmp);
        super::check::knots(direction, degree, &all)?;
        self.with_direction_changed(direction, degree, &all, |line| {
            let mix = |a: f64, p: &[f64; 3], q: &[f64; 3]| [0, 1, 2].map(|c| a * p[c] + (1.0 - a) * q[c]);
            insertion::insert_knots(space, new, line.to_vec(), mix)
        })
    }

    /// The same geometry with every non-empty span of both directions cut into `parts` equal ones.
    ///
    /// # Panics
    /// If `parts` is zero.
    pub fn subdivide(&self, parts: usize) -> Result<Self, NurbsError> {
        assert!(parts > 0, "a span has at least one part");
        let mut patch = self.clone();
        for direction in 0..2 {
            let spans = self.spaces[direction].spans().iter();
            let new: Vec<f64> = spans
                .flat_map(|span| (1..parts).map(|i| span.left + span.length() * i as f64 / parts as f64))
                .collect();
            patch = patch.insert_knots(direction, &new)?;
        }
        Ok(patch)
    }
}

/// The control point of the raised spline whose knots are `arguments` (p + 1 of them, non-decreasing).
fn elevated_point(degree: usize, knots: &[f64], points: &[[f64; 3]], arguments: &[f64]) -> [f64; 3] {
    let index = widest_span(degree, knots, arguments[0], arguments[degree]);
    let (left, right) = (knots[index], knots[index + 1]);
    let bezier = bezier_points(degree, knots, points, index);
    let local: Vec<f64> = arguments.iter().map(|t| (t - left) / (right - left)).collect();
    let mut sum = [0.0; 3];
    for omitted in 0..=degree {
        let mut row = bezier;
        let rest = (0..=degree).filter(|&j| j != omitted).map(|j| local[j]);
        for (level, s) in rest.enumerate() {
            for k in 0..degree - level {
                row[k] = blend(row[k], row[k + 1], s);
            }
        }
        sum = [0, 1, 2].map(|c| sum[c] + row[0][c]);
    }
    sum.map(|x| x / (degree + 1) as f64)
}

/// Index of the left knot of the widest span in `[low, high]`, or of one that touches it if they are equal.
fn widest_span(degree: usize, knots: &[f64], low: f64, high: f64) -> usize {
    let width = |&i: &usize| knots[i + 1] - knots[i];
    (degree..knots.len() - degree - 1)
        .filter(|&i| knots[i + 1] > knots[i])
        .filter(|&i| {
            if low < high { knots[i] >= low && knots[i + 1] <= high } else { knots[i] == low || knots[i + 1] == low }
        })
        .max_by(|a, b| width(a).total_cmp(&width(b)))
        .expect("every group of consecutive raised knots holds or touches a span")
}

/// Bézier points of the piece on the span `[knots[index], knots[index + 1])`, by the de Boor recursion on its
/// ends.
fn bezier_points(degree: usize, knots: &[f64], points: &[[f64; 3]], index: usize) -> [[f64; 3]; MAX_ORDER] {
    let (left, right) = (knots[index], knots[index + 1]);
    let mut bezier = [[0.0; 3]; MAX_ORDER];
    for k in 0..=degree {
        let mut row = [[0.0; 3]; MAX_ORDER];
        row[..=degree].copy_from_slice(&points[index - degree..=index]);
        for level in 1..=degree {
            let t = if level <= degree - k { left } else { right };
            for m in 0..=degree - level {
                let start = knots[index - degree + m + level];
                let end = knots[index + m + 1];
                row[m] = blend(row[m], row[m + 1], (t - start) / (end - start));
            }
        }
        bezier[k] = row[0];
    }
    bezier
}

/// Point `(1 − s) a + s b` of the line through two points in homogeneous coordinates.
fn blend(a: [f64; 3], b: [f64; 3], s: f64) -> [f64; 3] {
    [0, 1, 2].map(|c| (1.0 - s) * a[c] + s * b[c])
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn a_bezier_parabola_becomes_the_textbook_cubic() {
        let points = [[0.0, 0.0, 1.0], [3.0, 6.0, 1.0], [6.0, 0.0, 1.0]];
        let knots = [0.0, 0.0, 0.0, 2.0, 2.0, 2.0];
        let raised = [0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0];
        let expected = [[0.0, 0.0, 1.0], [2.0, 4.0, 1.0], [4.0, 4.0, 1.0], [6.0, 0.0, 1.0]];
        for i in 0..4 {
            let point = elevated_point(2, &knots, &points, &raised[i + 1..i + 4]);
            for c in 0..3 {
                assert_abs_diff_eq!(point[c], expected[i][c], epsilon = 1e-15);
            }
        }
    }

    #[test]
    fn the_highest_degree_cannot_be_raised() {
        let mut patch = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap();
        for degree in 3..=4 {
            patch = patch.elevate(1).unwrap();
            assert_eq!(patch.spaces()[1].degree(), degree);
            assert_eq!(patch.spaces()[1].dimension(), degree + 1);
        }
        assert!(matches!(patch.elevate(1).unwrap_err(), NurbsError::Knots { direction: 1, .. }));
    }

    #[test]
    fn knots_outside_or_too_many_are_refused() {
        let patch = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap();
        for bad in [0.0, 1.0, -0.5, 2.0, f64::NAN] {
            let error = patch.insert_knots(1, &[0.5, bad]).unwrap_err();
            assert!(matches!(error, NurbsError::Knots { direction: 1, .. }), "{error}");
        }
        let error = patch.insert_knots(0, &[0.5, 0.5]).unwrap_err();
        assert!(matches!(error, NurbsError::Knots { direction: 0, .. }), "{error}");
        assert_eq!(patch.insert_knots(1, &[0.5, 0.5]).unwrap().spaces()[1].dimension(), 5);
        assert_eq!(patch.subdivide(4).unwrap().spaces()[0].spans().len(), 4);
    }
}
