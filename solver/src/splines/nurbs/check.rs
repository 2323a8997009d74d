//! What a patch must satisfy before it is one.

use super::error::NurbsError;
use crate::splines::spline::MAX_DEGREE;

/// Degree and open knot vector of one direction.
///
/// # Errors
/// What is wrong with them, and where.
pub(crate) fn knots(direction: usize, degree: usize, knots: &[f64]) -> Result<(), NurbsError> {
    let wrong = |what: String| Err(NurbsError::Knots { direction, what });
    if !(1..=MAX_DEGREE).contains(&degree) {
        return wrong(format!("degree {degree} is not from 1 to {MAX_DEGREE}"));
    }
    let (count, least) = (knots.len(), 2 * (degree + 1));
    if count < least {
        return wrong(format!(
            "{count} knots are too few; an open knot vector of degree {degree} has at least {least}"
        ));
    }
    if let Some(index) = knots.iter().position(|k| !k.is_finite()) {
        return wrong(format!("knot {index} is {}; knots are finite numbers", knots[index]));
    }
    if let Some(index) = (1..count).find(|&i| knots[i] < knots[i - 1]) {
        let [previous, knot] = [knots[index - 1], knots[index]];
        return wrong(format!("knot {index} is {knot}, less than {previous} before it; knots never decrease"));
    }
    let (low, high, ends) = (knots[0], knots[count - 1], degree + 1);
    for group in knots.chunk_by(|a, b| a == b) {
        let (knot, times) = (group[0], group.len());
        let is_end = knot == low || knot == high;
        if is_end && times != ends {
            return wrong(format!("end knot {knot} stands {times} times; an open knot vector repeats it {ends} times"));
        } else if !is_end && times > degree {
            return wrong(format!("inner knot {knot} stands {times} times; more than {degree} tear the patch"));
        }
    }
    Ok(())
}

/// Counts, finite control points, positive weights.
pub(super) fn control_net(
    [columns, rows]: [usize; 2],
    control_points: &[[f64; 2]],
    weights: &[f64],
) -> Result<(), NurbsError> {
    let (given, expected) = ([control_points.len(), weights.len()], columns * rows);
    if given[0] != expected {
        let what = format!("{} control points; the knots and degrees ask for {columns} x {rows}", given[0]);
        return Err(NurbsError::ControlPoints(what));
    }
    if given[1] != expected {
        return Err(NurbsError::Weights(format!("{} weights for {expected} control points", given[1])));
    }
    for (n, (point, &weight)) in control_points.iter().zip(weights).enumerate() {
        let place = format!("control point ({}, {})", n % columns, n / columns);
        if !point.iter().all(|x| x.is_finite()) {
            return Err(NurbsError::ControlPoints(format!("{place} is {point:?}; coordinates are finite numbers")));
        }
        if !(weight > 0.0 && weight.is_finite()) {
            let what = format!("the weight of {place} is {weight}; weights are positive and finite");
            return Err(NurbsError::Weights(what));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::splines::nurbs::NurbsPatch;

    type Patched = Result<NurbsPatch, NurbsError>;

    fn square(knots: &[f64], points: [[f64; 2]; 4], weights: [f64; 4]) -> Patched {
        NurbsPatch::new([1, 1], [knots, &[0.0, 0.0, 1.0, 1.0]], points.to_vec(), weights.to_vec())
    }

    const KNOTS: [f64; 4] = [0.0, 0.0, 1.0, 1.0];
    const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];

    #[test]
    fn bad_knots_are_refused_where_they_are() {
        let refuse = |degree, vector: &[f64]| knots(1, degree, vector).unwrap_err().to_string();
        for (degree, vector, said) in [
            (5, &KNOTS[..], "direction 1: degree 5 is not from 1 to 4"),
            (0, &KNOTS, "direction 1: degree 0 is not from 1 to 4"),
            (2, &KNOTS, "4 knots are too few; an open knot vector of degree 2 has at least 6"),
            (1, &[0.0, 0.0, f64::NAN, 1.0, 1.0], "knot 2 is NaN"),
            (1, &[0.0, 0.0, 0.5, 0.4, 1.0, 1.0], "knot 3 is 0.4, less than 0.5"),
            (1, &[0.0, 0.5, 1.0, 1.0], "end knot 0 stands 1 times; an open knot vector repeats it 2 times"),
            (1, &[0.0, 0.0, 0.0, 1.0, 1.0], "stands 3 times"),
            (1, &[1.0, 1.0, 1.0, 1.0], "stands 4 times"),
            (1, &[0.0, 0.0, 0.5, 0.5, 1.0, 1.0], "inner knot 0.5 stands 2 times; more than 1 tear"),
        ] {
            assert!(refuse(degree, vector).contains(said), "{}", refuse(degree, vector));
        }
    }

    #[test]
    fn bad_control_nets_are_refused_where_they_are() {
        assert!(square(&KNOTS, CORNERS, [1.0; 4]).is_ok());
        let error = square(&[0.0, 0.0, 0.5, 1.0, 1.0], CORNERS, [1.0; 4]).unwrap_err();
        assert!(error.to_string().starts_with("4 control points; the knots and degrees ask for 3 x 2"), "{error}");
        let error = NurbsPatch::new([1, 1], [&KNOTS, &KNOTS], CORNERS.to_vec(), vec![1.0; 3]).unwrap_err();
        assert_eq!(error, NurbsError::Weights("3 weights for 4 control points".to_string()));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = square(&KNOTS, CORNERS, [1.0, 1.0, bad, 1.0]).unwrap_err();
            assert!(error.to_string().starts_with("the weight of control point (0, 1)"), "{error}");
        }
        let mut points = CORNERS;
        points[3][1] = f64::NAN;
        let error = square(&KNOTS, points, [1.0; 4]).unwrap_err();
        assert!(error.to_string().starts_with("control point (1, 1)"), "{error}");
    }

    #[test]
    fn folded_and_inverted_geometry_is_refused() {
        let [a, b, c, d] = CORNERS;
        for points in [[b, a, d, c], [a, b, d, c], [a, b, c, [0.2, 0.2]], [a, a, c, c]] {
            let error = square(&KNOTS, points, [1.0; 4]).unwrap_err();
            assert!(matches!(error, NurbsError::Folded { span: [0, 0], .. }), "{error}");
            assert!(error.to_string().contains("span (0, 0)"), "{error}");
        }
    }
}
