//! Checks of several bodies, rigid bodies and contact.

use super::Findings;
use super::geometry::defect;
use crate::contact::Surface;
use crate::scene::{Body, Frame, Scene, Shape, Transfer};
use crate::spans::span_lengths;

/// Overlap of two bodies that is not one, in spans: circles are lines of short segments.
const TOLERANCE: f64 = 1e-3;

pub(super) fn check(scene: &Scene, mesh_is_sound: bool, findings: &mut Findings) {
    if !scene.bodies.is_empty() && scene.bodies.iter().all(|body| body.rigid) {
        findings.error("body", "every body is rigid: there is nothing to model", "add a body that is not rigid");
    }
    let several = scene.bodies.len() > 1 || scene.contact.is_some();
    if several && scene.analysis.frame == Frame::Total {
        let message = "several bodies, and contact, need shape functions at the moved positions";
        findings.error("analysis.frame", message, "use frame = \"updated\"");
    }
    if scene.contact.is_some() && scene.analysis.transfer == Transfer::Musl {
        let message = "contact with MUSL, whose points follow a filtered motion that contact does not hold back";
        findings.error("analysis.transfer", message, "use transfer = \"flip\" or \"apic\"");
    }
    for (i, body) in scene.bodies.iter().enumerate().filter(|(_, body)| body.rigid) {
        rigid(&format!("body.{i}"), body, scene, findings);
    }
    match scene.contact {
        Some(_) if scene.bodies.len() == 1 => findings.warn("contact", "there is only one body; remove the table"),
        Some(_) if mesh_is_sound => overlaps(scene, findings),
        _ => (),
    }
}

fn rigid(key: &str, body: &Body, scene: &Scene, findings: &mut Findings) {
    if scene.contact.is_none() {
        let remedy = "add a [contact] table, or remove the body";
        findings.error(format!("{key}.rigid"), "a rigid body does nothing without contact", remedy);
    }
    for (what, given) in [("traction", !body.tractions.is_empty()), ("crack", !body.cracks.is_empty())] {
        if given {
            let message = format!("a {what} has no effect on a rigid body");
            findings.error(format!("{key}.{what}"), message, "remove it, or the key rigid");
        }
    }
}

/// Bodies that overlap at t = 0: contact would have to push them apart, and that energy comes from nowhere.
fn overlaps(scene: &Scene, findings: &mut Findings) {
    if scene.bodies.iter().any(|body| defect(&body.shape).is_some() || body.particles_per_cell.contains(&0)) {
        return; // said elsewhere
    }
    let surfaces: Vec<Surface> = scene.bodies.iter().map(|body| Surface::new(&scene.mesh, body)).collect();
    for j in 1..surfaces.len() {
        for i in 0..j {
            let (a, b) = (&scene.bodies[i], &scene.bodies[j]);
            if a.rigid && b.rigid {
                continue;
            }
            let [h, _] = span_lengths(&scene.mesh, &a.shape);
            let deepest = depth(&surfaces[i], &surfaces[j], &b.shape).max(depth(&surfaces[j], &surfaces[i], &a.shape));
            if deepest > TOLERANCE * h {
                let message = format!("body {:?} overlaps body {:?} by {deepest:.3e} m at t = 0", b.name, a.name);
                findings.error(format!("body.{j}.shape"), message, "move the bodies apart until they touch at most");
            }
        }
    }
}

/// How far the segments of one boundary reach into the body inside another, m.
fn depth(one: &Surface, other: &Surface, inside: &Shape) -> f64 {
    let [low, high] = other.bounding_box();
    let all = other.segments_in([[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]]);
    let centers = one.segments_in([low, high]).into_iter().map(|segment| one.center(segment).position);
    let within = centers.filter(|position| inside.contains(*position));
    let nearest = within.filter_map(|position| other.nearest(position, &all, f64::INFINITY));
    nearest.map(|nearest| nearest.distance.abs()).fold(0.0, f64::max)
}
