//! Checks of times, step, solver, boundaries and output.

use super::Findings;
use crate::scene::{Frame, Scene, Side, TimeStep, Transfer};

pub(super) fn check(scene: &Scene, findings: &mut Findings) {
    let analysis = &scene.analysis;
    findings.positive("analysis.thickness", analysis.thickness, "thickness = 1.0 (m)");
    findings.positive("analysis.end_time", analysis.end_time, "end_time = \"80 us\"");
    if let TimeStep::Fixed(step) = analysis.time_step {
        findings.positive("analysis.time_step", step, "time_step = \"10 ns\", or \"auto\"");
    }
    if !(analysis.safety > 0.0 && analysis.safety <= 1.0) {
        let message = format!("{} is no fraction of the critical step", analysis.safety);
        findings.error("analysis.safety", message, "give a number above 0 and at most 1, such as 0.8");
    }
    findings.finite("analysis.gravity", &analysis.gravity);
    if analysis.frame == Frame::Total && analysis.transfer != Transfer::Flip {
        let message = "has no effect with frame = \"total\", where the grid keeps its velocity; remove it, or use \
                       frame = \"updated\"";
        findings.warn("analysis.transfer", message);
    }
    solver(scene, findings);
    boundaries(scene, findings);
    output(scene, findings);
    if let Some(contact) = &scene.contact
        && !(contact.friction >= 0.0 && contact.friction.is_finite())
    {
        let message = format!("a friction coefficient of {}", contact.friction);
        findings.error("contact.friction", message, "give a coefficient of 0 or more");
    }
}

fn solver(scene: &Scene, findings: &mut Findings) {
    let tolerance = scene.solver.phase_field_tolerance;
    if !(tolerance > 1e-15 && tolerance <= 1e-2) {
        let message = format!("a relative residual of {tolerance:e} is outside (1e-15, 1e-2]");
        findings.error("solver.phase_field_tolerance", message, "give a number such as 1e-8");
    }
}

fn boundaries(scene: &Scene, findings: &mut Findings) {
    for (i, boundary) in scene.boundaries.iter().enumerate() {
        let key = format!("boundary.{i}");
        if boundary.fix == [false, false] {
            let remedy =
                "give fix = [\"x\"], [\"y\"] or [\"x\", \"y\"], or remove the boundary (a free side needs none)";
            findings.error(format!("{key}.fix"), "nothing is fixed", remedy);
        }
        findings.finite(format!("{key}.velocity"), &boundary.velocity);
        for d in 0..2 {
            let name = ["x", "y"][d];
            let twice = |other: usize| scene.boundaries[other].side == boundary.side && scene.boundaries[other].fix[d];
            if let Some(other) = (0..i).find(|other| boundary.fix[d] && twice(*other)) {
                let side = side_name(boundary.side);
                let message = format!("{name} is already fixed on the {side} side by boundary.{other}");
                findings.error(format!("{key}.fix"), message, "remove one of the two");
            }
            if !boundary.fix[d] && boundary.velocity[d] != 0.0 {
                let message = format!("the {name} velocity has no effect, because {name} is not in fix");
                findings.warn(format!("{key}.velocity"), message);
            }
        }
    }
}

pub(super) fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
        Side::Bottom => "bottom",
        Side::Top => "top",
    }
}

fn output(scene: &Scene, findings: &mut Findings) {
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
}
