//! The boundary of a body that may meet others: where it is now, and forces on it as nodal forces.
//!
//! It is divided into steps of about a span. Their ends and the tangents there move with the control points,
//!
//! ```text
//! x_k = Σ N_i(X_k) (X_i + u_i),      t_k = Σ ∂N_i(X_k)/∂s (X_i + u_i),
//! ```
//!
//! and cubics lie between them ([`arc`](crate::contact::gap_potential::arc)). A corner has the tangent of a
//! parabola through its neighbour instead. Functions that only just reach a corner have slopes there, but
//! next to no mass, and would shorten the critical step up to seventyfold. A force at a place of a cubic acts
//! on the control points by the same shares, as its work asks; a couple acts on the tangent. Both keep
//! momentum and angular momentum.
//!
//! The critical step counts a spring of twice κ all along the boundary: for two equal bodies that is what
//! both feel of each other. With friction it resists motion along the boundary as it does across it.

use crate::contact::gap_potential::arc::{Arc, CORNER, Outline, rule, shares, tangent_shares};
use crate::contact::outline::without_patch;
use crate::dynamics::surface::{SurfacePoint, place_on};
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::vectors::dot;
use crate::scene::edges::{BoundaryEdge, bounding_parts};
use crate::scene::{Mesh, Shape};
use crate::splines::patch::PointFunctions;
use crate::splines::quadrature::Rule;
use crate::splines::spline::ROUND_OFF;

/// The steps of the boundary of a shape, for a mesh whose shortest span has this length, m: part by part, the
/// surface points and derivatives by the step (m) at the ends of the steps.
fn steps(shape: &Shape, mesh: &Mesh, shortest: f64) -> Vec<Vec<(SurfacePoint, [f64; 2])>> {
    let of_part = |(edge, [from, to]): (BoundaryEdge, [f64; 2])| -> Vec<_> {
        let count = (edge.length() * (to - from) / shortest).ceil().max(1.0);
        let step = (to - from) / count;
        (0..=count as usize)
            .map(|i| {
                let (point, tangent) = place_on(&edge, from + i as f64 * step, 0.5 * (from + to));
                (point, tangent.map(|x| x * step))
            })
            .collect()
    };
    bounding_parts(&without_patch(shape, mesh)).into_iter().map(of_part).collect()
}

/// The boundary of a shape at rest, as arcs.
pub(crate) fn arcs_at_rest(shape: &Shape, mesh: &Mesh, shortest: f64) -> Vec<Arc> {
    let rule = rule();
    let arc = |ends: &[(SurfacePoint, [f64; 2])]| {
        Arc::new([ends[0].0.position, ends[1].0.position], [ends[0].1, ends[1].1], &rule)
    };
    steps(shape, mesh, shortest).iter().flat_map(|part| part.windows(2).map(arc)).collect()
}

/// A place on the boundary whose position and tangent follow the control points.
#[derive(Debug, Clone)]
struct BoundaryNode {
    /// Position at t = 0, m.
    position: [f64; 2],
    tangent: [f64; 2],
    /// Control point, share in the position, and in the tangent.
    shares: Vec<(usize, [f64; 2])>,
}

impl BoundaryNode {
    fn new(position: [f64; 2], tangent: [f64; 2], functions: &PointFunctions) -> Self {
        let slope = |gradient: &[f64; 2]| fault!("boundary-with-fixed-tangents", dot(*gradient, tangent) => 0.0);
        let share = |((at, value), gradient): (&(usize, f64), &[f64; 2])| (*at, [*value, slope(gradient)]);
        Self { position, tangent, shares: functions.values.iter().zip(&functions.gradients).map(share).collect() }
    }

