//! Knot insertion (Boehm 1980): the same spline with more control values.
//!
//! Inserting u into the span `[U_k, U_(k+1))` replaces the control values `Q_i = a_i P_i + (1 − a_i) P_(i−1)`
//! with `a_i = (u − U_i)/(U_(i+p) − U_i)` for `k − p < i ≤ k`. These are convex combinations, so that
//! round-off does not grow.

use std::collections::BTreeMap;

use super::spline::SplineSpace;

/// Inserts `new` knots one by one into a line of control values; `mix(a, P, Q)` is `a P + (1 − a) Q`.
pub(crate) fn insert_knots<P: Clone>(
    space: &SplineSpace,
    new: &[f64],
    mut values: Vec<P>,
    mix: impl Fn(f64, &P, &P) -> P,
) -> Vec<P> {
    let (degree, mut knots) = (space.degree(), space.knot_vector().to_vec());
    for &u in new {
        let next = knots.partition_point(|&knot| knot <= u);
        let replaced: Vec<P> = (next - degree..next)
            .map(|i| {
                let a = fault!("inserted-knot-halves", (u - knots[i]) / (knots[i + degree] - knots[i]) => 0.5);
                mix(a, &values[i], &values[i - 1])
            })
            .collect();
        values.splice(next - degree..next - 1, replaced);
        knots.insert(next, u);
    }
    values
}

/// For each function of the space with `new` knots those of `space` that determine its control value, with
/// weights whose sum is 1.
pub(crate) fn knot_insertion(space: &SplineSpace, new: &[f64]) -> Vec<Vec<(usize, f64)>> {
    let rows = (0..space.dimension()).map(|i| vec![(i, 1.0)]).collect();
    insert_knots(space, new, rows, |a, one: &Vec<(usize, f64)>, other| {
        let mut sum = BTreeMap::new();
        for (part, row) in [(a, one), (1.0 - a, other)] {
            row.iter().for_each(|&(i, weight)| *sum.entry(i).or_insert(0.0) += part * weight);
        }
        sum.into_iter().filter(|(_, weight)| *weight > 0.0).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_halved_as_de_casteljau_does() {
        let space = SplineSpace::new(2, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        let inserted = |new: &[f64]| insert_knots(&space, new, vec![0.0, 2.0, 0.0], |a, p, q| a * p + (1.0 - a) * q);
        assert_eq!(inserted(&[0.5]), [0.0, 1.0, 1.0, 0.0]);
        assert_eq!(inserted(&[0.5, 0.5]), [0.0, 1.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn a_spline_keeps_its_values() {
        for degree in 1..=4 {
            let ends = |x: f64| std::iter::repeat_n(x, degree);
            let knots =
                |inner: &[f64]| -> Vec<f64> { ends(0.0).chain(inner.iter().copied()).chain(ends(1.0)).collect() };
            let coarse = SplineSpace::new(degree, &knots(&[0.0, 0.2, 0.3, 0.7, 1.0]));
            let fine = SplineSpace::new(degree, &knots(&[0.0, 0.1, 0.2, 0.25, 0.3, 0.5, 0.7, 0.85, 1.0]));
            let values: Vec<f64> = (0..coarse.dimension()).map(|i| ((i * i * 7) % 5) as f64 - 1.5).collect();
            let rows = knot_insertion(&coarse, &[0.25, 0.1, 0.85, 0.5]);
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
