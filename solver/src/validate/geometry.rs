//! Shapes that are empty or malformed, and their outlines.

use crate::linear_algebra::extremes::{larger, smaller};
use crate::scene::Shape;
use crate::scene::edges::{bounding_parts, steps_along};
use crate::scene::shape::{Segment, polygon_edges};
use crate::splines::nurbs::NurbsPatch;

pub(super) type Position = [f64; 2];

/// Most points looked at along a polygon, unless it has more corners.
const MOST_OUTLINE: usize = 4096;

/// Points looked at along a circle or a straight edge of a body on a general patch, and along a side of the
/// patch.
const OUTLINE_INTERVALS: usize = 64;

/// Sine of the angle between two lines that counts as none.
const ROUND_OFF: f64 = 1e-12;
/// Places looked at outwards from a boundary, and most of these positions times the corners of the shape.
const GAP_LOOKS: usize = 10;
const MOST_GAP_LOOKS: usize = 200_000;

/// Why a shape is empty or malformed, with a remedy.
pub(crate) fn defect(shape: &Shape) -> Option<(String, &'static str)> {
    let finite = |p: &Position| p.iter().all(|x| x.is_finite());
    match shape {
        Shape::Rectangle { min, max } => {
            let sound = finite(min) && finite(max) && (0..2).all(|d| min[d] < max[d]);
            (!sound).then(|| ("an empty rectangle: min is not below max".into(), "give min below max in x and in y"))
        }
        Shape::Disk { center, radius } => {
            let sound = finite(center) && radius.is_finite() && *radius > 0.0;
            (!sound).then(|| (format!("an empty disk of radius {radius} m"), "give a positive radius"))
        }
        Shape::Annulus { center, inner_radius: inner, outer_radius: outer } => {
            let sound = finite(center) && outer.is_finite() && *inner >= 0.0 && inner < outer;
            let what = || format!("an empty annulus between the radii {inner} m and {outer} m");
            (!sound).then(|| (what(), "give 0 <= inner_radius < outer_radius"))
        }
        Shape::Polygon { points } if points.len() < 3 => {
            Some((format!("a polygon of {} points", points.len()), "give at least three points"))
        }
        Shape::Polygon { points } => {
            let sound = points.iter().all(finite) && {
                let (min, max) = shape.bounding_box();
                area(points).abs() > 1e-12 * (max[0] - min[0]).max(max[1] - min[1]).powi(2)
            };
            if !sound {
                return Some(("a polygon without area".into(), "give the corners in order, not all on one line"));
            }
            let remedy = "give the corners in order around the boundary";
            crossing(points).map(|[x, y]| (format!("a polygon whose edges cross near ({x}, {y}) m"), remedy))
        }
        Shape::Patch => None,
        Shape::Union(shapes) if shapes.is_empty() => Some(("a union of no shapes".into(), "give its shapes")),
        Shape::Union(shapes) => shapes.iter().find_map(defect),
        Shape::Difference { of, minus } => defect(of).or_else(|| minus.iter().find_map(defect)),
    }
}

/// Middle of an edge of a polygon that another one crosses, m.
fn crossing(points: &[Position]) -> Option<Position> {
    let range = |[a, b]: &Segment| [smaller(a[0], b[0]), larger(a[0], b[0])];
    let mut edges: Vec<(usize, Segment)> = polygon_edges(points).enumerate().collect();
    edges.sort_by(|a, b| range(&a.1)[0].total_cmp(&range(&b.1)[0]));
    let side = |[a, b]: Segment, c: Position| {
        let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let size = (b[0] - a[0]).hypot(b[1] - a[1]) * (c[0] - a[0]).hypot(c[1] - a[1]);
        if twice.abs() <= ROUND_OFF * size { 0.0 } else { twice.signum() }
    };
    let parts = |line: Segment, [a, b]: Segment| side(line, a) * side(line, b) < 0.0;
    edges.iter().enumerate().find_map(|(n, (i, edge))| {
        let after = edges[n + 1..].iter().take_while(|other| range(&other.1)[0] <= range(edge)[1]);
        let apart = |j: usize| i.abs_diff(j) > 1 && i.abs_diff(j) + 1 < points.len();
        let mut crossed = after.filter(|(j, other)| apart(*j) && parts(*edge, *other) && parts(*other, *edge));
        crossed.next().map(|_| [0, 1].map(|d| 0.5 * (edge[0][d] + edge[1][d])))
    })
}

