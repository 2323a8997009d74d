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
mod inspect;
mod j_integral;
mod levels;
mod observe;
mod prescribed;
pub(crate) mod stiffness;

use crate::dynamics::constraints::Constraints;
use crate::dynamics::energy::Ledger;
use crate::dynamics::loads::{Gravity, NodalLoad};
use crate::dynamics::mass::MassMatrix;
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::material::elasticity::ElasticModuli;
use crate::particles::lattice::Lattice;
use crate::phase_field::fracture::LatticeFracture;
use crate::scene::{Kinematics, Shape};
use crate::splines::patch::Patch;
use crate::transfer::sweep::StripForces;

use crate::transfer::finite::{Elastic, elastic_forces};
use boundary::MaterialBoundary;
use domain::{Domain, ProbePlace};
use edge_conditions::EdgeConditions;
use forced::LatticeForcing;
use prescribed::Reactions;

/// From the velocity at hand to that of the step to come, of a step: prescribed velocities are those in the
/// middle of steps.
const AT_WHOLE_STEP: f64 = 0.5;
const BETWEEN_STEPS: f64 = 1.0;

/// One body in the total frame.
#[derive(Debug, Clone)]
pub struct TotalFrame {
    /// Background patch with the shape functions of the body.
    pub patch: Patch,
    grid: ControlGrid,
    /// Material points of the body, in reference positions.
    pub lattice: Lattice,
    /// Elastic moduli of its material, Pa.
    pub moduli: ElasticModuli,
    kinematics: Kinematics,
    shape: Shape,
    thickness: f64,
    gravity: Gravity,
    loads: Vec<NodalLoad>,
    /// Loads that vary in space, if there are any.
    forced: Option<Box<LatticeForcing>>,
    /// Sides with prescribed velocity.
    pub constraints: Constraints,
    /// Conditions on edges that are not sides of the mesh, if there are any.
    edges: Option<Box<EdgeConditions>>,
    /// The boundary, if it may meet others.
    boundary: Option<Box<MaterialBoundary>>,
    /// Mass per unit thickness.
    pub mass: MassMatrix,
    /// Control points in use: all, unless the body has other levels.
    in_use: ActiveColumns,
    /// Control values of the displacement, m.
    pub displacement: VectorField,
    /// Control values of the velocity, m/s.
    pub velocity: VectorField,
    acceleration: VectorField,
    internal: VectorField,
    pub(crate) strip_forces: StripForces,
    /// The phase field, if the material fractures.
    pub fracture: Option<LatticeFracture>,
    probes: Vec<ProbePlace>,
    /// Domains of the J-integrals that the scene asks for.
    domains: Vec<Domain>,
    /// Density of its material, kg/m³.
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
        self.begin_forces();
        self.accelerate(AT_WHOLE_STEP);
    }

    /// Finds the forces at t = 0; no work is booked for them.
    fn begin_forces(&mut self) {
        self.follow_with_loads();
        self.internal_forces();
        self.ledger.history_work = 0.0; // there was no step yet
        self.fracture.iter_mut().for_each(|fracture| fracture.begin_work(&self.lattice));
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
        self.find_strains(dt);
        if let Some(fracture) = &mut self.fracture {
            fracture.advance_phase_field(&self.lattice)?;
        }
        self.internal_forces();
        Ok(())
    }

    /// Positions at the end of a step, and H where c is to be solved for.
    fn find_strains(&mut self, dt: f64) {
        self.predict(dt);
        self.update_loads();
        if self.fracture.as_ref().is_some_and(LatticeFracture::needs_history) {
            self.update_history();
        }
    }

    /// H at the present displacement.
    fn update_history(&mut self) {
        let Self { lattice, moduli, kinematics, displacement, strip_forces, fracture, time, .. } = self;
        if let Some(fracture) = fracture {
            let body = Elastic { lattice, moduli: *moduli, kinematics: *kinematics };
            fracture.update_history(body, *time, displacement, strip_forces);
        }
    }

    /// The other part: accelerations and velocities at its end.
    fn find_motion(&mut self, dt: f64) {
        self.accelerate(BETWEEN_STEPS);
        self.find_velocities(dt);
    }

    /// Velocities at the end of a step, and the work that was done in it.
    fn find_velocities(&mut self, dt: f64) {
        self.book_external_work(dt);
        self.correct(dt);
    }

    /// `v ← v + dt/2 a`, `u ← u + dt v`, t ← t + dt.
    fn predict(&mut self, dt: f64) {
        let Self { in_use, grid, velocity, displacement, acceleration, .. } = self;
        for ((v, u), a) in velocity.iter_mut().zip(displacement).zip(acceleration) {
            in_use.for_each_part(*grid, [v, u], |used, [v, u]| {
                for ((v, u), a) in v.iter_mut().zip(u).zip(&a[used]) {
                    *v += 0.5 * dt * a;
                    *u += dt * *v;
                }
            });
        }
        self.lattice.sheets.spread(&mut self.displacement);
        self.time += dt;
    }

    /// Second half of the change of velocity in a step of velocity Verlet: `v ← v + dt/2 a`.
    fn correct(&mut self, dt: f64) {
        let part = fault!("whole-kick", 0.5 * dt => dt);
        for (v, a) in self.velocity.iter_mut().zip(&self.acceleration) {
            self.in_use.for_each_part(self.grid, [v], |used, [v]| {
                v.iter_mut().zip(&a[used]).for_each(|(v, a)| *v += part * a);
            });
        }
        self.lattice.sheets.spread(&mut self.velocity);
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
        let Self { lattice, displacement, strip_forces, internal, .. } = self;
        let body = Elastic { lattice, moduli: self.moduli, kinematics: self.kinematics };
        if let Some(fracture) = &mut self.fracture {
            let sums = fracture.degraded_forces(body, displacement, strip_forces);
            self.elastic_energy = sums.elastic_energy;
            self.ledger.history_work += sums.history_work;
            strip_forces.assemble(self.grid.stride, internal);
        } else {
            self.elastic_energy = elastic_forces(body, displacement, strip_forces, internal);
        }
        lattice.fold(internal);
    }

    /// `a = M⁻¹ (f_ext − f_int)`, or what is prescribed, from the velocity at hand so much of a step before.
    fn accelerate(&mut self, part: f64) {
        self.external_minus_internal();
        self.divide_by_mass(part);
    }

    /// `a = M⁻¹ f`, or what is prescribed, of the forces in the room of the acceleration.
    fn divide_by_mass(&mut self, part: f64) {
        self.reactions.begin(&self.constraints, &self.acceleration);
        self.mass.divide_in_use(&self.in_use, self.grid, &mut self.acceleration);
        let Self { reactions, constraints, edges, mass, velocity, acceleration, .. } = self;
        let step = [self.time, self.time_step];
        reactions.prescribe(constraints, step, part, mass, velocity, acceleration);
        if let Some(edges) = edges {
            edges.enforce(step, part, velocity, acceleration, reactions);
        }
    }

    /// Makes ready for steps of `dt` seconds: the accelerations at t = 0 of what is prescribed.
    pub(crate) fn prepare(&mut self, dt: f64) {
        self.expect_steps(dt);
        self.accelerate(AT_WHOLE_STEP);
    }

    /// Takes the length of the steps to come, s.
    fn expect_steps(&mut self, dt: f64) {
        self.time_step = dt;
        self.loads.iter_mut().for_each(|load| load.factor.prepare(dt));
        self.gravity.factor.prepare(dt);
    }

    /// Kinetic and elastic energy, and energy of the crack, J/m.
    fn stored_energies(&self) -> [f64; 2] {
        let surface = self.fracture.as_ref().map_or(0.0, |fracture| fracture.surface_energy(&self.lattice).0);
        [self.mass.half_square(&self.velocity) + self.elastic_energy, surface]
    }

    /// Forces and state of the points after points came or went, where the crack had so much energy (J/m):
    /// no step was taken, so no work was done.
    fn refresh(&mut self, surface_energy: f64) {
        let (history_work, surface) = (self.ledger.history_work, surface_energy);
        let on_drive = self.fracture.as_ref().and_then(|fracture| fracture.lag_work.as_ref()).map(|work| work.on_drive);
        self.internal_forces();
        self.ledger.history_work = history_work;
        if let Some(fracture) = &mut self.fracture {
            let now = fracture.surface_energy(&self.lattice).0;
            if let (Some(work), Some(on_drive)) = (&mut fracture.lag_work, on_drive) {
                (work.on_drive, work.surface_at_start) = (on_drive, work.surface_at_start + now - surface);
            }
        }
    }

    /// `f_ext − f_int` in the room of the acceleration.
    fn external_minus_internal(&mut self) {
        let mass = &self.mass.row_sums;
        let gravity = self.gravity.at(self.time);
        for (component, (a, f)) in self.acceleration.iter_mut().zip(&self.internal).enumerate() {
            let gravity = fault!("gravity-upwards", gravity[component] => -gravity[component]);
            self.in_use.for_each_part(self.grid, [a], |used, [a]| {
                let forces = f[used.clone()].iter().zip(&mass[used]);
                a.iter_mut().zip(forces).for_each(|(a, (f, m))| *a = gravity * m - f);
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
        for (component, gravity) in self.gravity.mean(self.time, dt).into_iter().enumerate().filter(|(_, g)| *g != 0.0)
        {
            power += gravity * self.mass.row_sums.iter().zip(&velocity[component]).map(|(m, v)| m * v).sum::<f64>();
        }
        if let Some(forced) = &self.forced {
            power += forced.mean_power(velocity);
        }
        let edges = self.edges.as_mut().map_or(0.0, |edges| edges.work(dt));
        let conditions = self.reactions.work(dt) + edges;
        self.ledger.external_work += dt * power + fault!("driven-work-left-out", conditions => 0.0);
    }
}
