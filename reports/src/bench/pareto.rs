//! Which of many ways is worth its cost.

/// Indices of the points `(cost, error)` that no other point beats in both, from the cheapest to the most
/// accurate. Points that are no numbers take no part.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let usable = |i: &usize| points[*i].0.is_finite() && points[*i].1.is_finite();
    let mut order: Vec<usize> = (0..points.len()).filter(usable).collect();
    let by = |i: usize, j: usize| points[i].0.total_cmp(&points[j].0).then(points[i].1.total_cmp(&points[j].1));
    order.sort_by(|i, j| by(*i, *j));
    let mut front: Vec<usize> = Vec::new();
    for i in order {
        if front.last().is_none_or(|&last| points[i].1 < points[last].1) {
            front.push(i);
        }
    }
    front
}

/// Cost of an error on a curve of points `(cost, error)`, between two neighbours on logarithmic axes; `None`
/// where the curve does not reach.
pub fn cost_of(curve: &[(f64, f64)], error: f64) -> Option<f64> {
    let mut sorted = curve.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let between = |pair: &&[(f64, f64)]| pair[0].1 >= error && pair[1].1 <= error && pair[0].1 > pair[1].1;
    sorted.windows(2).find(between).map(|pair| {
        let t = (pair[0].1 / error).ln() / (pair[0].1 / pair[1].1).ln();
        pair[0].0 * (pair[1].0 / pair[0].0).powf(t)
    })
}

/// Cost from which on the error of a curve is at most `error`: as [`cost_of`], or that of its cheapest point
/// if all are good enough. An error counts for a point if no dearer one has a larger error: a coarse mesh may
/// be right by chance, and nobody knows beforehand which one is.
pub fn cost_to_reach(curve: &[(f64, f64)], error: f64) -> Option<f64> {
    let mut kept = curve.to_vec();
    kept.sort_by(|a, b| a.0.total_cmp(&b.0));
    for i in (1..kept.len()).rev() {
        kept[i - 1].1 = kept[i - 1].1.max(kept[i].1);
    }
    let cheapest = kept.first()?;
    if cheapest.1 <= error { Some(cheapest.0) } else { cost_of(&kept, error) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_has_what_nothing_beats() {
        let points = [(1.0, 1.0), (2.0, 0.1), (2.0, 0.5), (3.0, 0.2), (f64::NAN, 0.0), (4.0, 0.01), (0.5, 2.0)];
        assert_eq!(front(&points), [6, 0, 1, 5]);
        assert!(front(&[]).is_empty());
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]).len(), 1, "one of two equal points");
    }

    #[test]
    fn costs_between_points_follow_power_laws() {
        let curve = [(1.0, 1.0), (100.0, 1e-4)];
        let found = cost_of(&curve, 1e-2).unwrap();
        assert!((found - 10.0).abs() <= 1e-12, "{found}");
        assert_eq!(cost_of(&curve, 1e-6), None);
        assert_eq!(cost_of(&curve, 2.0), None);
        assert_eq!((cost_to_reach(&curve, 2.0), cost_to_reach(&curve, 1e-6)), (Some(1.0), None));
        assert_eq!(cost_to_reach(&curve, 1e-2), Some(found));
    }

    #[test]
    fn an_error_that_is_small_by_chance_does_not_count() {
        let curve = [(1.0, 0.01), (2.0, 0.03), (4.0, 0.01), (8.0, 0.005)];
        let found = cost_to_reach(&curve, 0.02).unwrap();
        assert!((2.0..4.0).contains(&found), "{found}");
        assert_eq!(cost_to_reach(&curve, 0.03), Some(1.0));
        assert_eq!(cost_to_reach(&[(1.0, 0.01), (2.0, 0.03)], 0.02), None);
    }
}
