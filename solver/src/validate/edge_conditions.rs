//! Checks of the conditions on edges of a body.

use super::conditions::motion;
use super::findings::Findings;
use super::look::Look;
use super::tractions;
use crate::dynamics::surface::curve_of;
use crate::scene::edges::BoundaryEdge;
use crate::scene::{Body, Boundary, Edge, EdgeCondition, Frame, Hold, Mass, Mesh, Scene, Shape, Side};

/// Distance within which two edges are one, of the size of an edge.
const NEAR: f64 = 1e-9;

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
        if let Some(i) = (0..j).find(|&i| prescribe_the_same([condition, &body.conditions[i]], body)) {
            let message = format!("this motion is prescribed on a part of this edge by condition.{i} too");
            findings.error(format!("{key}.fix"), message, "remove one of the two");
        }
        for (i, boundary) in scene.boundaries.iter().enumerate() {
            let side = EdgeCondition {
                edge: part_of_side(boundary, &scene.mesh),
                hold: Hold::Components(boundary.fix),
                ..condition.clone()
            };
            if prescribe_the_same([condition, &side], body) {
                let message = format!("this motion is prescribed on a part of this edge by boundary.{i} too");
                findings.error(format!("{key}.fix"), message, "remove one of the two");
            }
        }
    }
}

/// The part of a side of the mesh on which a condition acts.
fn part_of_side(boundary: &Boundary, mesh: &Mesh) -> Edge {
    let (min, max) = (mesh.origin(), mesh.end());
    let [mut a, mut b] = Shape::Rectangle { min, max }.side(boundary.side).unwrap_or_default();
    if let Some([from, to]) = boundary.part {
        let along = usize::from(matches!(boundary.side, Side::Left | Side::Right));
        (a[along], b[along]) = (from, to);
    }
    Edge::Segment([a, b])
}

/// What the updated frame, patches and the consistent mass do not have.
fn supported(key: &str, scene: &Scene, look: &Look<'_>, findings: &mut Findings) -> bool {
    let (message, remedy) = if look.body.rigid {
        ("a condition on a rigid body, which moves with its velocity", "remove the condition, or rigid = true")
    } else if scene.analysis.frame == Frame::Updated {
        (
            "a condition on a body in the updated frame, which is not implemented",
            "use frame = \"total\", or a rigid body that pushes",
        )
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

/// Whether two conditions prescribe a component on a part that their edges share.
fn prescribe_the_same(pair: [&EdgeCondition; 2], body: &Body) -> bool {
    let shared = match pair.map(|condition| condition.hold) {
        [Hold::Components(a), Hold::Components(b)] => (0..2).any(|d| a[d] && b[d]),
        _ => true,
    };
    shared && [[pair[0], pair[1]], [pair[1], pair[0]]].iter().any(|[a, b]| overlap(&a.edge, &b.edge, body))
}

/// Whether two edges share more than places.
fn overlap(edge: &Edge, other: &Edge, body: &Body) -> bool {
    let ((curve, [from, to]), other) = (curve_of(body, edge), curve_of(body, other));
    let ends = other.1.map(|end| place_on(&curve, from, other.0.at(end).0));
    let mut places: Vec<f64> = ends.into_iter().filter(|s| (from..=to).contains(s)).chain([from, to]).collect();
    places.sort_by(f64::total_cmp);
    let parts = places.windows(2).filter(|pair| pair[1] - pair[0] > NEAR * (to - from));
    parts.into_iter().any(|pair| lies_on(curve.at(0.5 * (pair[0] + pair[1])).0, &other))
}

/// Where a position (m) is on a curve, from one of its places on.
fn place_on(curve: &BoundaryEdge, from: f64, position: [f64; 2]) -> f64 {
    let place = curve.place_of(position);
    if let BoundaryEdge::Circle { .. } = curve { place + (from - place).ceil() } else { place }
}

/// Whether a position (m) is on a part of a curve.
fn lies_on(position: [f64; 2], (curve, [from, to]): &(BoundaryEdge, [f64; 2])) -> bool {
    let place = place_on(curve, *from, position);
    let [x, y] = curve.at(place).0;
    (*from..=*to).contains(&place) && (position[0] - x).hypot(position[1] - y) <= NEAR * curve.length()
}
