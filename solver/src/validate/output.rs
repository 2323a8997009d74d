//! Checks of what is recorded: samples, frames, probes, bodies, J-integrals.

use super::geometry::defect;
use super::ground::{Findings, Ground, TOLERANCE};
use crate::dynamics::body_sample::column_name;
use crate::dynamics::total_frame::domain::{Domain, column};
use crate::linear_algebra::extremes::larger;
use crate::scene::{Body, Frame, JIntegral, Kinematics, Scene};
use crate::splines::patch::Patch;

/// Most bodies whose columns are recorded.
const MOST_RECORDED: usize = 64;
/// Least radius of the domain of a J-integral, in spans.
const LEAST_SPANS: f64 = 4.0;

pub(super) fn check(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    let (output, end) = (&scene.output, scene.analysis.end_time);
    if output.samples == 0 {
        findings.error("output.samples", "no samples", "give at least 1");
    }
    for (i, time) in output.frames.iter().enumerate() {
        if !(*time >= 0.0 && *time <= end * (1.0 + 1e-9)) {
            let message = format!("a frame at {time:e} s is outside the simulated time, 0 to {end:e} s");
            findings.error(format!("output.frames.{i}"), message, "remove it, or raise analysis.end_time");
        }
    }
    if output.bodies {
        recorded_bodies(scene, findings);
    }
    if output.fragments && !counts_fragments(scene) {
        let message = "only the cracks of a body in the total frame divide it into parts that are counted here";
        findings.error("output.fragments", message, "use frame = \"total\" and a fracture table, or contact.fragments");
    }
    probes(scene, ground, findings);
    for (i, integral) in scene.output.j_integrals.iter().enumerate() {
        j_integral(i, integral, scene, ground, findings);
    }
}

/// A J-integral knows its tip and direction, and its domain lies in the body.
fn j_integral(i: usize, integral: &JIntegral, scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    let key = format!("output.j_integral.{i}");
    if scene.analysis.frame == Frame::Updated
        || scene.analysis.kinematics == Kinematics::Finite
        || scene.mesh.geometry.is_some()
    {
        let message = "a J-integral is implemented for small strains in the total frame, on a rectangular mesh";
        findings.error(
            &key,
            message,
            "remove it, or use frame = \"total\", kinematics = \"small\" and a mesh of size and cells",
        );
    }
    if let Some(j) = (0..i).find(|&j| column(&scene.output.j_integrals[j]) == column(integral)) {
        let message = format!("the column {} would be that of output.j_integral.{j} too", column(integral));
        findings.error(format!("{key}.name"), message, "give them names that differ in letters or digits");
    }
    let places = integral.at.into_iter().flatten().chain(integral.angle);
    let is_sound = findings.positive(format!("{key}.radius"), integral.radius, "radius = \"5 mm\"")
        && findings.finite(&key, &places.collect::<Vec<_>>());
    let Some(body) = scene.bodies.first().filter(|_| is_sound) else { return };
    let Some((tip, _)) = integral.tip_and_axis(body) else {
        let remedy = "give at = [x, y] and angle = 0.0 (degrees), or a [[body.crack]]";
        return findings.error(key, "neither it nor a crack says where the tip is and where the crack goes", remedy);
    };
    let fracture = scene.materials.get(&body.material).and_then(|material| material.fracture.as_ref());
    filled(&key, integral, tip, (scene, body, fracture.is_some()), ground, findings);
    let span = |d: usize| {
        let space = &ground.spaces.as_ref()?[d];
        space.find_span(tip[d]).map(|span| space.spans()[span].length())
    };
    let span = (0..2).filter_map(span).fold(0.0, larger);
    if integral.radius < LEAST_SPANS * span * (1.0 - TOLERANCE) {
        let message = format!("a radius of {:.2} cells", integral.radius / span);
        let remedy = format!("give at least {LEAST_SPANS} cells, {:.4e} m, or use smaller cells", LEAST_SPANS * span);
        findings.error(format!("{key}.radius"), message, remedy);
    }
    if let Some(l0) = fracture.map(|fracture| fracture.length_scale).filter(|l0| integral.radius < 8.0 * l0) {
        let message = format!("half of the radius is less than 4 l0 = {} m: the process zone counts in part", 4.0 * l0);
        findings.warn(format!("{key}.radius"), message);
    }
}

/// The body fills the domain; about a tip that runs it may do so later.
fn filled(
    key: &str,
    integral: &JIntegral,
    tip: [f64; 2],
    (scene, body, fractures): (&Scene, &Body, bool),
    ground: &Ground<'_>,
    findings: &mut Findings,
) {
    if !ground.is_sound || ground.patch.is_some() || defect(&body.shape).is_some() {
        return;
    }
    let domains = Domain::all(&Patch::new(&scene.mesh), body, std::slice::from_ref(integral));
    if domains.iter().all(|domain| domain.is_filled(tip, &body.shape)) {
        return;
    }
    let key = format!("{key}.radius");
    let message =
        format!("the boundary of the body or another crack enters the circle about the tip ({}, {}) m", tip[0], tip[1]);
    if fractures && integral.at.is_none() {
        findings.warn(key, format!("{message}: J is not a number until the tip is a radius away from it"));
    } else {
        findings.error(key, message, "give a smaller radius; the last point of the crack is its tip");
    }
}

/// A body of the total frame may fall into parts.
fn counts_fragments(scene: &Scene) -> bool {
    let is_brittle =
        |body: &Body| scene.materials.get(&body.material).is_some_and(|material| material.fracture.is_some());
    scene.analysis.frame == Frame::Total && scene.bodies.iter().any(is_brittle)
}

/// Probes lie in a body and on the patch, under names that differ as columns.
fn probes(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    let probes = &scene.output.probes;
    let on_patch = |at| ground.patch.as_ref().is_none_or(|patch| patch.locate(at, None).is_ok());
    for (i, probe) in probes.iter().enumerate() {
        let key = format!("output.probe.{i}");
        if scene.analysis.frame == Frame::Updated {
            let message = "a probe in the updated frame, which is not implemented";
            findings.error(&key, message, "remove it, or use frame = \"total\"");
        }
        let [x, y] = probe.at;
        if findings.finite(format!("{key}.at"), &probe.at)
            && !(on_patch(probe.at) && scene.bodies.iter().any(|body| body.shape.contains_within(probe.at, TOLERANCE)))
        {
            findings.error(format!("{key}.at"), format!("({x}, {y}) m lies in no body"), "give a place in a body");
        }
        if let Some(j) = (0..i).find(|&j| column_name(&probes[j].name) == column_name(&probe.name)) {
            let message = format!("the column {}_ux_m would be that of output.probe.{j} too", column_name(&probe.name));
            findings.error(format!("{key}.name"), message, "give the probes names that differ in letters or digits");
        }
    }
}

/// Bodies can be recorded one by one, under names that differ as columns.
fn recorded_bodies(scene: &Scene, findings: &mut Findings) {
    if scene.bodies.len() > MOST_RECORDED {
        let message = format!("{} bodies; at most {MOST_RECORDED} are recorded one by one", scene.bodies.len());
        findings.error("output.bodies", message, "remove it");
    }
    let mut names: Vec<String> = scene.bodies.iter().map(|body| column_name(&body.name)).collect();
    names.sort_unstable();
    if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        let message = format!("two bodies would have the columns {}_x_m", twice[0]);
        findings.error("output.bodies", message, "give the bodies names that differ in letters or digits");
    }
}
