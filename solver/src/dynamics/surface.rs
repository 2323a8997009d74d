//! Points on the boundary of a body: along the edge of a traction, or around all of it.
//!
//! An edge is divided where it crosses knots and where a slit ends on it: shape functions are smooth on every
//! part, and Gauss points integrate them.

use crate::scene::edges::{BESIDE, BoundaryEdge, beside, bounding_parts};
use crate::scene::{Body, Edge, Layout, Shape};
use crate::splines::patch::Patch;
use crate::splines::quadrature::Rule;

/// Point on the boundary of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfacePoint {
    /// Position on the boundary, m.
    pub position: [f64; 2],
    /// Length it stands for, m.
    pub length: f64,
    /// Distance along its curve, m.
    pub along: f64,
    /// Outward unit normal of the body.
    pub normal: [f64; 2],
    /// Position just inside the body, m: a position on a face of a narrow gap has no side.
    pub inner: [f64; 2],
}

/// Largest part of a circle between two divisions, and Gauss points in a part beyond the degree.
const PART_OF_CIRCLE: f64 = 1.0 / 16.0;
const BEYOND_DEGREE: usize = 4;
/// Distance between two divisions, of the length of an edge, that counts as none.
const NEAR: f64 = 1e-12;

/// Surface points along the edge of a traction. Along one beside whole spans they have the layout of the body
/// in every span: the point sums over the edge then fit those over the body, which the patch test needs for
/// equally spaced points.
pub(crate) fn surface_points(patch: &Patch, body: &Body, edge: &Edge) -> Vec<SurfacePoint> {
    let (curve, part) = curve_of(body, edge);
    let rule = match &curve {
        BoundaryEdge::Line([a, b]) if fits_points(patch, body, [*a, *b]) => {
            let direction = usize::from((b[1] - a[1]).abs() > (b[0] - a[0]).abs());
            Rule::new(body.layout, body.particles_per_cell[direction])
        }
        _ => smooth_rule(patch),
    };
    points_between(&divisions(patch, &curve, part, &mouths(body)), &curve, &rule, &body.shape).collect()
}

/// The curve of an edge of a body, and the part of it, s.
pub(crate) fn curve_of(body: &Body, edge: &Edge) -> (BoundaryEdge, [f64; 2]) {
    match *edge {
        Edge::Arc { center, radius, angles } => {
            let circle = BoundaryEdge::Circle { center, radius, sign: 1.0 };
            (circle, angles.map(|angle| angle / std::f64::consts::TAU))
        }
        Edge::Side(_) | Edge::Segment(_) => (BoundaryEdge::Line(edge_ends(body, edge)), [0.0, 1.0]),
    }
}

/// Gauss points along an edge of a body, part by part: those of a part are in one span, and their distances
/// are from the first end of the edge.
pub(crate) fn smooth_parts(patch: &Patch, body: &Body, edge: &Edge) -> Vec<Vec<SurfacePoint>> {
    let ((curve, part), rule) = (curve_of(body, edge), smooth_rule(patch));
    let places = divisions(patch, &curve, part, &mouths(body));
    let from_the_end = |point: SurfacePoint| SurfacePoint { along: point.along - places[0] * curve.length(), ..point };
    let points = |pair| points_between(pair, &curve, &rule, &body.shape).map(from_the_end).collect();
    places.windows(2).map(points).collect()
}

/// Whether the points of the body beside a straight edge are those of whole spans, or of spans that a
/// rectangle cuts.
fn fits_points(patch: &Patch, body: &Body, [a, b]: [[f64; 2]; 2]) -> bool {
    let Some(d) = (0..2).find(|&d| a[d] == b[d]) else { return false };
    let near = NEAR.sqrt() * patch.shortest_span();
    let on_knot =
        |x: f64| patch.spaces[d].spans().iter().any(|s| (s.left - x).abs() < near || (s.right - x).abs() < near);
    matches!(body.shape, Shape::Rectangle { .. } | Shape::Patch) || on_knot(a[d])
}

/// Points around a shape: along every part of its edges with the shape on one side only.
pub(crate) fn points_around(patch: &Patch, shape: &Shape) -> Vec<SurfacePoint> {
    let rule = smooth_rule(patch);
    let mut points = Vec::new();
    for (edge, part) in bounding_parts(shape) {
        points.extend(points_between(&divisions(patch, &edge, part, &[]), &edge, &rule, shape));
    }
    points
}

/// The surface point at s on an edge that bounds a shape on its left, of no length, and the derivative of its
/// position by s, m. It sees the material beside the edge at another s, since a corner has no side.
pub(crate) fn place_on(edge: &BoundaryEdge, s: f64, beside_at: f64) -> (SurfacePoint, [f64; 2]) {
    let (position, tangent) = edge.at(s);
    let speed = tangent[0].hypot(tangent[1]);
    let [inner, _] = beside(edge, s + BESIDE * (beside_at - s));
    let normal = [tangent[1] / speed, -tangent[0] / speed];
    (SurfacePoint { position, length: 0.0, along: s * speed, normal, inner }, tangent)
}

