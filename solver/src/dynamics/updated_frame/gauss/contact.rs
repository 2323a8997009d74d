//! Contact of bodies whose spans integrate: their boundaries, and forces on them.
//!
//! A force at x acts on control point i with the share `N_i(x)`, as the work of it on the motion of x asks.
//! The critical step counts a spring of twice κ all along the boundary: for two equal bodies that is what
//! both feel of each other. With friction they resist motion along the boundary as they do across it.
//! Friction acts on both bodies at one place, which is inside one of them by the depth of the overlap.

use super::boundary::{MovingBoundary, edges};
use super::{BoundarySprings, SpanQuadrature};
use crate::contact::gap_potential::GapForce;
use crate::contact::gap_potential::arc::{Outline, rule};
use crate::contact::gap_potential::rigid_outline::RigidOutline;
use crate::contact::rigid::RigidMotion;
use crate::contact::surface::Surface;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::vectors::dot;
use crate::scene::{Body, Contact, Mesh};
use crate::splines::patch::Patch;
use crate::splines::spline::ShapeFunctions;

/// The boundary of a rigid body on a patch; `None` of a shape whose boundary has no rule.
pub(crate) fn rigid_outline(mesh: &Mesh, body: &Body, patch: &Patch) -> Option<RigidOutline> {
    let boundary = MovingBoundary::new(edges(&body.shape, mesh)?, patch.shortest_span(), patch.spaces[0].degree());
    let motion = RigidMotion::new(body, Surface::new(mesh, body).centroid());
    Some(RigidOutline::new(boundary.arcs(), motion))
}

/// Control points that a place acts on, with their shares.
struct Shares {
    grid: ControlGrid,
    first: [usize; 2],
    functions: [ShapeFunctions; 2],
    order: [usize; 2],
}

impl Shares {
    fn new(patch: &Patch, position: [f64; 2]) -> Self {
        let along = |d: usize| {
            let spans = patch.spaces[d].spans();
            let span = spans.partition_point(|span| span.right <= position[d]).min(spans.len() - 1);
            (spans[span].first, patch.spaces[d].shape_functions(span, position[d]))
        };
        let [(column, x), (row, y)] = [along(0), along(1)];
        let order = [0, 1].map(|d| patch.spaces[d].degree() + 1);
        Self { grid: patch.control_grid(), first: [column, row], functions: [x, y], order }
    }

    fn for_each(&self, mut f: impl FnMut(usize, f64)) {
        let [x, y] = &self.functions;
        for l in 0..self.order[1] {
            for k in 0..self.order[0] {
                f(self.grid.index(self.first[0] + k, self.first[1] + l), x.value[k] * y.value[l]);
            }
        }
    }
}

impl SpanQuadrature {
    /// From now on the boundary may meet others.
    pub(crate) fn expect_contact(&mut self, patch: &Patch, contact: &Contact) {
        let speed = self.moduli.dilatational_speed(self.density);
        let stiffness = contact.stiffness * (self.density * speed * speed) / patch.shortest_span();
        self.springs = Some(BoundarySprings { stiffness, friction: contact.friction > 0.0 });
    }

    /// The boundary at the last response, if it may meet others.
    pub(crate) fn outline(&self) -> Option<Outline> {
        Some(Outline { arcs: self.boundary.arcs(), spring: self.springs?.stiffness })
    }

    /// Takes the force of a pair on this body, which is its `side`, until the accelerations are found.
    pub(crate) fn push(&mut self, patch: &Patch, pair: &GapForce, side: usize) {
        let force =
            if side == 0 { pair.force.map(|f| fault!("gap-force-one-sided", -f => -0.9 * f)) } else { pair.force };
        self.act(patch, pair.places[side], force);
        if let Some(friction) = pair.friction {
            self.act(patch, pair.places[1], if side == 0 { friction.map(|f| -f) } else { friction });
        }
    }

    /// Takes a force at a place.
    fn act(&mut self, patch: &Patch, place: [f64; 2], force: [f64; 2]) {
        let Self { force: field, pushed, .. } = self;
        pushed.add(place, force);
        Shares::new(patch, place).for_each(|at, share| {
            (0..2).for_each(|c| field[c][at] += share * force[c]);
        });
    }

    /// Adds what springs along the boundary answer to a motion of the control points.
    pub(crate) fn add_springs(&self, patch: &Patch, motion: &VectorField, out: &mut VectorField) {
        let Some(BoundarySprings { stiffness, friction }) = self.springs else { return };
        let rule = rule();
        for place in self.boundary.arcs().iter().flat_map(|arc| arc.places(&rule)) {
            let shares = Shares::new(patch, place.position);
            let mut moved = [0.0; 2];
            shares.for_each(|at, share| (0..2).for_each(|c| moved[c] += share * motion[c][at]));
            let stiffness = 2.0 * stiffness * place.length;
            if friction {
                shares.for_each(|at, share| (0..2).for_each(|c| out[c][at] += share * stiffness * moved[c]));
            } else {
                let answer = stiffness * dot(moved, place.normal);
                shares.for_each(|at, share| (0..2).for_each(|c| out[c][at] += share * answer * place.normal[c]));
            }
        }
    }
}
