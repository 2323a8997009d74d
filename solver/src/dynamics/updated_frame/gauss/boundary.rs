//! The boundary of a body that moves: closed lines of reference positions, and the part of each span they
//! enclose now.
//!
//! A span that the boundary cuts keeps its Gauss points; their weights are the integrals of their Lagrange
//! polynomials over the part inside (moment fitting: Müller, Kummer & Oberlack 2013, *Highly accurate
//! surface and volume integration on implicit domains by means of moment-fitting*, International Journal
//! for Numerical Methods in Engineering 96), so that a polynomial up to the degree of the rule is
//! integrated exactly. By Gauss's theorem, with the body to the left of its boundary,
//!
//! ```text
//! w_ab = ∫ ℓ_a(x) ℓ_b(y) dx dy = ∮ L_a(x) ℓ_b(y) dy,      L_a(x) = ∫ ℓ_a from the left end of the span to x
//! ```
//!
//! where a line that passes a span to its right counts with `L_a = ω_a`, the weight of the whole rule. A
//! piece of the boundary therefore contributes to its own span and to those to the left of it: nothing else
//! has to be known about the shape of the part, which may be anything.
//!
//! Positions x(s) on the boundary are roots of `x − d(x) = X(s)` ([`InverseMap`]); it is divided where x(s)
//! crosses knots.

use super::map::{Folded, InverseMap};
use crate::linear_algebra::extremes::smaller;
use crate::scene::{Layout, Mesh, Shape};
use crate::splines::quadrature::Rule;

/// Corrections to where a line crosses a knot, and what is near enough, in lengths of the step.
const CROSSING_LIMIT: usize = 12;
const CROSSING_CLOSE: f64 = 1e-13;

/// A smooth part of the boundary, by reference positions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum BoundaryEdge {
    /// From one corner to another, m.
    Line([[f64; 2]; 2]),
    /// Circle, counterclockwise if `sign` is 1, else clockwise.
    Circle {
        /// Centre, m.
        center: [f64; 2],
        /// Radius, m.
        radius: f64,
        /// Sense.
        sign: f64,
    },
}

impl BoundaryEdge {
    /// Position (m) and its derivative at s from 0 to 1.
    fn at(&self, s: f64) -> ([f64; 2], [f64; 2]) {
        match self {
            Self::Line([a, b]) => {
                let along = [0, 1].map(|d| b[d] - a[d]);
                ([0, 1].map(|d| a[d] + s * along[d]), along)
            }
            Self::Circle { center, radius, sign } => {
                let turn = sign * std::f64::consts::TAU;
                let (sin, cos) = (turn * s).sin_cos();
                let position = [center[0] + radius * cos, center[1] + radius * sin];
                (position, [-radius * turn * sin, radius * turn * cos])
            }
        }
    }

    fn length(&self) -> f64 {
        match self {
            Self::Line([a, b]) => (b[0] - a[0]).hypot(b[1] - a[1]),
            Self::Circle { radius, .. } => std::f64::consts::TAU * radius,
        }
    }
}

/// The edges of a shape, the body to their left; `None` of a shape that has no rule yet.
pub(crate) fn edges(shape: &Shape, mesh: &Mesh) -> Option<Vec<BoundaryEdge>> {
    let polygon = |corners: &[[f64; 2]]| -> Vec<BoundaryEdge> {
        let next = |i: usize| corners[(i + 1) % corners.len()];
        let doubled: f64 = (0..corners.len()).map(|i| corners[i][0] * next(i)[1] - corners[i][1] * next(i)[0]).sum();
        let line =
            |i: usize| BoundaryEdge::Line(if doubled > 0.0 { [corners[i], next(i)] } else { [next(i), corners[i]] });
        (0..corners.len()).map(line).collect()
    };
    let box_of = |low: [f64; 2], high: [f64; 2]| polygon(&[low, [high[0], low[1]], high, [low[0], high[1]]]);
    Some(match shape {
        Shape::Rectangle { .. } | Shape::Patch => {
            let (low, high) = mesh.extent(shape);
            box_of(low, high)
        }
        Shape::Polygon { points } => polygon(points),
        Shape::Disk { center, radius } => vec![BoundaryEdge::Circle { center: *center, radius: *radius, sign: 1.0 }],
        Shape::Annulus { center, inner_radius, outer_radius } => vec![
            BoundaryEdge::Circle { center: *center, radius: *outer_radius, sign: 1.0 },
            BoundaryEdge::Circle { center: *center, radius: *inner_radius, sign: -1.0 },
        ],
        Shape::Difference { .. } => return None,
    })
}

/// A boundary, and where it was last.
#[derive(Debug, Clone)]
pub(crate) struct MovingBoundary {
    edges: Vec<BoundaryEdge>,
    /// Present positions (m) of equally spaced s, the ends of each edge among them.
    nodes: Vec<Vec<[f64; 2]>>,
    /// Rule along a piece.
    along: Rule,
}

