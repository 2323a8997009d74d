//! The scene: everything one simulation models, in SI units.
//!
//! A scene is plain data. What it does not declare is not modelled: without [`Fracture`] in a material there
//! is no phase field in memory or in the step, without [`Contact`] no contact search.
//! [`crate::Simulation::new`] turns a scene into a running model; [`crate::validate::validate`] says what is
//! wrong with one, by key.

mod body;
mod condition;
pub(crate) mod edges;
pub mod error;
mod mesh;
pub(crate) mod shape;
mod steps;
pub mod time;
mod toughness;

use std::collections::BTreeMap;

pub use body::{Body, Crack, CrackKind, CrackModel, Fracture, Layout, Material, Softening, Split};
pub use condition::{Boundary, Edge, EdgeCondition, Hold, Load, Motion, Prescribed, Side, StressField, Traction};
pub use mesh::{Geometry, Mesh};
pub use shape::Shape;
pub use time::TimeFactor;
pub use toughness::{Anisotropy, RandomToughness};

/// Everything that one simulation models and records, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Title of the scene for people; the solver does not use it.
    pub title: String,
    /// Background spline mesh.
    pub mesh: Mesh,
    /// Plane state, frame, times, integration.
    pub analysis: Analysis,
    /// Tolerances of the linear solvers.
    pub solver: SolverSettings,
    /// Materials of the bodies, by the names with which bodies refer to them.
    pub materials: BTreeMap<String, Material>,
    /// Bodies made of material points.
    pub bodies: Vec<Body>,
    /// Frictional contact between bodies, if they are to meet.
    pub contact: Option<Contact>,
    /// Conditions on the sides of the mesh.
    pub boundaries: Vec<Boundary>,
    /// Whether it starts from the static state under the loads and conditions at t = 0 (total frame).
    pub equilibrium: bool,
    /// Results that the run records.
    pub output: Output,
}

/// Plane state: whether the strain or the stress out of the plane is zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    /// No out-of-plane strain.
    Strain,
    /// No out-of-plane stress.
    Stress,
}

/// Where the shape functions are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// At the reference positions, once; the grid keeps its velocity.
    Total,
    /// At the moved positions; the grid is rebuilt each step.
    Updated,
}

/// Strain measure from which the stress follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kinematics {
    /// Linear strain: the symmetric part of the displacement gradient.
    Small,
    /// Hencky strain from the deformation gradient.
    Finite,
}

/// Velocity transfer between points and grid in the updated frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Transfer {
    /// PIC: points take the velocity of the mesh.
    Pic,
    /// FLIP: points add the change of the velocity of the mesh.
    Flip,
    /// Affine particle-in-cell: it conserves angular momentum.
    #[default]
    Apic,
    /// Taylor particle-in-cell.
    Tpic,
    /// Extended particle-in-cell of the given order.
    Xpic(usize),
}

/// Mass matrix of the control points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mass {
    /// Diagonal matrix with the row sums of the consistent one.
    Lumped,
    /// Full matrix `M_IJ = Σ_p m_p N_I(x_p) N_J(x_p)` of the material points p.
    Consistent,
}

/// How the length of the time steps is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeStep {
    /// `safety` times the critical step of the operator.
    Auto,
    /// Largest length of a step, s. Steps are shortened until a whole number of them fits between two
    /// samples.
    Fixed(f64),
}

/// Plane state, frame, times, integration.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Plane strain or plane stress.
    pub plane: Plane,
    /// Thickness of all bodies out of the plane, m.
    pub thickness: f64,
    /// Frame of the shape functions.
    pub frame: Frame,
    /// Strain measure, for small or for finite strains.
    pub kinematics: Kinematics,
    /// End of the simulated time, s.
    pub end_time: f64,
    /// How the length of the time steps is chosen.
    pub time_step: TimeStep,
    /// Fraction of the critical step used by [`TimeStep::Auto`].
    pub safety: f64,
    /// Transfer of the updated frame.
    pub transfer: Transfer,
    /// Mass matrix of the control points, lumped or consistent.
    pub mass: Mass,
    /// Acceleration of gravity in x and y at a time factor of 1, m/s².
    pub gravity: [f64; 2],
    /// Its factor over time.
    pub gravity_time: TimeFactor,
}

/// Solver of the phase-field system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhaseFieldSolver {
    /// Conjugate gradients on the stencil, preconditioned by incomplete Cholesky factors.
    ConjugateGradients,
    /// Sparse Cholesky factorisation each step: the reference.
    Cholesky,
}

