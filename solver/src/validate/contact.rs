//! Checks of several bodies, rigid bodies and contact.

use super::analysis::MOST_STEPS;
use super::geometry::{complexity, defect};
use super::ground::{Findings, Ground};
use super::tractions;
use crate::contact::Surface;
use crate::contact::motion::{longest_step, rigid_bodies_that_approach};
use crate::contact::outline::without_patch;
use crate::linear_algebra::extremes::larger;
use crate::particles::spans::smallest_span;
use crate::scene::edges::{bounding_parts, steps_along};
use crate::scene::{Body, Frame, Kinematics, Scene, Shape, TimeStep};

/// Overlap of two bodies that is not one, in spans: circles are lines of short segments.
const TOLERANCE: f64 = 1e-3;

/// Size of a rigid body, in spans, below which contact does not resolve it: discs of half a span in radius
/// and less turned what they struck the wrong way.
const SMALLEST: f64 = 1.5;

/// Steps, in spans, in which boundaries are looked at for an overlap.
const STEP: f64 = 0.25;

/// Most segments of boundaries times corners and circles of their shapes: a quarter of a second, half a GiB.
const MOST_WORK: f64 = 1e7;
/// Overlaps that are told, and most distances that are taken for each.
const MOST_OVERLAPS: usize = 10;
const MOST_DISTANCES: usize = 250_000;

pub(super) fn check(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    if !scene.bodies.is_empty() && scene.bodies.iter().all(|body| body.rigid) {
        findings.error("body", "every body is rigid: there is nothing to model", "add a body that is not rigid");
    }
    if scene.analysis.frame == Frame::Total && (scene.bodies.len() > 1 || scene.contact.is_some()) {
        in_the_total_frame(scene, findings);
    }
    if scene.contact.as_ref().is_some_and(|contact| contact.fragments) {
        fragments(scene, findings);
    }
    if scene.analysis.frame == Frame::Updated && scene.contact.as_ref().is_some_and(|contact| contact.self_contact) {
        let remedy = "use analysis.frame = \"total\" and kinematics = \"finite\", or remove the key";
        findings.error("contact.self_contact", "bodies meet themselves in the total frame only", remedy);
    }
    for (i, body) in scene.bodies.iter().enumerate().filter(|(_, body)| body.rigid) {
        rigid(&format!("body.{i}"), body, scene, findings);
    }
    match &scene.contact {
        Some(contact) if scene.bodies.len() == 1 && !contact.fragments && !contact.self_contact => {
            findings.warn("contact", "there is only one body, and it does not meet itself; add self_contact = true in the total frame, or remove the table");
        }
        Some(_) if ground.is_sound && overlaps(scene, ground, findings) => {
            speeds(scene, findings);
            if let Some([one, other]) = rigid_bodies_that_approach(scene) {
                findings.warn(
                    "contact",
                    format!("rigid bodies do not meet: {one:?} and {other:?} pass through each other"),
                );
            }
        }
        None if scene.bodies.len() > 1 => findings.warn(
            "contact",
            format!(
                "{} bodies and no [contact] table: they pass through each other; add [contact] with a friction, or \
                 keep them apart",
                scene.bodies.len()
            ),
        ),
        _ => (),
    }
}

/// What contact in the total frame lacks.
fn in_the_total_frame(scene: &Scene, findings: &mut Findings) {
    let updated = "use analysis.frame = \"updated\"";
    if scene.analysis.kinematics == Kinematics::Small {
        let message = "several bodies, and contact, in the total frame need finite strains: small ones do not move";
        findings.error("analysis.kinematics", message, "use kinematics = \"finite\"");
    }
    if scene.mesh.geometry.is_some() {
        let message = "several bodies, and contact, need a mesh over a rectangle";
        findings.error("mesh.geometry", message, "give the mesh origin, size and cells, and the body its shape");
    }
    if scene.equilibrium {
        let message = "several bodies, and contact, cannot start from an equilibrium";
        findings.error(
            "start.equilibrium",
            message,
            "remove it, and let loads grow over time, gravity by analysis.gravity_time",
        );
    }
    if scene.contact.as_ref().is_some_and(|contact| contact.fragments) {
        findings.error("contact.fragments", "bodies fall into fragments in the updated frame only", updated);
    }
}

/// Bodies that may fall into fragments.
fn fragments(scene: &Scene, findings: &mut Findings) {
    let fractures = |body: &Body| scene.materials.get(&body.material).is_some_and(|m| m.fracture.is_some());
    let mut fracturing = scene.bodies.iter().enumerate().filter(|(_, body)| !body.rigid && fractures(body)).peekable();
    if fracturing.peek().is_none() {
        let remedy = "give a material a fracture table, or remove the key";
        findings.error("contact.fragments", "no body fractures, so none falls into fragments", remedy);
    }
    for (i, body) in fracturing.filter(|(_, body)| !body.tractions.is_empty()) {
        let message = format!("a traction on body {:?}, which may fall into fragments", body.name);
        let remedy = "drive a side of the mesh instead, or remove contact.fragments";
        findings.error(format!("body.{i}.traction"), message, remedy);
    }
}

