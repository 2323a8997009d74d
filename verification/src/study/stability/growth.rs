//! Steps below and above the critical one: how fast errors grow, and what a run says about it.
//!
//! A mode of frequency ω is multiplied in a step by z with `z + 1/z = 2 − (ω dt)²`. Below ω dt = 2 the
//! modulus of z is one; above, it is e^θ with `θ = 2 acosh(ω dt/2)`, and the elastic energy grows by 2 θ per
//! step. The largest ω is that of a dense eigenvalue. Below, the staggered energy is constant and bounds the
//! elastic energy by `1/(1 − (ω dt/2)²)` of it.

use fisura::scene::{Boundary, Mesh, Scene, Shape, Side};

use super::{total_frame, with_step};
use crate::extremes::largest;
use crate::output::history::Table;
use crate::record::{Axis, CurveStyle, Figure, FigureBody, Reference};
use crate::scene::plain::PlainScene;
use crate::study::charts::curve;
use crate::study::dense;
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, other, samples, theory, yes};

/// Time steps over the critical one.
const RATIOS: [f64; 3] = [BELOW, 1.01, ABOVE];
const BELOW: f64 = 0.95;
const ABOVE: f64 = 1.05;
/// Steps of the runs below the critical step.
const LONG: usize = 10_000;
/// Steps between which growth is measured: when the fastest mode has left the others behind, and before
/// numbers end.
const FROM: usize = 100;
const TO: usize = 300;

pub(in super::super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let stem = series_stem(case, "energy");
    let mut table = Table::new(&["step"]);
    table.columns = vec![(0..=TO).map(|step| step as f64).collect()];
    let mut curves = Vec::new();
    for degree in 1..=3 {
        let scene = cut_block(degree);
        let frequency = || Ok(dense::highest(&dense::frequencies(&total_frame(&scene)?)?));
        let frequency = findings.compute(frequency)?.unwrap_or(f64::NAN);
        for ratio in RATIOS {
            let variant = format!("p={degree}, {ratio} of the critical step");
            let step = ratio * 2.0 / frequency;
            let energies = findings.compute(|| elastic_energies(&scene, step, TO))?;
            if ratio > 1.0 {
                let rate = energies.as_ref().map(|e| (e[TO] / e[FROM]).ln() / (2.0 * (TO - FROM) as f64));
                let source = theory(1.0, "2 acosh(ω dt/2) of the largest ω");
                let growth = rate.map(|rate| rate / (2.0 * f64::acosh(ratio)));
                findings.add(&variant, "growth per step over that of theory", growth, source);
            }
            if ratio == BELOW {
                let bound = theory(1.0, "the staggered energy is constant");
                let bound = bound.map(|bound| Reference { side: crate::record::Side::AtMost, ..bound });
                let quantities = [
                    ("largest elastic energy of 10000 steps over its bound", bound),
                    ("closure of the ledger after 10000 steps over the energy", None),
                ];
                findings.measure(&variant, quantities, || below(&scene, ratio, step))?;
            }
            if ratio == ABOVE {
                let quantities = ["steps until the run breaks down", "place, time and cause are named (1 is yes)"];
                findings.measure(&variant, quantities.map(|quantity| (quantity, None)), || above(&scene, step))?;
            }
            let column = format!("p{degree}_{ratio}");
            curves.push(curve(&format!("p = {degree}, {ratio} of it"), &stem, ["step", &column], CurveStyle::Line));
            table.names.push(column);
            table.columns.push(energies.unwrap_or_default());
        }
    }
    let energy = Axis::logarithmic("elastic energy (J/m)");
    let title = "Elastic energy below and above the critical step";
    let caption = "A block whose free edges cut spans, held at its left side and set in motion.";
    let body = FigureBody::chart([Axis::linear("step"), energy], curves, Vec::new());
    findings.figures.push(Figure::new(&case.suite, [&series_stem(case, "energy"), title, caption], body));
    findings.series.push((stem, table));
    Ok(())
}

/// A square of 4.25 spans a side, held at its left side, in motion.
fn cut_block(degree: usize) -> Scene {
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [5.0; 2], [5; 2]);
    let mut scene = PlainScene::unit(mesh, 0.3).scene();
    scene.bodies[0].shape = Shape::Rectangle { min: [0.0; 2], max: [4.25; 2] };
    scene.bodies[0].velocity = [1e-3, 3e-4];
    scene.boundaries = vec![Boundary::fixed(Side::Left, [true; 2])];
    scene
}

fn elastic_energies(scene: &Scene, dt: f64, steps: usize) -> Result<Vec<f64>, StudyError> {
    let mut frame = total_frame(scene)?;
    let mut energies = vec![frame.sample(dt).kinetic]; // nothing is strained yet: the scale of what follows
    for _ in 0..steps {
        crate::watch::check()?;
        frame.step(dt).map_err(|_| other("no phase field is expected"))?;
        energies.push(frame.elastic_energy());
    }
    Ok(energies)
}

fn below(scene: &Scene, ratio: f64, step: f64) -> Result<[f64; 2], StudyError> {
    let samples = samples(&mut with_step(scene, step, LONG)?)?;
    let (energy, later) = (samples[0].stored(), &samples[1..]);
    let elastic = largest(later.iter().map(|sample| sample.elastic));
    let closure = largest(later.iter().map(|sample| sample.closure.abs()));
    let bound = 1.0 / (1.0 - ratio * ratio);
    Ok([elastic / (bound * energy), closure / energy])
}

/// A step above the critical one has to end the run, with place, time and cause.
fn above(scene: &Scene, dt: f64) -> Result<[f64; 2], StudyError> {
    let mut simulation = with_step(scene, dt, LONG)?;
    let found = loop {
        crate::watch::check()?;
        match simulation.step() {
            Err(found) => break Some(found),
            Ok(()) if simulation.finished() => break None,
            Ok(()) => (),
        }
    };
    let Some(found) = found else { return Ok([f64::NAN, 0.0]) };
    // Control points stand up to a span outside.
    let near = scene.bodies[0].shape.contains_within(found.place, 1.0);
    let timed = found.time > 0.0 && found.time.is_finite() && !found.to_string().contains("NaN");
    Ok([found.step as f64, yes(near && timed && found.cause.contains("times the critical step"))])
}
