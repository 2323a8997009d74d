//! Outlines of shapes: closed lines of short steps, the body to their left. Area, boundary length and
//! centroid of a shape, by integrals along its boundary: so many Gauss points make those along a whole circle
//! exact to round-off.

use crate::linear_algebra::extremes::smaller;
use crate::scene::edges::{BoundaryEdge, bounding_parts};
use crate::scene::shape::polygon_edges;
use crate::scene::{Body, Layout, Mesh, Shape};
use crate::splines::quadrature::{MAX_POINTS, Rule};

/// Distance between the points of a body, m: that of the smallest span.
pub(super) fn spacing(mesh: &Mesh, body: &Body) -> f64 {
    let smallest = |d: usize| {
        let spans = mesh.knots[d].windows(2).map(|pair| pair[1] - pair[0]).filter(|length| *length > 0.0);
        spans.fold(f64::INFINITY, smaller) / body.particles_per_cell[d].clamp(1, MAX_POINTS) as f64
    };
    smallest(0).min(smallest(1))
}

/// The same shape with a rectangle for the whole patch, which is one in the updated frame.
pub(crate) fn without_patch(shape: &Shape, mesh: &Mesh) -> Shape {
    match shape {
        Shape::Patch => Shape::Rectangle { min: mesh.origin(), max: mesh.end() },
        Shape::Union(shapes) => Shape::Union(shapes.iter().map(|shape| without_patch(shape, mesh)).collect()),
        Shape::Difference { of, minus } => {
            let minus = minus.iter().map(|hole| without_patch(hole, mesh)).collect();
            Shape::Difference { of: Box::new(without_patch(of, mesh)), minus }
        }
        other => other.clone(),
    }
}

/// Length of all lines that [`rings`] gives, m; none of the patch, see [`without_patch`].
pub(super) fn perimeter(shape: &Shape) -> f64 {
    shape.edges().iter().map(BoundaryEdge::length).sum()
}

/// Closed lines that bound a shape, the body to their left, in steps of about `spacing`.
pub(super) fn rings(shape: &Shape, spacing: f64) -> Vec<Vec<[f64; 2]>> {
    let circle = |center: [f64; 2], radius: f64| -> Vec<[f64; 2]> {
        // A multiple of four, so that the circle keeps the symmetries of the mesh.
        let count = 4 * ((std::f64::consts::FRAC_PI_2 * radius / spacing).ceil() as usize).max(4);
        let at = |i: usize| {
            let (sin, cos) = (std::f64::consts::TAU * (i as f64 + 0.5) / count as f64).sin_cos();
            [center[0] + radius * cos, center[1] + radius * sin]
        };
        (0..count).map(at).collect()
    };
    let polygon = |corners: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let edges = polygon_edges(corners);
        let along = |[a, b]: [[f64; 2]; 2]| {
            let count = (((b[0] - a[0]).hypot(b[1] - a[1]) / spacing).ceil() as usize).max(1);
            (0..count).map(move |i| [0, 1].map(|d| a[d] + (b[d] - a[d]) * i as f64 / count as f64))
        };
        let mut line: Vec<_> = edges.flat_map(along).collect();
        if polygon_edges(corners).map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum::<f64>() < 0.0 {
            line.reverse();
        }
        line
    };
    match shape {
        Shape::Rectangle { min, max } => vec![polygon(&[*min, [max[0], min[1]], *max, [min[0], max[1]]])],
        Shape::Disk { center, radius } => vec![circle(*center, *radius)],
        Shape::Annulus { center, inner_radius, outer_radius } => {
            let mut lines = vec![circle(*center, *outer_radius)];
            if *inner_radius > 0.0 {
                lines.push(circle(*center, *inner_radius));
                lines[1].reverse();
            }
            lines
        }
        Shape::Polygon { points } => vec![polygon(points)],
        Shape::Patch => Vec::new(), // see without_patch
        Shape::Union(shapes) => shapes.iter().flat_map(|shape| rings(shape, spacing)).collect(),
        Shape::Difference { of, minus } => {
            let holes = minus.iter().flat_map(|hole| rings(hole, spacing)).map(|mut line| {
                line.reverse();
                line
            });
            rings(of, spacing).into_iter().chain(holes).collect()
        }
    }
}

/// Whether a segment bounds a shape: its middle lies on the boundary, and twice as deep as the tolerance (m)
/// there is material, both within the tolerance. Where a cut ends flush with a side there is none, though
/// both lines run there.
pub(super) fn bounds(shape: &Shape, [a, b]: [[f64; 2]; 2], tolerance: f64) -> bool {
    let middle = [0, 1].map(|d| 0.5 * (a[d] + b[d]));
    let depth = 2.0 * tolerance / (b[0] - a[0]).hypot(b[1] - a[1]);
    let beneath = [middle[0] - depth * (b[1] - a[1]), middle[1] + depth * (b[0] - a[0])];
    let on_boundary = shape.contains_within(middle, tolerance) && !shape.contains_within(middle, -tolerance);
    on_boundary && shape.contains_within(beneath, tolerance)
}

/// Integrals over a shape.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShapeIntegrals {
    /// Area inside the boundary, m².
    pub area: f64,
    /// Length of the boundary, m.
    pub length: f64,
    /// Centre of that area, m.
    pub centroid: [f64; 2],
}

