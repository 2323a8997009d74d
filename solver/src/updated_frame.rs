//! Explicit dynamics in the updated frame: points carry everything, the grid is rebuilt at every step (lumped mass).
//!
//! Between two whole steps n and n + 1 the shape functions are those at the positions x(n). The scheme is velocity Verlet
//! written as one full kick on the rebuilt grid; no acceleration outlives its grid. What the points take from the grid is
//! the transfer's choice: see [`departure`]. Strains are small, the sum of `dt sym(grad v(n + 1/2))`, or finite: Hencky
//! strains of the deformation gradient of each point with Kirchhoff stresses, so that the internal force is
//! `Σ V tau grad N` with the reference volume V ([`crate::hencky`]). Every loss of a transfer is measured: see [`losses`].
//!
//! # The critical step
//!
//! It is shorter than the `2/ω_max` of a grid that keeps its velocity. For points at rest a mode of the grid obeys
//! `u ← u + dt (v − dt ω² u)`, `v ← v − dt s ω² u` with FLIP, where 0 ≤ s ≤ 1 is what the way to the points and back
//! (`M⁻¹` times the consistent mass) leaves of an increment. The mode is stable up to `ω dt = 2/√(2 − s)`: 1.46 for the
//! shortest waves of quadratic splines, and √2 for what the points do not see. [`UpdatedFrame::critical_step`] is √2/ω_max
//! for every transfer but MUSL, whose limit is 2/ω_max ([`departure`]). With finite strains ω_max is that of the stiffness
//! without the geometric part.

pub mod affine;
pub mod assembly;
pub mod cracking;
pub mod departure;
pub mod grid;
pub mod losses;
pub mod observe;
pub mod points;
pub mod smoothing;
pub mod stiffness;
pub mod strain;
pub mod tractions;
pub mod transfer;
pub mod verify;
pub mod volume_forcing;
pub mod windows;

use rayon::prelude::*;

use crate::constraints::Constraints;
use crate::critical_step::highest_frequency;
use crate::energy::Ledger;
use crate::fracture::{NotConverged, lowest_tip};
use crate::hencky::Gradient;
use crate::lane::dispatch;
use crate::lattice::Lattice;
use crate::material::{ElasticModuli, FractureModel};
use crate::patch::Patch;
use crate::scene::{Kinematics, Plane, Scene, Transfer};
use affine::{AffineVelocities, Fit};
use cracking::Cracking;
use departure::Departure;
use grid::{ImposedEnergy, NodalFields};
use losses::TransferLosses;
use points::{Cells, OutsidePatch, Point};
use smoothing::Smoothing;
use stiffness::Stiffness;
use strain::{Finite, Small};
use tractions::SurfaceLoad;
use transfer::{GridToPoints, PointsToGrid, StripMotion};
use volume_forcing::VolumeForcing;
use windows::{cut, scatter};

/// Why a step could not be taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Failure {
    /// The phase-field solve stopped short of its tolerance.
    NotConverged(NotConverged),
    /// A point left the patch, m.
    Left([f64; 2]),
}

