//! `[solver] accuracy`: what a scene with cracks leaves to the program, chosen for an error of the kinetic
//! energy and the work.
//!
//! The rule is that of the plate of the benchmarks (`reports/gallery/performance.md`, a seed of two
//! spans on either side). With the toughness of the mesh and p = 2 both errors are below 1 % on spans of l0;
//! without it the cost of a crack on spans of l0 is an error of 4 %, which falls with h. A tolerance of a
//! tenth of the accuracy, and a solve in every second step at 1 %, add less than half of it.

use std::collections::BTreeMap;

use fisura::material::mesh_toughness::slope_in;
use fisura::scene::{Body, CrackModel, Frame, Material, PhaseFieldInterval, SolverSettings};

use super::document::Node;
use super::fields::{Fields, Item};
use super::read::number;
use crate::extremes::smaller;

/// Accuracies that can be chosen for.
const LEAST: f64 = 1e-3;
const MOST: f64 = 0.1;
/// Accuracy on spans of l0, with and without the toughness of the mesh.
const WITH_TOUGHNESS: f64 = 0.01;
const WITHOUT: f64 = 0.04;
/// Tolerance of the phase field, of the accuracy; and the largest.
const TOLERANCE: f64 = 0.1;
const LOOSEST: f64 = 1e-3;

/// The accuracy in the `[solver]` table.
pub(super) fn accuracy(fields: &Fields<'_>) -> Option<f64> {
    fields.maybe("accuracy", |item: &Item<'_>| {
        let value = number(item)?;
        let message = || format!("nothing can be chosen for an accuracy of {value}");
        if (LEAST..=MOST).contains(&value) { Some(value) } else { item.fail(message(), "give \"0.1 %\" to \"10 %\"") }
    })
}

/// Makes Gc that of a mesh of some degree where that is known and the scene does not say, and returns the
/// longest span (m), if a material can break. `scene` is the tree of the scene.
pub(super) fn choose_span(
    accuracy: f64,
    materials: &mut BTreeMap<String, Material>,
    (bodies, frame, degree): (&[Body], Frame, [usize; 2]),
    scene: &Node,
) -> Option<f64> {
    let mut longest = None;
    for (name, material) in materials {
        let Some(fracture) = &mut material.fracture else { continue };
        let says = |node: &Node| node.get(name)?.get("fracture")?.get("mesh_toughness").map(|_| ());
        let is_fitted = frame == Frame::Total && fracture.model == CrackModel::At2;
        let is_known = is_fitted && bodies.iter().all(|body| slope_in(fracture, degree, body).is_some());
        if scene.get("material").and_then(says).is_none() {
            fracture.mesh_toughness = is_known;
        }
        let at_l0 = if fracture.mesh_toughness && is_known { WITH_TOUGHNESS } else { WITHOUT };
        let span = fracture.length_scale * smaller(accuracy / at_l0, 1.0);
        longest = Some(longest.map_or(span, |longest| smaller(longest, span)));
    }
    longest
}

/// Sets tolerance and interval of the phase field where the `[solver]` table, `node`, does not.
pub(super) fn choose_settings(
    accuracy: f64,
    settings: &mut SolverSettings,
    (materials, frame): (&BTreeMap<String, Material>, Frame),
    node: &Node,
) {
    if node.get("phase_field_tolerance").is_none() {
        settings.phase_field_tolerance = smaller(TOLERANCE * accuracy, LOOSEST);
    }
    let models = || materials.values().filter_map(|material| material.fracture.as_ref()).map(|fracture| fracture.model);
    let can_wait = frame == Frame::Total && models().all(|model| model == CrackModel::At2);
    if node.get("phase_field_interval").is_none() && can_wait && accuracy >= WITH_TOUGHNESS {
        settings.phase_field_interval = PhaseFieldInterval::Steps(2);
    }
}
