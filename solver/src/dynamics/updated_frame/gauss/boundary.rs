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
use crate::contact::gap_potential::arc::Arc;
use crate::linear_algebra::extremes::smaller;
use crate::scene::edges::BoundaryEdge;
use crate::scene::{Layout, Mesh, Shape};
use crate::splines::quadrature::{MAX_POINTS, Rule};

/// Trials for where a line crosses a knot or turns back, and what is near enough, in lengths of the step.
const CROSSING_LIMIT: usize = 60;
const CROSSING_CLOSE: f64 = 1e-13;

/// The edges of a shape, the body to their left; `None` of a shape that has no rule yet.
pub(crate) fn edges(shape: &Shape, mesh: &Mesh) -> Option<Vec<BoundaryEdge>> {
    match shape {
        Shape::Patch | Shape::Rectangle { .. } => {
            let (min, max) = mesh.extent(shape);
            Some(Shape::Rectangle { min, max }.edges())
        }
        Shape::Union(_) | Shape::Difference { .. } => None,
        _ => Some(shape.edges()),
    }
}

/// A boundary, and where it was last.
#[derive(Debug, Clone)]
pub(crate) struct MovingBoundary {
    edges: Vec<BoundaryEdge>,
    /// Present positions (m) of equally spaced s, the ends of each edge among them, and their derivatives by
    /// s.
    nodes: Vec<Vec<[f64; 2]>>,
    tangents: Vec<Vec<[f64; 2]>>,
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
            (0..=count).map(|i| edge.at(i as f64 / count as f64)).unzip()
        };
        let (nodes, tangents) = edges.iter().map(nodes_of).unzip();
        Self { edges, nodes, tangents, along: Rule::new(Layout::Gauss, (2 * degree + 1).min(MAX_POINTS)) }
    }

    /// Present positions and tangents, edge by edge, m.
    pub(crate) fn places(&mut self) -> impl Iterator<Item = &mut Vec<[f64; 2]>> {
        self.nodes.iter_mut().chain(&mut self.tangents)
    }

    /// The cubics through the nodes now.
    pub(crate) fn arcs(&self) -> Vec<Arc> {
        let of_edge = |(nodes, tangents): (&Vec<[f64; 2]>, &Vec<[f64; 2]>)| -> Vec<Arc> {
            let steps = (nodes.len() - 1) as f64;
            let ends = nodes.windows(2).zip(tangents.windows(2));
            ends.map(|(x, t)| Arc::new([x[0], x[1]], [t[0], t[1]].map(|t| t.map(|t| t / steps)))).collect()
        };
        self.nodes.iter().zip(&self.tangents).flat_map(of_edge).collect()
    }

    /// Follows the motion and calls `f` with the pieces.
    ///
    /// # Errors
    /// If the motion has no inverse somewhere on the boundary.
    pub(crate) fn follow(&mut self, map: &InverseMap<'_>, mut f: impl FnMut(Piece<'_>)) -> Result<(), Folded> {
        let Self { edges, nodes, tangents, along } = self;
        let mut breaks = Vec::new();
        for ((edge, nodes), tangents) in edges.iter().zip(nodes).zip(tangents) {
            let count = nodes.len() - 1;
            for (i, (node, carried)) in nodes.iter_mut().zip(tangents.iter_mut()).enumerate() {
                let (position, tangent) = edge.at(i as f64 / count as f64);
                (*node, *carried) = map.forward(position, tangent, *node)?;
            }
            for i in 0..count {
                let place = |i: usize| EdgePlace { s: i as f64 / count as f64, x: nodes[i], tangent: tangents[i] };
                let step = Step { edge, map, ends: [place(i), place(i + 1)] };
                breaks.clear();
                step.divide(&mut breaks)?;
                for pair in breaks.windows(2) {
                    step.piece(along, [pair[0], pair[1]], &mut f)?;
                }
            }
        }
        Ok(())
    }
}

/// A place on an edge: s, position (m), and its derivative by s (m).
#[derive(Debug, Clone, Copy)]
struct EdgePlace {
    s: f64,
    x: [f64; 2],
    tangent: [f64; 2],
}

/// A part of an edge.
struct Step<'a> {
    edge: &'a BoundaryEdge,
    map: &'a InverseMap<'a>,
    ends: [EdgePlace; 2],
}