/// A place (m) on the boundary of a shape from which, outwards, there is material within a `reach` (m), and
/// the distance at which it was found, m: a gap, or the other side of a small hole.
pub(crate) fn narrow_gap(shape: &Shape, reach: f64) -> Option<(Position, f64)> {
    let parts = bounding_parts(shape);
    let most = MOST_GAP_LOOKS / complexity(shape).max(1);
    let length: f64 = parts.iter().map(|(edge, [from, to])| (to - from) * edge.length()).sum();
    let step = larger(0.25 * reach, length / most as f64);
    steps_along(&parts, step).find_map(|[place, inward]| {
        let at = |depth: f64| [0, 1].map(|d| place[d] - depth * inward[d]);
        let found = (1..=GAP_LOOKS).map(|k| reach * k as f64 / GAP_LOOKS as f64).find(|d| shape.contains(at(*d)));
        found.map(|depth| (place, depth))
    })
}

/// A shape that is cut out of another one that it does not reach.
pub(crate) fn cut_nowhere(shape: &Shape) -> Option<&Shape> {
    let Shape::Difference { of, minus } = shape else { return None };
    let reaches = |a: &Shape, b: &Shape| outline(a).into_iter().any(|place| b.contains(place));
    let crosses = |a: &Shape, b: &Shape| {
        let edges = b.edges();
        a.edges().iter().any(|edge| edges.iter().any(|other| !edge.meets(other).is_empty()))
    };
    let misses = |hole: &&Shape| !reaches(hole, of) && !reaches(of, hole) && !crosses(hole, of);
    minus.iter().find(|hole| **of != Shape::Patch && misses(hole))
}

/// Corners and circles of a shape: what a test of a position against it costs.
pub(crate) fn complexity(shape: &Shape) -> usize {
    match shape {
        Shape::Rectangle { .. } | Shape::Disk { .. } | Shape::Annulus { .. } | Shape::Patch => 1,
        Shape::Polygon { points } => points.len(),
        Shape::Union(shapes) => shapes.iter().map(complexity).sum(),
        Shape::Difference { of, minus } => complexity(of) + minus.iter().map(complexity).sum::<usize>(),
    }
}