/// One body in the updated frame.
#[derive(Debug, Clone)]
pub struct UpdatedFrame {
    patch: Patch,
    moduli: ElasticModuli,
    /// Logarithmic change of volume over that of area: less than 1 in plane stress, where the thickness follows.
    thickening: f64,
    density: f64,
    thickness: f64,
    gravity: [f64; 2],
    points: Vec<Point>,
    cells: Cells,
    nodes: NodalFields,
    departure: Departure,
    /// Velocity gradients of the points, for the transfers that need them.
    affine: Option<AffineVelocities>,
    /// Displacement gradients `F − I` of the points, if the kinematics are finite.
    deformation: Option<Vec<Gradient>>,
    loads: Vec<SurfaceLoad>,
    forcing: Option<VolumeForcing>,
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
        let mut cells = Cells::default();
        cells.sort(&patch, &mut points)?;
        let crack = |f| Cracking::new(&patch, body, FractureModel::new(f), &scene.solver, &points);
        let constraints = Constraints::new(patch.control_grid(), &scene.boundaries);
        let affine = |fit| AffineVelocities::new(fit, &patch, points.len());
        let center = center_of_mass(&points);
        let mut frame = Self {
            fracture: material.fracture.as_ref().map(crack),
            nodes: NodalFields::new(&patch, constraints),
            departure: Departure::new(patch.control_grid(), scene.analysis.transfer),
            affine: match scene.analysis.transfer {
                Transfer::Apic => Some(affine(Fit::Weighted)),
                Transfer::Tpic => Some(affine(Fit::Taylor)),
                Transfer::Flip | Transfer::Pic | Transfer::Musl | Transfer::Xpic(_) => None,
            },
            deformation: (scene.analysis.kinematics == Kinematics::Finite).then(|| vec![[[0.0; 2]; 2]; points.len()]),
            loads: body.tractions.iter().map(|t| SurfaceLoad::new(&patch, body, t)).collect(),
            forcing: None,
            moduli: ElasticModuli::new(material, scene.analysis.plane),
            thickening: match scene.analysis.plane {
                Plane::Strain => 1.0,
                Plane::Stress => (1.0 - 2.0 * material.poisson_ratio) / (1.0 - material.poisson_ratio),
            },
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
        let (velocity, spin) = (body.velocity, body.angular_velocity);
        frame.give_velocity(|x| [velocity[0] - spin * (x[1] - center[1]), velocity[1] + spin * (x[0] - center[0])]);
        frame.attach_loads()?;
        frame.crack_and_stress(true)?;
        frame.ledger.history_work = 0.0; // there was no step yet
        frame.find_accelerations();
        Ok(frame)
    }

