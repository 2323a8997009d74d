//! Checks of times, step, solver and output, and how large a scene will be, before anything is made of it.

use super::ground::{Findings, Ground, TOLERANCE};
use super::material::plausible_speed;
use super::{output, tractions};
use crate::linear_algebra::extremes::larger;
use crate::scene::{Body, Contact, Frame, Mass, PhaseFieldInterval, Scene, Shape, TimeStep, Transfer};
use crate::splines::quadrature::Rule;
use crate::splines::spline::SplineSpace;

/// Most steps of a run.
pub(super) const MOST_STEPS: f64 = 1e9;

/// Steps of a run that is likely to have another unit in mind.
const MANY_STEPS: f64 = 1e7;

/// How many of the smallest cells waves cross in the shortest run without a warning.
const LEAST_CROSSED: f64 = 1.0;

/// Highest order of XPIC: each costs a transfer to the points and back per step.
const HIGHEST_XPIC: usize = 100;

/// Most material points of a scene; each takes 100 to 300 bytes.
const MOST_POINTS: usize = 500_000_000;

/// Memory of a process per material point in the total and in the updated frame, bytes: without a phase
/// field, and what that adds. Measured with 10⁶ points, p = 2 and 3, to 15 %.
const BYTES_OF_POINT: [[usize; 2]; 2] = [[20, 30], [170, 80]];

/// The same per control point: of the mechanics, and per pair of coupled functions of a phase field.
const BYTES_OF_CONTROL_POINT: usize = 200;
const BYTES_OF_COUPLING: usize = 21;

pub(super) fn check(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    let analysis = &scene.analysis;
    findings.positive("analysis.thickness", analysis.thickness, "thickness = 1.0 (m)");
    let mut sound = findings.positive("analysis.end_time", analysis.end_time, "end_time = \"80 us\"");
    if let TimeStep::Fixed(step) = analysis.time_step {
        sound &= findings.positive("analysis.time_step", step, "time_step = \"10 ns\", or \"auto\"");
    }
    if sound {
        steps(scene, ground, findings);
    }
    if !(analysis.safety > 0.0 && analysis.safety <= 1.0) {
        let message = format!("{} is no fraction of the critical step", analysis.safety);
        findings.error("analysis.safety", message, "give a number above 0 and at most 1, such as 0.8");
    }
    findings.finite("analysis.gravity", &analysis.gravity);
    tractions::factor("analysis.gravity_time", &analysis.gravity_time, analysis.end_time, findings);
    if analysis.gravity == [0.0; 2] && !analysis.gravity_time.is_constant() {
        findings.warn("analysis.gravity_time", "a factor of gravity, which is zero; add gravity, or remove the key");
    }
    if analysis.frame == Frame::Total && ![Transfer::Apic, Transfer::Flip].contains(&analysis.transfer) {
        let message = "has no effect with frame = \"total\", where the grid keeps its velocity; remove it, or use \
                       frame = \"updated\"";
        findings.warn("analysis.transfer", message);
    }
    if analysis.frame == Frame::Updated && scene.mesh.degree.contains(&1) {
        let message = "linear functions in the updated frame: forces jump where points cross spans, and runs gain energy or \
                       break down; use degree 2 or more";
        findings.warn("mesh.degree", message);
    }
    if analysis.mass == Mass::Consistent {
        consistent_mass(scene, ground, findings);
    }
    if let Transfer::Xpic(order) = analysis.transfer
        && !(1..=HIGHEST_XPIC).contains(&order)
    {
        let remedy = format!("give an order from 1 (which is pic) to {HIGHEST_XPIC}, such as 5");
        findings.error("analysis.transfer", format!("xpic of order {order}"), remedy);
    }
    solver(scene, findings);
    if scene.equilibrium && analysis.frame == Frame::Updated {
        let message = "a static start in the updated frame, which is not implemented";
        findings.error("start.equilibrium", message, "remove it, or use frame = \"total\"");
    }
    output::check(scene, ground, findings);
    if let Some(contact) = &scene.contact
        && !(contact.friction >= 0.0 && contact.friction.is_finite())
    {
        let message = format!("a friction coefficient of {}", contact.friction);
        findings.error("contact.friction", message, "give a coefficient of 0 or more");
    }
    if let Some(contact) = &scene.contact {
        stiffness(contact, findings);
    }
}