/// A piece of the boundary within one span: positions in and weights `dy` of a rule along it.
pub(crate) struct Piece<'a> {
    /// Span in x and y.
    pub span: [usize; 2],
    /// Positions, m, and `dy/ds` times the weight, m.
    pub points: &'a [([f64; 2], f64)],
}

impl MovingBoundary {
    /// Edges at rest on a mesh whose shortest span has this length, m, for splines of degree p.
    pub(crate) fn new(edges: Vec<BoundaryEdge>, shortest: f64, degree: usize) -> Self {
        let nodes_of = |edge: &BoundaryEdge| {
            let count = (edge.length() / shortest).ceil().max(1.0) as usize;
            (0..=count).map(|i| edge.at(i as f64 / count as f64).0).collect()
        };
        let nodes = edges.iter().map(nodes_of).collect();
        Self { edges, nodes, along: Rule::new(Layout::Gauss, degree + 2) }
    }

    /// Present positions, edge by edge, m.
    pub(crate) fn places(&mut self) -> impl Iterator<Item = &mut Vec<[f64; 2]>> {
        self.nodes.iter_mut()
    }

    /// Follows the motion and calls `f` with the pieces.
    ///
    /// # Errors
    /// If the motion has no inverse somewhere on the boundary.
    pub(crate) fn follow(&mut self, map: &InverseMap<'_>, mut f: impl FnMut(Piece<'_>)) -> Result<(), Folded> {
        let Self { edges, nodes, along } = self;
        let mut breaks = Vec::new();
        for (edge, nodes) in edges.iter().zip(nodes) {
            let count = nodes.len() - 1;
            for (i, node) in nodes.iter_mut().enumerate() {
                *node = map.forward(edge.at(i as f64 / count as f64).0, [0.0; 2], *node)?.0;
            }
            for i in 0..count {
                let ends = [i, i + 1].map(|i| i as f64 / count as f64);
                let places = [nodes[i], nodes[i + 1]];
                breaks.clear();
                breaks.push((ends[0], places[0]));
                crossings(edge, map, ends, places, &mut breaks)?;
                breaks[1..].sort_by(|a, b| a.0.total_cmp(&b.0));
                breaks.push((ends[1], places[1]));
                for pair in breaks.windows(2) {
                    piece(edge, map, along, [pair[0], pair[1]], &mut f)?;
                }
            }
        }
        Ok(())
    }
}

/// Where a step of an edge crosses knots of either direction: s and position.
fn crossings(
    edge: &BoundaryEdge,
    map: &InverseMap<'_>,
    [from, to]: [f64; 2],
    [a, b]: [[f64; 2]; 2],
    breaks: &mut Vec<(f64, [f64; 2])>,
) -> Result<(), Folded> {
    for d in 0..2 {
        let spans = map.patch.spaces[d].spans();
        let (low, high) = (smaller(a[d], b[d]), -smaller(-a[d], -b[d]));
        let first = spans.partition_point(|span| span.left <= low);
        for knot in spans[first..].iter().map(|span| span.left).take_while(|knot| *knot < high) {
            let share = (knot - a[d]) / (b[d] - a[d]);
            let mut s = from + share * (to - from);
            let mut x = [0, 1].map(|c| a[c] + share * (b[c] - a[c]));
            for _ in 0..CROSSING_LIMIT {
                let (position, tangent) = edge.at(s);
                let (place, carried) = map.forward(position, tangent, x)?;
                let correction = (knot - place[d]) / carried[d];
                x = place;
                if !correction.is_finite() {
                    break;
                }
                s = (s + correction).clamp(from, to);
                if correction.abs() <= CROSSING_CLOSE * (to - from) {
                    break;
                }
            }
            breaks.push((s, x));
        }
    }
    Ok(())
}

/// Hands on one piece between two breaks.
fn piece(
    edge: &BoundaryEdge,
    map: &InverseMap<'_>,
    along: &Rule,
    [(from, a), (to, b)]: [(f64, [f64; 2]); 2],
    f: &mut impl FnMut(Piece<'_>),
) -> Result<(), Folded> {
    if to <= from {
        return Ok(());
    }
    let mut points = [([0.0; 2], 0.0); 8];
    for ((point, t), weight) in points.iter_mut().zip(&along.points).zip(&along.weights) {
        let (position, tangent) = edge.at(from + t * (to - from));
        let (x, carried) = map.forward(position, tangent, [0, 1].map(|c| a[c] + t * (b[c] - a[c])))?;
        *point = (x, weight * (to - from) * carried[1]);
    }
    let points = &points[..along.points.len()];
    let middle = points[points.len() / 2].0;
    let span = [0, 1].map(|d| {
        let spans = map.patch.spaces[d].spans();
        spans.partition_point(|span| span.right <= middle[d]).min(spans.len() - 1)
    });
    f(Piece { span, points });
    Ok(())
}
