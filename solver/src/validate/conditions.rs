//! Checks of the conditions on the sides of the mesh and on edges of bodies: their names and motions, and
//! what they prescribe, compared with each other.

use super::ground::{Findings, Ground, Look, TOLERANCE, side_name};
use super::tractions;
use crate::dynamics::body_sample::column_name;
use crate::dynamics::surface::curve_of;
use crate::dynamics::updated_frame::held_sides::lies_on;
use crate::scene::edges::BoundaryEdge;
use crate::scene::{Body, Boundary, EdgeCondition, Frame, Hold, Mass, Mesh, Prescribed, Scene, Shape};
use crate::splines::patch::Patch;

/// Distance within which two places are one, of the size of an edge.
const NEAR: f64 = 1e-9;

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
fn motion(key: &str, prescribed: &Prescribed, fix: [bool; 2], scene: &Scene, findings: &mut Findings) {
    let (word, value) = (word(prescribed), prescribed.value());
    findings.finite(format!("{key}.{word}"), &value);
    tractions::factor(&format!("{key}.time"), &prescribed.time, scene.analysis.end_time, findings);
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

/// Checks the conditions on the edges of a body.
pub(super) fn check_edges(key: &str, scene: &Scene, look: &Look<'_>, findings: &mut Findings) {
    let body = look.body;
    for (j, condition) in body.conditions.iter().enumerate() {
        let key = format!("{key}.condition.{j}");
        if !has_edges(&key, scene, look, findings) {
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
fn has_edges(key: &str, scene: &Scene, look: &Look<'_>, findings: &mut Findings) -> bool {
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

/// What is prescribed on a part of a curve, and by whom.
pub(super) struct Held<'a> {
    who: String,
    curve: BoundaryEdge,
    part: [f64; 2],
    hold: Hold,
    prescribed: &'a Prescribed,
}

impl<'a> Held<'a> {
    pub(super) fn on_edge(
        i: usize,
        EdgeCondition { edge, hold, prescribed, .. }: &'a EdgeCondition,
        body: &Body,
    ) -> Self {
        let (curve, part) = curve_of(body, edge);
        Self { who: format!("condition.{i}"), curve, part, hold: *hold, prescribed }
    }

    pub(super) fn on_side(i: usize, boundary: &'a Boundary, mesh: &Mesh) -> Self {
        let (min, max) = (mesh.origin(), mesh.end());
        let [mut a, mut b] = Shape::Rectangle { min, max }.side(boundary.side).unwrap_or_default();
        if let Some([from, to]) = boundary.part {
            let along = boundary.side.along();
            (a[along], b[along]) = (from, to);
        }
        Self {
            who: format!("boundary.{i}"),
            curve: BoundaryEdge::Line([a, b]),
            part: [0.0, 1.0],
            hold: Hold::Components(boundary.fix),
            prescribed: &boundary.prescribed,
        }
    }

    /// An error of the key if both prescribe the same component on a part, or, where they `join`, other
    /// motions of the place where they meet.
    pub(super) fn compare(&self, other: &Self, join: bool, key: &str, findings: &mut Findings) {
        if self.shares_component_with(other) && (self.overlaps(other) || other.overlaps(self)) {
            let message = format!("this motion is prescribed on a part of this edge by {} too", other.who);
            findings.error(format!("{key}.fix"), message, "remove one of the two");
        } else if let (Some(d), true) = (self.contradicts(other), join && (self.meets(other) || other.meets(self))) {
            let message = format!("{} prescribes another motion in {} where this edge ends", other.who, ["x", "y"][d]);
            let remedy = "give both the same motion, or leave a gap of a cell between them";
            findings.error(format!("{key}.fix"), message, remedy);
        }
    }

    fn shares_component_with(&self, other: &Self) -> bool {
        match [self.hold, other.hold] {
            [Hold::Components(a), Hold::Components(b)] => (0..2).any(|d| a[d] && b[d]),
            _ => true,
        }
    }

    /// A component to which both give different motions.
    fn contradicts(&self, other: &Self) -> Option<usize> {
        let [Hold::Components(a), Hold::Components(b)] = [self.hold, other.hold] else { return None };
        (0..2).find(|&d| a[d] && b[d] && self.prescribed.course(d) != other.prescribed.course(d))
    }

    /// Whether an end of it is on the other.
    fn meets(&self, other: &Self) -> bool {
        self.part.iter().any(|end| other.holds(self.curve.at(*end).0))
    }

    /// Whether more than places of it are on the other.
    fn overlaps(&self, other: &Self) -> bool {
        let [from, to] = self.part;
        let ends = other.part.map(|end| self.curve.place_of(other.curve.at(end).0));
        let ends = ends.into_iter().map(|place| self.curve.place_after(from, place));
        let mut places: Vec<f64> = ends.filter(|s| (from..=to).contains(s)).chain([from, to]).collect();
        places.sort_by(f64::total_cmp);
        let mut parts = places.windows(2).filter(|pair| pair[1] - pair[0] > NEAR * (to - from));
        parts.any(|pair| other.holds(self.curve.at(0.5 * (pair[0] + pair[1])).0))
    }

    /// Whether a position (m) is on it.
    fn holds(&self, position: [f64; 2]) -> bool {
        let [from, to] = self.part;
        let place = self.curve.place_after(from, self.curve.place_of(position));
        let [x, y] = self.curve.at(place).0;
        (from - NEAR..=to + NEAR).contains(&place)
            && (position[0] - x).hypot(position[1] - y) <= NEAR * self.curve.length()
    }
}
