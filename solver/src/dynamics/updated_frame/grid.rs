//! Nodal fields of the updated frame, rebuilt at every step.

use std::collections::BTreeSet;

use crate::dynamics::constraints::Constraints;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::extremes::larger;
use crate::splines::patch::Patch;

/// Masses below this fraction of the largest give no acceleration; their control points keep their velocity.
///
/// Removing such a control point (zero velocity) would break the partition of unity and brake every moving
/// boundary.
const NEGLIGIBLE_MASS: f64 = 1e-16;

/// Mass, velocities and forces of the control points at the present whole step, per unit thickness.
#[derive(Debug, Clone)]
pub struct NodalFields {
    /// Layout of the control points.
    pub grid: ControlGrid,
    /// Greville abscissae in x and y, m: where the control points stand.
    pub greville: [Vec<f64>; 2],
    /// Lumped mass, kg/m, and its inverse (zero where negligible).
    pub mass: Vec<f64>,
    /// See [`Self::mass`].
    pub inverse_mass: Vec<f64>,
    /// Velocity with which the points arrived, v(n − 1/2) before conditions on the sides, m/s.
    pub arrived: VectorField,
    /// v(n − 1/2) with conditions on the sides; after the kick v(n + 1/2), m/s.
    pub velocity: VectorField,
    /// External minus internal force, N/m.
    pub force: VectorField,
    /// a(n), m/s²; zero where the velocity is prescribed or the mass negligible.
    pub acceleration: VectorField,
    /// What the points add up to: momentum and force, two numbers each, and mass.
    pub sums: Vec<[f64; 5]>,
    /// What the sides hold.
    constraints: Constraints,
    /// Control points and components that sides hold.
    pub fixed: BTreeSet<(usize, usize)>,
}

/// What the grid holds at the end of a step, per unit thickness.
#[derive(Debug, Clone, Copy)]
pub(super) struct EndOfStep {
    pub kinetic: f64,
    /// Momentum of the motion of the points.
    pub momentum: [f64; 2],
    /// Power of the forces on that motion, less what the grid follows.
    pub not_followed: f64,
}

/// Energies of imposing the conditions on the sides, J/m.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ImposedEnergy {
    /// Impulse times prescribed velocity.
    pub work: f64,
    /// `1/2 Σ m (v_prescribed − v)²`: what the impact costs.
    pub loss: f64,
}

impl ImposedEnergy {
    /// Sum of two such energies, term by term.
    pub(super) fn plus(self, other: Self) -> Self {
        Self { work: self.work + other.work, loss: self.loss + other.loss }
    }
}

impl NodalFields {
    /// Fields of zeros on the control points of a patch, some of which the sides hold.
    pub(crate) fn new(patch: &Patch, constraints: Constraints) -> Self {
        let grid = patch.control_grid();
        let vectors = || [grid.zeros(), grid.zeros()];
        Self {
            grid,
            greville: [0, 1].map(|d| patch.spaces[d].greville()),
            mass: grid.zeros(),
            inverse_mass: grid.zeros(),
            arrived: vectors(),
            velocity: vectors(),
            force: vectors(),
            acceleration: vectors(),
            sums: vec![[0.0; 5]; grid.len()],
            fixed: constraints.iter().map(|(at, component, _)| (at, component)).collect(),
            constraints,
        }
    }

    /// Lets the sides hold other control points.
    pub(super) fn hold(&mut self, constraints: Constraints) {
        self.fixed = constraints.iter().map(|(at, component, _)| (at, component)).collect();
        self.constraints = constraints;
    }

    /// Mass, arriving velocity and force from [`Self::sums`], and the inverse masses.
    pub fn divide_by_mass(&mut self) {
        let ([px, py], [fx, fy]) = (&mut self.arrived, &mut self.force);
        for (at, sums) in self.sums.iter().enumerate() {
            [px[at], py[at], fx[at], fy[at], self.mass[at]] = *sums;
        }
        let negligible = NEGLIGIBLE_MASS * self.mass.iter().copied().fold(0.0, larger);
        let [x, y] = &mut self.arrived;
        let nodes = self.mass.iter().zip(&mut self.inverse_mass).zip(x.iter_mut().zip(y));
        for ((&mass, inverse), (x, y)) in nodes {
            *inverse = if mass > negligible { 1.0 / mass } else { 0.0 };
            let divisor = if mass == 0.0 { f64::INFINITY } else { mass };
            *x /= divisor;
            *y /= divisor;
        }
        for (velocity, arrived) in self.velocity.iter_mut().zip(&self.arrived) {
            velocity.copy_from_slice(arrived);
        }
    }

