//! Stiffness at the Gauss points, for the critical step.
//!
//! Points follow the grid's accelerations and are a leapfrog of their own, so the step is stable up to `2/ω`
//! with the highest frequency ω of `M⁻¹ K`. The penalty in M bounds ω however the boundary cuts spans.
//! Where bodies may meet, K has the springs of the boundary ([`contact`](super::contact)).

use super::SpanQuadrature;
use super::balance::SpanBalance;
use super::system::Accuracy;
use crate::dynamics::critical_step::{StiffnessOperator, highest_frequency};
use crate::linear_algebra::control_grid::VectorField;
use crate::splines::patch::Patch;

/// Error of the solves with M.
const TOLERANCE: f64 = 1e-10;

/// `K x` and `M⁻¹ x` on the control points that take part and are not held.
struct SpanStiffness<'a> {
    spans: SpanQuadrature,
    patch: &'a Patch,
    free: Vec<(usize, usize)>,
    field: VectorField,
    image: VectorField,
}

impl SpanQuadrature {
    /// Critical time step at the present positions, s.
    pub(crate) fn critical_step(&self, patch: &Patch) -> f64 {
        let grid = self.inertia.matrix.grid;
        let moves = |&(at, c): &(usize, usize)| self.inertia.takes(at) && self.held[c].binary_search(&at).is_err();
        let free = grid.indices().flat_map(|at| [(at, 0), (at, 1)]).filter(moves).collect();
        let field = || [grid.zeros(), grid.zeros()];
        let mut operator = SpanStiffness { spans: self.clone(), patch, free, field: field(), image: field() };
        2.0 / highest_frequency(&mut operator)
    }
}

impl SpanStiffness<'_> {
    fn unpack(&mut self, x: &[f64]) {
        self.free.iter().zip(x).for_each(|(&(at, c), x)| self.field[c][at] = *x);
    }

    fn pack(&self, out: &mut [f64]) {
        self.free.iter().zip(out).for_each(|(&(at, c), out)| *out = self.image[c][at]);
    }
}

impl StiffnessOperator for SpanStiffness<'_> {
    fn size(&self) -> usize {
        self.free.len()
    }

    fn stiffness(&mut self, x: &[f64], out: &mut [f64]) {
        self.unpack(x);
        let Self { spans, patch, field, image, .. } = self;
        let SpanQuadrature { gauss, displacement, moduli, density, .. } = spans;
        let balance = SpanBalance { gauss, displacement: &displacement[0], moduli: *moduli, density: *density };
        balance.stiffness(field, image);
        spans.add_springs(patch, field, image);
        self.pack(out);
    }

    fn divide_by_mass(&mut self, x: &[f64], out: &mut [f64]) {
        self.unpack(x);
        let Self { spans, field, image, .. } = self;
        let inertia = &mut spans.inertia;
        image.iter_mut().for_each(|image| image.fill(0.0));
        if inertia.solve(field, image, Accuracy { tolerance: TOLERANCE, round_off: 0.0 }).is_err() {
            image.iter_mut().for_each(|image| image.fill(f64::NAN));
        }
        self.pack(out);
    }
}