    /// The same place with the tangent of a parabola through both ends of its arc and the tangent at the
    /// other end, or with `bend` 0 of a line: `forward` is 1 where the arc begins, −1 where it ends.
    fn at_corner(&self, other: &Self, forward: f64, bend: f64) -> Self {
        let chord = (1.0 + bend) * forward;
        let tangent = [0, 1].map(|d| chord * (other.position[d] - self.position[d]) - bend * other.tangent[d]);
        let own = self.shares.iter().map(|&(at, [position, _])| (at, [position, -chord * position]));
        let others = other.shares.iter().map(|&(at, [position, slope])| (at, [0.0, chord * position - bend * slope]));
        Self { position: self.position, tangent, shares: own.chain(others).collect() }
    }

    /// Whether a part of the boundary that ends here goes on in the one that begins there, without a corner.
    fn goes_on_at(&self, next: &Self) -> bool {
        let [length, of_next] = [self.tangent, next.tangent].map(|[x, y]| x.hypot(y));
        let [x, y] = [0, 1].map(|d| next.position[d] - self.position[d]);
        x.hypot(y) < ROUND_OFF * length && dot(self.tangent, next.tangent) > CORNER * length * of_next
    }

    /// Position and tangent under a displacement, m.
    fn now(&self, displacement: &VectorField) -> [[f64; 2]; 2] {
        let mut now = [self.position, self.tangent];
        for &(at, shares) in &self.shares {
            for (now, share) in now.iter_mut().zip(shares) {
                (0..2).for_each(|d| now[d] += share * displacement[d][at]);
            }
        }
        now
    }

    /// Adds forces on the position and on the tangent.
    fn push(&self, on_position: [f64; 2], on_tangent: [f64; 2], forces: &mut VectorField) {
        for &(at, [position, tangent]) in &self.shares {
            (0..2).for_each(|d| forces[d][at] += position * on_position[d] + tangent * on_tangent[d]);
        }
    }
}

/// Sets the tangents at the ends of a part of the boundary that are corners.
fn turn_corners(part: &mut [BoundaryNode], [first, last]: [bool; 2]) {
    let end = part.len() - 1;
    let bend = if end == 1 && first && last { 0.0 } else { 1.0 };
    if first {
        part[0] = part[0].at_corner(&part[1], 1.0, bend);
    }
    if last {
        part[end] = part[end].at_corner(&part[end - 1], -1.0, bend);
    }
}

/// The boundary of a body.
#[derive(Debug, Clone)]
pub(super) struct MaterialBoundary {
    nodes: Vec<BoundaryNode>,
    /// Node at which each arc begins, and the arc at t = 0; it ends at the next node.
    arcs: Vec<(usize, Arc)>,
    /// Stiffness κ of contact, Pa/m.
    stiffness: f64,
    friction: bool,
    rule: Rule,
}

impl MaterialBoundary {
    /// The boundary of a shape on a mesh with this shortest span (m), stiffness κ of contact (Pa/m), and
    /// friction or not; `functions` finds the shape functions at a place.
    ///
    /// # Errors
    /// Those of `functions`.
    pub(super) fn new<E>(
        (shape, mesh): (&Shape, &Mesh),
        (shortest, stiffness, friction): (f64, f64, bool),
        functions: impl Fn(&SurfacePoint) -> Result<PointFunctions, E>,
    ) -> Result<Self, E> {
        let of_step = |(point, tangent): &(SurfacePoint, [f64; 2])| {
            Ok(BoundaryNode::new(point.position, *tangent, &functions(point)?))
        };
        let of_part = |part: &Vec<_>| part.iter().map(of_step).collect::<Result<Vec<_>, E>>();
        let parts: Vec<_> = steps(shape, mesh, shortest).iter().map(of_part).collect::<Result<_, E>>()?;
        let is_corner = |part: &Vec<BoundaryNode>| {
            let (first, last) = (&part[0], &part[part.len() - 1]);
            let goes_on = |other: &Vec<BoundaryNode>| last.goes_on_at(&other[0]);
            [!parts.iter().any(|other| other[other.len() - 1].goes_on_at(first)), !parts.iter().any(goes_on)]
        };
        let corners: Vec<_> = parts.iter().map(is_corner).collect();
        let (mut nodes, mut arcs, rule) = (Vec::new(), Vec::new(), rule());
        for (mut part, corners) in parts.into_iter().zip(corners) {
            turn_corners(&mut part, corners);
            for (step, ends) in part.windows(2).enumerate() {
                let [positions, tangents] = [[0, 1].map(|i| ends[i].position), [0, 1].map(|i| ends[i].tangent)];
                arcs.push((nodes.len() + step, Arc::new(positions, tangents, &rule)));
            }
            nodes.append(&mut part);
        }
        Ok(Self { nodes, arcs, stiffness, friction, rule })
    }