impl Step<'_> {
    /// The place at s, looked for from the cubic between the ends.
    fn at(&self, s: f64) -> Result<EdgePlace, Folded> {
        let [a, b] = self.ends;
        let length = b.s - a.s;
        let t = (s - a.s) / length;
        let [turn, left, right] = [t * t * (3.0 - 2.0 * t), t * (1.0 - t).powi(2) * length, t * t * (t - 1.0) * length];
        let near = [0, 1].map(|c| a.x[c] + turn * (b.x[c] - a.x[c]) + left * a.tangent[c] + right * b.tangent[c]);
        let (position, tangent) = self.edge.at(s);
        let (x, tangent) = self.map.forward(position, tangent, near)?;
        Ok(EdgePlace { s, x, tangent })
    }

    /// s at its ends and where it crosses knots of either direction, in order. Where it turns back in a
    /// direction it may cross a knot twice, so it is divided there first.
    fn divide(&self, breaks: &mut Vec<f64>) -> Result<(), Folded> {
        let mut places = vec![self.ends[0]];
        for d in 0..2 {
            let tangents = self.ends.map(|end| end.tangent[d]);
            if tangents[0] * tangents[1] < 0.0 {
                places.push(self.root(self.ends, |place| place.tangent[d])?);
            }
        }
        places[1..].sort_by(|a, b| a.s.total_cmp(&b.s));
        places.push(self.ends[1]);
        for pair in places.windows(2) {
            let first = breaks.len();
            breaks.push(pair[0].s);
            self.crossings([pair[0], pair[1]], breaks)?;
            breaks[first..].sort_by(f64::total_cmp);
        }
        breaks.push(self.ends[1].s);
        Ok(())
    }

    /// Where a part that turns back nowhere crosses knots.
    fn crossings(&self, ends: [EdgePlace; 2], breaks: &mut Vec<f64>) -> Result<(), Folded> {
        for d in 0..2 {
            let spans = self.map.patch.spaces[d].spans();
            let [a, b] = ends.map(|end| end.x[d]);
            let (low, high) = (smaller(a, b), -smaller(-a, -b));
            let first = spans.partition_point(|span| span.left <= low);
            for knot in spans[first..].iter().map(|span| span.left).take_while(|knot| *knot < high) {
                breaks.push(self.root(ends, |place| place.x[d] - knot)?.s);
            }
        }
        Ok(())
    }

    /// The place between two at which a function that has opposite signs there is zero, by false position
    /// with the weight of an end that stays halved (Dowell & Jarratt 1971, *A modified regula falsi method
    /// for computing the root of an equation*, BIT 11).
    fn root(&self, [mut a, mut b]: [EdgePlace; 2], f: impl Fn(&EdgePlace) -> f64) -> Result<EdgePlace, Folded> {
        let (mut at_a, mut at_b) = (f(&a), f(&b));
        let close = CROSSING_CLOSE * (b.s - a.s);
        let mut side = 0;
        for _ in 0..CROSSING_LIMIT {
            let share = at_a / (at_a - at_b);
            let place = self.at(a.s + share * (b.s - a.s))?;
            let found = f(&place);
            let narrow = smaller((place.s - a.s).abs(), (b.s - place.s).abs()) <= close;
            if found == 0.0 || narrow || !found.is_finite() {
                return Ok(place);
            }
            if found * at_a < 0.0 {
                (b, at_b) = (place, found);
                at_a *= if side == -1 { 0.5 } else { 1.0 };
                side = -1;
            } else {
                (a, at_a) = (place, found);
                at_b *= if side == 1 { 0.5 } else { 1.0 };
                side = 1;
            }
        }
        Ok(a)
    }

    /// Hands on the piece between two breaks.
    fn piece(&self, along: &Rule, [from, to]: [f64; 2], f: &mut impl FnMut(Piece<'_>)) -> Result<(), Folded> {
        if to <= from {
            return Ok(());
        }
        let mut points = [([0.0; 2], 0.0); MAX_POINTS];
        for ((point, t), weight) in points.iter_mut().zip(&along.points).zip(&along.weights) {
            let place = self.at(from + t * (to - from))?;
            *point = (place.x, weight * (to - from) * place.tangent[1]);
        }
        let points = &points[..along.points.len()];
        let middle = points[points.len() / 2].0;
        let span = [0, 1].map(|d| {
            let spans = self.map.patch.spaces[d].spans();
            spans.partition_point(|span| span.right <= middle[d]).min(spans.len() - 1)
        });
        f(Piece { span, points });
        Ok(())
    }
}
