//! Checks of bodies: shape, place in the mesh, points, resolution of the length scale, tractions, cracks.

use super::geometry::{covered_side, cut_nowhere, defect, narrow_gap, outline};
use super::ground::{Findings, Ground, Look, TOLERANCE};
use super::points::Points;
use super::{conditions, cracks, mesh, tractions};
use crate::particles::lattice::cuts_spans;
use crate::scene::{Body, CrackModel, Fracture, Frame, Kinematics, Layout, Mesh, Scene, Shape};
use crate::splines::nurbs::{LocateError, NurbsPatch};
use crate::splines::quadrature::MAX_POINTS;

/// Most points of the Maclaurin rule.
const MOST_MACLAURIN: usize = 5;

pub(super) fn check(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    if scene.bodies.is_empty() {
        findings.error("body", "there is no body", "add a [[body]]; without a shape it fills the mesh");
    }
    for (i, body) in scene.bodies.iter().enumerate() {
        let key = format!("body.{i}");
        if scene.bodies[..i].iter().any(|other| other.name == body.name) {
            findings.error(format!("{key}.name"), format!("a second body named {:?}", body.name), "give each its name");
        }
        findings.finite(format!("{key}.velocity"), &body.velocity);
        findings.finite(format!("{key}.angular_velocity"), &[body.angular_velocity]);
        let gradient = format!("{key}.velocity_gradient");
        if findings.finite(gradient.clone(), &body.velocity_gradient.concat())
            && body.rigid
            && body.velocity_gradient != [[0.0; 2]; 2]
        {
            findings.error(gradient, "a rigid body that stretches", "remove it, or the key rigid");
        }
        if !body.rigid && !body.time.is_constant() {
            let message = "time is a factor of the velocity of a rigid body; this one moves freely";
            findings.error(
                format!("{key}.time"),
                message,
                "add rigid = true, or give the time of a load or a condition",
            );
        }
        points(&key, body, scene, findings);
        let fracture = material(&key, body, scene, findings);
        if let Some((message, remedy)) = defect(&body.shape) {
            findings.error(format!("{key}.shape"), message, remedy);
            continue;
        }
        if let Some(hole) = cut_nowhere(&body.shape) {
            let (min, max) = hole.bounding_box();
            let message =
                format!("a shape from {min:?} m to {max:?} m that is cut out does not reach the shape it is cut from");
            findings.warn(format!("{key}.shape"), message);
        }
        let placed = ground.is_sound && !body.rigid && inside_mesh(&key, body, ground, findings);
        match scene.analysis.frame {
            Frame::Total if placed => cut_spans(&key, body, ground, findings),
            Frame::Updated if placed => gaps(&key, body, &scene.mesh.degree, ground, findings),
            _ => {}
        }
        let before = findings.errors.len();
        if placed && let Some(fracture) = fracture {
            mesh::check_resolution(body, fracture, ground, findings);
        }
        let look = Look::new(body, ground, &scene.analysis);
        for (j, traction) in body.tractions.iter().enumerate() {
            tractions::check(&format!("{key}.traction.{j}"), traction, &look, findings);
        }
        conditions::check_edges(&key, scene, &look, findings);
        for (j, crack) in body.cracks.iter().enumerate() {
            if crack.is_slit() {
                cracks::slit(&format!("{key}.crack.{j}"), crack, scene, ground, findings);
            }
            cracks::check(&format!("{key}.crack.{j}"), crack, scene.materials.get(&body.material), &look, findings);
        }
        if placed && (0..2).all(|d| has_rule(body, d)) {
            let fracture = fracture.filter(|_| findings.errors.len() == before);
            material_points(&key, body, fracture, ground, findings);
        }
    }
}

/// The body has material points, and the seeds of its cracks, if they are sound, reach them.
fn material_points(key: &str, body: &Body, fracture: Option<&Fracture>, ground: &Ground<'_>, findings: &mut Findings) {
    let has_cut_spans = ground.patch.is_none(); // with points of their own
    let points = Points::new(body, ground).filter(|points| !has_cut_spans || points.exist());
    let Some(points) = points else {
        let seeds = (0..body.cracks.len()).filter(|_| fracture.is_some());
        return seeds.for_each(|j| cracks::unchecked(format!("{key}.crack.{j}"), findings));
    };
    let [_, h] = ground.span_lengths(&body.shape);
    if !points.exist() {
        let message = format!("no material point lies in body {:?}: its cells are up to {h:.3e} m wide", body.name);
        let remedy = "use smaller cells or more particles_per_cell, or make the body larger";
        findings.error(format!("{key}.shape"), message, remedy);
    } else if let Some(fracture) = fracture.filter(|fracture| fracture.model == CrackModel::At2) {
        cracks::seeds(key, body, fracture, &points, h, findings);
    }
}

