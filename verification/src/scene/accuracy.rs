//! `[solver] accuracy`: what a scene with cracks leaves to the program, chosen for an error of the kinetic
//! energy and the work.
//!
//! The rule is that of the plate of the benchmarks (`reports/gallery/performance-plate.md`, a seed of two
//! spans on either side). With the toughness of the mesh and p = 2 both errors are below 1 % on spans of l0;
//! without it the cost of a crack on spans of l0 is an error of 4 %, which falls with h. A tolerance of a
//! tenth of the accuracy, and a solve in every second step at 1 %, add less than half of it.

use std::collections::BTreeMap;

use fisura::material::mesh_toughness::kappa;
use fisura::scene::{CrackModel, Frame, Material, PhaseFieldInterval, SolverSettings};

use super::document::{Node, Value};
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
pub(super) fn accuracy(fields: &Fields<'_>) -> Option<Option<f64>> {
    fields.maybe("accuracy", |item: &Item<'_>| {
        let value = number(item)?;
        let message = || format!("nothing can be chosen for an accuracy of {value}");
        if (LEAST..=MOST).contains(&value) { Some(value) } else { item.fail(message(), "give \"0.1 %\" to \"10 %\"") }
    })
}

/// Whether the cost of a crack is known on the mesh of a scene, given by its tree: see
/// [`fisura::material::mesh_toughness`].
fn cost_is_known(scene: &Node) -> bool {
    let both = |node: &Node| match &node.value {
        Value::Integer(value) => Some(*value),
        Value::Array(pair) if pair.len() == 2 && pair[0].value == pair[1].value => match pair[0].value {
            Value::Integer(value) => Some(value),
            _ => None,
        },
        _ => None,
    };
    let Some(degree) = scene.get("mesh").and_then(|mesh| both(mesh.get("degree")?)) else { return false };
    let is_updated = scene.get("analysis").and_then(|table| table.get("frame")?.as_str()) == Some("updated");
    let holds = |body: &Node| {
        let is_gauss = body.get("layout").is_none_or(|layout| layout.as_str() == Some("gauss"));
        let points = body.get("particles_per_cell").map_or(Some(degree.max(2)), both);
        is_gauss && points.is_some_and(|points| kappa(degree as usize, points as usize, 0.0).is_some())
    };
    !is_updated && scene.get("body").and_then(Node::as_array).is_some_and(|bodies| bodies.iter().all(holds))
}

/// Makes Gc that of the mesh where that is known and the scene does not say, and returns the longest span
/// (m), if a material can break. `scene` is the tree of the scene.
pub(super) fn choose_span(accuracy: f64, materials: &mut BTreeMap<String, Material>, scene: &Node) -> Option<f64> {
    let mut longest = None;
    for (name, material) in materials {
        let Some(fracture) = &mut material.fracture else { continue };
        let says = |node: &Node| node.get(name)?.get("fracture")?.get("mesh_toughness").map(|_| ());
        let is_known = fracture.model == CrackModel::At2 && fracture.anisotropy.is_none() && cost_is_known(scene);
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
