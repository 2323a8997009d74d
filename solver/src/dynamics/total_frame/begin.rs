//! How a body in the total frame begins: from a scene, from given fields under loads that vary in space, or
//! from a stored state.

use std::sync::Arc;

use super::TotalFrame;
use super::domain::{Domain, ProbePlace};
use super::edge_conditions::EdgeConditions;
use super::forced::LatticeForcing;
use super::prescribed::{Reactions, held_points};
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::constraints::Constraints;
use crate::dynamics::energy::Ledger;
use crate::dynamics::failure::Failure;
use crate::dynamics::forcing::Forcing;
use crate::dynamics::loads::{Gravity, NodalLoad};
use crate::dynamics::mass::MassMatrix;
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::VectorField;
use crate::material::degradation::FractureModel;
use crate::material::elasticity::ElasticModuli;
use crate::particles::lattice::{Lattice, STRIP_ROWS};
use crate::phase_field::fracture::{LatticeFracture, crack_start};
use crate::scene::{Body, Scene};
use crate::splines::patch::Patch;
use crate::transfer::finite::Elastic;
use crate::transfer::sweep::StripForces;

impl TotalFrame {
    /// The body of `scene` at t = 0 with its initial accelerations.
    ///
    /// # Errors
    /// If the body holds no material point, a part of a traction would be lost, the initial phase field does
    /// not converge, or a consistent mass matrix is singular to round-off.
    pub fn new(scene: &Scene) -> Result<Self, Failure> {
        Self::in_strips(scene, STRIP_ROWS)
    }

    /// As [`Self::new`], with so many rows of spans in a strip of the lattice.
    ///
    /// # Errors
    /// As there.
    pub(super) fn in_strips(scene: &Scene, strip_rows: usize) -> Result<Self, Failure> {
        let patch = Patch::new(&scene.mesh);
        let body = &scene.bodies[0];
        let material = &scene.materials[&body.material];
        let lattice = Lattice::in_strips(&patch, body, strip_rows);
        if lattice.count() == 0 {
            return Err(Failure::NoPoints(0));
        }
        let grid = lattice.grid;
        let constraints = Constraints::new(&scene.boundaries, |boundary| {
            let is_reached = scene.mesh.geometry.is_some() || scene.mesh.is_reached(boundary.side, &body.shape);
            if is_reached { held_points(&patch, &lattice, body, boundary) } else { Vec::new() }
        });
        if let Some(conditions) = constraints.contradiction {
            return Err(Failure::Contradiction(conditions));
        }
        let held = [0, 1].map(|component| constraints.held(component));
        let fracture = FractureModel::of(material)
            .map(|model| LatticeFracture::new(&patch, &lattice, body, model, material.fracture.as_ref(), &scene.solver))
            .transpose()?;
        let mass = MassMatrix::new(&lattice, material.density, scene.analysis.mass, held)?;
        if let Some(number) = constraints.conditions.iter().enumerate().position(|(number, condition)| {
            let moves = |(at, _, of): (usize, usize, usize)| of == number && mass.moves(at);
            condition.part.is_some() && !constraints.iter().any(moves)
        }) {
            return Err(Failure::HoldsNothing(number));
        }
        let load = |(number, traction)| {
            let moves = |at| mass.moves(at);
            let load = NodalLoad::new((&patch, &lattice), body, traction, scene.analysis.kinematics, moves);
            load.map_err(|lost| Failure::LostTraction { body: 0, traction: number, lost })
        };
        let zeros = || [grid.zeros(), grid.zeros()];
        let edges = EdgeConditions::new(&patch, &lattice, body, &mass, &constraints)?;
        let probe = |probe| ProbePlace::new(&patch, &lattice, probe, |at| mass.moves(at));
        let probes = scene.output.probes.iter().filter_map(probe).collect();
        let mut frame = Self {
            loads: body.tractions.iter().enumerate().map(load).collect::<Result<_, _>>()?,
            forced: None,
            edges,
            boundary: None,
            mass,
            moduli: ElasticModuli::new(material, scene.analysis.plane),
            kinematics: scene.analysis.kinematics,
            shape: body.shape.clone(),
            thickness: scene.analysis.thickness,
            gravity: Gravity::new(&scene.analysis),
            strip_forces: StripForces::new(&lattice),
            probes,
            domains: Domain::all(&patch, body, &scene.output.j_integrals),
            density: material.density,
            crack_start: crack_start(body),
            counts_fragments: scene.output.fragments,
            in_use: ActiveColumns::all(grid),
            displacement: zeros(),
            velocity: zeros(),
            acceleration: zeros(),
            internal: zeros(),
            elastic_energy: 0.0,
            ledger: Ledger::default(),
            time: 0.0,
            time_step: 0.0,
            reactions: Reactions::new(&constraints),
            constraints,
            judged_stiffening: 1.0,
            patch,
            grid,
            lattice,
            fracture,
        };
        frame.set_initial_velocity(body);
        if scene.equilibrium {
            frame.find_equilibrium()?;
            frame.release_phase_field()?;
        }
        frame.begin();
        Ok(frame)
    }

