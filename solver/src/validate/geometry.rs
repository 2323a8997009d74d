//! Shapes that are empty or malformed, and their outlines.

use crate::scene::Shape;
use crate::shape::polygon_edges;

type Point = [f64; 2];

/// Points looked at along a circle or a straight edge of a body on a general patch.
const OUTLINE_INTERVALS: usize = 64;

/// Why a shape is empty or malformed, with a remedy.
pub fn defect(shape: &Shape) -> Option<(String, &'static str)> {
    let finite = |p: &Point| p.iter().all(|x| x.is_finite());
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
        Shape::Difference { of, minus } => defect(of).or_else(|| minus.iter().find_map(defect)),
    }
}

/// Signed area of a polygon, m².
fn area(points: &[Point]) -> f64 {
    polygon_edges(points).map(|[a, b]| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

/// Points on the boundary of a shape, m.
pub fn outline(shape: &Shape) -> Vec<[f64; 2]> {
    let n = OUTLINE_INTERVALS;
    let circle = |[x, y]: [f64; 2], radius: f64| {
        (0..n).map(move |i| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
            [x + radius * cos, y + radius * sin]
        })
    };
    let ring = |corners: &[[f64; 2]]| {
        let edges: Vec<_> = polygon_edges(corners).collect();
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
        Shape::Difference { of, .. } => outline(of),
    }
}
