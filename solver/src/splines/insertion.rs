//! Knot insertion: control values of a spline in a space that holds its own.
//!
//! The control value of function j of the finer space is the polar form of the spline at the inner knots of
//! that function (Ramshaw 1989; Goldman and Lyche 1993), by de Boor's recursion with another knot in each
//! step.

use super::spline::{MAX_ORDER, SplineSpace};

/// Weights below this are round-off.
const NONE: f64 = 1e-13;

/// For each function of `fine` the functions of `coarse` that determine its control value, with weights whose
/// sum is 1.
pub(crate) fn knot_insertion(coarse: &SplineSpace, fine: &SplineSpace) -> Vec<Vec<(usize, f64)>> {
    let (p, knots, inserted) = (coarse.degree(), coarse.knot_vector(), fine.knot_vector());
    let row = |j: usize| {
        let meets = |span: &&super::spline::Span| (span.first..=span.first + p).contains(&j);
        let span = fine.spans().iter().find(meets).expect("a function has a span");
        let first = coarse.first_function(0.5 * (span.left + span.right)).expect("one of the coarse space");
        let mut weights = [[0.0; MAX_ORDER]; MAX_ORDER]; // of the result r, of coarse function first + i
        (0..=p).for_each(|r| weights[r][r] = 1.0);
        for step in 1..=p {
            for r in (step..=p).rev() {
                let (left, right) = (knots[first + r], knots[first + r + p + 1 - step]);
                let t = (inserted[j + step] - left) / (right - left);
                weights[r] = std::array::from_fn(|i| (1.0 - t) * weights[r - 1][i] + t * weights[r][i]);
            }
        }
        (0..=p).map(|i| (first + i, weights[p][i])).filter(|(_, weight)| weight.abs() > NONE).collect()
    };
    (0..fine.dimension()).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_keeps_its_values() {
        for degree in 1..=4 {
            let ends = |x: f64| std::iter::repeat_n(x, degree);
            let knots =
                |inner: &[f64]| -> Vec<f64> { ends(0.0).chain(inner.iter().copied()).chain(ends(1.0)).collect() };
            let coarse = SplineSpace::new(degree, &knots(&[0.0, 0.2, 0.3, 0.3, 0.7, 1.0]));
            let fine = SplineSpace::new(degree, &knots(&[0.0, 0.1, 0.2, 0.25, 0.3, 0.3, 0.5, 0.7, 0.85, 1.0]));
            let values: Vec<f64> = (0..coarse.dimension()).map(|i| ((i * i * 7) % 5) as f64 - 1.5).collect();
            let rows = knot_insertion(&coarse, &fine);
            let inserted: Vec<f64> =
                rows.iter().map(|row| row.iter().map(|(i, weight)| weight * values[*i]).sum()).collect();
            let at = |space: &SplineSpace, values: &[f64], x: f64| {
                let span = space.find_span(x).unwrap();
                let shape = space.shape_functions(span, x);
                let first = space.spans()[span].first;
                (0..=degree).map(|k| shape.value[k] * values[first + k]).sum::<f64>()
            };
            for x in [0.03, 0.12, 0.22, 0.28, 0.31, 0.6, 0.71, 0.99] {
                approx::assert_abs_diff_eq!(at(&coarse, &values, x), at(&fine, &inserted, x), epsilon = 1e-13);
            }
            assert!(rows.iter().all(|row| (row.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-13));
        }
    }
}