/// Functions of the updated frame reach across gaps and join their sides.
fn gaps(key: &str, body: &Body, degree: &[usize; 2], ground: &Ground<'_>, findings: &mut Findings) {
    let [_, h] = ground.span_lengths(&body.shape);
    let cells = (degree[0].max(degree[1]) + 1) as f64;
    if let Some(([x, y], width)) = narrow_gap(&body.shape, cells * h) {
        let message = format!(
            "a gap or hole of body {:?} is narrower than {cells} cells: {width:.2e} m beside ({x:.4e}, {y:.4e}) m; in the \
             updated frame functions reach across it and join its sides; use frame = \"total\" or smaller cells",
            body.name
        );
        findings.warn(format!("{key}.shape"), message);
    }
}

/// Bilinear functions of a small part of a span shorten the step, down to a twenty-fifth.
fn cut_spans(key: &str, body: &Body, ground: &Ground<'_>, findings: &mut Findings) {
    let Some(spaces) = ground.spaces.as_ref().filter(|_| ground.patch.is_none()) else { return };
    if spaces.iter().any(|space| space.degree() == 1) && cuts_spans(body, spaces) {
        let message = format!(
            "the boundary or a slit of body {:?} cuts cells, which needs splines of degree 2 or higher",
            body.name
        );
        findings.error(
            format!("{key}.shape"),
            message,
            "use mesh.degree = 2, or put its edges and slits on the edges of cells",
        );
    }
}

/// Whether the layout of a body has a rule of its number of points in a direction.
pub(super) fn has_rule(body: &Body, d: usize) -> bool {
    let most = if body.layout == Layout::Maclaurin { MOST_MACLAURIN } else { MAX_POINTS };
    (1..=most).contains(&body.particles_per_cell[d])
}

fn points(key: &str, body: &Body, scene: &Scene, findings: &mut Findings) {
    let (counts, degree) = (body.particles_per_cell, scene.mesh.degree);
    let points = format!("{key}.particles_per_cell");
    if let Some(n) = counts.iter().find(|n| **n == 0 || **n > MAX_POINTS) {
        findings.error(points, format!("{n} points per cell and direction"), format!("give 1 to {MAX_POINTS}"));
    } else if body.layout == Layout::Maclaurin && counts.iter().any(|n| *n > MOST_MACLAURIN) {
        let message = format!("the maclaurin layout has no rule of {} points", counts[0].max(counts[1]));
        let remedy = "give at most 5 particles_per_cell, or use layout = \"gauss\" or \"uniform\"";
        findings.error(format!("{key}.layout"), message, remedy);
    } else if (0..2).any(|d| counts[d] == 1 && degree[d] >= 2) {
        let message =
            "one point per cell leaves modes of a mesh of degree 2 and higher without stiffness; use at least 2";
        findings.warn(points, message);
    } else if scene.analysis.frame == Frame::Total && !body.rigid && (0..2).any(|d| weak(degree[d], counts[d], scene)) {
        let message = format!(
            "{counts:?} points per cell are fewer than the degree of the mesh, {degree:?}: a body that is pressed or hit \
             can collapse without resistance; use as many points as the degree, which is the default"
        );
        findings.warn(points, message);
    } else if !body.rigid && is_underdetermined(body, scene) {
        let message = format!(
            "{counts:?} points in a body of one cell leave some of its motions without stiffness; use [{}, {}], or smaller \
             cells",
            degree[0] + 1,
            degree[1] + 1
        );
        findings.warn(points, message);
    }
}

/// Whether a body of one cell has fewer strains at its points than its control points have motions, besides
/// those of a rigid body.
fn is_underdetermined(body: &Body, scene: &Scene) -> bool {
    let Mesh { degree: [p, q], geometry: None, knots, .. } = &scene.mesh else { return false };
    if knots[0].len() < 2 * (p + 1) || knots[1].len() < 2 * (q + 1) {
        return false; // said elsewhere
    }
    let around = scene.mesh.around(&body.shape).knots;
    let is_one_cell = around[0].len() == 2 * (p + 1) && around[1].len() == 2 * (q + 1);
    let strains = 3 * body.particles_per_cell.iter().product::<usize>();
    matches!(body.shape, Shape::Rectangle { .. }) && is_one_cell && strains < 2 * (p + 1) * (q + 1) - 3
}

