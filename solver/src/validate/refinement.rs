//! Checks of local refinement: what it cannot be used with.

use super::findings::Findings;
use crate::particles::spans::longest_span;
use crate::scene::{Frame, Kinematics, Mass, PhaseFieldSolver, Scene, Shape};

/// Relative tolerance of "covers the mesh".
const TOLERANCE: f64 = crate::splines::spline::ROUND_OFF;

pub(super) fn check(scene: &Scene, findings: &mut Findings) {
    let body = scene.bodies.first();
    let fracture = body.and_then(|body| scene.materials.get(&body.material)?.fracture.as_ref());
    let covers = |shape: &Shape| {
        let (origin, end) = (scene.mesh.origin(), scene.mesh.end());
        let near = |d: usize, one: f64, other: f64| (one - other).abs() <= TOLERANCE * (end[d] - origin[d]);
        match shape {
            Shape::Rectangle { min, max } => (0..2).all(|d| near(d, min[d], origin[d]) && near(d, max[d], end[d])),
            _ => *shape == Shape::Patch,
        }
    };
    let repeats = |d: usize| {
        let (knots, ends) = (&scene.mesh.knots[d], scene.mesh.degree[d] + 1);
        knots.get(ends..knots.len().saturating_sub(ends)).is_some_and(|inner| inner.windows(2).any(|k| k[0] == k[1]))
    };
    let output = &scene.output;
    let obstacles = [
        (scene.analysis.frame == Frame::Updated, "frame = \"updated\"", "use frame = \"total\""),
        (scene.analysis.kinematics == Kinematics::Finite, "finite kinematics", "use kinematics = \"small\""),
        (scene.analysis.mass == Mass::Consistent, "a consistent mass", "leave analysis.mass out"),
        (scene.contact.is_some() || scene.bodies.len() > 1, "several bodies or contact", "describe one body alone"),
        (
            body.is_some_and(|body| !body.conditions.is_empty()),
            "conditions on edges of a body",
            "give them on sides of the mesh ([[boundary]])",
        ),
        (body.is_some_and(|body| !covers(&body.shape)), "a body that does not cover the mesh", "let it cover the mesh"),
        (fracture.is_none(), "a body that does not break", "give its material a fracture table"),
        (scene.equilibrium, "a static start", "remove start.equilibrium"),
        ((0..2).any(repeats), "repeated knots", "give every inner knot once"),
        (
            scene.solver.phase_field_solver == PhaseFieldSolver::Cholesky,
            "phase_field_solver = \"cholesky\"",
            "use \"conjugate-gradients\"",
        ),
        (!output.j_integrals.is_empty(), "J-integrals", "remove output.j_integral"),
        (output.fragments || output.bodies, "a count of fragments or a record of bodies", "remove them from output"),
    ];
    for (_, what, remedy) in obstacles.into_iter().filter(|(is_there, ..)| *is_there) {
        findings.error(
            "mesh.refine",
            format!("local refinement with {what} is not implemented"),
            format!("{remedy}, or remove mesh.refine"),
        );
    }
    if let (Some(body), Some(fracture)) = (body, fracture) {
        let (coarse, l0) = (longest_span(&scene.mesh, &body.shape), fracture.shortest_length());
        // With a threshold, spans are halved before a crack begins.
        let begins_anywhere = !fracture.model.has_threshold() && (body.cracks.is_empty() || fracture.random.is_some());
        if begins_anywhere && scene.mesh.geometry.is_none() && coarse > l0 * (1.0 + TOLERANCE) {
            let message = format!(
                "a crack may begin where cells are {:.4} mm long against l0 = {:.4} mm: they are halved when it is there, \
                 which is late; use cells of at most l0, or fewer levels",
                1e3 * coarse,
                1e3 * l0
            );
            findings.warn("mesh.refine", message);
        }
    }
}
