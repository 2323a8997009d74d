//! What is wrong with a scene, by key, before anything runs.
//!
//! Errors are what cannot be modelled or cannot be meant; warnings are legal but suspicious. Each names the key path of
//! the scene file (`body.0.crack.0.from`) and says what would be right. Units are SI throughout.

mod analysis;
mod body;
mod contact;
mod geometry;
mod material;
mod mesh;
mod points;
mod seed;
mod size;

use crate::particles::spans::{lengths_of_chords, lengths_of_spans};
use crate::scene::error::{SceneError, SceneWarning};
use crate::scene::{Frame, Mesh, Scene, Shape};
use crate::splines::nurbs::NurbsPatch;
use crate::splines::spline::SplineSpace;

pub use size::{ExpectedSize, expected_size};

/// Checks a scene; the warnings, if it can be modelled.
///
/// # Errors
/// Everything that is wrong, in the order of the scene's tables.
pub fn validate(scene: &Scene) -> Result<Vec<SceneWarning>, Vec<SceneError>> {
    let mut findings = Findings::default();
    let patch = mesh::check(&scene.mesh, &mut findings);
    let ground = Ground::new(&scene.mesh, findings.errors.is_empty(), patch);
    analysis::check(scene, &ground, &mut findings);
    material::check(scene, &mut findings);
    body::check(scene, &ground, &mut findings);
    contact::check(scene, &ground, &mut findings);
    size::check(scene, &mut findings);
    unsupported(scene, &mut findings);
    if findings.errors.is_empty() { Ok(findings.warnings) } else { Err(findings.errors) }
}

/// What several checks ask of the mesh, found once: a general patch is not made for every body and crack.
struct Ground<'a> {
    mesh: &'a Mesh,
    is_sound: bool,
    /// The geometry, if the mesh has one that is sound.
    patch: Option<NurbsPatch>,
    /// Smallest and largest span of that, m.
    patch_spans: [f64; 2],
    /// Spline spaces of both directions, if the mesh is sound.
    spaces: Option<[SplineSpace; 2]>,
}

impl<'a> Ground<'a> {
    fn new(mesh: &'a Mesh, is_sound: bool, patch: Option<NurbsPatch>) -> Self {
        let patch_spans = patch.as_ref().map_or([f64::INFINITY, 0.0], lengths_of_chords);
        let spaces = is_sound.then(|| [0, 1].map(|d| SplineSpace::new(mesh.degree[d], &mesh.knots[d])));
        Self { mesh, is_sound, patch, patch_spans, spaces }
    }

    /// Smallest and largest span under a shape, m.
    fn span_lengths(&self, shape: &Shape) -> [f64; 2] {
        if self.patch.is_some() { self.patch_spans } else { lengths_of_spans(self.mesh, shape) }
    }
}

/// What the checks found so far.
#[derive(Default)]
struct Findings {
    errors: Vec<SceneError>,
    warnings: Vec<SceneWarning>,
}

impl Findings {
    fn error(&mut self, key: impl Into<String>, message: impl Into<String>, remedy: impl Into<String>) {
        self.errors.push(SceneError { key: key.into(), message: message.into(), remedy: remedy.into() });
    }

    fn warn(&mut self, key: impl Into<String>, message: impl Into<String>) {
        self.warnings.push(SceneWarning { key: key.into(), message: message.into() });
    }

    /// An error unless `value` is positive and finite; `like` is an example with its unit.
    fn positive(&mut self, key: impl Into<String>, value: f64, like: &str) -> bool {
        let holds = value > 0.0 && value.is_finite();
        if !holds {
            self.error(key, format!("{value} is not positive"), format!("give a positive value such as {like}"));
        }
        holds
    }

    /// An error unless all values are finite.
    fn finite(&mut self, key: impl Into<String>, values: &[f64]) -> bool {
        let holds = values.iter().all(|v| v.is_finite());
        if !holds {
            self.error(key, "not a finite number", "give finite numbers");
        }
        holds
    }
}

/// What a scene can say and the solver cannot do yet. A feature that arrives deletes its lines here.
fn unsupported(scene: &Scene, findings: &mut Findings) {
    if scene.analysis.frame == Frame::Updated && scene.mesh.geometry.is_some() {
        let message = "a mesh with control_points or annulus in the updated frame is not supported yet";
        findings.error("analysis.frame", message, "use frame = \"total\", or a rectangle");
    }
}

#[cfg(test)]
mod tests;
