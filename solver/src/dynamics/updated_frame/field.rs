//! One body of the updated frame: its points and its own nodal fields, a discrete field on the shared patch.
//!
//! The nodal fields cover the part of the patch the body is in and a few spans around it; the part follows
//! the body ([`fragments`](super::fragments)). Bodies know nothing of each other: see [`crate::contact`].

use std::sync::Arc;

use rayon::prelude::*;

use super::affine::AffineVelocities;
use super::grid::{EndOfStep, NodalFields};
use super::held_edges::HeldEdges;
use super::held_sides::HeldSide;
use super::loads::{PointForcing, SurfaceLoad};
use super::losses::TransferLosses;
use super::pointwise_fracture::PointwiseFracture;
use super::strain::{FiniteStrain, SmallStrain, StrainUpdate};
use super::transfer::{GridToPoints, PointsToGrid, StripMotion};
use super::velocity_transfer::{Smoothing, VelocityTransfer};
use super::windows::{cut, scatter};
use crate::contact::{BodyView, Surface};
use crate::dynamics::energy::Ledger;
use crate::dynamics::failure::Failure;
use crate::dynamics::loads::Gravity;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::dispatch;
use crate::material::elasticity::ElasticModuli;
use crate::material::hencky::Gradient;
use crate::particles::points::{Cells, OutsidePatch, Point};
use crate::splines::patch::Patch;

/// One body in the updated frame.
#[derive(Debug, Clone)]
pub struct DiscreteField {
    pub(super) whole: Arc<Patch>,
    /// The part of the patch the nodal fields cover, and its first control column and row.
    pub patch: Patch,
    pub(super) origin: [usize; 2],
    /// Sides that hold it at rest.
    pub(super) sides: Vec<HeldSide>,
    /// Conditions on edges that move with it.
    pub(super) edges: Option<Box<HeldEdges>>,
    /// Elastic moduli of its material, Pa.
    pub moduli: ElasticModuli,
    /// Logarithmic change of volume over that of area: less than 1 in plane stress, where the thickness
    /// follows.
    pub(super) thickening: f64,
    pub(super) density: f64,
    /// Stiffness κ of its boundary, Pa/m, if that is not rigid.
    pub(super) boundary_stiffness: Option<f64>,
    pub(super) thickness: f64,
    pub(super) gravity: Gravity,
    /// Material points, sorted by span.
    pub points: Vec<Point>,
    /// Order of the points.
    pub cells: Cells,
    /// Nodal fields at the present whole step.
    pub nodes: NodalFields,
    pub(super) velocity_transfer: VelocityTransfer,
    /// Velocity gradients of the points, for the transfers that need them.
    pub(super) affine: Option<AffineVelocities>,
    /// Displacement gradients `F − I` of the points, if the kinematics are finite.
    pub(super) deformation: Option<Vec<Gradient>>,
    pub(super) loads: Vec<SurfaceLoad>,
    pub(super) forcing: Option<PointForcing>,
    /// The boundary, if the body may meet others.
    pub surface: Option<Surface>,
    /// The phase field, if the material fractures.
    pub fracture: Option<PointwiseFracture>,
    pub(super) crack_start: Option<[f64; 2]>,
    pub(super) elastic_energy: f64,
    /// `Σ V sigma(n+1) : de` of the last step.
    pub(super) stress_work: f64,
    pub(super) ledger: Ledger,
    pub(super) losses: TransferLosses,
    pub(super) time: f64,
    /// No step was taken yet: the points carry v(0).
    pub(super) at_start: bool,
    /// Length of the last step, s.
    pub(super) last_step: f64,
    /// Bound of the distance any point moved since the critical step was taken, m.
    pub(super) travelled: f64,
}

impl DiscreteField {
    /// One time step of `dt` seconds (E 14–24).
    ///
    /// # Errors
    /// If the phase field does not converge, or a point leaves the patch.
    pub fn step(&mut self, dt: f64) -> Result<(), Failure> {
        let end_of_step = self.advance(dt)?;
        self.respond_and_book(dt, &end_of_step); // a(n+1)
        Ok(())
    }

    /// The step up to the forces at its end; what the grid held before them.
    ///
    /// # Errors
    /// If the phase field does not converge, or a point leaves the patch.
    pub(super) fn advance(&mut self, dt: f64) -> Result<EndOfStep, Failure> {
        self.kick(dt); // grid: v(n+1/2) = v(n−1/2) + dt a(n)
        self.choose_velocities(); // transfer: the increment for the points
        let end_of_step = self.end_of_step();
        let left_span = self.grid_to_points(dt)?; // G2P: velocities, positions, strains
        if fault!("span-not-renewed", left_span => false) {
            self.sort()?;
        }
        self.crack_and_stress()?; // points: psi+, H, phase field, stress at n + 1
        self.points_to_grid(); // P2G: mass, velocity, internal forces at x(n+1)
        self.attach_loads()?;
        self.add_external_forces();
        Ok(end_of_step)
    }