    /// One time step of `dt` seconds (E 14–24).
    ///
    /// # Errors
    /// If the phase field does not converge, or a point leaves the patch.
    pub fn step(&mut self, dt: f64) -> Result<(), Failure> {
        self.kick(dt); // grid: v(n+1/2) = v(n−1/2) + dt a(n)
        self.depart(); // transfer: what the points take up, and the motion they follow
        let leaving = self.leaving();
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

    fn kick(&mut self, dt: f64) {
        self.nodes.kick(if self.at_start { 0.5 * dt } else { dt });
        self.at_start = false;
        self.time += dt;
    }

    fn depart(&mut self) {
        let Self { patch, cells, points, nodes, departure, affine, density, .. } = self;
        departure.leave(nodes, &Smoothing { patch, cells, points, density: *density, mass: &nodes.mass });
        if let Some(affine) = affine {
            affine.take(patch, cells, points, &nodes.velocity);
        }
    }

    /// `v_p ← kept v_p + Σ N taken`, `x_p += dt Σ N motion`, and the strain of the motion; whether a point left its span.
    fn grid_to_points(&mut self, dt: f64) -> bool {
        let Self { patch, cells, points, departure, forcing, .. } = self;
        if let Some(forcing) = forcing {
            forcing.before_motion(patch, cells, points, &departure.motion);
        }
        let motions = match self.deformation.take() {
            None => self.move_points(dt, self.cells.strips.iter().map(|_| Small).collect()),
            Some(mut deformation) => {
                let strips = cut(&mut deformation, self.cells.strips.iter().map(|s| s.points.clone()));
                let motions = self.move_points(dt, strips.into_iter().map(Finite).collect());
                self.deformation = Some(deformation);
                motions
            }
        };
        let Self { patch, nodes, points, departure, forcing, loads, .. } = self;
        for load in loads {
            load.move_points(patch, nodes.grid, &departure.motion, dt);
        }
        if let Some(forcing) = forcing {
            forcing.after_motion(points, self.time, dt);
        }
        let fastest = motions.iter().map(|m| m.fastest).fold(0.0, f64::max);
        self.travelled += dt * (2.0 * fastest).sqrt();
        self.elastic_energy = motions.iter().map(|m| m.elastic_energy).sum();
        self.stress_work = motions.iter().map(|m| m.stress_work).sum();
        motions.iter().any(|m| m.left_span)
    }

    /// Velocity, position and strain of the points; `kinematics` for each strip.
    fn move_points<K: strain::Kinematics + Send>(&mut self, dt: f64, kinematics: Vec<K>) -> Vec<StripMotion> {
        let Self { patch, cells, nodes, points, departure, fracture, .. } = self;
        let elastic = fracture.is_none().then_some(self.moduli);
        let ranges = || cells.strips.iter().map(|s| s.points.clone());
        let cracked = match fracture {
            Some(fracture) => cut(&mut fracture.points, ranges()),
            None => cells.strips.iter().map(|_| &mut [][..]).collect(),
        };
        let (kept, grid) = (departure.kept, nodes.grid);
        let motion = departure.motion.each_ref().map(|f| &f[..]);
        let taken = departure.taken.each_ref().map(|f| &f[..]);
        let strips = cut(points, ranges()).into_par_iter().zip(cracked).zip(kinematics).zip(&cells.strips);
        strips
            .map(|(((points, fracture), kinematics), strip)| {
                let cells = &cells.cells[strip.cells.clone()];
                dispatch(GridToPoints {
                    patch,
                    grid,
                    dt,
                    motion,
                    taken,
                    kept,
                    kinematics,
                    elastic,
                    cells,
                    points,
                    fracture,
                })
            })
            .collect()
    }

    fn sort(&mut self) -> Result<(), OutsidePatch> {
        let Self { patch, cells, points, .. } = self;
        cells.sort(patch, points)?;
        if let Some(fracture) = &mut self.fracture {
            cells.reorder(&mut fracture.points);
        }
        if let Some(affine) = &mut self.affine {
            cells.reorder(&mut affine.gradients);
        }
        if let Some(deformation) = &mut self.deformation {
            cells.reorder(deformation);
        }
        if let Some(forcing) = &mut self.forcing {
            forcing.reorder(cells);
        }
        Ok(())
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
        if let Some(affine) = &self.affine {
            affine.give(patch, cells, points, density, &mut nodes.arrived);
        }
        nodes.divide_by_mass();
        nodes.add_gravity(self.gravity);
        for load in &self.loads {
            load.add_forces(patch, grid, self.time, &mut nodes.force);
        }
        if let Some(forcing) = &self.forcing {
            forcing.add_forces(patch, cells, points, &mut nodes.force);
        }
    }

    fn apply_boundary(&mut self) -> ImposedEnergy {
        self.nodes.impose_velocities()
    }

    fn accelerate(&mut self) {
        self.nodes.accelerate();
    }

    /// Rebuilds the grid where no step leads to it.
    fn find_accelerations(&mut self) {
        self.points_to_grid();
        self.apply_boundary();
        self.accelerate();
        self.driven_power = self.nodes.power_of_driven_sides();
    }

    /// Gives the points a velocity field (m/s), and its gradients where the transfer carries them.
    fn give_velocity(&mut self, velocity: impl Fn([f64; 2]) -> [f64; 2]) {
        let Self { patch, cells, points, affine, nodes, .. } = self;
        points.iter_mut().for_each(|point| point.velocity = velocity(point.position));
        if let Some(affine) = affine {
            affine.take(patch, cells, points, &nodes.at_greville_points(patch, velocity));
        }
    }

    /// Critical time step of the undamaged body at the present positions, s; infinite if nothing can move.
    pub fn critical_step(&self) -> f64 {
        let frequency = highest_frequency(&mut Stiffness::new(self));
        if frequency > 0.0 { self.departure.stable_fraction() / frequency } else { f64::INFINITY }
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

/// Centre of mass, m.
fn center_of_mass(points: &[Point]) -> [f64; 2] {
    let volume: f64 = points.iter().map(|p| p.volume).sum();
    [0, 1].map(|d| points.iter().map(|p| p.volume * p.position[d]).sum::<f64>() / volume)
}
