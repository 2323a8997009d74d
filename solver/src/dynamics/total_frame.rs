//! Explicit dynamics in the total frame: velocity Verlet on control points that keep their velocity.
//!
//! Shape functions are evaluated at the reference positions only, so displacement and velocity live on the
//! control points for the whole run, strains follow from the displacement, and nothing is lost in transfers.
//! With beta = 0 the strain at n + 1 does not depend on the acceleration at n + 1: one pass of the staggered
//! scheme is converged.

mod begin;
pub mod bodies;
mod boundary;
mod contact;
pub mod domain;
mod edge_conditions;
mod equilibrium;
mod forced;
mod fragments;
mod held_points;
mod inspect;
mod j_integral;
mod observe;
mod paint;
mod prescribed;
mod probe;
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
use boundary::MaterialBoundary;
use domain::Domain;
use edge_conditions::EdgeConditions;
use forced::LatticeForcing;
use prescribed::Reactions;
use probe::ProbePlace;

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
    /// Conditions on edges that are not sides of the mesh, if there are any.
    edges: Option<Box<EdgeConditions>>,
    /// The boundary, if it may meet others.
    boundary: Option<Box<MaterialBoundary>>,
    mass: MassMatrix,
    displacement: VectorField,
    velocity: VectorField,
    acceleration: VectorField,
    internal: VectorField,
    strip_forces: StripForces,
    /// The phase field, if the material fractures.
    pub fracture: Option<LatticeFracture>,
    probes: Vec<ProbePlace>,
    /// J-integrals.
    domains: Vec<Domain>,
    /// kg/m³.
    density: f64,
    /// Where its crack begins, m, once there is one.
    crack_start: Option<[f64; 2]>,
    /// Whether samples have the number of fragments.
    counts_fragments: bool,
    elastic_energy: f64,
    ledger: Ledger,
    time: f64,
    /// The step in use, s; zero before the first.
    time_step: f64,
    /// Reactions to the conditions, if one of them moves or has a name.
    reactions: Reactions,
    /// Stiffening by finite strains at which the critical step was last taken.
    judged_stiffening: f64,
}

impl TotalFrame {
    /// Forces and accelerations at t = 0.
    fn begin(&mut self) {
        self.follow_with_loads();
        self.internal_forces();
        self.ledger.history_work = 0.0; // there was no step yet
        self.fracture.iter_mut().for_each(|fracture| fracture.begin_work(&self.lattice));
        self.accelerate();
    }

    /// One time step of `dt` seconds (E 14–18).
    ///
    /// # Errors
    /// If the phase field cannot be solved for.
    pub fn step(&mut self, dt: f64) -> Result<(), SolveFailure> {
        self.find_internal_forces(dt)?;
        self.find_motion(dt);
        Ok(())
    }

    /// The first part of a step: positions, phase field and internal forces at its end.
    fn find_internal_forces(&mut self, dt: f64) -> Result<(), SolveFailure> {
        self.predict(dt);
        self.update_loads();
        if let Some(fracture) = &mut self.fracture {
            let Self { lattice, moduli, kinematics, displacement, strip_forces, .. } = self;
            if fracture.needs_history() {
                fracture.update_history(lattice, self.time, *moduli, *kinematics, displacement, strip_forces);
            }
            fracture.advance_phase_field(&self.lattice)?;
        }
        self.internal_forces();
        Ok(())
    }

    /// The other part: accelerations and velocities at its end.
    fn find_motion(&mut self, dt: f64) {
        self.accelerate();
        self.book_external_work(dt);
        self.correct(dt);
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
        if let Some(sheets) = self.lattice.sheets() {
            sheets.spread(&mut self.displacement);
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
        if let Some(sheets) = self.lattice.sheets() {
            sheets.spread(&mut self.velocity);
        }
    }

    /// Loads that follow the body or vary in space, at the present time.
    fn update_loads(&mut self) {
        self.follow_with_loads();
        let Some(forced) = &mut self.forced else { return };
        forced.update_forces(&self.lattice, self.time);
        if let Some(fracture) = &mut self.fracture {
            fracture.field.set_load(forced.phase_load(&self.lattice, self.time));
        }
    }

    /// Loads that follow the body, at the present displacement.
    fn follow_with_loads(&mut self) {
        self.loads.iter_mut().for_each(|load| load.follow(&self.displacement));
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
        if let Some(sheets) = lattice.sheets() {
            internal.iter_mut().for_each(|component| sheets.fold(component));
        }
    }

    /// `a = M⁻¹ (f_ext − f_int)`, or what is prescribed.
    fn accelerate(&mut self) {
        self.external_minus_internal();
        self.reactions.begin(&self.constraints, &self.acceleration);
        self.mass.divide(&mut self.acceleration);
        let Self { reactions, constraints, edges, mass, velocity, acceleration, .. } = self;
        let step = [self.time, self.time_step];
        reactions.prescribe(constraints, step, mass, velocity, acceleration);
        if let Some(edges) = edges {
            edges.enforce(step, velocity, acceleration, reactions);
        }
    }

    /// Makes ready for steps of `dt` seconds: the accelerations at t = 0 of what is prescribed.
    pub(crate) fn prepare(&mut self, dt: f64) {
        self.time_step = dt;
        self.loads.iter_mut().for_each(|load| load.factor.prepare(dt));
        self.accelerate();
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
            let factor = load.factor.at(self.time);
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

    /// Work of tractions, gravity and conditions over the last step: mean force times displacement.
    fn book_external_work(&mut self, dt: f64) {
        let velocity = &self.velocity; // half a step before self.time: between the two ends of the step
        let mut power = 0.0;
        for load in &self.loads {
            let before = fault!("work-of-the-last-force", load.factor.at(self.time - dt) => load.factor.at(self.time));
            power += 0.5 * load.power([before, load.factor.at(self.time)], velocity);
        }
        for (component, gravity) in self.gravity.into_iter().enumerate().filter(|(_, g)| *g != 0.0) {
            power += gravity * self.mass.row_sums().iter().zip(&velocity[component]).map(|(m, v)| m * v).sum::<f64>();
        }
        if let Some(forced) = &self.forced {
            power += forced.mean_power(velocity);
        }
        let edges = self.edges.as_mut().map_or(0.0, |edges| edges.work(dt));
        let conditions = self.reactions.work(dt) + edges;
        self.ledger.external_work += dt * power + fault!("driven-work-left-out", conditions => 0.0);
    }
}
