//! The scene of one mesh of a convergence study.

use fisura::scene::{Frame, Scene, Shape};
use fisura::validate::validate;

use super::problem::Problem;
use super::{Variant, other};
use crate::case::convergence::{ConvergenceSetup, PatchFamily};
use crate::exact::Equation;
use crate::exact::vortex::RADII;
use crate::scene::plain::PlainScene;
use crate::study::StudyError;
use crate::study::patches;

/// The scene of one mesh: nothing but the exact solution loads the body, which fills the patch unless the
/// family says otherwise.
pub(super) fn scene(
    setup: &ConvergenceSetup,
    problem: &Problem,
    n: usize,
    cells: usize,
    Variant { transfer, offset }: Variant,
) -> Result<Scene, StudyError> {
    let mut material = problem.solution.material();
    if problem.equation == Equation::PhaseField {
        material.fracture = None; // the study builds its own phase field, on the points of this scene
    }
    let plain = PlainScene {
        mesh: patches::shifted_mesh(setup.patch, setup.degrees[n], cells, offset).map_err(other)?,
        material,
        plane: setup.plane,
        mass: setup.mass,
        layout: setup.layout,
        points: setup.points(n),
        held: problem.held.clone(),
    };
    let mut scene = plain.scene();
    scene.analysis.kinematics = problem.kinematics;
    if setup.frame == Frame::Updated {
        (scene.analysis.frame, scene.analysis.transfer) = (Frame::Updated, transfer);
    }
    let body = &mut scene.bodies[0];
    match setup.patch {
        PatchFamily::Ring => {
            let [inner_radius, outer_radius] = RADII;
            body.shape = Shape::Annulus { center: [0.0; 2], inner_radius, outer_radius };
        }
        PatchFamily::Holed => {
            let (min, max) = (scene.mesh.origin(), scene.mesh.end());
            let hole = Shape::Disk { center: [0.0; 2], radius: 1.0 };
            body.shape = Shape::Difference { of: Box::new(Shape::Rectangle { min, max }), minus: vec![hole] };
        }
        PatchFamily::Disc => body.shape = Shape::Disk { center: [0.0; 2], radius: 1.0 },
        PatchFamily::Block => body.shape = Shape::Rectangle { min: [0.0; 2], max: [1.0; 2] },
        // Nothing varies across a strip, where two points will do.
        PatchFamily::Strip => body.particles_per_cell[1] = setup.points(n).min(2),
        _ => {}
    }
    validate(&scene).map_err(|errors| other(errors.iter().map(|e| e.to_string()).collect::<Vec<_>>().join("; ")))?;
    Ok(scene)
}
