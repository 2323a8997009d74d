//! Explicit dynamics in the total frame: velocity Verlet on control points that keep their velocity.
//!
//! Shape functions are evaluated at the reference positions only, so displacement and velocity live on the control
//! points for the whole run, strains follow from the displacement, and nothing is lost in transfers. With beta = 0 the
//! strain at n + 1 does not depend on the acceleration at n + 1: one pass of the staggered scheme is converged.

mod observe;
mod stiffness;

use rayon::prelude::*;

use crate::constraints::Constraints;
use crate::energy::Ledger;
use crate::fracture::{Fracturing, NotConverged};
use crate::kernels::ElasticStress;
use crate::lane::Lane;
use crate::lattice::Lattice;
use crate::loads::NodalLoad;
use crate::material::{ElasticModuli, FractureModel};
use crate::patch::{ControlGrid, Patch};
use crate::phase_field::integrate_shape_functions;
use crate::scene::{Boundary, Scene, Shape, Side};
use crate::stencil::CHUNK_ROWS;
use crate::sweep::{Fields, StripForces, sweep};

pub use stiffness::Stiffness;

/// Masses below this fraction of the largest give no acceleration; their control points keep their velocity.
const NEGLIGIBLE_MASS: f64 = 1e-12;

/// A field of vectors on the control points, by component.
type VectorField = [Vec<f64>; 2];

/// One body in the total frame.
#[derive(Debug, Clone)]
pub struct TotalFrame {
    patch: Patch,
    grid: ControlGrid,
    lattice: Lattice,
    moduli: ElasticModuli,
    shape: Shape,
    thickness: f64,
    gravity: [f64; 2],
    loads: Vec<NodalLoad>,
    constraints: Constraints,
    /// Lumped mass per unit thickness, kg/m, and its inverse (zero where negligible).
    mass: Vec<f64>,
    inverse_mass: Vec<f64>,
    displacement: VectorField,
    velocity: VectorField,
    acceleration: VectorField,
    internal: VectorField,
    strip_forces: StripForces,
    /// The phase field, if the material fractures.
    pub fracture: Option<Fracturing>,
    lowest_tip: f64,
    elastic_energy: f64,
    ledger: Ledger,
    time: f64,
    driven_power: f64,
}

impl TotalFrame {
    /// The body of `scene` at t = 0 with its initial accelerations.
    ///
    /// # Errors
    /// If the initial phase field does not converge.
    pub fn new(scene: &Scene) -> Result<Self, NotConverged> {
        let patch = Patch::new(&scene.mesh);
        let body = &scene.bodies[0];
        let material = &scene.materials[&body.material];
        let lattice = Lattice::new(&patch, body);
        let grid = lattice.grid;
        let mut mass = integrate_shape_functions(&lattice);
        mass.iter_mut().for_each(|m| *m *= material.density);
        let negligible = NEGLIGIBLE_MASS * mass.iter().copied().fold(0.0, f64::max);
        let inverse_mass = mass.iter().map(|&m| if m > negligible { 1.0 / m } else { 0.0 }).collect();
        let fracture = material
            .fracture
            .as_ref()
            .map(|f| Fracturing::new(&lattice, body, FractureModel::new(f), &scene.solver))
            .transpose()?;
        let zeros = || [grid.zeros(), grid.zeros()];
        let mut frame = Self {
            loads: body.tractions.iter().map(|t| NodalLoad::new(&patch, grid, body, t)).collect(),
            constraints: Constraints::new(grid, &scene.boundaries),
            moduli: ElasticModuli::new(material, scene.analysis.plane),
            shape: body.shape.clone(),
            thickness: scene.analysis.thickness,
            gravity: scene.analysis.gravity,
            strip_forces: StripForces::new(&lattice),
            lowest_tip: lowest_tip(scene),
            displacement: zeros(),
            velocity: zeros(),
            acceleration: zeros(),
            internal: zeros(),
            elastic_energy: 0.0,
            ledger: Ledger::default(),
            time: 0.0,
            driven_power: 0.0,
            patch,
            grid,
            lattice,
            mass,
            inverse_mass,
            fracture,
        };
        frame.set_initial_velocity(body.velocity, body.angular_velocity);
        frame.internal_forces();
        frame.ledger.history_work = 0.0; // there was no step yet
        frame.accelerate();
        frame.driven_power = frame.power_of_driven_sides();
        Ok(frame)
    }