/// Whether bodies are so fast that steps in which contact can follow them would never end.
fn speeds(scene: &Scene, findings: &mut Findings) {
    let steps = scene.analysis.end_time / longest_step(scene);
    if scene.analysis.time_step == TimeStep::Auto && steps > MOST_STEPS {
        let message = format!("bodies so fast that {steps:.1e} steps are needed to follow them, above {MOST_STEPS:e}");
        findings.error("contact", message, "give lower velocities, each with its unit, or a shorter end_time");
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
    let (low, high) = without_patch(&body.shape, &scene.mesh).bounding_box();
    let span = smallest_span(&scene.mesh);
    if scene.mesh.geometry.is_none() && (0..2).all(|d| high[d] - low[d] < SMALLEST * span) {
        let message = format!(
            "is smaller than {SMALLEST} cells: contact does not resolve its boundary, and turns what it strikes; use \
             smaller cells"
        );
        findings.warn(format!("{key}.shape"), message);
    }
    tractions::factor(&format!("{key}.time"), &body.time, scene.analysis.end_time, findings);
}

/// Bodies that overlap at t = 0: contact would have to push them apart, and that energy comes from nowhere.
/// False if there are no boundaries to look at.
fn overlaps(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) -> bool {
    let errors = findings.errors.len();
    if scene.bodies.iter().any(|body| defect(&body.shape).is_some() || body.particles_per_cell.contains(&0)) {
        return false; // said elsewhere
    }
    let mut work = 0.0;
    for (i, body) in scene.bodies.iter().enumerate() {
        let segments = Surface::expected_segments(&scene.mesh, body);
        work += segments * complexity(&body.shape) as f64;
        if work.is_nan() || work > MOST_WORK {
            let message = format!("a boundary of about {segments:.1e} segments, as long as its points stand apart");
            let remedy = "make the body no larger than it can be met, its outline simpler, or the cells larger";
            findings.error(format!("body.{i}.shape"), message, remedy);
            return false;
        }
    }
    let surfaces: Vec<Surface> = scene.bodies.iter().map(|body| Surface::new(&scene.mesh, body)).collect();
    let boxes: Vec<_> = surfaces.iter().map(Surface::bounding_box).collect();
    let spans: Vec<f64> = scene.bodies.iter().map(|body| ground.span_lengths(&body.shape)[0]).collect();
    let steps = |(body, span): (&Body, &f64)| {
        steps_along(&bounding_parts(&without_patch(&body.shape, &scene.mesh)), STEP * span).collect::<Vec<_>>()
    };
    let steps: Vec<_> = scene.bodies.iter().zip(&spans).map(steps).collect();
    for j in 1..surfaces.len() {
        for i in 0..j {
            let (a, b) = (&scene.bodies[i], &scene.bodies[j]);
            let apart = (0..2).any(|d| boxes[i][1][d] < boxes[j][0][d] || boxes[j][1][d] < boxes[i][0][d]);
            if apart || (a.rigid && b.rigid) {
                continue;
            }
            let least = TOLERANCE * spans[i];
            let [a_in_b, b_in_a] = [(i, j, &b.shape), (j, i, &a.shape)]
                .map(|(one, other, inside)| depth(&steps[one], &surfaces[other], inside, 2.0 * least));
            let deepest = larger(a_in_b, b_in_a);
            if deepest > least {
                let by = deepest + 2.0 * least;
                let message = format!("body {:?} overlaps body {:?} by {by:.3e} m or more at t = 0", b.name, a.name);
                findings.error(format!("body.{j}.shape"), message, "move the bodies apart until they touch at most");
            }
            if findings.errors.len() >= errors + MOST_OVERLAPS {
                return true; // enough to begin with
            }
        }
    }
    true
}

/// How far what lies `beneath` (m) the boundary of one body reaches into the body inside another, m: the
/// boundaries of bodies that coincide do not cross. Of very many steps, some are looked at.
fn depth(one: &[[[f64; 2]; 2]], other: &Surface, inside: &Shape, beneath: f64) -> f64 {
    let below = one.iter().map(|[position, inward]| [0, 1].map(|d| position[d] + beneath * inward[d]));
    let within: Vec<_> = below.filter(|position| inside.contains(*position)).collect();
    if within.is_empty() {
        return 0.0;
    }
    let all = other.segments_in([[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]]);
    let stride = within.len() * all.len() / MOST_DISTANCES + 1;
    let nearest = within.into_iter().step_by(stride).filter_map(|x| other.nearest(x, &all, f64::INFINITY));
    nearest.map(|nearest| nearest.distance.abs()).fold(0.0, larger)
}