/// Signed area of a polygon, m².
fn area(points: &[Position]) -> f64 {
    polygon_edges(points).map(|[a, b]| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

/// Points on the boundary of a shape (m), without that of what is cut out of it.
pub(crate) fn outline(shape: &Shape) -> Vec<[f64; 2]> {
    match shape {
        Shape::Union(shapes) => shapes.iter().flat_map(outline).collect(),
        Shape::Difference { of, .. } => outline(of),
        _ => {
            let edges = shape.edges();
            let n = (MOST_OUTLINE / edges.len().max(1)).clamp(1, OUTLINE_INTERVALS);
            edges.iter().flat_map(|edge| (0..n).map(|i| edge.at(i as f64 / n as f64).0)).collect()
        }
    }
}

/// A point (m) of the sides of a patch that lies inside a shape, not on its boundary.
pub(crate) fn covered_side(shape: &Shape, patch: &NurbsPatch) -> Option<[f64; 2]> {
    if is_patch(shape) {
        return None;
    }
    let margin = 1e-6 * patch.size();
    let ranges =
        patch.spaces().each_ref().map(|space| [space.spans()[0].left, space.spans()[space.spans().len() - 1].right]);
    let at = |d: usize, t: f64| (1.0 - t) * ranges[d][0] + t * ranges[d][1];
    let sides = (0..=OUTLINE_INTERVALS).map(|i| i as f64 / OUTLINE_INTERVALS as f64);
    let parameters = sides.flat_map(|t| [[t, 0.0], [t, 1.0], [0.0, t], [1.0, t]]).map(|[s, t]| [at(0, s), at(1, t)]);
    let position = |p: [f64; 2]| patch.find_span(p).map(|span| patch.map(&patch.shape_functions(span, p)).position);
    parameters.filter_map(position).find(|x| shape.contains_within(*x, -margin))
}

/// Whether a shape is the whole patch, less what is cut out of it.
fn is_patch(shape: &Shape) -> bool {
    match shape {
        Shape::Union(shapes) => shapes.iter().any(is_patch),
        Shape::Difference { of, .. } => is_patch(of),
        _ => *shape == Shape::Patch,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_over_a_hole_covers_its_side() {
        use std::f64::consts::PI;
        let half_ring = NurbsPatch::annular_sector(1.0, 3.0, [0.0, PI]).unwrap();
        let disk = |x: f64, y: f64, radius: f64| Shape::Disk { center: [x, y], radius };
        assert!(covered_side(&disk(0.0, 1.2, 1.1), &half_ring).is_some(), "over the inner side");
        assert!(covered_side(&disk(0.0, 2.0, 1.0), &half_ring).is_none(), "touching both arcs");
        assert!(covered_side(&disk(-1.5, 1.5, 0.5), &half_ring).is_none(), "well inside");
        assert!(covered_side(&Shape::Patch, &half_ring).is_none());
        let cut = Shape::Difference { of: Box::new(Shape::Patch), minus: vec![disk(0.0, 2.0, 0.5)] };
        assert!(covered_side(&cut, &half_ring).is_none(), "the patch less a disk");

        // Almost closed, so that the outline of a disk over the hole lies on the patch but where the ring is
        // open.
        let ring = NurbsPatch::annular_sector(1.0, 3.0, [0.0, 2.0 * PI - 1e-3]).unwrap();
        let hole = || vec![disk(0.0, 0.0, 1.0)];
        let around_hole = Shape::Difference { of: Box::new(disk(0.0, 0.0, 2.0)), minus: hole() };
        let [x, y] = covered_side(&disk(0.0, 0.0, 2.0), &ring).unwrap();
        assert!(x.hypot(y) <= 2.0);
        let [x, y] = covered_side(&around_hole, &ring).expect("the opening is still covered");
        assert!(x.hypot(y) > 1.0 && y.abs() < 1e-2, "not the side of the hole: ({x}, {y})");
    }

    #[test]
    fn edges_that_cross_are_told_from_those_that_touch() {
        let refused = |points: &[Position]| defect(&Shape::Polygon { points: points.to_vec() }).is_some();
        let bow = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]];
        assert!(refused(&bow) && refused(&bow.map(|[x, y]| [-y, x])), "in any direction");
        assert!(!refused(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]]), "a re-entrant corner");
        let keyhole = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0], [0.0, 0.0], [1.0, 1.0], [1.0, 2.0], [2.0, 1.0]];
        assert!(!refused(&[&keyhole[..], &[[1.0, 1.0]]].concat()), "a hole joined to the outside by a line");
    }

    #[test]
    fn narrow_gaps_and_small_holes_are_found() {
        let block = |x: f64| Shape::Rectangle { min: [x, 0.0], max: [x + 1.0, 1.0] };
        let apart = |gap: f64| narrow_gap(&Shape::Union(vec![block(0.0), block(1.0 + gap)]), 0.25).is_some();
        assert!(apart(0.02) && apart(0.24) && !apart(0.26));
        let holed = |radius: f64| {
            let hole = Shape::Disk { center: [0.5; 2], radius };
            narrow_gap(&Shape::Difference { of: Box::new(block(0.0)), minus: vec![hole] }, 0.25).is_some()
        };
        assert!(holed(0.12) && !holed(0.13));
        let corner = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        assert!(narrow_gap(&Shape::Polygon { points: corner }, 0.25).is_none(), "an L has no gap");
    }

    #[test]
    fn a_cut_that_misses_is_found() {
        let disk = |x, y, radius| Shape::Disk { center: [x, y], radius };
        let plate = || Box::new(Shape::Rectangle { min: [0.0; 2], max: [1.0; 2] });
        let cut = |hole| cut_nowhere(&Shape::Difference { of: plate(), minus: vec![hole] }).is_some();
        assert!(cut(disk(2.0, 0.5, 0.9)) && cut(disk(-1.0, -1.0, 1.4)), "beside it");
        let strip = Shape::Rectangle { min: [0.5, -1e3], max: [0.5001, 1e3] };
        assert!(!cut(disk(0.5, 0.5, 1e-3)) && !cut(disk(0.5, 0.5, 9.0)) && !cut(disk(2.0, 0.5, 1.01)) && !cut(strip));
    }
}
