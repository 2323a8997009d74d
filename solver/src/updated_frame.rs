//! Explicit dynamics in the updated frame: points carry everything, the grid is rebuilt at every step (FLIP, lumped mass).
//!
//! Between two whole steps n and n + 1 the shape functions are those at the positions x(n). The scheme is velocity Verlet
//! written as one full kick on the rebuilt grid; no acceleration outlives its grid. Strains are small: the strain of a
//! point is the sum of `dt sym(grad v(n + 1/2))`.
//!
//! # The energy ledger
//!
//! Let `v` be the velocity that leaves grid n (after the kick), `w` the one that arrives on grid n + 1 (P2G), `w*` that
//! velocity with the prescribed components imposed, and f = f_ext − f_int. Then, for a linear elastic body, term by term,
//!
//! ```text
//! Δ(kinetic − stagger) = 1/2 w*ᵀ M(n+1) w* − 1/2 vᵀ M(n) v + dt/2 [ (f + r)(n) · v + (f + r)(n+1) · w* ]
//! Δ elastic            = dt/2 Σ V [ sigma(n) + sigma(n+1) ] : d,          d = sym grad v at the points, on grid n
//! ```
//!
//! with the reactions r. The forces of n + 1 work on the points' motion `v` but on the grid's `w*`; the lumped projection
//! has filtered the difference away. So the transfer loss has three parts, each measured where it happens:
//!
//! - `kinetic`: `1/2 vᵀ M(n) v − 1/2 wᵀ M(n+1) w`, the fall between leaving and arriving;
//! - `power`: `dt/2 [ P(n+1) − f(n+1) · w* ]`, where `P(n+1) = t(n+1) · v_s + Σ m g · v_p − Σ V sigma(n+1) : d` is the power
//!   of the new forces on the motion the points just made, and likewise `dt/2 f(n) · v` of control points whose mass is
//!   negligible, which feel forces and do not follow them;
//! - `imposed`: `1/2 Σ m (v_prescribed − w)²` where a prescribed velocity is imposed on what arrived. The rest of that
//!   jump, `Σ m (v_prescribed − w) v_prescribed`, is work of the driven side.
//!
//! External work is force times motion of the points it acts on: `dt/2 [t(n) + t(n+1)] · v_s` of surface points,
//! `dt g · Σ m v` of gravity, and the mean reaction of driven sides. What closure remains is round-off in an elastic body.
//! With a phase field there remain the stress-work quadrature, as in the total frame, and what the energy of the phase
//! field changes by as its points pass through the spans: it swings with the period of a span and does not add up. It is
//! not booked, since the only measure of it, the residual of the phase-field equation, would hide errors of that equation.
//!
//! # The critical step
//!
//! It is shorter than the `2/ω_max` of a grid that keeps its velocity. For points at rest a mode of the grid obeys
//! `u ← u + dt (v − dt ω² u)`, `v ← v − dt s ω² u`, where 0 ≤ s ≤ 1 is what the way to the points and back
//! (`M⁻¹` times the consistent mass) leaves of an increment. The mode is stable up to `ω dt = 2/√(2 − s)`: 1.46 for the
//! shortest waves of quadratic splines, and √2 for what the points do not see. [`UpdatedFrame::critical_step`] is √2/ω_max.

pub mod assembly;
pub mod cracking;
pub mod grid;
pub mod observe;
pub mod points;
pub mod stiffness;
pub mod tractions;
pub mod transfer;
pub mod windows;

use rayon::prelude::*;

use crate::constraints::Constraints;
use crate::critical_step::highest_frequency;
use crate::energy::Ledger;
use crate::fracture::NotConverged;
use crate::lane::dispatch;
use crate::lattice::Lattice;
use crate::material::{ElasticModuli, FractureModel};
use crate::patch::Patch;
use crate::scene::Scene;
use crate::total_frame::lowest_tip;
use cracking::Cracking;
use grid::{ImposedEnergy, NodalFields};
use points::{Cells, OutsidePatch, Point};
use stiffness::Stiffness;
use tractions::SurfaceLoad;
use transfer::{GridToPoints, PointsToGrid, StripMotion};
use windows::{cut, scatter};

