//! Contact of bodies whose spans integrate: their boundaries, and forces on them.
//!
//! A force at x acts on control point i with the share `N_i(x)`, as the work of it on the motion of x asks.
//! The critical step counts a spring of twice κ all along the boundary: for two equal bodies that is what
//! both feel of each other.

use super::SpanQuadrature;
use crate::contact::gap_potential::{GapForce, Outline, rule, spring};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::vectors::dot;
use crate::splines::patch::Patch;
use crate::splines::spline::ShapeFunctions;

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
    pub(crate) fn expect_contact(&mut self, patch: &Patch) {
        let speed = self.moduli.dilatational_speed(self.density);
        self.spring = Some(spring(self.density * speed * speed, patch.shortest_span()));
    }

    /// The boundary at the last response, if it may meet others.
    pub(crate) fn outline(&self) -> Option<Outline> {
        Some(Outline { arcs: self.boundary.arcs(), spring: self.spring? })
    }

    /// Takes the force of a pair on this body, which is its `side`, until the accelerations are found.
    pub(crate) fn push(&mut self, patch: &Patch, pair: &GapForce, side: usize) {
        let force =
            if side == 0 { pair.force.map(|f| fault!("gap-force-one-sided", -f => -0.9 * f)) } else { pair.force };
        let Self { force: field, pushed, .. } = self;
        pushed.add(pair.places[side], force);
        Shares::new(patch, pair.places[side]).for_each(|at, share| {
            (0..2).for_each(|c| field[c][at] += share * force[c]);
        });
    }

    /// Adds what springs along the boundary answer to a motion of the control points.
    pub(crate) fn add_springs(&self, patch: &Patch, motion: &VectorField, out: &mut VectorField) {
        let Some(Outline { arcs, spring }) = self.outline() else { return };
        let rule = rule();
        for place in arcs.iter().flat_map(|arc| arc.places(&rule)) {
            let shares = Shares::new(patch, place.position);
            let mut moved = [0.0; 2];
            shares.for_each(|at, share| (0..2).for_each(|c| moved[c] += share * motion[c][at]));
            let answer = 2.0 * spring * place.length * dot(moved, place.normal);
            shares.for_each(|at, share| (0..2).for_each(|c| out[c][at] += share * answer * place.normal[c]));
        }
    }
}
