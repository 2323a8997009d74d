//! Shapes that are empty or malformed, and their outlines.

use crate::scene::Shape;
use crate::scene::shape::polygon_edges;
use crate::splines::nurbs::NurbsPatch;

pub(super) type Position = [f64; 2];

/// Most points looked at along a polygon, unless it has more corners.
const MOST_OUTLINE: usize = 4096;

/// Points looked at along a circle or a straight edge of a body on a general patch, and along a side of the
/// patch.
const OUTLINE_INTERVALS: usize = 64;

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
            (!sound).then(|| ("a polygon without area".into(), "give the corners in order, not all on one line"))
        }
        Shape::Patch => None,
        Shape::Union(shapes) if shapes.is_empty() => Some(("a union of no shapes".into(), "give its shapes")),
        Shape::Union(shapes) => shapes.iter().find_map(defect),
        Shape::Difference { of, minus } => defect(of).or_else(|| minus.iter().find_map(defect)),
    }
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

/// Points on the boundary of a shape, m.
pub(crate) fn outline(shape: &Shape) -> Vec<[f64; 2]> {
    let n = OUTLINE_INTERVALS;
    let circle = |[x, y]: [f64; 2], radius: f64| {
        (0..n).map(move |i| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
            [x + radius * cos, y + radius * sin]
        })
    };
    let ring = |corners: &[[f64; 2]]| {
        let edges: Vec<_> = polygon_edges(corners).collect();
        let n = (MOST_OUTLINE / edges.len().max(1)).clamp(1, n);
        let along =
            |[a, b]: [[f64; 2]; 2]| (0..n).map(move |i| [0, 1].map(|d| a[d] + (b[d] - a[d]) * i as f64 / n as f64));
        edges.into_iter().flat_map(along).collect::<Vec<_>>()
    };
    match shape {
        Shape::Patch => Vec::new(),
        Shape::Rectangle { min, max } => ring(&[*min, [max[0], min[1]], *max, [min[0], max[1]]]),
        Shape::Polygon { points } => ring(points),
        Shape::Disk { center, radius } => circle(*center, *radius).collect(),
        Shape::Annulus { center, inner_radius, outer_radius } => {
            circle(*center, *inner_radius).chain(circle(*center, *outer_radius)).collect()
        }
        Shape::Union(shapes) => shapes.iter().flat_map(outline).collect(),
        Shape::Difference { of, .. } => outline(of),
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
    fn a_cut_that_misses_is_found() {
        let disk = |x, y, radius| Shape::Disk { center: [x, y], radius };
        let plate = || Box::new(Shape::Rectangle { min: [0.0; 2], max: [1.0; 2] });
        let cut = |hole| cut_nowhere(&Shape::Difference { of: plate(), minus: vec![hole] }).is_some();
        assert!(cut(disk(2.0, 0.5, 0.9)) && cut(disk(-1.0, -1.0, 1.4)), "beside it");
        let strip = Shape::Rectangle { min: [0.5, -1e3], max: [0.5001, 1e3] };
        assert!(!cut(disk(0.5, 0.5, 1e-3)) && !cut(disk(0.5, 0.5, 9.0)) && !cut(disk(2.0, 0.5, 1.01)) && !cut(strip));
    }
}
