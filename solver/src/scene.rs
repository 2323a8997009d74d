//! The scene: everything one simulation models, in SI units.
//!
//! A scene is plain data. What it does not declare is not modelled: without [`Fracture`] in a material there
//! is no phase field in memory or in the step, without [`Contact`] no contact search.
//! [`crate::Simulation::new`] turns a scene into a running model; [`crate::validate::validate`] says what is
//! wrong with one, by key.

pub mod error;
pub(crate) mod shape;

use std::collections::BTreeMap;

use crate::linear_algebra::extremes::{larger, smaller};

/// One simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Title, for people.
    pub title: String,
    /// Background spline mesh.
    pub mesh: Mesh,
    /// Plane state, frame, times, integration.
    pub analysis: Analysis,
    /// Tolerances of the linear solvers.
    pub solver: SolverSettings,
    /// Materials by name.
    pub materials: BTreeMap<String, Material>,
    /// Bodies made of material points.
    pub bodies: Vec<Body>,
    /// Frictional contact between bodies, if they are to meet.
    pub contact: Option<Contact>,
    /// Conditions on the sides of the mesh.
    pub boundaries: Vec<Boundary>,
    /// What is recorded.
    pub output: Output,
}

/// Background NURBS patch: a B-spline patch over an axis-aligned rectangle, or any other with its geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Polynomial degree per direction, 1 to 4.
    pub degree: [usize; 2],
    /// Open knot vector per direction: first and last knot repeated `degree + 1` times. In metres over a
    /// rectangle, in any unit with a geometry.
    pub knots: [Vec<f64>; 2],
    /// Control points and weights; absent over a rectangle, whose knots are its coordinates.
    pub geometry: Option<Geometry>,
}

/// Geometry of a general patch, row by row, first direction fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Control points, m.
    pub control_points: Vec<[f64; 2]>,
    /// Weights, all positive.
    pub weights: Vec<f64>,
}

impl Mesh {
    /// Open uniform knots: `cells[d]` equal spans of a rectangle with lower left corner `origin` (m) and
    /// `size` (m).
    pub fn uniform(degree: [usize; 2], origin: [f64; 2], size: [f64; 2], cells: [usize; 2]) -> Self {
        let knots = [0, 1].map(|d| {
            let interior = (0..=cells[d]).map(|i| origin[d] + size[d] * (i as f64 / cells[d] as f64));
            let mut knots = vec![origin[d]; degree[d]];
            knots.extend(interior);
            knots.extend(std::iter::repeat_n(origin[d] + size[d], degree[d]));
            knots
        });
        Self { degree, knots, geometry: None }
    }

    /// Lower left corner of the patch, or of the box around its control points, m.
    pub fn origin(&self) -> [f64; 2] {
        [0, 1].map(|d| match &self.geometry {
            None => self.knots[d].first().copied().unwrap_or(0.0),
            Some(geometry) => geometry.control_points.iter().map(|p| p[d]).fold(f64::INFINITY, smaller),
        })
    }

    /// Upper right corner of the patch, or of the box around its control points, m.
    pub fn end(&self) -> [f64; 2] {
        [0, 1].map(|d| match &self.geometry {
            None => self.knots[d].last().copied().unwrap_or(0.0),
            Some(geometry) => geometry.control_points.iter().map(|p| p[d]).fold(f64::NEG_INFINITY, larger),
        })
    }

    /// The box around the part of a shape that lies in the box around the patch: lower left and upper right
    /// corner, m.
    pub fn extent(&self, shape: &Shape) -> ([f64; 2], [f64; 2]) {
        let (low, high) = shape.bounding_box();
        let (origin, end) = (self.origin(), self.end());
        ([0, 1].map(|d| low[d].max(origin[d])), [0, 1].map(|d| high[d].min(end[d])))
    }
}

/// Plane state.
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

/// Strain measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kinematics {
    /// Linear strain.
    Small,
    /// Hencky strain from the deformation gradient.
    Finite,
}

/// Velocity transfer between points and grid in the updated frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transfer {
    /// Particle-in-cell.
    Pic,
    /// Fluid-implicit-particle.
    Flip,
    /// Affine particle-in-cell.
    Apic,
    /// Taylor particle-in-cell.
    Tpic,
    /// Extended particle-in-cell of the given order.
    Xpic(usize),
}

/// What integrates forces and inertia in the updated frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quadrature {
    /// The material points.
    Points,
    /// Gauss points of the part of each span that the body fills.
    Gauss,
}

/// Mass matrix of the control points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mass {
    /// Row sums.
    Lumped,
    /// Full matrix.
    Consistent,
}

/// Time step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeStep {
    /// `safety` times the critical step of the operator.
    Auto,
    /// Given, in s.
    Fixed(f64),
}

