//! What is wrong with a scene, by key, before anything runs.
//!
//! Errors are what cannot be modelled or cannot be meant; warnings are legal but suspicious. Each names the
//! key path of the scene file (`body.0.crack.0.from`) and says what would be right. Units are SI throughout.

mod analysis;
mod body;
mod conditions;
mod contact;
mod cracks;
mod geometry;
mod ground;
mod material;
mod mesh;
mod output;
mod points;
mod tractions;

use crate::scene::error::{SceneError, SceneWarning};
use crate::scene::{Frame, Scene};

pub use analysis::expected_size;
use ground::{Findings, Ground};

/// Checks a scene; the warnings, if it can be modelled.
///
/// # Errors
/// Everything that is wrong, in the order of the scene's tables.
pub fn validate(scene: &Scene) -> Result<Vec<SceneWarning>, Vec<SceneError>> {
    let mut findings = Findings::default();
    let patch = mesh::check(&scene.mesh, &mut findings);
    let finest = Scene { mesh: scene.mesh.finest(), ..scene.clone() };
    let scene = if scene.mesh.halvings > 0 {
        mesh::check_refinement(scene, &mut findings);
        &finest
    } else {
        scene
    };
    let ground = Ground::new(&scene.mesh, findings.errors.is_empty(), patch);
    analysis::check(scene, &ground, &mut findings);
    conditions::check(scene, &ground, &mut findings);
    material::check(scene, &mut findings);
    body::check(scene, &ground, &mut findings);
    contact::check(scene, &ground, &mut findings);
    analysis::check_size(scene, &mut findings);
    // What a scene can say and the solver cannot do yet: a feature that arrives deletes its lines here.
    if scene.analysis.frame == Frame::Updated && scene.mesh.geometry.is_some() {
        let message = "a mesh with control_points or annulus in the updated frame is not supported yet";
        findings.error("analysis.frame", message, "use frame = \"total\", or a rectangle");
    }
    if findings.errors.is_empty() { Ok(findings.warnings) } else { Err(findings.errors) }
}

#[cfg(test)]
mod tests;
