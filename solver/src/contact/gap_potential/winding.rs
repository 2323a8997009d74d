//! Whether a position is inside a body, by the winding number of its boundary.
//!
//! The boundary winds w times around a position: as often as it crosses a ray from there counterclockwise,
//! less as often as it does clockwise. The position is inside where w > 0. That changes only where the
//! position crosses the boundary, also beside corners and where a crushed corner crosses itself, so that a
//! depth with this sign is continuous. The side of the nearest place on which it lies does not have that
//! property (Jacobson, Kavan & Sorkine-Hornung 2013, *Robust inside-outside segmentation using generalized
//! winding numbers*).

use super::arc::{Arc, Outline};
use crate::linear_algebra::vectors::dot;

/// Direction of the ray, 1 rad: bodies seldom have corners in line with it.
const RAY: [f64; 2] = [0.540_302_305_868_139_8, 0.841_470_984_807_896_5];
/// Halvings of an arc near the position; round-off is reached.
const HALVINGS: usize = 50;

impl Outline {
    /// Whether a position, m, is inside the body.
    pub(crate) fn contains(&self, position: [f64; 2]) -> bool {
        let seen = |x: [f64; 2]| {
            let arm = [x[0] - position[0], x[1] - position[1]];
            [dot(arm, RAY), dot(arm, [-RAY[1], RAY[0]])]
        };
        // A box that lies behind the position or to one side of the ray holds no crossing.
        let is_met = |&(_, &[[left, low], [right, high]]): &(&Arc, &[[f64; 2]; 2])| {
            seen([right, high])[0] >= 0.0 && seen([left, high])[1] > 0.0 && seen([right, low])[1] <= 0.0
        };
        let met = self.arcs.iter().zip(&self.boxes).filter(is_met);
        let crossings = met.map(|(arc, _)| crossings(arc.control_polygon().map(seen), HALVINGS));
        crossings.sum::<i32>() > 0
    }
}

/// Crossings of a ray by a cubic with this control polygon, along the ray and to its left, m.
fn crossings(polygon: [[f64; 2]; 4], halvings: usize) -> i32 {
    let left = polygon.map(|[_, across]| across > 0.0);
    if left == [left[0]; 4] || polygon.iter().all(|[along, _]| *along < 0.0) {
        return 0;
    }
    if halvings == 0 || polygon.iter().all(|[along, _]| *along >= 0.0) {
        return i32::from(left[3]) - i32::from(left[0]);
    }
    let middle = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|d| 0.5 * (a[d] + b[d]));
    let [a, b, c, d] = polygon;
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
    let half = middle(abc, bcd);
    crossings([a, ab, abc, half], halvings - 1) + crossings([half, bcd, cd, d], halvings - 1)
}

#[cfg(test)]
mod tests {
    use super::super::arc::rule;
    use super::*;

    /// Straight lines between corners, m.
    fn polygon(corners: &[[f64; 2]]) -> Outline {
        let line = |(i, a): (usize, &[f64; 2])| {
            let b = corners[(i + 1) % corners.len()];
            Arc::new([*a, b], [[0, 1].map(|d| b[d] - a[d]); 2], &rule())
        };
        Outline::new(corners.iter().enumerate().map(line).collect(), 1.0)
    }

    #[test]
    fn beside_an_acute_corner_is_outside() {
        let wedge = polygon(&[[-1.0, 0.0], [0.0, 0.0], [-0.1, 1.0]]);
        assert!(!wedge.contains([0.5, 0.01]) && !wedge.contains([0.2, -0.5]) && wedge.contains([-0.3, 0.1]));
        assert!(!wedge.contains([-5.0, 0.1]) && !wedge.contains([0.0, 7.0]) && !wedge.contains([-0.05, 1.0]));
    }

    #[test]
    fn where_a_crushed_corner_crosses_itself_the_side_changes_on_the_boundary_only() {
        // The corner that was at (1, 1) is pushed through the opposite side: a loop winds the other way.
        let crushed = polygon(&[[0.0, 0.0], [1.0, 0.0], [0.5, -0.2], [0.0, 1.0]]);
        let (steps, mut crossings) = (4000, 0);
        let place = |i: i32| [-0.5 + 2.0 * f64::from(i) / f64::from(steps), 0.05];
        for i in 1..=steps {
            if crushed.contains(place(i - 1)) != crushed.contains(place(i)) {
                crossings += 1;
                let nearest = super::super::arc::nearest(place(i), &crushed, 0..4, |_| true).unwrap();
                assert!(nearest.distance < 1e-3, "{:?}: {}", place(i), nearest.distance);
            }
        }
        assert_eq!(crossings, 2);
        assert!(!crushed.contains([0.6, -0.05]));
    }

    #[test]
    fn a_hole_is_outside() {
        let square = polygon(&[[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]]);
        let hole = polygon(&[[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]]);
        let ring = Outline::new([square.arcs, hole.arcs].concat(), 1.0);
        assert!(ring.contains([0.5, 1.5]) && ring.contains([1.5, 2.5]) && !ring.contains([1.5, 1.5]));
    }
}