/// Steps from one solve of the phase field to the next; samples fall on solves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhaseFieldInterval {
    /// That many steps; with 1 every step solves.
    Steps(usize),
    /// As many steps as change no control value of c by more than 0.05, at most 4.
    Automatic,
}

/// Tolerances of the linear solvers.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverSettings {
    /// Error of the phase field in the energy norm over 2 l0: see [`crate::phase_field`].
    pub phase_field_tolerance: f64,
    /// Method that solves the linear system of the phase field.
    pub phase_field_solver: PhaseFieldSolver,
    /// How often it solves: see [`crate::phase_field`].
    pub phase_field_interval: PhaseFieldInterval,
}

/// Frictional contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Coulomb coefficient.
    pub friction: f64,
    /// Whether a body that is cracked through becomes fragments with fields of their own.
    pub fragments: bool,
    /// Whether a body may meet itself.
    pub self_contact: bool,
    /// Stiffness of the boundaries of bodies over that of a span. Without it boundaries are rigid in the
    /// updated frame, and have [`Self::SOFT`] in the total one.
    pub stiffness: Option<f64>,
}

impl Contact {
    /// Half of this stiffness makes a contact softer than the first span behind it, and longer.
    pub const SOFT: f64 = 0.5;
}

impl Default for Contact {
    /// Contact without friction, without fragments, and without contact of a body with itself.
    fn default() -> Self {
        Self { friction: 0.0, fragments: false, self_contact: false, stiffness: None }
    }
}

/// Which results a run records, and at which times.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Output {
    /// Rows of the history after the first.
    pub samples: usize,
    /// Times of the field pictures, s.
    pub frames: Vec<f64>,
    /// Whether the motion of every body and the forces between them are recorded (updated frame).
    pub bodies: bool,
    /// Whether the parts are counted into which cracks divide a body (total frame).
    pub fragments: bool,
    /// Places whose motion and stress are recorded (total frame).
    pub probes: Vec<Probe>,
    /// J-integrals about the tip of a crack (total frame).
    pub j_integrals: Vec<JIntegral>,
}

impl Output {
    /// So many rows of the history after the first, and nothing else.
    pub fn rows(samples: usize) -> Self {
        Self { samples, ..Self::default() }
    }
}

/// A place of a body whose motion and stress are recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name of the probe, which becomes part of the names of its columns.
    pub name: String,
    /// Position at t = 0, m.
    pub at: [f64; 2],
}

/// A J-integral about the tip of a crack.
#[derive(Debug, Clone, PartialEq)]
pub struct JIntegral {
    /// Name in its column, if there are several.
    pub name: Option<String>,
    /// Radius of its domain, m.
    pub radius: f64,
    /// Where the tip is (m), if it does not move; absent: the tip of the crack.
    pub at: Option<[f64; 2]>,
    /// Angle of the direction in which the crack goes, rad; absent: that of the crack that ends at `at`, or
    /// of the end of the first crack.
    pub angle: Option<f64>,
}

impl JIntegral {
    /// Where the tip is at t = 0 (m), and the unit vector along the crack; `None` if neither it nor a crack
    /// of its body says so.
    pub(crate) fn tip_and_axis(&self, body: &Body) -> Option<([f64; 2], [f64; 2])> {
        let first = body.cracks.first();
        let last = first.and_then(|crack| crack.segments().last());
        let driven = first.filter(|crack| matches!(crack.kind, CrackKind::Driven(_)));
        let tip = self.at.or(driven.map(|crack| crack.points[0])).or(last.map(|[_, to]| to))?;
        let ends = body.cracks.iter().filter_map(|crack| crack.segments().last());
        let beginnings = body.cracks.iter().filter_map(|crack| crack.segments().next()).map(|[from, to]| [to, from]);
        let length = |[from, to]: [[f64; 2]; 2]| (to[0] - from[0]).hypot(to[1] - from[1]);
        let ends_there = |crack: &[[f64; 2]; 2]| length([crack[1], tip]) < shape::ROUND_OFF * length(*crack);
        let along = ends.chain(beginnings).find(ends_there).filter(|_| self.at.is_some()).or(last);
        let axis = match (self.angle, along) {
            (Some(angle), _) => [angle.cos(), angle.sin()],
            (None, Some([from, to])) => [0, 1].map(|d| (to[d] - from[d]) / length([from, to])),
            (None, None) => return None,
        };
        Some((tip, axis))
    }
}
