//! Scenes that studies build by themselves: one body that fills its mesh, loaded by nothing that a scene can
//! say.

use fisura::scene::{
    Analysis, Body, Boundary, Frame, Kinematics, Layout, Mass, Material, Mesh, Output, PhaseFieldInterval,
    PhaseFieldSolver, Plane, Scene, Shape, Side, SolverSettings, TimeFactor, TimeStep, Transfer,
};

/// What differs from study to study.
#[derive(Debug, Clone)]
pub struct PlainScene {
    /// Background mesh, which the body fills.
    pub mesh: Mesh,
    /// Material of the body.
    pub material: Material,
    /// Plane state, strain or stress.
    pub plane: Plane,
    /// Kind of mass matrix, lumped or consistent.
    pub mass: Mass,
    /// Layout of the points.
    pub layout: Layout,
    /// Points per span and direction.
    pub points: usize,
    /// Sides that are held, by component.
    pub held: Vec<(Side, [bool; 2])>,
}

/// Rollers on all four sides of a rectangle.
pub const ROLLERS: [(Side, [bool; 2]); 4] = [
    (Side::Left, [true, false]),
    (Side::Right, [true, false]),
    (Side::Bottom, [false, true]),
    (Side::Top, [false, true]),
];

impl PlainScene {
    /// A free body in plane strain with the lumped mass and `points` by `points` Gauss points per span.
    pub fn free(mesh: Mesh, material: Material, points: usize) -> Self {
        Self { mesh, material, plane: Plane::Strain, mass: Mass::Lumped, layout: Layout::Gauss, points, held: vec![] }
    }

    /// A bar of unit modulus and density that does not contract sideways, between rollers, with p + 1 Gauss
    /// points per span.
    pub fn unit_bar(mesh: Mesh, mass: Mass) -> Self {
        Self { mass, held: ROLLERS.to_vec(), ..Self::unit(mesh, 0.0) }
    }

    /// A free body of unit modulus and density, with p + 1 points.
    pub fn unit(mesh: Mesh, poisson_ratio: f64) -> Self {
        let material = Material { young_modulus: 1.0, poisson_ratio, density: 1.0, fracture: None };
        let points = mesh.degree[0] + 1;
        Self::free(mesh, material, points)
    }

    /// The scene, in the total frame with small strains.
    pub fn scene(self) -> Scene {
        let shape = match self.mesh.geometry {
            None => Shape::Rectangle { min: self.mesh.origin(), max: self.mesh.end() },
            Some(_) => Shape::Patch,
        };
        let points = [self.points; 2];
        let body = Body { particles_per_cell: points, layout: self.layout, ..Body::at_rest("body", "material", shape) };
        let boundary = |(side, fix)| Boundary::fixed(side, fix);
        Scene {
            title: String::new(),
            mesh: self.mesh,
            analysis: Analysis {
                plane: self.plane,
                thickness: 1.0,
                frame: Frame::Total,
                kinematics: Kinematics::Small,
                end_time: 1.0,
                time_step: TimeStep::Auto,
                safety: 0.5,
                transfer: Transfer::default(),
                mass: self.mass,
                gravity: [0.0; 2],
                gravity_time: TimeFactor::default(),
            },
            solver: SolverSettings {
                phase_field_tolerance: 1e-14,
                phase_field_solver: PhaseFieldSolver::Cholesky,
                phase_field_interval: PhaseFieldInterval::Steps(1),
            },
            materials: [("material".to_string(), self.material)].into(),
            bodies: vec![body],
            contact: None,
            boundaries: self.held.into_iter().map(boundary).collect(),
            equilibrium: false,
            output: Output::rows(1),
        }
    }
}
