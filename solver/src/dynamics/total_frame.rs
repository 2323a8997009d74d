//! Explicit dynamics in the total frame: velocity Verlet on control points that keep their velocity.
//!
//! Shape functions are evaluated at the reference positions only, so displacement and velocity live on the
//! control points for the whole run, strains follow from the displacement, and nothing is lost in transfers.
//! With beta = 0 the strain at n + 1 does not depend on the acceleration at n + 1: one pass of the staggered
//! scheme is converged.

mod begin;
mod driven;
mod forced;
mod inspect;
mod observe;
mod paint;
mod rotation;
mod state;
pub(crate) mod stiffness;
mod tangent;

use rayon::prelude::*;

use crate::dynamics::constraints::Constraints;
use crate::dynamics::energy::Ledger;
use crate::dynamics::loads::NodalLoad;
use crate::dynamics::mass::MassMatrix;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::stencil::CHUNK_ROWS;
use crate::material::elasticity::ElasticModuli;
use crate::particles::lattice::Lattice;
use crate::phase_field::fracture::LatticeFracture;
use crate::scene::{Kinematics, Shape};
use crate::splines::patch::Patch;
use crate::transfer::sweep::StripForces;

use crate::transfer::elastic_forces::elastic_forces;
use driven::DrivenSides;
use forced::LatticeForcing;

/// One body in the total frame.
#[derive(Debug, Clone)]
pub struct TotalFrame {
    patch: Patch,
    grid: ControlGrid,
    lattice: Lattice,
    moduli: ElasticModuli,
    kinematics: Kinematics,
    shape: Shape,
    thickness: f64,
    gravity: [f64; 2],
    loads: Vec<NodalLoad>,
    /// Loads that vary in space, if there are any.
    forced: Option<Box<LatticeForcing>>,
    constraints: Constraints,
    mass: MassMatrix,
    displacement: VectorField,
    velocity: VectorField,
    acceleration: VectorField,
    internal: VectorField,
    strip_forces: StripForces,
    /// The phase field, if the material fractures.
    pub fracture: Option<LatticeFracture>,
    lowest_tip: f64,
    elastic_energy: f64,
    ledger: Ledger,
    time: f64,
    /// Sides that are driven, if there are any, and their power at the last whole step, W/m.
    driven: Option<Box<DrivenSides>>,
    driven_power: f64,
    /// Stiffening by finite strains at which the critical step was last taken.
    judged_stiffening: f64,
}

impl TotalFrame {
    /// Forces and accelerations at t = 0.
    fn begin(&mut self) {
        self.internal_forces();
        self.ledger.history_work = 0.0; // there was no step yet
        self.accelerate();
        self.driven_power = self.power_of_driven_sides();
    }

    /// One time step of `dt` seconds (E 14–18).
    ///
    /// # Errors
    /// If the phase field cannot be solved for.
    pub fn step(&mut self, dt: f64) -> Result<(), SolveFailure> {
        self.predict(dt);
        self.update_loads();
        if let Some(fracture) = &mut self.fracture {
            fracture.update_history(&self.lattice, self.moduli, self.kinematics, &self.displacement);
            fracture.advance_phase_field(&self.lattice)?;
        }
        self.internal_forces();
        self.accelerate();
        self.book_external_work(dt);
        self.correct(dt);
        Ok(())
    }

    /// `v ← v + dt/2 a`, `u ← u + dt v`, t ← t + dt.
    fn predict(&mut self, dt: f64) {
        let chunk = CHUNK_ROWS * self.grid.stride;
        for component in 0..2 {
            let v = self.velocity[component].par_chunks_mut(chunk);
            let u = self.displacement[component].par_chunks_mut(chunk);
            v.zip(u).zip(self.acceleration[component].par_chunks(chunk)).for_each(|((v, u), a)| {
                for ((v, u), a) in v.iter_mut().zip(u).zip(a) {
                    *v += 0.5 * dt * a;
                    *u += dt * *v;
                }
            });
        }
        self.time += dt;
    }

    /// `v ← v + dt/2 a`.
    fn correct(&mut self, dt: f64) {
        let chunk = CHUNK_ROWS * self.grid.stride;
        for component in 0..2 {
            let v = self.velocity[component].par_chunks_mut(chunk);
            v.zip(self.acceleration[component].par_chunks(chunk)).for_each(|(v, a)| {
                for (v, a) in v.iter_mut().zip(a) {
                    *v += fault!("whole-kick", 0.5 * dt => dt) * a;
                }
            });
        }
    }