/// Plane state, frame, times, integration.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Plane state.
    pub plane: Plane,
    /// Thickness, m.
    pub thickness: f64,
    /// Frame of the shape functions.
    pub frame: Frame,
    /// Strain measure.
    pub kinematics: Kinematics,
    /// End of the simulated time, s.
    pub end_time: f64,
    /// Time step.
    pub time_step: TimeStep,
    /// Fraction of the critical step used by [`TimeStep::Auto`].
    pub safety: f64,
    /// Transfer of the updated frame.
    pub transfer: Transfer,
    /// Quadrature of the updated frame.
    pub quadrature: Quadrature,
    /// Mass matrix.
    pub mass: Mass,
    /// Gravity, m/s².
    pub gravity: [f64; 2],
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
    /// Which solver.
    pub phase_field_solver: PhaseFieldSolver,
    /// How often it solves: see [`crate::phase_field`].
    pub phase_field_interval: PhaseFieldInterval,
}

/// Isotropic linear elastic material, brittle if it has a fracture table.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Young's modulus, Pa.
    pub young_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// Brittle fracture, if modelled.
    pub fracture: Option<Fracture>,
}

/// Which part of the elastic energy drives and feels the phase field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Split {
    /// Tensile part by principal strains.
    Spectral,
    /// All of it.
    None,
}

/// AT2 phase field in Borden's convention.
#[derive(Debug, Clone, PartialEq)]
pub struct Fracture {
    /// Critical energy release rate Gc, J/m².
    pub critical_energy_release_rate: f64,
    /// Length scale l0 (half the l of the d²/l form), m.
    pub length_scale: f64,
    /// Residual stiffness k.
    pub residual_stiffness: f64,
    /// Split of the elastic energy.
    pub split: Split,
}

/// Region of the plane, in m.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Axis-aligned rectangle.
    Rectangle {
        /// Lower left corner.
        min: [f64; 2],
        /// Upper right corner.
        max: [f64; 2],
    },
    /// Disk.
    Disk {
        /// Centre.
        center: [f64; 2],
        /// Radius.
        radius: f64,
    },
    /// Ring between two circles.
    Annulus {
        /// Centre.
        center: [f64; 2],
        /// Inner radius.
        inner_radius: f64,
        /// Outer radius.
        outer_radius: f64,
    },
    /// Simple polygon.
    Polygon {
        /// Corners in order.
        points: Vec<[f64; 2]>,
    },
    /// All of the background patch.
    Patch,
    /// A shape without other shapes.
    Difference {
        /// The shape cut from.
        of: Box<Shape>,
        /// The shapes cut out.
        minus: Vec<Shape>,
    },
}

/// Arrangement of material points in a span.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Gauss–Legendre points with their weights as volumes.
    Gauss,
    /// Equally spaced points of equal volume.
    Uniform,
    /// Equally spaced points with Maclaurin weights as volumes.
    Maclaurin,
}

/// Side of a rectangle, or of a patch: left and right bound its first parametric direction, bottom and top
/// its second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Smallest x.
    Left,
    /// Largest x.
    Right,
    /// Smallest y.
    Bottom,
    /// Largest y.
    Top,
}

/// Where a traction acts.
#[derive(Debug, Clone, PartialEq)]
pub enum Edge {
    /// A side of a body that is a rectangle or the whole patch.
    Side(Side),
    /// A straight segment, m.
    Segment([[f64; 2]; 2]),
}

/// Traction on an edge of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Traction {
    /// Where.
    pub edge: Edge,
    /// Traction vector, Pa.
    pub stress: [f64; 2],
    /// Time over which it rises linearly from zero, s; absent: full from t = 0.
    pub ramp: Option<f64>,
}

/// Initial crack, seeded through the history field.
#[derive(Debug, Clone, PartialEq)]
pub struct Crack {
    /// First end, m.
    pub from: [f64; 2],
    /// Second end, m.
    pub to: [f64; 2],
    /// Half width of the initial history field, m; absent: half the length scale.
    pub half_width: Option<f64>,
}

/// A body of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// Region it fills.
    pub shape: Shape,
    /// Material points per span and direction.
    pub particles_per_cell: [usize; 2],
    /// Arrangement of the points.
    pub layout: Layout,
    /// Initial velocity, m/s.
    pub velocity: [f64; 2],
    /// Initial angular velocity about the centre of mass, rad/s.
    pub angular_velocity: f64,
    /// Moves with its velocity, unaffected.
    pub rigid: bool,
    /// Tractions.
    pub tractions: Vec<Traction>,
    /// Initial cracks.
    pub cracks: Vec<Crack>,
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
    /// Stiffness of the boundaries of bodies whose spans integrate, over that of a span.
    pub stiffness: f64,
}

impl Default for Contact {
    /// Without friction. Half of this stiffness makes a contact softer than the first span behind it, and
    /// longer.
    fn default() -> Self {
        Self { friction: 0.0, fragments: false, self_contact: false, stiffness: 0.5 }
    }
}

/// Condition on a side of the mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary {
    /// Side of the mesh.
    pub side: Side,
    /// Which components are prescribed.
    pub fix: [bool; 2],
    /// Prescribed velocity of those components, m/s.
    pub velocity: [f64; 2],
}

/// What is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Rows of the history after the first.
    pub samples: usize,
    /// Times of the field pictures, s.
    pub frames: Vec<f64>,
    /// Whether the motion of every body and the forces between them are recorded (updated frame).
    pub bodies: bool,
}
