//! The scene of one mesh of a convergence study.

use fisura::scene::{
    Analysis, Body, Boundary, Frame, Kinematics, Output, PhaseFieldSolver, Scene, SolverSettings, TimeStep, Transfer,
};
use fisura::validate::validate;

use super::problem::{Kind, Problem};
use super::{other, patches};
use crate::case::convergence::ConvergenceSetup;
use crate::study::StudyError;

/// The scene of one mesh: the body fills the patch, and nothing but the exact solution loads it.
pub(super) fn scene(
    setup: &ConvergenceSetup,
    problem: &Problem,
    n: usize,
    cells: usize,
    transfer: Transfer,
) -> Result<Scene, StudyError> {
    let (mesh, shape) = patches::mesh(setup.patch, setup.degrees[n], cells).map_err(|e| other(e.to_string()))?;
    let mut material = problem.solution.material();
    if problem.kind == Kind::PhaseField {
        material.fracture = None; // the study builds its own phase field, on the points of this scene
    }
    let body = Body {
        name: "body".into(),
        material: "material".into(),
        shape,
        particles_per_cell: patches::points_per_span(setup.patch, setup.points(n)),
        layout: setup.layout,
        velocity: [0.0; 2],
        angular_velocity: 0.0,
        rigid: false,
        tractions: vec![],
        cracks: vec![],
    };
    let boundary = |&(side, fix): &(_, _)| Boundary { side, fix, velocity: [0.0; 2] };
    let scene = Scene {
        title: setup.problem.clone(),
        mesh,
        analysis: Analysis {
            plane: setup.plane,
            thickness: 1.0,
            frame: setup.frame,
            kinematics: if setup.frame == Frame::Updated { Kinematics::Finite } else { Kinematics::Small },
            end_time: 1.0,
            time_step: TimeStep::Auto,
            safety: 0.5,
            transfer,
            mass: setup.mass,
            gravity: [0.0; 2],
        },
        solver: SolverSettings { phase_field_tolerance: 1e-14, phase_field_solver: PhaseFieldSolver::Cholesky },
        materials: [("material".to_string(), material)].into(),
        bodies: vec![body],
        contact: None,
        boundaries: problem.held.iter().map(boundary).collect(),
        output: Output { samples: 1, frames: vec![] },
    };
    validate(&scene).map_err(|errors| other(errors.iter().map(|e| e.to_string()).collect::<Vec<_>>().join("; ")))?;
    Ok(scene)
}
