//! Outlines of shapes: closed lines of short steps, the body to their left.

use crate::linear_algebra::extremes::smaller;
use crate::scene::shape::polygon_edges;
use crate::scene::{Body, Mesh, Shape};
use crate::splines::quadrature::MAX_POINTS;

/// Distance between the points of a body, m: that of the smallest span.
pub(super) fn spacing(mesh: &Mesh, body: &Body) -> f64 {
    let smallest = |d: usize| {
        let spans = mesh.knots[d].windows(2).map(|pair| pair[1] - pair[0]).filter(|length| *length > 0.0);
        spans.fold(f64::INFINITY, smaller) / body.particles_per_cell[d].clamp(1, MAX_POINTS) as f64
    };
    smallest(0).min(smallest(1))
}

/// The same shape with a rectangle for the whole patch, which is one in the updated frame.
pub(super) fn without_patch(shape: &Shape, mesh: &Mesh) -> Shape {
    match shape {
        Shape::Patch => Shape::Rectangle { min: mesh.origin(), max: mesh.end() },
        Shape::Difference { of, minus } => {
            let minus = minus.iter().map(|hole| without_patch(hole, mesh)).collect();
            Shape::Difference { of: Box::new(without_patch(of, mesh)), minus }
        }
        other => other.clone(),
    }
}

/// Length of all lines that [`rings`] gives, m.
pub(super) fn perimeter(shape: &Shape) -> f64 {
    let circle = |radius: f64| std::f64::consts::TAU * radius;
    match shape {
        Shape::Rectangle { min, max } => 2.0 * ((max[0] - min[0]) + (max[1] - min[1])),
        Shape::Disk { radius, .. } => circle(*radius),
        Shape::Annulus { inner_radius, outer_radius, .. } => circle(*inner_radius) + circle(*outer_radius),
        Shape::Polygon { points } => polygon_edges(points).map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum(),
        Shape::Patch => 0.0, // see without_patch
        Shape::Difference { of, minus } => perimeter(of) + minus.iter().map(perimeter).sum::<f64>(),
    }
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
        Shape::Difference { of, minus } => {
            let holes = minus.iter().flat_map(|hole| rings(hole, spacing)).map(|mut line| {
                line.reverse();
                line
            });
            rings(of, spacing).into_iter().chain(holes).collect()
        }
    }
}

pub(super) fn is_on_boundary(shape: &Shape, position: [f64; 2], tolerance: f64) -> bool {
    shape.contains_within(position, tolerance) && !shape.contains_within(position, -tolerance)
}
