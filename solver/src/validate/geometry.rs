//! Regions of the plane, as far as validation needs them: bounding box, closure, emptiness.

use crate::scene::Shape;

type Point = [f64; 2];

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
                let (min, max) = bounding_box(shape);
                area(points).abs() > 1e-12 * (max[0] - min[0]).max(max[1] - min[1]).powi(2)
            };
            (!sound).then(|| ("a polygon without area".into(), "give the corners in order, not all on one line"))
        }
        Shape::Difference { of, minus } => defect(of).or_else(|| minus.iter().find_map(defect)),
    }
}

/// Signed area of a polygon, m².
fn area(points: &[Point]) -> f64 {
    edges(points).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

fn edges(points: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    (0..points.len()).map(|i| (points[i], points[(i + 1) % points.len()]))
}

/// Lower left and upper right corner of the smallest axis-aligned rectangle around a shape, m.
pub fn bounding_box(shape: &Shape) -> (Point, Point) {
    let around = |c: &Point, r: f64| (c.map(|x| x - r), c.map(|x| x + r));
    match shape {
        Shape::Rectangle { min, max } => (*min, *max),
        Shape::Disk { center, radius } => around(center, *radius),
        Shape::Annulus { center, outer_radius, .. } => around(center, *outer_radius),
        Shape::Polygon { points } => points.iter().fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(a, b), p| {
            ([a[0].min(p[0]), a[1].min(p[1])], [b[0].max(p[0]), b[1].max(p[1])])
        }),
        Shape::Difference { of, .. } => bounding_box(of),
    }
}

/// Whether `point` lies in the shape grown by `margin` (m); a negative margin shrinks it.
pub fn contains(shape: &Shape, point: Point, margin: f64) -> bool {
    let distance = |c: &Point| (point[0] - c[0]).hypot(point[1] - c[1]);
    match shape {
        Shape::Rectangle { min, max } => (0..2).all(|d| point[d] >= min[d] - margin && point[d] <= max[d] + margin),
        Shape::Disk { center, radius } => distance(center) <= radius + margin,
        Shape::Annulus { center, inner_radius, outer_radius } => {
            let r = distance(center);
            r <= outer_radius + margin && r >= inner_radius - margin
        }
        Shape::Polygon { points } => {
            let near = edges(points).map(|(a, b)| distance_to_segment(point, a, b)).fold(f64::INFINITY, f64::min);
            let inside = in_polygon(points, point);
            if margin >= 0.0 { inside || near <= margin } else { inside && near >= -margin }
        }
        Shape::Difference { of, minus } => {
            contains(of, point, margin) && !minus.iter().any(|m| contains(m, point, -margin))
        }
    }
}

/// Even-odd rule.
fn in_polygon(points: &[Point], p: Point) -> bool {
    let crosses = |(a, b): &(Point, Point)| {
        (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    edges(points).filter(crosses).count() % 2 == 1
}

fn distance_to_segment(p: Point, a: Point, b: Point) -> f64 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = along[0] * along[0] + along[1] * along[1];
    let t = if squared > 0.0 { ((to[0] * along[0] + to[1] * along[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (to[0] - t * along[0]).hypot(to[1] - t * along[1])
}