/// Whether modes between so many points per span have hardly any stiffness. Cubic ones need a finite
/// compression to show.
fn weak(degree: usize, count: usize, scene: &Scene) -> bool {
    let sound = if scene.analysis.kinematics == Kinematics::Finite { 2 } else { 3 };
    degree > sound && count < degree
}

/// The fracture table of the body's material, if it has one that makes sense.
fn material<'a>(key: &str, body: &Body, scene: &'a Scene, findings: &mut Findings) -> Option<&'a Fracture> {
    let Some(material) = scene.materials.get(&body.material) else {
        let names: Vec<&str> = scene.materials.keys().map(String::as_str).collect();
        let remedy = match names.as_slice() {
            [] => format!("add a table [material.{}]", body.material),
            _ => format!("known materials: {}", names.join(", ")),
        };
        findings.error(format!("{key}.material"), format!("unknown material {:?}", body.material), remedy);
        return None;
    };
    if material.fracture.is_none() && body.cracks.iter().any(|crack| !crack.is_slit()) {
        let message =
            format!("a seeded crack needs the phase field, but material {:?} has no fracture table", body.material);
        let remedy = format!("add [material.{}.fracture], remove the crack, or give it as = \"slit\"", body.material);
        findings.error(format!("{key}.crack"), message, remedy);
    }
    material.fracture.as_ref().filter(|f| f.length_scale > 0.0)
}

fn inside_mesh(key: &str, body: &Body, ground: &Ground<'_>, findings: &mut Findings) -> bool {
    match (&body.shape, &ground.patch) {
        (Shape::Patch, Some(_)) => return true,
        (Shape::Patch, None) => {
            let remedy = "give the rectangle of the mesh: shape = { rectangle = { min = …, max = … } }";
            findings.error(format!("{key}.shape"), "the mesh is a rectangle without a geometry of its own", remedy);
            return false;
        }
        (shape, Some(patch)) => return inside_patch(key, shape, patch, findings),
        _ => {}
    }
    let (min, max) = body.shape.bounding_box();
    let (origin, end) = (ground.mesh.origin(), ground.mesh.end());
    let outside = |d: usize| {
        let tolerance = TOLERANCE * (end[d] - origin[d]);
        min[d] < origin[d] - tolerance || max[d] > end[d] + tolerance
    };
    let Some(d) = (0..2).find(|d| outside(*d)) else { return true };
    let name = ["x", "y"][d];
    let message = format!(
        "the body reaches from {name} = {} m to {} m, outside the mesh, {} m to {} m",
        min[d], max[d], origin[d], end[d]
    );
    findings.error(format!("{key}.shape"), message, "enlarge mesh.size, or move mesh.origin or the body");
    false
}

/// Whether a shape lies on a patch with a geometry: its outline does, and no side of the patch runs inside
/// it, as that of a hole would.
fn inside_patch(key: &str, shape: &Shape, patch: &NurbsPatch, findings: &mut Findings) -> bool {
    let tolerance = TOLERANCE * patch.size();
    let mut last = None;
    for point in outline(shape) {
        let found = patch.locate(point, last);
        last = found.as_ref().ok().map(|location| location.parameters).or(last);
        if let Err(LocateError::Outside { nearest: [x, y], distance, .. }) = found
            && distance > tolerance
        {
            let message = format!("the point ({}, {}) m of the body lies outside the patch", point[0], point[1]);
            let remedy = format!(
                "move or shrink the body (the patch begins {distance:.3e} m away, at ({x}, {y}) m), or use shape = \"patch\""
            );
            findings.error(format!("{key}.shape"), message, remedy);
            return false;
        }
    }
    if let Some([x, y]) = covered_side(shape, patch) {
        let message =
            format!("the body covers the side of the patch at ({x:.6e}, {y:.6e}) m, beyond which there is no mesh");
        let remedy = "move or shrink the body, cut the hole out of it, or use shape = \"patch\"";
        findings.error(format!("{key}.shape"), message, remedy);
        return false;
    }
    true
}