/// Boundaries that push each other apart have a stiffness.
fn stiffness(contact: &Contact, findings: &mut Findings) {
    if let Some(stiffness) = contact.stiffness
        && !(stiffness > 0.0 && stiffness.is_finite())
    {
        let remedy = format!("give a number above 0, such as {}", Contact::SOFT);
        let message = format!("boundaries with {stiffness} times the stiffness of a span");
        findings.error("contact.stiffness", message, remedy);
    }
}

/// The consistent mass needs the total frame, spans that no body cuts, and points that determine every
/// control value.
fn consistent_mass(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    let key = "analysis.mass";
    if scene.analysis.frame == Frame::Updated {
        let message = "the consistent mass with frame = \"updated\", where cut spans would collapse the critical step";
        return findings.error(key, message, "use mass = \"lumped\", or frame = \"total\"");
    }
    for body in scene.bodies.iter().take(1).filter(|_| ground.is_sound) {
        // the total frame has one
        let on_knots = |d: usize, x: f64| {
            let knots = &scene.mesh.knots[d];
            knots.iter().any(|k| (k - x).abs() <= TOLERANCE * (knots[knots.len() - 1] - knots[0]))
        };
        let uncut = match &body.shape {
            Shape::Patch => true,
            Shape::Rectangle { min, max } => {
                scene.mesh.geometry.is_none() && (0..2).all(|d| on_knots(d, min[d]) && on_knots(d, max[d]))
            }
            _ => false,
        };
        if !uncut {
            let message =
                format!("body {:?} cuts spans, which collapses the critical step of the consistent mass", body.name);
            findings.error(key, message, "let the body end at knots of the mesh, or use mass = \"lumped\"");
        }
        let (low, high) = match body.shape {
            Shape::Patch => Shape::Patch.bounding_box(),
            _ => scene.mesh.extent(&body.shape),
        };
        for d in (0..2).filter(|&d| super::body::has_rule(body, d)) {
            let space = SplineSpace::new(scene.mesh.degree[d], &scene.mesh.knots[d]);
            if !determined(&space, [low[d], high[d]], &Rule::new(body.layout, body.particles_per_cell[d])) {
                let n = body.particles_per_cell[d];
                let message =
                    format!("{n} points per cell in direction {} leave the mass matrix singular", ["x", "y"][d]);
                let remedy = format!("give {} particles_per_cell", scene.mesh.degree[d] + 1);
                findings.error(key, message, remedy);
            }
        }
    }
}

/// Whether the points of a rule in every span between two ends determine a spline there (Schoenberg and
/// Whitney): taken in order, each basis function has a point of its own inside its support.
fn determined(space: &SplineSpace, [from, to]: [f64; 2], rule: &Rule) -> bool {
    let spans: Vec<_> =
        space.spans().iter().filter(|s| 0.5 * (s.left + s.right) > from && 0.5 * (s.left + s.right) < to).collect();
    let (Some(first), Some(last)) = (spans.first(), spans.last()) else { return true };
    let (knots, order) = (space.knot_vector(), space.degree() + 1);
    let (mut next, end) = (first.first, last.first + order);
    for span in &spans {
        for t in &rule.points {
            let x = span.left + t * span.length();
            if next < end && knots[next] < x && x < knots[next + order] {
                next += 1;
            }
        }
    }
    next == end
}

/// Whether the run has a number of steps that can be taken: with a step of choice, one span per step is the
/// estimate.
fn steps(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    let end = scene.analysis.end_time;
    if let TimeStep::Fixed(step) = scene.analysis.time_step {
        let steps = end / step;
        if steps > MOST_STEPS {
            let message =
                format!("steps of {step:e} s to end_time = {end:e} s are {steps:.1e} steps, above {MOST_STEPS:e}");
            let remedy = "give a longer time_step, or \"auto\", or a shorter end_time";
            findings.error("analysis.time_step", message, remedy);
        }
    } else if ground.is_sound {
        let steps = scene.bodies.iter().filter_map(|body| crossings(body, scene, ground)).fold(0.0, larger);
        if steps > 0.0 && steps < LEAST_CROSSED && !scene.equilibrium {
            let message = "until then waves cross less than one cell; check the units of times and lengths (m)";
            findings.warn("analysis.end_time", message);
        }
        if steps > MOST_STEPS {
            let message = format!("{end:e} s are about {steps:.1e} steps of the smallest cell, above {MOST_STEPS:e}");
            findings.error("analysis.end_time", message, "give a shorter end_time with its unit, such as \"80 us\"");
        } else if steps > MANY_STEPS {
            let message = format!("{end:e} s are about {steps:.1e} steps of the smallest cell; check its unit");
            findings.warn("analysis.end_time", message);
        }
    }
}