    /// Adds the weight of the control points.
    pub(crate) fn add_gravity(&mut self, gravity: [f64; 2]) {
        for component in (0..2).filter(|&c| gravity[c] != 0.0) {
            for (force, mass) in self.force[component].iter_mut().zip(&self.mass) {
                *force += gravity[component] * fault!("gravity-without-mass", *mass => 1.0);
            }
        }
    }

    /// Stops what the sides hold.
    pub fn stop(&mut self) -> ImposedEnergy {
        let mut loss = 0.0;
        for (at, component, _) in self.constraints.iter() {
            let velocity = std::mem::take(&mut self.velocity[component][at]);
            loss += 0.5 * self.mass[at] * velocity * velocity;
        }
        ImposedEnergy { work: 0.0, loss }
    }

    /// `a = M⁻¹ f`, zero where the velocity is prescribed.
    pub fn accelerate(&mut self) {
        for (acceleration, force) in self.acceleration.iter_mut().zip(&self.force) {
            for ((a, f), inverse) in acceleration.iter_mut().zip(force).zip(&self.inverse_mass) {
                *a = f * inverse;
            }
        }
        self.constraints.remove(&mut self.acceleration);
    }

    /// Changes the velocity by the acceleration over `dt` seconds: `v ← v + dt a`.
    pub fn kick(&mut self, dt: f64) {
        for (velocity, acceleration) in self.velocity.iter_mut().zip(&self.acceleration) {
            for (v, a) in velocity.iter_mut().zip(acceleration) {
                *v += dt * a;
            }
        }
    }

    /// `1/2 vᵀ M v` of a velocity field, J/m.
    pub(crate) fn kinetic_energy(&self, velocity: &VectorField) -> f64 {
        let [x, y] = velocity;
        0.5 * self.mass.iter().zip(x.iter().zip(y)).map(|(m, (x, y))| m * (x * x + y * y)).sum::<f64>()
    }

    /// Momentum of a velocity field, kg/s.
    pub fn momentum(&self, velocity: &VectorField) -> [f64; 2] {
        [0, 1].map(|c| self.mass.iter().zip(&velocity[c]).map(|(m, v)| m * v).sum())
    }

    /// Power of the present forces on the present velocities, W/m: at control points that accelerate if
    /// `followed`, at the others if not.
    pub(crate) fn power(&self, followed: bool) -> f64 {
        let mut power = 0.0;
        for component in 0..2 {
            let nodes = self.force[component].iter().zip(&self.velocity[component]).zip(&self.inverse_mass);
            for ((force, velocity), _) in nodes.filter(|(_, inverse)| (**inverse > 0.0) == followed) {
                power += force * velocity;
            }
        }
        power
    }

    /// Position of a control point, m.
    pub fn position(&self, at: usize) -> [f64; 2] {
        [self.greville[0][self.grid.column_of(at)], self.greville[1][self.grid.row_of(at)]]
    }

    /// Values of a velocity field at the Greville points: exact control values of an affine field, of second
    /// order for others.
    pub(crate) fn at_greville_points(&self, velocity: impl Fn([f64; 2]) -> [f64; 2]) -> VectorField {
        let mut field = [self.grid.zeros(), self.grid.zeros()];
        for at in self.grid.indices() {
            [field[0][at], field[1][at]] = velocity(self.position(at));
        }
        field
    }

    /// Components that accelerate: control point and component.
    pub fn free(&self) -> Vec<(usize, usize)> {
        let moving = |&(at, c): &(usize, usize)| self.inverse_mass[at] > 0.0 && !self.fixed.contains(&(at, c));
        self.grid.indices().flat_map(|at| [(at, 0), (at, 1)]).filter(moving).collect()
    }
}