    /// Accelerations of the forces, and what the step adds to the ledger.
    pub(super) fn respond_and_book(&mut self, dt: f64, end_of_step: &EndOfStep) {
        if let Some(edges) = &mut self.edges {
            edges.go_on([self.time, dt]);
        }
        let imposed = self.apply_boundary();
        self.accelerate();
        self.book(dt, end_of_step, imposed);
    }

    /// Length of the coming kick of a step of `dt` seconds, s: from the middle of the last step to that of
    /// the coming one, or half a step at the start, where the points carry v(0).
    pub(crate) fn kick_length(&self, dt: f64) -> f64 {
        if self.at_start { 0.5 * dt } else { 0.5 * (self.last_step + dt) }
    }

    fn kick(&mut self, dt: f64) {
        self.nodes.kick(self.kick_length(dt));
        self.book_change_of_step(dt, |field| field.nodes.kinetic_energy(&field.nodes.acceleration));
        self.at_start = false;
        self.last_step = dt;
        self.time += dt;
    }

    /// Tells the boundary how far it moves in a step of `dt` seconds with the present velocity.
    pub(super) fn expect_motion(&mut self, dt: f64) {
        if let Some(mut surface) = self.surface.take() {
            surface.expect(&self.view(), &self.nodes.velocity, dt);
            self.surface = Some(surface);
        }
    }