/// How many times a dilatational wave crosses the smallest span under a body until the end; `None` without a
/// material that makes sense.
fn crossings(body: &Body, scene: &Scene, ground: &Ground<'_>) -> Option<f64> {
    let speed = plausible_speed(scene.materials.get(&body.material)?, scene.analysis.plane)?;
    let [smallest, _] = ground.span_lengths(&body.shape);
    Some(scene.analysis.end_time * speed / smallest)
}

fn solver(scene: &Scene, findings: &mut Findings) {
    let tolerance = scene.solver.phase_field_tolerance;
    if !(tolerance > 1e-15 && tolerance <= 1e-2) {
        let message = format!("an error of {tolerance:e} of the phase field is outside (1e-15, 1e-2]");
        findings.error("solver.phase_field_tolerance", message, "give a number such as 1e-8");
    }
    if scene.solver.phase_field_interval == PhaseFieldInterval::Steps(1) {
        return;
    }
    let breaks = || scene.materials.values().filter_map(|m| m.fracture.as_ref());
    if breaks().next().is_none() {
        findings.warn("solver.phase_field_interval", "has no effect where no material breaks; remove it");
    }
    let bounded = breaks().any(|fracture| fracture.model.has_threshold());
    if scene.analysis.frame == Frame::Updated || bounded {
        let message = "in the updated frame, and with at1 or pf-czm, the phase field is solved for in every step";
        findings.error("solver.phase_field_interval", message, "remove the key, or use at2 in the total frame");
    }
}

/// About how large the model of a scene will be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExpectedSize {
    /// Material points, if every span under the box around a body is full of them.
    pub points: usize,
    /// Control points of the mesh.
    pub control_points: usize,
    /// Memory of points and control points without what the phase field of the control points takes, bytes.
    pub mechanics_bytes: usize,
    /// Memory of the phase field of the control points, bytes.
    pub phase_field_bytes: usize,
}

/// Size of the model of a valid scene, to the points that lie outside a body in spans it cuts.
pub fn expected_size(scene: &Scene) -> ExpectedSize {
    let bodies = scene.bodies.iter().filter(|body| !body.rigid);
    let points = bodies.map(|body| points(body, scene)).fold(0, usize::saturating_add);
    let functions = |d: usize| scene.mesh.knots[d].len().saturating_sub(scene.mesh.degree[d] + 1);
    let control_points = functions(0).saturating_mul(functions(1));
    let fractures = scene.materials.values().any(|material| material.fracture.is_some());
    let [plain, added] = BYTES_OF_POINT[usize::from(scene.analysis.frame == Frame::Updated)];
    let of_point = if fractures { plain + added } else { plain };
    let mechanics_bytes =
        points.saturating_mul(of_point).saturating_add(control_points.saturating_mul(BYTES_OF_CONTROL_POINT));
    let couplings = scene.mesh.degree.iter().map(|p| 2 * p + 1).product::<usize>().div_ceil(2);
    let phase_field_bytes = if fractures { control_points.saturating_mul(couplings * BYTES_OF_COUPLING) } else { 0 };
    ExpectedSize { points, control_points, mechanics_bytes, phase_field_bytes }
}

/// More material points than a run can have.
pub(super) fn check_size(scene: &Scene, findings: &mut Findings) {
    let points = expected_size(scene).points;
    if points > MOST_POINTS {
        let remedy = format!("use larger cells or fewer particles_per_cell: at most {MOST_POINTS} points in all");
        findings.error("body", format!("bodies of about {points} points"), remedy);
    }
}

fn points(body: &Body, scene: &Scene) -> usize {
    let (from, to) = scene.mesh.extent(&body.shape);
    let along = |d: usize| {
        let spans = scene.mesh.knots[d].windows(2).filter(|k| k[1] > k[0]);
        let under = |k: &&[f64]| scene.mesh.geometry.is_some() || (k[1] > from[d] && k[0] < to[d]);
        spans.filter(under).count().saturating_mul(body.particles_per_cell[d])
    };
    along(0).saturating_mul(along(1))
}