    /// One time step of `dt` seconds (E 14–18).
    ///
    /// # Errors
    /// If the phase field does not converge.
    pub fn step(&mut self, dt: f64) -> Result<(), NotConverged> {
        self.predict(dt);
        if let Some(fracture) = &mut self.fracture {
            fracture.update_history(&self.lattice, self.moduli, &self.displacement);
            fracture.solve_phase_field(&self.lattice)?;
        }
        self.internal_forces();
        self.book_external_work(dt);
        self.accelerate();
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
                    *v += 0.5 * dt * a;
                }
            });
        }
    }

    /// Stress at the points and its nodal forces; books the work of the history field.
    fn internal_forces(&mut self) {
        let moduli = self.moduli;
        let displacement = [&self.displacement[0][..], &self.displacement[1][..]];
        if let Some(fracture) = &mut self.fracture {
            let sums = fracture.degraded_forces(&self.lattice, moduli, displacement, &mut self.strip_forces);
            self.elastic_energy = sums.elastic_energy;
            self.ledger.history_work += sums.history_work;
        } else {
            let mut kernels: Vec<_> =
                (0..self.lattice.strips()).map(|_| ElasticStress { moduli, energy: Lane::ZERO }).collect();
            let fields = Fields { displacement, phase: &[] };
            sweep(&self.lattice, fields, &mut kernels, Some(&mut self.strip_forces));
            self.elastic_energy = kernels.iter().map(|k| k.energy.sum()).sum();
        }
        self.strip_forces.assemble(self.grid.stride, &mut self.internal);
    }

    /// `a = M⁻¹ (f_ext − f_int)`, zero where the velocity is prescribed.
    fn accelerate(&mut self) {
        let chunk = CHUNK_ROWS * self.grid.stride;
        for component in 0..2 {
            let gravity = self.gravity[component];
            let a = self.acceleration[component].par_chunks_mut(chunk);
            a.zip(self.internal[component].par_chunks(chunk)).zip(self.inverse_mass.par_chunks(chunk)).for_each(
                |((a, f), inverse)| {
                    for ((a, f), inverse) in a.iter_mut().zip(f).zip(inverse) {
                        *a = if *inverse > 0.0 { gravity - f * inverse } else { 0.0 };
                    }
                },
            );
        }
        for load in &self.loads {
            let factor = load.factor(self.time);
            for &(at, force) in &load.forces {
                for component in 0..2 {
                    self.acceleration[component][at] += factor * force[component] * self.inverse_mass[at];
                }
            }
        }
        self.constraints.remove(&mut self.acceleration);
    }

    /// Work of tractions, gravity and driven sides over the last step: mean force times displacement.
    fn book_external_work(&mut self, dt: f64) {
        let velocity = &self.velocity; // half a step before self.time: between the two ends of the step
        let mut power = 0.0;
        for load in &self.loads {
            let factor = 0.5 * (load.factor(self.time - dt) + load.factor(self.time));
            let forces = load.forces.iter();
            power += factor * forces.map(|&(at, f)| f[0] * velocity[0][at] + f[1] * velocity[1][at]).sum::<f64>();
        }
        for (component, gravity) in self.gravity.into_iter().enumerate().filter(|(_, g)| *g != 0.0) {
            power += gravity * self.mass.iter().zip(&velocity[component]).map(|(m, v)| m * v).sum::<f64>();
        }
        let driven = self.power_of_driven_sides();
        power += 0.5 * (self.driven_power + driven);
        self.driven_power = driven;
        self.ledger.external_work += dt * power;
    }

    /// Reaction times velocity of the driven control points, whose acceleration is zero.
    fn power_of_driven_sides(&self) -> f64 {
        let mut power = 0.0;
        for (at, component, value) in self.constraints.iter().filter(|(_, _, value)| *value != 0.0) {
            let loads = self.loads.iter().flat_map(|load| load.forces.iter().map(|f| (load.factor(self.time), f)));
            let applied: f64 = loads.filter(|(_, f)| f.0 == at).map(|(factor, f)| factor * f.1[component]).sum();
            let weight = self.gravity[component] * self.mass[at];
            power += value * (self.internal[component][at] - applied - weight);
        }
        power
    }

    fn set_initial_velocity(&mut self, velocity: [f64; 2], angular_velocity: f64) {
        let greville = [0, 1].map(|d| self.patch.spaces[d].greville());
        let center = self.center_of_mass(&greville);
        for at in self.grid.indices() {
            let (x, y) = (greville[0][self.grid.column_of(at)], greville[1][self.grid.row_of(at)]);
            self.velocity[0][at] = velocity[0] - angular_velocity * (y - center[1]);
            self.velocity[1][at] = velocity[1] + angular_velocity * (x - center[0]);
        }
        self.constraints.apply_velocity(&mut self.velocity);
    }

    fn center_of_mass(&self, greville: &[Vec<f64>; 2]) -> [f64; 2] {
        let mut sums = [0.0; 3];
        for at in self.grid.indices() {
            let m = self.mass[at];
            sums[0] += m;
            sums[1] += m * greville[0][self.grid.column_of(at)];
            sums[2] += m * greville[1][self.grid.row_of(at)];
        }
        [sums[1] / sums[0], sums[2] / sums[0]]
    }

    /// Stress `[xx, yy, xy]` (Pa) of the undamaged body under a displacement field at a position; NaN outside the patch.
    pub fn elastic_stress_at(&self, displacement: &[Vec<f64>; 2], position: [f64; 2]) -> [f64; 3] {
        let [x, y] = [0, 1].map(|c| self.patch.evaluate(&displacement[c], position));
        let (Some(x), Some(y)) = (x, y) else { return [f64::NAN; 3] };
        let strain = [x.gradient[0], y.gradient[1], 0.5 * (x.gradient[1] + y.gradient[0])];
        self.moduli.stress(strain.map(Lane::splat)).map(|s| s[0])
    }

    /// Elastic energy, J.
    pub fn elastic_energy(&self) -> f64 {
        self.elastic_energy * self.thickness
    }

    /// External work so far, J.
    pub fn external_work(&self) -> f64 {
        self.ledger.external_work * self.thickness
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Material points.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Region of the body.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Background patch.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// Moduli.
    pub fn moduli(&self) -> ElasticModuli {
        self.moduli
    }

    /// Control values of the displacement, m.
    pub fn displacement(&self) -> &VectorField {
        &self.displacement
    }

    /// Control values of the velocity, m/s.
    pub fn velocity(&self) -> &VectorField {
        &self.velocity
    }

    /// Lumped masses per unit thickness, kg/m.
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// Heap memory of mechanics and of the phase field, bytes.
    pub fn bytes(&self) -> [usize; 2] {
        let mechanics = 8 * 10 * self.grid.len() + self.strip_forces.bytes();
        [mechanics, self.fracture.as_ref().map_or(0, Fracturing::bytes)]
    }
}

/// Height from which the crack tip is looked for: the middle of the body, or its foot if the body is the upper half of a
/// symmetric one: it stands on the bottom side, a roller holds that side, and a crack lies along it.
pub(crate) fn lowest_tip(scene: &Scene) -> f64 {
    let body = &scene.bodies[0];
    let (low, high) = body.shape.bounding_box();
    let at_foot = |y: f64| (y - low[1]).abs() <= 1e-9 * (high[1] - low[1]);
    let roller = |b: &Boundary| b.side == Side::Bottom && b.fix == [false, true] && b.velocity[1] == 0.0;
    let half = at_foot(scene.mesh.origin()[1])
        && scene.boundaries.iter().any(roller)
        && body.cracks.iter().any(|crack| at_foot(crack.from[1]) && at_foot(crack.to[1]));
    if half { low[1] } else { 0.5 * (low[1] + high[1]) }
}