    /// Begins anew at t = 0 from given control values of displacement (m) and velocity (m/s), under loads
    /// that vary in space.
    ///
    /// # Errors
    /// If the initial phase field does not converge.
    pub fn start_from(
        &mut self,
        displacement: VectorField,
        velocity: VectorField,
        forcing: Arc<dyn Forcing>,
    ) -> Result<(), SolveFailure> {
        let mut forced = LatticeForcing::new(forcing, &self.patch, &self.lattice, &self.shape);
        forced.update_forces(&self.lattice, 0.0);
        if let Some(fracture) = &mut self.fracture {
            fracture.field.set_load(forced.phase_load(&self.lattice, 0.0));
        }
        self.forced = Some(Box::new(forced));
        self.start_with(displacement, velocity)
    }

    /// Begins anew at t = 0 from given control values of displacement (m) and velocity (m/s), under the loads
    /// it has.
    ///
    /// # Errors
    /// If the initial phase field does not converge.
    pub fn start_with(&mut self, displacement: VectorField, velocity: VectorField) -> Result<(), SolveFailure> {
        (self.displacement, self.velocity) = (displacement, velocity);
        self.start_conditions();
        self.ledger = Ledger::default();
        self.time = 0.0;
        self.release_phase_field()?;
        self.begin();
        Ok(())
    }

    /// The phase field that belongs to the present displacement.
    fn release_phase_field(&mut self) -> Result<(), SolveFailure> {
        if let Some(fracture) = &mut self.fracture {
            fracture.field.wake_everything();
            let Self { lattice, moduli, kinematics, displacement, strip_forces, .. } = self;
            let body = Elastic { lattice, moduli: *moduli, kinematics: *kinematics };
            fracture.update_history(body, self.time, displacement, strip_forces);
            fracture.field.initialise(&self.lattice, &fracture.history)?;
        }
        Ok(())
    }

    /// Motion about the centre of mass: linear in the position, so its control values are exact.
    fn set_initial_velocity(&mut self, body: &Body) {
        let [x, y] = self.control_positions();
        let mass = &self.mass.row_sums;
        let total: f64 = mass.iter().sum();
        let center = [&x, &y].map(|x| mass.iter().zip(x).map(|(m, x)| m * x).sum::<f64>() / total);
        for at in self.grid.indices() {
            let relative = body.relative_velocity([x[at] - center[0], y[at] - center[1]]);
            for d in 0..2 {
                self.velocity[d][at] = body.velocity[d] + relative[d];
            }
        }
        self.start_conditions();
    }

    /// Sets what conditions prescribe at t = 0.
    fn start_conditions(&mut self) {
        self.constraints.start(&mut self.displacement, &mut self.velocity);
        let Some(edges) = &self.edges else { return };
        edges.start(&mut self.displacement, &mut self.velocity);
        self.lattice.sheets.spread(&mut self.displacement);
        self.lattice.sheets.spread(&mut self.velocity);
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene, and loads that only the program knows.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { loads, forced, edges, displacement, velocity, acceleration, internal, fracture, .. } = self;
        if forced.is_some() {
            return Err(StateError("loads that only the program knows cannot be stored".to_string()));
        }
        let stored = fault!("checkpoint-without-accelerations", 4 => 3);
        for field in [&mut *displacement, velocity, internal, acceleration].into_iter().take(stored) {
            field.iter_mut().try_for_each(|component| archive.list(component))?;
        }
        loads.iter_mut().for_each(|load| load.follow(displacement));
        if let Some(LatticeFracture { history, phase, excess, lag_work, field, iterations, .. }) = fracture {
            [history, phase, excess].into_iter().try_for_each(|values| archive.list(values))?;
            field.exchange(archive)?;
            lag_work.as_mut().map_or(Ok(()), |work| work.exchange(archive))?;
            archive.value(iterations)?;
        }
        let values = [&mut self.elastic_energy, &mut self.time, &mut self.judged_stiffening];
        values.into_iter().try_for_each(|value| archive.value(value))?;
        archive.value(&mut self.crack_start)?;
        self.reactions.exchange(archive)?;
        edges.as_mut().map_or(Ok(()), |edges| edges.exchange(archive))?;
        archive.value(&mut self.ledger)
    }
}