    /// Loads that vary in space, at the present time.
    fn update_loads(&mut self) {
        let Some(forced) = &mut self.forced else { return };
        forced.update_forces(&self.lattice, self.time);
        if let Some(fracture) = &mut self.fracture {
            fracture.field.set_load(forced.phase_load(&self.lattice, self.time));
        }
    }

    /// Stress at the points and its nodal forces; books the work of the history field.
    fn internal_forces(&mut self) {
        let Self { lattice, moduli, kinematics, displacement, strip_forces, internal, .. } = self;
        if let Some(fracture) = &mut self.fracture {
            let displacement = [&displacement[0][..], &displacement[1][..]];
            let sums = fracture.degraded_forces(lattice, *moduli, *kinematics, displacement, strip_forces);
            self.elastic_energy = sums.elastic_energy;
            self.ledger.history_work += sums.history_work;
            strip_forces.assemble(self.grid.stride, internal);
        } else {
            self.elastic_energy = elastic_forces(lattice, *moduli, *kinematics, displacement, strip_forces, internal);
        }
    }

    /// `a = M⁻¹ (f_ext − f_int)`, zero where the velocity is prescribed.
    fn accelerate(&mut self) {
        self.external_minus_internal();
        self.mass.divide(&mut self.acceleration);
        self.constraints.remove(&mut self.acceleration);
    }

    /// `f_ext − f_int` in the room of the acceleration.
    fn external_minus_internal(&mut self) {
        let chunk = CHUNK_ROWS * self.grid.stride;
        for component in 0..2 {
            let gravity = fault!("gravity-upwards", self.gravity[component] => -self.gravity[component]);
            let a = self.acceleration[component].par_chunks_mut(chunk);
            let mass = self.mass.row_sums().par_chunks(chunk);
            a.zip(self.internal[component].par_chunks(chunk)).zip(mass).for_each(|((a, f), m)| {
                for ((a, f), m) in a.iter_mut().zip(f).zip(m) {
                    *a = gravity * m - f;
                }
            });
        }
        for load in &self.loads {
            let factor = load.factor(self.time);
            for &(at, force) in &load.forces {
                for component in 0..2 {
                    self.acceleration[component][at] += factor * force[component];
                }
            }
        }
        if let Some(forced) = &self.forced {
            forced.add_to(&mut self.acceleration);
        }
    }

    /// Work of tractions, gravity and driven sides over the last step: mean force times displacement.
    fn book_external_work(&mut self, dt: f64) {
        let velocity = &self.velocity; // half a step before self.time: between the two ends of the step
        let mut power = 0.0;
        for load in &self.loads {
            let before = fault!("work-of-the-last-force", load.factor(self.time - dt) => load.factor(self.time));
            let factor = 0.5 * (before + load.factor(self.time));
            let forces = load.forces.iter();
            power += factor * forces.map(|&(at, f)| f[0] * velocity[0][at] + f[1] * velocity[1][at]).sum::<f64>();
        }
        for (component, gravity) in self.gravity.into_iter().enumerate().filter(|(_, g)| *g != 0.0) {
            power += gravity * self.mass.row_sums().iter().zip(&velocity[component]).map(|(m, v)| m * v).sum::<f64>();
        }
        if let Some(forced) = &self.forced {
            power += forced.mean_power(velocity);
        }
        let driven = fault!("driven-work-left-out", self.power_of_driven_sides() => 0.0);
        power += 0.5 * (self.driven_power + driven);
        self.driven_power = driven;
        self.ledger.external_work += dt * power;
    }

    /// Reaction times velocity of the driven control points, W/m: internal and inertial minus external force.
    fn power_of_driven_sides(&mut self) -> f64 {
        let Self { driven: Some(driven), mass, acceleration, internal, loads, gravity, time, .. } = self else {
            return 0.0;
        };
        let DrivenSides { points, inertia, forced } = &mut **driven;
        for component in 0..2 {
            mass.multiply(&acceleration[component], &mut inertia[component]);
        }
        if let Some(loads) = &self.forced {
            let forced = forced.get_or_insert_with(|| [self.grid.zeros(), self.grid.zeros()]);
            forced.iter_mut().for_each(|forced| forced.fill(0.0));
            loads.add_to(forced);
        }
        let mut power = 0.0;
        for &(at, component, value) in &*points {
            let loads = loads.iter().flat_map(|load| load.forces.iter().map(|f| (load.factor(*time), f)));
            let applied: f64 = loads.filter(|(_, f)| f.0 == at).map(|(factor, f)| factor * f.1[component]).sum();
            let varying = forced.as_ref().map_or(0.0, |forced| forced[component][at]);
            let external = applied + varying + gravity[component] * mass.row_sums()[at];
            power += value * (internal[component][at] + inertia[component][at] - external);
        }
        power
    }
}
