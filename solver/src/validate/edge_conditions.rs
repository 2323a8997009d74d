//! Checks of the conditions on edges of a body.

use super::conditions::motion;
use super::findings::Findings;
use super::held::Held;
use super::look::Look;
use super::tractions;
use crate::scene::{Hold, Mass, Scene, Shape};

pub(super) fn check(key: &str, scene: &Scene, look: &Look<'_>, findings: &mut Findings) {
    let body = look.body;
    for (j, condition) in body.conditions.iter().enumerate() {
        let key = format!("{key}.condition.{j}");
        if !supported(&key, scene, look, findings) {
            continue;
        }
        if condition.hold == Hold::Components([false; 2]) {
            let remedy = "give fix = [\"x\"], [\"y\"], [\"x\", \"y\"] or [\"normal\"], or remove the condition";
            findings.error(format!("{key}.fix"), "nothing is fixed", remedy);
        }
        let before = findings.errors.len();
        motion(&key, &condition.prescribed, condition.components(), scene, findings);
        tractions::edge(&key, &condition.edge, true, look, findings);
        if findings.errors.len() > before {
            continue;
        }
        let here = Held::on_edge(j, condition, body);
        let sides = scene.boundaries.iter().enumerate().map(|(i, boundary)| Held::on_side(i, boundary, &scene.mesh));
        let edges = body.conditions[..j].iter().enumerate().map(|(i, other)| Held::on_edge(i, other, body));
        for there in sides.chain(edges) {
            here.compare(&there, true, &key, findings);
        }
    }
}

/// What bodies that meet themselves, patches and the consistent mass do not have.
fn supported(key: &str, scene: &Scene, look: &Look<'_>, findings: &mut Findings) -> bool {
    let (message, remedy) = if look.body.rigid {
        ("a condition on a rigid body, which moves with its velocity", "remove the condition, or rigid = true")
    } else if scene.analysis.mass == Mass::Consistent {
        ("a condition on a body with the consistent mass, which is not implemented", "use mass = \"lumped\"")
    } else if look.body.shape == Shape::Patch || scene.mesh.geometry.is_some() {
        (
            "a condition on a body on a patch, whose edges are the sides of the mesh",
            "use [[boundary]] with side = \"left\"",
        )
    } else {
        return true;
    };
    findings.error(key, message, remedy);
    false
}