impl ShapeIntegrals {
    /// Those of a shape that is not the patch.
    pub(crate) fn new(shape: &Shape) -> Self {
        let (rule, parts) = (Rule::new(Layout::Gauss, MAX_POINTS), bounding_parts(shape));
        let origin = parts.first().map_or([0.0; 2], |(edge, _)| edge.at(0.0).0);
        let (mut area, mut length, mut moment) = (0.0, 0.0, [0.0; 2]);
        for (edge, [from, to]) in &parts {
            for (at, weight) in rule.points.iter().zip(&rule.weights) {
                let (place, tangent) = edge.at(from + at * (to - from));
                let arm = [0, 1].map(|d| place[d] - origin[d]);
                let step = weight * (to - from);
                let part = 0.5 * step * (arm[0] * tangent[1] - arm[1] * tangent[0]);
                area += part;
                length += step * tangent[0].hypot(tangent[1]);
                (0..2).for_each(|d| moment[d] += 2.0 / 3.0 * part * arm[d]);
            }
        }
        Self { area, length, centroid: [0, 1].map(|d| origin[d] + moment[d] / area) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::rectangle;
    use approx::assert_relative_eq;

    const SPACING: f64 = 2.5e-3;

    /// Length of the lines that bound a shape, m.
    fn bounded(shape: &Shape) -> f64 {
        let lines = rings(shape, SPACING);
        let segments = lines.iter().flat_map(|ring| (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]));
        let bounding = segments.filter(|ends| bounds(shape, *ends, 0.1 * SPACING));
        bounding.map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum()
    }

    #[test]
    fn lines_without_material_under_them_bound_nothing() {
        let cut = |minus: Vec<Shape>| Shape::Difference { of: Box::new(rectangle([0.0; 2], [0.2; 2])), minus };
        let notch = |left: f64, right: f64| rectangle([left, 0.09], [right, 0.11]);
        let notched = 0.8 + 2.0 * 0.08;
        for (name, shape, length) in [
            ("across the side", cut(vec![notch(-0.01, 0.08)]), notched),
            ("flush with it", cut(vec![notch(0.0, 0.08)]), notched),
            ("in two halves", cut(vec![notch(0.0, 0.04), notch(0.04, 0.08)]), notched),
            ("flush with three sides", cut(vec![rectangle([0.0, 0.1], [0.2; 2])]), 0.6),
            ("a slit thinner than points stand apart", cut(vec![rectangle([0.1, 0.1], [0.15, 0.1001])]), 0.8 + 0.1002),
        ] {
            let found = bounded(&shape);
            assert!((found - length).abs() < 2.0 * SPACING, "{name}: {found} m instead of {length} m");
        }
    }

    /// A segment of each circle has its middle on the cut, to round-off on either side of it.
    #[test]
    fn a_cut_through_the_middle_of_segments_keeps_them() {
        for shift in [-1e-16, 0.0, 1e-16] {
            let ring = Shape::Annulus { center: [0.1, shift], inner_radius: 0.03, outer_radius: 0.05 };
            let below = rectangle([-1.0, -1.0], [1.0, 0.0]);
            let half = Shape::Difference { of: Box::new(ring), minus: vec![below] };
            let outer = rings(&half, SPACING)[0].clone();
            let segments = (0..outer.len()).map(|i| [outer[i], outer[(i + 1) % outer.len()]]);
            let kept = segments.filter(|ends| bounds(&half, *ends, 0.1 * SPACING)).count();
            assert_eq!(kept, outer.len() / 2 + 1, "shifted by {shift}");
        }
    }

    #[test]
    fn circles_of_any_size_bound_their_bodies() {
        for radius in [0.1 * SPACING, SPACING, 10.0 * SPACING] {
            let disk = Shape::Disk { center: [0.1; 2], radius };
            let holed = Shape::Difference { of: Box::new(rectangle([0.0; 2], [0.2; 2])), minus: vec![disk.clone()] };
            let length = perimeter(&disk);
            assert!((bounded(&disk) / length - 1.0).abs() < 0.01, "{radius}: {} m", bounded(&disk));
            assert!((bounded(&holed) - 0.8 - length).abs() < 0.01 * length, "{radius}: {} m", bounded(&holed));
        }
    }

    #[test]
    fn parts_that_share_an_edge_are_counted_once() {
        let rectangle = |min, max| Shape::Rectangle { min, max };
        let angle = Shape::Union(vec![rectangle([3.0, 1.0], [5.0, 2.0]), rectangle([3.0, 1.0], [4.0, 3.0])]);
        let ShapeIntegrals { area, length, centroid } = ShapeIntegrals::new(&angle);
        assert_relative_eq!(area, 3.0, max_relative = 1e-12);
        assert_relative_eq!(length, 8.0, max_relative = 1e-12);
        assert_relative_eq!(centroid[0], 3.0 + 5.0 / 6.0, max_relative = 1e-12);
        assert_relative_eq!(centroid[1], 1.0 + 5.0 / 6.0, max_relative = 1e-12);
    }

    #[test]
    fn circles_are_exact() {
        let hole = Shape::Disk { center: [0.5, 0.1], radius: 0.5 };
        let shape =
            Shape::Difference { of: Box::new(Shape::Disk { center: [0.0; 2], radius: 2.0 }), minus: vec![hole] };
        let ShapeIntegrals { area, length, centroid } = ShapeIntegrals::new(&shape);
        let pi = std::f64::consts::PI;
        assert_relative_eq!(area, pi * 3.75, max_relative = 1e-12);
        assert_relative_eq!(length, pi * 5.0, max_relative = 1e-12);
        assert_relative_eq!(centroid[0], -0.125 / 3.75, max_relative = 1e-11);
    }
}