    /// What contact sees of it.
    pub fn view(&self) -> BodyView<'_> {
        let Self { patch, cells, surface, nodes, density, boundary_stiffness, .. } = self;
        let NodalFields { grid, inverse_mass, velocity, acceleration, .. } = nodes;
        BodyView {
            patch,
            cells,
            surface: surface.as_ref(),
            grid: *grid,
            inverse_mass,
            density: *density,
            stiffness: *boundary_stiffness,
            fixed: &nodes.fixed,
            velocity,
            acceleration,
        }
    }

    /// Adds an acceleration to a control point for the coming kick, m/s².
    pub fn add_acceleration(&mut self, at: usize, acceleration: [f64; 2]) {
        for (field, a) in self.nodes.acceleration.iter_mut().zip(acceleration) {
            field[at] += a;
        }
    }

    fn choose_velocities(&mut self) {
        let Self { patch, cells, points, nodes, velocity_transfer, density, .. } = self;
        velocity_transfer.update(nodes, &Smoothing { patch, cells, points, density: *density, mass: &nodes.mass });
    }

    /// `v_p ← k v_p + Σ N Δv` (k the kept fraction, Δv the increment), `x_p += dt Σ N v`, and the strain of
    /// this motion; whether a point left its span.
    pub(super) fn grid_to_points(&mut self, dt: f64) -> Result<bool, OutsidePatch> {
        let Self { patch, cells, points, nodes, forcing, .. } = self;
        if let Some(forcing) = forcing {
            forcing.before_motion(patch, cells, points, &nodes.velocity);
        }
        let motions = match self.deformation.take() {
            None => self.move_points(dt, self.cells.strips.iter().map(|_| SmallStrain).collect()),
            Some(mut deformation) => {
                let ranges = self.cells.strips.iter().map(|s| s.points.clone());
                let strips = cut(&mut deformation, ranges).into_iter();
                let motions = self.move_points(dt, strips.map(|deformation| FiniteStrain { deformation }).collect());
                self.deformation = Some(deformation);
                motions
            }
        };
        if let Some(mut surface) = self.surface.take() {
            surface.follow(&self.view(), &self.nodes.velocity, dt);
            self.surface = Some(surface);
        }
        let Self { patch, nodes, points, forcing, loads, edges, sides, density, .. } = self;
        for load in loads {
            load.move_points(patch, nodes.grid, &nodes.velocity, dt);
        }
        if let Some(edges) = edges {
            edges.move_points(patch, nodes, dt);
        }
        let slid =
            sides.iter_mut().map(|side| side.follow(patch, nodes, *density, dt)).collect::<Result<Vec<_>, _>>()?;
        if let Some(forcing) = forcing {
            forcing.after_motion(points, self.time, dt);
        }
        let fastest = motions.iter().map(|m| m.fastest).fold(0.0, larger);
        self.travelled += dt * fastest.sqrt();
        self.elastic_energy = motions.iter().map(|m| m.elastic_energy).sum();
        self.stress_work = motions.iter().map(|m| m.stress_work).sum();
        if slid.contains(&true) {
            self.hold_sides();
        }
        Ok(motions.iter().any(|m| m.left_span))
    }

    /// Velocity, position and strain of the points; `kinematics` for each strip.
    fn move_points<K: StrainUpdate + Send>(&mut self, dt: f64, kinematics: Vec<K>) -> Vec<StripMotion> {
        let Self { patch, cells, nodes, points, velocity_transfer, affine, fracture, .. } = self;
        let elastic = fracture.is_none().then_some(self.moduli);
        let ranges = || cells.strips.iter().map(|s| s.points.clone());
        let cracked = match fracture {
            Some(fracture) => cut(&mut fracture.points, ranges()),
            None => cells.strips.iter().map(|_| &mut [][..]).collect(),
        };
        let affine: Vec<_> = match affine {
            Some(affine) => affine.pieces(ranges()).map(Some).collect(),
            None => cells.strips.iter().map(|_| None).collect(),
        };
        let (kept_fraction, grid) = (velocity_transfer.kept_fraction, nodes.grid);
        let fields = velocity_transfer.fields(&nodes.velocity);
        let strips = cut(points, ranges()).into_par_iter().zip(cracked).zip(affine).zip(kinematics).zip(&cells.strips);
        strips
            .map(|((((points, fracture), affine), kinematics), strip)| {
                let cells = &cells.cells[strip.cells.clone()];
                dispatch(GridToPoints {
                    patch,
                    grid,
                    dt,
                    fields,
                    kept_fraction,
                    affine,
                    kinematics,
                    elastic,
                    cells,
                    points,
                    fracture,
                })
            })
            .collect()
    }

    pub(super) fn sort(&mut self) -> Result<(), OutsidePatch> {
        if self.reaches_beyond() || self.cells.sort(&self.patch, &mut self.points).is_err() {
            self.follow()?;
        }
        let cells = &self.cells;
        if let Some(fracture) = &mut self.fracture {
            fault!("history-left-behind", cells.reorder(&mut fracture.points) => ());
        }
        if let Some(affine) = &mut self.affine {
            fault!("affine-left-behind", cells.reorder(&mut affine.gradients) => ());
        }
        if let Some(deformation) = &mut self.deformation {
            fault!("deformation-left-behind", cells.reorder(deformation) => ());
        }
        if let Some(forcing) = &mut self.forcing {
            forcing.reorder(cells);
        }
        Ok(())
    }

    /// Finds spans for the surface points of loads and conditions, by the masses of the grid.
    ///
    /// # Errors
    /// If one has lost its material, or conditions are not independent.
    pub(super) fn attach_loads(&mut self) -> Result<(), Failure> {
        let Self { patch, nodes, loads, edges, density, .. } = self;
        loads.iter_mut().try_for_each(|load| load.attach(patch, nodes, *density))?;
        edges.iter_mut().try_for_each(|edges| edges.attach(patch, nodes, *density))
    }

    /// History, phase field and degraded stress; an elastic body has its stress from G2P.
    pub(super) fn crack_and_stress(&mut self) -> Result<(), SolveFailure> {
        let Self { patch, cells, points, moduli, .. } = self;
        let Some(fracture) = &mut self.fracture else { return Ok(()) };
        fracture.update_history(moduli, cells, points);
        fracture.solve(patch, cells, points)?;
        let sums = fracture.update_stress(patch, moduli, cells, points);
        self.elastic_energy = sums.elastic_energy;
        self.stress_work = sums.stress_work;
        self.ledger.history_work += sums.history_work;
        self.losses.phase_field -= fault!("phase-motion-unbooked", sums.gained_in_motion => 0.0);
        Ok(())
    }

    /// Mass, arriving velocity, and internal forces.
    pub(super) fn points_to_grid(&mut self) {
        let Self { patch, cells, points, nodes, density, .. } = self;
        let (grid, density) = (nodes.grid, *density);
        nodes.sums.fill([0.0; 5]);
        let affine = self.affine.as_ref().map(|affine| (affine.view(), &affine.gradients[..]));
        scatter(&cells.strips, [&mut nodes.sums[..]], [grid.stride], |strip, window| {
            let cells = &cells.cells[strip.cells.clone()];
            dispatch(PointsToGrid { patch, grid, density, cells, points, affine, window });
        });
        nodes.divide_by_mass();
    }

    /// Gravity, tractions and other loads.
    pub(super) fn add_external_forces(&mut self) {
        let Self { patch, cells, points, nodes, .. } = self;
        let grid = nodes.grid;
        nodes.add_gravity(self.gravity.at(self.time));
        for load in &self.loads {
            load.add_forces(patch, grid, self.time, &mut nodes.force);
        }
        if let Some(forcing) = &self.forcing {
            forcing.add_forces(patch, cells, points, &mut nodes.force);
        }
    }

    /// Rebuilds the grid where no step leads to it.
    ///
    /// # Errors
    /// A load or a condition that has lost its material.
    pub(super) fn rebuild_grid(&mut self) -> Result<(), Failure> {
        self.points_to_grid();
        self.attach_loads()?;
        self.respond();
        Ok(())
    }

    /// Accelerations on a grid that has its masses and internal forces, where no step leads to them.
    pub(super) fn respond(&mut self) {
        self.add_external_forces();
        self.apply_boundary();
        self.accelerate();
    }

    /// Velocity gradients of a velocity field (m/s), where the transfer carries them.
    pub(super) fn take_affine_velocities(&mut self, velocity: impl Fn([f64; 2]) -> [f64; 2]) {
        let Self { patch, cells, points, affine, nodes, .. } = self;
        if let Some(affine) = affine {
            affine.take(patch, cells, points, &nodes.at_greville_points(velocity));
        }
    }

    /// Whether a point may have moved a quarter of the shortest span since the critical step was taken.
    pub(crate) fn has_moved(&self) -> bool {
        self.travelled >= 0.25 * self.patch.shortest_span()
    }
}