/// Why a step could not be taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Failure {
    /// The phase-field solve stopped short of its tolerance.
    NotConverged(NotConverged),
    /// A point left the patch, m.
    Left([f64; 2]),
}

/// Parts of the transfer loss so far, J per metre of thickness.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TransferLosses {
    /// Fall of the kinetic energy between leaving one grid and arriving on the next.
    pub kinetic: f64,
    /// Work of the forces on the part of the motion that was filtered away.
    pub power: f64,
    /// Loss where prescribed velocities are imposed on what arrived.
    pub imposed: f64,
}

/// One body in the updated frame.
#[derive(Debug, Clone)]
pub struct UpdatedFrame {
    patch: Patch,
    moduli: ElasticModuli,
    density: f64,
    thickness: f64,
    gravity: [f64; 2],
    points: Vec<Point>,
    cells: Cells,
    nodes: NodalFields,
    loads: Vec<SurfaceLoad>,
    /// The phase field, if the material fractures.
    pub fracture: Option<Cracking>,
    lowest_tip: f64,
    elastic_energy: f64,
    /// `Σ V sigma(n+1) : de` of the last step.
    stress_work: f64,
    driven_power: f64,
    ledger: Ledger,
    losses: TransferLosses,
    time: f64,
    /// Before the first step the points carry v(0) and the kick is half a step.
    at_start: bool,
    /// Bound of the distance any point moved since the critical step was taken, m.
    travelled: f64,
}

/// What the grid holds when the points leave it, per unit thickness.
struct Leaving {
    kinetic: f64,
    momentum: [f64; 2],
    /// Power of forces on control points of negligible mass.
    idle_power: f64,
}

impl UpdatedFrame {
    /// The body of `scene` at t = 0 with its initial accelerations.
    ///
    /// # Errors
    /// If the initial phase field does not converge, or a point is not on the patch.
    pub fn new(scene: &Scene) -> Result<Self, Failure> {
        let patch = Patch::new(&scene.mesh);
        let body = &scene.bodies[0];
        let material = &scene.materials[&body.material];
        let mut points = Point::of_lattice(&Lattice::new(&patch, body));
        set_velocities(&mut points, body.velocity, body.angular_velocity);
        let mut cells = Cells::default();
        cells.sort(&patch, &mut points, None)?;
        let crack = |f| Cracking::new(&patch, body, FractureModel::new(f), &scene.solver, &points);
        let constraints = Constraints::new(patch.control_grid(), &scene.boundaries);
        let mut frame = Self {
            fracture: material.fracture.as_ref().map(crack),
            nodes: NodalFields::new(&patch, constraints),
            loads: body.tractions.iter().map(|t| SurfaceLoad::new(&patch, body, t)).collect(),
            moduli: ElasticModuli::new(material, scene.analysis.plane),
            density: material.density,
            thickness: scene.analysis.thickness,
            gravity: scene.analysis.gravity,
            lowest_tip: lowest_tip(scene),
            elastic_energy: 0.0,
            stress_work: 0.0,
            driven_power: 0.0,
            ledger: Ledger::default(),
            losses: TransferLosses::default(),
            time: 0.0,
            at_start: true,
            travelled: 0.0,
            patch,
            points,
            cells,
        };
        frame.attach_loads()?;
        frame.crack_and_stress(true)?;
        frame.ledger.history_work = 0.0; // there was no step yet
        frame.points_to_grid();
        frame.apply_boundary();
        frame.accelerate();
        frame.driven_power = frame.nodes.power_of_driven_sides();
        Ok(frame)
    }

