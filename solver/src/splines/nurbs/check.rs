//! What a patch must satisfy before it is one.

use super::error::NurbsError;
use crate::splines::spline::MAX_DEGREE;

/// Degree and open knot vector of one direction.
pub(super) fn knots(direction: usize, degree: usize, knots: &[f64]) -> Result<(), NurbsError> {
    if !(1..=MAX_DEGREE).contains(&degree) {
        return Err(NurbsError::Degree { direction, degree });
    }
    let (count, least) = (knots.len(), 2 * (degree + 1));
    if count < least {
        return Err(NurbsError::KnotCount { direction, count, least });
    }
    if let Some(index) = knots.iter().position(|k| !k.is_finite()) {
        return Err(NurbsError::KnotNotFinite { direction, index, value: knots[index] });
    }
    if let Some(index) = (1..count).find(|&i| knots[i] < knots[i - 1]) {
        return Err(NurbsError::DecreasingKnots { direction, index, previous: knots[index - 1], value: knots[index] });
    }
    let (low, high) = (knots[0], knots[count - 1]);
    for group in knots.chunk_by(|a, b| a == b) {
        let (knot, times) = (group[0], group.len());
        if knot == low || knot == high {
            if times != degree + 1 {
                return Err(NurbsError::NotOpen { direction, knot, times, expected: degree + 1 });
            }
        } else if times > degree {
            return Err(NurbsError::TornKnot { direction, knot, times, degree });
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
    let expected = columns * rows;
    if control_points.len() != expected {
        return Err(NurbsError::ControlPointCount { given: control_points.len(), columns, rows });
    }
    if weights.len() != expected {
        return Err(NurbsError::WeightCount { given: weights.len(), expected });
    }
    for (n, (point, &weight)) in control_points.iter().zip(weights).enumerate() {
        let (column, row) = (n % columns, n / columns);
        if !point.iter().all(|x| x.is_finite()) {
            return Err(NurbsError::ControlPointNotFinite { column, row, value: *point });
        }
        if !(weight > 0.0 && weight.is_finite()) {
            return Err(NurbsError::Weight { column, row, value: weight });
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
        use NurbsError::*;
        let refuse = |degree, vector: &[f64]| knots(1, degree, vector).unwrap_err();
        assert_eq!(refuse(5, &KNOTS), Degree { direction: 1, degree: 5 });
        assert_eq!(refuse(0, &KNOTS), Degree { direction: 1, degree: 0 });
        assert_eq!(refuse(2, &KNOTS), KnotCount { direction: 1, count: 4, least: 6 });
        assert!(matches!(refuse(1, &[0.0, 0.0, f64::NAN, 1.0, 1.0]), KnotNotFinite { index: 2, .. }));
        assert_eq!(
            refuse(1, &[0.0, 0.0, 0.5, 0.4, 1.0, 1.0]),
            DecreasingKnots { direction: 1, index: 3, previous: 0.5, value: 0.4 }
        );
        assert!(matches!(refuse(1, &[0.0, 0.5, 1.0, 1.0]), NotOpen { times: 1, expected: 2, .. }));
        assert!(matches!(refuse(1, &[0.0, 0.0, 0.0, 1.0, 1.0]), NotOpen { times: 3, .. }));
        assert!(matches!(refuse(1, &[1.0, 1.0, 1.0, 1.0]), NotOpen { times: 4, .. }));
        assert!(matches!(refuse(1, &[0.0, 0.0, 0.5, 0.5, 1.0, 1.0]), TornKnot { times: 2, degree: 1, .. }));
    }

    #[test]
    fn bad_control_nets_are_refused_where_they_are() {
        assert!(square(&KNOTS, CORNERS, [1.0; 4]).is_ok());
        let error = square(&[0.0, 0.0, 0.5, 1.0, 1.0], CORNERS, [1.0; 4]).unwrap_err();
        assert_eq!(error, NurbsError::ControlPointCount { given: 4, columns: 3, rows: 2 });
        let error = NurbsPatch::new([1, 1], [&KNOTS, &KNOTS], CORNERS.to_vec(), vec![1.0; 3]).unwrap_err();
        assert_eq!(error, NurbsError::WeightCount { given: 3, expected: 4 });
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = square(&KNOTS, CORNERS, [1.0, 1.0, bad, 1.0]).unwrap_err();
            assert!(matches!(error, NurbsError::Weight { column: 0, row: 1, .. }), "{error}");
        }
        let mut points = CORNERS;
        points[3][1] = f64::NAN;
        let error = square(&KNOTS, points, [1.0; 4]).unwrap_err();
        assert!(matches!(error, NurbsError::ControlPointNotFinite { column: 1, row: 1, .. }), "{error}");
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