    /// Arcs of the boundary at t = 0, in their order along it.
    pub(super) fn arcs_at_rest(&self) -> Vec<Arc> {
        self.arcs.iter().map(|(_, arc)| *arc).collect()
    }

    /// The arcs under a displacement, m.
    pub(super) fn outline(&self, displacement: &VectorField) -> Outline {
        let now: Vec<_> = self.nodes.iter().map(|node| node.now(displacement)).collect();
        let through = |(first, arc): &(usize, Arc)| {
            let ([a, s], [b, t]) = (now[*first], now[first + 1]);
            arc.through([a, b], [s, t])
        };
        Outline::new(self.arcs.iter().map(through).collect(), self.stiffness)
    }

    /// Adds a force at a place of an arc, and what turns the tangent there (see [`Self::turning`]).
    pub(super) fn push(&self, (arc, t): (usize, f64), force: [f64; 2], turning: [f64; 2], forces: &mut VectorField) {
        let (first, _) = self.arcs[arc];
        let ([a, b, s, e], [da, db, ds, de]) = (shares(t), tangent_shares(t));
        let on = |share: f64, slope: f64| [0, 1].map(|d| share * force[d] + slope * turning[d]);
        self.nodes[first].push(on(a, da), on(s, ds), forces);
        self.nodes[first + 1].push(on(b, db), on(e, de), forces);
    }

    /// What acts on the tangent at a place so that it is a couple, N.
    pub(super) fn turning(&self, (arc, t): (usize, f64), couple: f64, displacement: &VectorField) -> [f64; 2] {
        let (first, at_rest) = &self.arcs[arc];
        let [[a, s], [b, e]] = [first, &(first + 1)].map(|at| self.nodes[*at].now(displacement));
        let [x, y] = at_rest.through([a, b], [s, e]).tangent(t);
        let square = x * x + y * y;
        [-couple * y / square, couple * x / square]
    }

    /// Adds what springs along the boundary answer to a motion of the control points.
    pub(super) fn add_springs(&self, motion: &VectorField, out: &mut VectorField) {
        for (number, (first, arc)) in self.arcs.iter().enumerate() {
            let of = |node: &BoundaryNode| {
                let [now, tangent] = node.now(motion);
                [[0, 1].map(|d| now[d] - node.position[d]), [0, 1].map(|d| tangent[d] - node.tangent[d])]
            };
            let [[a, s], [b, t]] = [of(&self.nodes[*first]), of(&self.nodes[first + 1])];
            for (place, at) in arc.places(&self.rule).zip(&self.rule.points) {
                let [of_a, of_b, of_s, of_t] = shares(*at);
                let moved = [0, 1].map(|d| of_a * a[d] + of_b * b[d] + of_s * s[d] + of_t * t[d]);
                let stiffness = fault!("springs-of-the-boundary-left-out", 2.0 => 0.0) * self.stiffness * place.length;
                let across = dot(moved, place.normal);
                let answer = if self.friction { moved } else { place.normal.map(|n| across * n) };
                self.push((number, *at), answer.map(|x| stiffness * x), [0.0; 2], out);
            }
        }
    }
}
