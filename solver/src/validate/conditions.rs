//! Checks of the conditions on the sides of the mesh, and of names and motions of all conditions.

use super::findings::{Findings, side_name};
use super::ground::Ground;
use super::held::Held;
use super::time;
use crate::dynamics::body_sample::column_name;
use crate::dynamics::updated_frame::held_sides::lies_on;
use crate::scene::{Body, Boundary, Frame, Mass, Mesh, Prescribed, Scene};
use crate::splines::patch::Patch;

/// Relative tolerance of "on the side", of the size of the mesh.
const TOLERANCE: f64 = crate::splines::spline::ROUND_OFF;

pub(super) fn check(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    for (i, boundary) in scene.boundaries.iter().enumerate() {
        let key = format!("boundary.{i}");
        if boundary.fix == [false, false] {
            let remedy =
                "give fix = [\"x\"], [\"y\"] or [\"x\", \"y\"], or remove the boundary (a free side needs none)";
            findings.error(format!("{key}.fix"), "nothing is fixed", remedy);
        }
        motion(&key, &boundary.prescribed, boundary.fix, scene, findings);
        supported(&key, boundary, scene, findings);
        if ground.is_sound && part(&key, boundary, &scene.mesh, findings) {
            held(&format!("{key}.side"), boundary, scene, findings);
        }
        let here = Held::on_side(i, boundary, &scene.mesh);
        for (j, other) in scene.boundaries[..i].iter().enumerate().filter(|_| ground.is_sound) {
            let join = boundary.side.along() != other.side.along();
            here.compare(&Held::on_side(j, other, &scene.mesh), join, &key, findings);
        }
    }
    names(scene, findings);
}

fn word(prescribed: &Prescribed) -> &'static str {
    if prescribed.is_displacement() { "displacement" } else { "velocity" }
}

/// What a condition prescribes of some components.
pub(super) fn motion(key: &str, prescribed: &Prescribed, fix: [bool; 2], scene: &Scene, findings: &mut Findings) {
    let (word, value) = (word(prescribed), prescribed.value());
    findings.finite(format!("{key}.{word}"), &value);
    time::check(key, &prescribed.time, scene.analysis.end_time, findings);
    without_jump(key, prescribed, fix, scene.equilibrium, findings);
    for d in (0..2).filter(|&d| !fix[d] && value[d] != 0.0) {
        let name = ["x", "y"][d];
        let message = format!("the {name} {word} has no effect, because {name} is not in fix");
        findings.warn(format!("{key}.{word}"), message);
    }
}

/// A displacement that jumps, at the start or where it ends, gives the body an energy that depends on the
/// mesh and is no work.
fn without_jump(key: &str, prescribed: &Prescribed, fix: [bool; 2], equilibrium: bool, findings: &mut Findings) {
    if !prescribed.is_displacement() {
        return;
    }
    if prescribed.time.until.is_some() {
        let message = "a displacement with an end would jump back to zero there";
        findings.error(format!("{key}.time.until"), message, "remove until, or give a table that ends at 0");
    }
    let first = prescribed.time.value(0.0);
    if !equilibrium && (0..2).any(|d| fix[d] && first * prescribed.value()[d] != 0.0) {
        let message = format!("the displacement jumps from 0 to {first} times its value at t = 0");
        let remedy = "let its factor rise from 0, such as time = { smooth = \"1 us\" }, or solve for the start: \
                      [start] equilibrium = true";
        findings.error(format!("{key}.displacement"), message, remedy);
    }
}

/// What the consistent mass does not have.
fn supported(key: &str, boundary: &Boundary, scene: &Scene, findings: &mut Findings) {
    let prescribed = &boundary.prescribed;
    let varying = [("displacement", prescribed.is_displacement()), ("time", !prescribed.time.is_constant())];
    for (word, _) in varying.into_iter().filter(|(_, given)| *given && scene.analysis.mass == Mass::Consistent) {
        let message = "a boundary whose velocity changes, with the consistent mass, is not implemented";
        findings.error(format!("{key}.{word}"), message, "use mass = \"lumped\"");
    }
}

/// Whether the part of a side is sound: in order, on the side, of a rectangle.
fn part(key: &str, boundary: &Boundary, mesh: &Mesh, findings: &mut Findings) -> bool {
    let Some([from, to]) = boundary.part else { return true };
    if mesh.geometry.is_some() {
        let message = "a part of a side of a mesh with control_points or annulus, which is not implemented";
        findings.error(format!("{key}.from"), message, "remove from and to");
        return false;
    }
    let d = boundary.side.along();
    let (origin, end) = (mesh.origin()[d], mesh.end()[d]);
    let tolerance = TOLERANCE * (end - origin);
    let (side, name) = (side_name(boundary.side), ["x", "y"][d]);
    if from >= to || !(to - from).is_finite() {
        let message = format!("the part of the {side} side goes from {name} = {from} m to {to} m");
        findings.error(format!("{key}.to"), message, "give the smaller one as from");
        return false;
    }
    if from < origin - tolerance || to > end + tolerance {
        let message = format!("the part leaves the {side} side, which goes from {name} = {origin} m to {end} m");
        let key = format!("{key}.{}", if from < origin - tolerance { "from" } else { "to" });
        findings.error(key, message, "give ends on the side");
        return false;
    }
    true
}

/// Names of conditions are parts of columns.
fn names(scene: &Scene, findings: &mut Findings) {
    let sides = scene.boundaries.iter().enumerate().map(|(i, b)| (format!("boundary.{i}"), &b.name));
    let edges = scene.bodies.iter().enumerate().flat_map(|(i, body)| {
        let conditions = body.conditions.iter().enumerate();
        conditions.map(move |(j, condition)| (format!("body.{i}.condition.{j}"), &condition.name))
    });
    let named = sides.chain(edges).filter_map(|(key, name)| Some((key, column_name(name.as_ref()?))));
    let named: Vec<_> = named.collect();
    for (n, (key, name)) in named.iter().enumerate() {
        let of_name = format!("{key}.name");
        if name.is_empty() {
            findings.error(of_name, "an empty name", "name the condition, such as name = \"impactor\"");
        } else if let Some((other, _)) = named[..n].iter().find(|(_, other)| other == name) {
            let message = format!("the columns work_{name}_j would be those of {other} too");
            findings.error(of_name, message, "give the conditions names that differ in letters or digits");
        }
    }
}

/// A warning unless a body reaches the side of a boundary.
fn held(key: &str, boundary: &Boundary, scene: &Scene, findings: &mut Findings) {
    if scene.mesh.geometry.is_some() {
        return; // the sides of the patch are not those of the box around it
    }
    let patch = (scene.analysis.frame == Frame::Updated).then(|| Patch::new(&scene.mesh));
    let is_held = |body: &Body| match &patch {
        Some(patch) => lies_on(patch, body, boundary),
        None => scene.mesh.is_reached(boundary.side, &body.shape),
    };
    if !scene.bodies.iter().any(is_held) {
        let message = format!(
            "no body lies on the {} side of the mesh at t = 0, so nothing is held there; a [[body.condition]] holds an \
             edge wherever it is",
            side_name(boundary.side)
        );
        findings.warn(key, message);
    }
}