    /// One time step of `dt` seconds (E 14–24).
    ///
    /// # Errors
    /// If the phase field does not converge, or a point leaves the patch.
    pub fn step(&mut self, dt: f64) -> Result<(), Failure> {
        let leaving = self.kick(dt); // grid: v(n+1/2) = v(n−1/2) + dt a(n)
        let left_span = self.grid_to_points(dt); // G2P: velocities, positions, strains
        if left_span {
            self.sort()?;
        }
        self.attach_loads()?;
        self.crack_and_stress(left_span)?; // points: psi+, H, phase field, stress at n + 1
        self.points_to_grid(); // P2G: mass, velocity, forces at x(n+1)
        let imposed = self.apply_boundary();
        self.accelerate(); // a(n+1)
        self.book(dt, &leaving, imposed);
        Ok(())
    }

    fn kick(&mut self, dt: f64) -> Leaving {
        self.nodes.kick(if self.at_start { 0.5 * dt } else { dt });
        self.at_start = false;
        self.time += dt;
        let [_, idle_power] = self.nodes.power();
        Leaving {
            kinetic: self.nodes.kinetic_energy(&self.nodes.velocity),
            momentum: self.nodes.momentum(),
            idle_power,
        }
    }

    /// FLIP: `v_p += Σ N (v(n+1/2) − v arrived)`, `x_p += dt Σ N v(n+1/2)`; whether a point left its span.
    fn grid_to_points(&mut self, dt: f64) -> bool {
        let Self { patch, cells, nodes, points, fracture, .. } = self;
        let elastic = fracture.is_none().then_some(self.moduli);
        let ranges = || cells.strips.iter().map(|s| s.points.clone());
        let cracked = match fracture {
            Some(fracture) => cut(&mut fracture.points, ranges()),
            None => cells.strips.iter().map(|_| &mut [][..]).collect(),
        };
        let velocity = nodes.velocity.each_ref().map(|f| &f[..]);
        let arrived = nodes.arrived.each_ref().map(|f| &f[..]);
        let strips = cut(points, ranges()).into_par_iter().zip(cracked).zip(&cells.strips);
        let motions: Vec<StripMotion> = strips
            .map(|((points, fracture), strip)| {
                let cells = &cells.cells[strip.cells.clone()];
                dispatch(GridToPoints {
                    patch,
                    grid: nodes.grid,
                    dt,
                    velocity,
                    arrived,
                    elastic,
                    cells,
                    points,
                    fracture,
                })
            })
            .collect();
        for load in &mut self.loads {
            load.move_points(patch, nodes.grid, &nodes.velocity, dt);
        }
        let fastest = motions.iter().map(|m| m.fastest).fold(0.0, f64::max);
        self.travelled += dt * (2.0 * fastest).sqrt();
        self.elastic_energy = motions.iter().map(|m| m.elastic_energy).sum();
        self.stress_work = motions.iter().map(|m| m.stress_work).sum();
        motions.iter().any(|m| m.left_span)
    }

    fn sort(&mut self) -> Result<(), OutsidePatch> {
        let fracture = self.fracture.as_mut().map(|f| &mut f.points);
        self.cells.sort(&self.patch, &mut self.points, fracture)
    }

    fn attach_loads(&mut self) -> Result<(), OutsidePatch> {
        self.loads.iter_mut().try_for_each(|load| load.attach(&self.patch, &self.cells))
    }

    /// History, phase field and degraded stress; an elastic body has its stress from G2P.
    fn crack_and_stress(&mut self, moved: bool) -> Result<(), NotConverged> {
        let Self { patch, cells, points, moduli, .. } = self;
        let Some(fracture) = &mut self.fracture else { return Ok(()) };
        fracture.update_history(moduli, cells, points);
        fracture.solve(patch, cells, points, moved)?;
        let sums = fracture.update_stress(patch, moduli, cells, points);
        self.elastic_energy = sums.elastic_energy;
        self.stress_work = sums.stress_work;
        self.ledger.history_work += sums.history_work;
        Ok(())
    }

