//! Points exactly on knots, on the edge of the patch, and beyond it; bodies that overlap from the start.
//!
//! A block of equally spaced points, two a span, flies a sixteenth of a span in every step: its points stand
//! on knots again and again. Powers of two make positions exact, or nearly so. Nothing may happen to it until
//! its first point is off the mesh, which has to end the run in words at the step at which it happens. Bodies
//! that overlap at t = 0 have to be refused.

use fisura::Simulation;
use fisura::scene::{Body, Contact, Frame, Layout, Mesh, Scene, Shape, TimeStep, Transfer};
use fisura::validate::validate;

use crate::extremes::{larger, largest};
use crate::scene::plain::PlainScene;
use crate::study::{Case, CaseScene, Findings, StudyError, exact, other, yes};

/// Spans of the mesh along x, all of length one; the block is two long and begins at one.
const SPANS: usize = 12;
/// Overlaps of bodies that have to be refused, in spans.
const DEPTHS: [f64; 3] = [1e-2, 0.5, 1.0];
/// Time step, s; the speed is one.
const STEP: f64 = 0.0625;

pub(in super::super) fn study(_case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for degree in 1..=3 {
        for (word, transfer) in [("FLIP", Transfer::Flip), ("APIC", Transfer::Apic)] {
            // The foremost points stand at 2.75 + t: beyond 12 from t = 9.25 + STEP on; those of a step
            // before are on the edge.
            let quantities = [
                ("points that stood on a knot", None),
                ("change of velocity, and strain, over the speed", exact(0.0, "a rigid translation")),
                ("time at which the run ends, s", exact(9.25 + STEP, "the first point beyond the edge")),
                ("the ending names what left, and a remedy (1 is yes)", None),
            ];
            findings.measure(&format!("p={degree}, {word}"), quantities, || fly(&flying(degree, transfer)))?;
        }
    }
    for depth in DEPTHS {
        let quantity = ("overlapping bodies are refused (1 is yes)", exact(1.0, "refused"));
        findings.measure(&format!("{depth} of a span deep"), [quantity], || {
            let refused = validate(&overlapping(depth)).err();
            let named = refused.is_some_and(|errors| errors.iter().any(|e| e.message.contains("overlaps")));
            Ok([yes(named)])
        })?;
    }
    let quantity = ("touching bodies are taken (1 is yes)", exact(1.0, "taken"));
    findings.measure("touching", [quantity], || Ok([yes(validate(&overlapping(0.0)).is_ok())]))
}

/// A block whose points stand a quarter of a span from knots at t = 0, and fly at unit speed.
fn flying(degree: usize, transfer: Transfer) -> Scene {
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [SPANS as f64, 4.0], [SPANS, 4]);
    let mut scene = PlainScene { layout: Layout::Uniform, points: 2, ..PlainScene::unit(mesh, 0.25) }.scene();
    scene.analysis.frame = Frame::Updated;
    scene.analysis.transfer = transfer;
    scene.analysis.time_step = TimeStep::Fixed(STEP);
    scene.analysis.end_time = SPANS as f64;
    scene.bodies[0].shape = Shape::Rectangle { min: [1.0, 1.0], max: [3.0, 3.0] };
    scene.bodies[0].velocity = [1.0, 0.0];
    scene
}

fn fly(scene: &Scene) -> Result<[f64; 4], StudyError> {
    let mut simulation = Simulation::new(scene)?;
    let (mut on_knots, mut off) = (0_usize, 0.0_f64);
    let ending = loop {
        crate::watch::check()?;
        if simulation.finished() {
            break None;
        }
        if let Err(ending) = simulation.step() {
            break Some(ending);
        }
        let frame = simulation.updated_frame().ok_or_else(|| other("not the updated frame"))?;
        let points = &frame.fields[0].points;
        on_knots += points.iter().filter(|p| (p.position[0] - p.position[0].round()).abs() < 1e-12).count();
        let speed = points.iter().flat_map(|p| [(p.velocity[0] - 1.0).abs(), p.velocity[1].abs()]);
        off = larger(off, largest(speed));
        off = larger(off, largest(points.iter().flat_map(|p| p.strain).map(f64::abs)));
    };
    let time = ending.as_ref().map_or(f64::NAN, |ending| ending.time);
    let named = ending.is_some_and(|e| e.to_string().contains("left the mesh") && e.cause.contains("mesh"));
    Ok([on_knots as f64, off, time, yes(named)])
}

/// Two blocks, one span a side, that overlap by some of a span.
fn overlapping(depth: f64) -> Scene {
    let mut scene = flying(2, Transfer::Flip);
    scene.contact = Some(Contact::default());
    scene.bodies[0].velocity = [0.0; 2];
    let other = Body {
        name: "other".into(),
        shape: Shape::Rectangle { min: [3.0 - depth, 1.0], max: [5.0, 3.0] },
        ..scene.bodies[0].clone()
    };
    scene.bodies.push(other);
    scene
}