/// Gauss points for products of shape functions along any line.
fn smooth_rule(patch: &Patch) -> Rule {
    let degree = patch.spaces.iter().map(|space| space.degree()).max().unwrap_or(1);
    Rule::new(Layout::Gauss, degree + BEYOND_DEGREE)
}

/// Places (m) where slits of a body may end on its boundary.
pub(crate) fn mouths(body: &Body) -> Vec<[f64; 2]> {
    body.slits().flat_map(|slit| slit.points.iter().copied()).collect()
}

/// Ends of a part of an edge (s), and where between them it crosses knots or is met by one of the `mouths`.
fn divisions(patch: &Patch, edge: &BoundaryEdge, [from, to]: [f64; 2], mouths: &[[f64; 2]]) -> Vec<f64> {
    let near = NEAR.sqrt() * patch.shortest_span();
    let met = mouths.iter().map(|mouth| (edge.place_of(*mouth), mouth)).filter(|(s, mouth)| {
        let [x, y] = edge.at(*s).0;
        (x - mouth[0]).hypot(y - mouth[1]) < near
    });
    let mut places = vec![from, to];
    places.extend(met.map(|(s, _)| s));
    let [low, high] = edge.bounding_box();
    for d in 0..2 {
        let knots = patch.spaces[d].spans().iter().map(|span| span.left);
        let end = fault!("boundary-undivided-at-knots", high[d] => low[d]);
        let crossed = knots.filter(|knot| low[d] < *knot && *knot < end);
        places.extend(crossed.flat_map(|knot| edge.places(d, knot)));
    }
    if let BoundaryEdge::Circle { .. } = edge {
        let parts = ((to - from) / PART_OF_CIRCLE).ceil();
        places.extend((1..parts as usize).map(|part| from + (to - from) * part as f64 / parts));
        places[2..].iter_mut().for_each(|s| *s = edge.place_after(from, *s));
    }
    places.retain(|s| (from + NEAR..to - NEAR).contains(s) || *s == from || *s == to);
    places.sort_by(f64::total_cmp);
    places.dedup_by(|next, place| *next - *place < NEAR); // a corner of spans is crossed once
    places
}

/// Points of a rule in every part of an edge between two divisions.
fn points_between<'a>(
    places: &'a [f64],
    edge: &'a BoundaryEdge,
    rule: &'a Rule,
    shape: &'a Shape,
) -> impl Iterator<Item = SurfacePoint> + 'a {
    let parts = places.windows(2).filter(|pair| pair[1] > pair[0]);
    parts.flat_map(move |pair| {
        let [inner, _] = beside(edge, 0.5 * (pair[0] + pair[1]));
        let inwards = if shape.contains(inner) { 1.0 } else { -1.0 };
        let side = fault!("normals-to-the-right-of-an-edge", inwards => 1.0);
        rule.points.iter().zip(&rule.weights).map(move |(t, weight)| {
            let s = pair[0] + t * (pair[1] - pair[0]);
            let (position, tangent) = edge.at(s);
            let speed = tangent[0].hypot(tangent[1]);
            let normal = [side * tangent[1] / speed, -side * tangent[0] / speed];
            let length = weight * (pair[1] - pair[0]) * speed;
            let inner = [0, 1].map(|d| position[d] - BESIDE * length * normal[d]);
            SurfacePoint { position, length, along: s * speed, normal, inner }
        })
    })
}

/// Ends of a straight edge, m; they coincide if the body has no such side.
pub(crate) fn edge_ends(body: &Body, edge: &Edge) -> [[f64; 2]; 2] {
    match edge {
        Edge::Side(side) => {
            body.shape.side(fault!("traction-on-wrong-edge", *side => crate::scene::Side::Bottom)).unwrap_or_default()
        }
        Edge::Segment(ends) => *ends,
        Edge::Arc { .. } => Default::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    /// Circles through corners of spans, at which both directions cross a knot: round-off leaves no part
    /// there.
    #[test]
    fn a_corner_of_spans_is_crossed_once() {
        for (radius, corners) in [(5.0, 12), (13.0, 12), (25.0, 20), (10.0, 12)] {
            for origin in [[-30.0, -30.0], [-29.0, -31.0]] {
                let patch = Patch::new(&Mesh::uniform([2, 2], origin, [60.0, 60.0], [60, 60]));
                let circle = BoundaryEdge::Circle { center: [0.0; 2], radius, sign: 1.0 };
                let places = divisions(&patch, &circle, [0.0, 1.0], &[]);
                assert!(places.windows(2).all(|pair| pair[1] - pair[0] > 1e-6), "radius {radius}");
                let is_whole = |x: f64| (x - x.round()).abs() < 1e-9;
                let at_corner = places.iter().filter(|s| circle.at(**s).0.iter().all(|x| is_whole(*x)));
                assert_eq!(at_corner.count(), corners + 1, "radius {radius}: the start is the end");
            }
        }
    }
}