    /// Mass, arriving velocity, and internal and external forces.
    fn points_to_grid(&mut self) {
        let Self { patch, cells, points, nodes, density, .. } = self;
        nodes.clear();
        let (grid, density) = (nodes.grid, *density);
        let NodalFields { mass, arrived: [px, py], force: [fx, fy], .. } = nodes;
        scatter(&cells.strips, [mass, px, py, fx, fy], [grid.stride; 5], |strip, window| {
            let cells = &cells.cells[strip.cells.clone()];
            dispatch(PointsToGrid { patch, grid, density, cells, points, window });
        });
        nodes.divide_by_mass();
        nodes.add_gravity(self.gravity);
        for load in &self.loads {
            load.add_forces(patch, grid, self.time, &mut nodes.force);
        }
    }

    fn apply_boundary(&mut self) -> ImposedEnergy {
        self.nodes.impose_velocities()
    }

    fn accelerate(&mut self) {
        self.nodes.accelerate();
    }

    /// Books the works and losses of the step that ends now.
    fn book(&mut self, dt: f64, leaving: &Leaving, imposed: ImposedEnergy) {
        let [following, _] = self.nodes.power();
        let weight = self.gravity[0] * leaving.momentum[0] + self.gravity[1] * leaving.momentum[1];
        let traction_at = |time: f64| self.loads.iter().map(|load| load.factor(time) * load.power()).sum::<f64>();
        let [before, now] = [self.time - dt, self.time].map(traction_at);
        let driven = self.nodes.power_of_driven_sides();
        let on_points = now + weight - self.stress_work / dt;
        self.losses.kinetic += leaving.kinetic - self.nodes.kinetic_energy(&self.nodes.arrived);
        self.losses.power += 0.5 * dt * (leaving.idle_power + on_points - following);
        self.losses.imposed += imposed.loss;
        self.ledger.external_work += imposed.work + dt * weight + 0.5 * dt * (before + now);
        self.ledger.external_work += 0.5 * dt * (self.driven_power + driven);
        self.ledger.transfer_loss = self.losses.kinetic + self.losses.power + self.losses.imposed;
        self.driven_power = driven;
    }

    /// Critical time step of the undamaged body at the present positions, s; infinite if nothing can move.
    pub fn critical_step(&self) -> f64 {
        let frequency = highest_frequency(&mut Stiffness::new(self));
        if frequency > 0.0 { std::f64::consts::SQRT_2 / frequency } else { f64::INFINITY }
    }

    /// Whether a point may have moved a quarter of the smallest span since the last call that said so: the time to take
    /// the critical step again.
    pub fn critical_step_is_due(&mut self) -> bool {
        let spans = self.patch.spaces.iter().flat_map(|space| space.spans());
        let due = self.travelled >= 0.25 * spans.map(|s| s.length()).fold(f64::INFINITY, f64::min);
        if due {
            self.travelled = 0.0;
        }
        due
    }
}

impl From<NotConverged> for Failure {
    fn from(failure: NotConverged) -> Self {
        Self::NotConverged(failure)
    }
}

impl From<OutsidePatch> for Failure {
    fn from(OutsidePatch(position): OutsidePatch) -> Self {
        Self::Left(position)
    }
}

/// Initial velocities: a translation and a rotation about the centre of mass.
fn set_velocities(points: &mut [Point], velocity: [f64; 2], angular_velocity: f64) {
    let volume: f64 = points.iter().map(|p| p.volume).sum();
    let center = [0, 1].map(|d| points.iter().map(|p| p.volume * p.position[d]).sum::<f64>() / volume);
    for point in points {
        let [x, y] = [0, 1].map(|d| point.position[d] - center[d]);
        point.velocity = [velocity[0] - angular_velocity * y, velocity[1] + angular_velocity * x];
    }
}
