//! Loads of a body that vary in space and time, as nodal forces: see [`crate::dynamics::forcing`].

use std::sync::Arc;

use crate::dynamics::forcing::Forcing;
use crate::dynamics::loads::take_side;
use crate::dynamics::surface::{SurfacePoint, points_around};
use crate::linear_algebra::control_grid::VectorField;
use crate::particles::lattice::Lattice;
use crate::scene::{Shape, Side};
use crate::splines::patch::{BoundaryPoint, Patch};
use crate::splines::quadrature::Rule;
use crate::splines::spline::ROUND_OFF;

/// Nodal forces of a [`Forcing`] on a body.
#[derive(Debug, Clone)]
pub(super) struct LatticeForcing {
    forcing: Arc<dyn Forcing>,
    boundary: Vec<BoundaryPoint>,
    /// At the present step and at the one before, N/m.
    now: VectorField,
    before: VectorField,
}

impl LatticeForcing {
    /// Tractions on the sides of a patch are integrated with the points' own rule in every span of them.
    pub(crate) fn new(forcing: Arc<dyn Forcing>, patch: &Patch, lattice: &Lattice, shape: &Shape) -> Self {
        let fills = match shape {
            Shape::Rectangle { min, max } => {
                let (low, high) = patch.bounding_box();
                (0..2).all(|d| (min[d] - low[d]).abs().max((max[d] - high[d]).abs()) <= ROUND_OFF * (high[d] - low[d]))
            }
            shape => *shape == Shape::Patch,
        };
        let boundary = if fills {
            let [left, bottom] = [1, 0].map(|along| Rule::new(lattice.layout, lattice.points[along]));
            let sides = [(Side::Left, &left), (Side::Right, &left), (Side::Bottom, &bottom), (Side::Top, &bottom)];
            sides.into_iter().flat_map(|(side, rule)| patch.boundary(side, rule)).collect()
        } else {
            let with_functions = |SurfacePoint { position, length, normal, inner, .. }| {
                let mut functions = patch.functions_at(position)?;
                take_side(lattice, &mut functions, inner);
                Some(BoundaryPoint { normal, length, functions })
            };
            points_around(patch, shape).into_iter().filter_map(with_functions).collect()
        };
        let zeros = || [lattice.grid.zeros(), lattice.grid.zeros()];
        Self { forcing, boundary, now: zeros(), before: zeros() }
    }

    /// Forces at `time` (s); those in force before are kept for the work of the step.
    pub(crate) fn update_forces(&mut self, lattice: &Lattice, time: f64) {
        std::mem::swap(&mut self.now, &mut self.before);
        self.now.iter_mut().for_each(|f| f.fill(0.0));
        if self.forcing.acts_inside() {
            let [x, y] = &mut self.now;
            lattice.add_integral(&mut [x, y], |_, _, position| {
                let load = self.forcing.volume(position, time);
                (load.force, load.stress)
            });
        }
        for point in &self.boundary {
            let traction = self.forcing.traction(point.functions.position, point.normal, time);
            for &(at, value) in &point.functions.values {
                for component in 0..2 {
                    self.now[component][at] += value * point.length * traction[component];
                }
            }
        }
    }

    /// Right-hand side of the phase-field equation at `time` (s), m².
    pub(crate) fn phase_load(&self, lattice: &Lattice, time: f64) -> Vec<f64> {
        let mut load = lattice.integrate(|_, _, position| self.forcing.phase_source(position, time));
        for point in &self.boundary {
            let flux = self.forcing.phase_flux(point.functions.position, point.normal, time);
            for &(at, value) in &point.functions.values {
                load[at] += value * point.length * flux;
            }
        }
        lattice.onto_patch(load)
    }

    pub(crate) fn add_to(&self, forces: &mut VectorField) {
        for component in 0..2 {
            for (sum, force) in forces[component].iter_mut().zip(&self.now[component]) {
                *sum += force;
            }
        }
    }

    /// Mean of the forces at both ends of the step times the velocity between them.
    pub(crate) fn mean_power(&self, velocity: &VectorField) -> f64 {
        let component = |c: usize| {
            let forces = self.now[c].iter().zip(&self.before[c]).zip(&velocity[c]);
            forces.map(|((now, before), v)| 0.5 * (now + before) * v).sum::<f64>()
        };
        component(0) + component(1)
    }
}
