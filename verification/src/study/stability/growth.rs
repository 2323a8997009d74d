//! Steps below and above the critical one: how fast errors grow, and what a run says about it.
//!
//! A mode of frequency ω is multiplied in a step by z with `z + 1/z = 2 − (ω dt)²`. Below ω dt = 2 the
//! modulus of z is one; above, it is e^θ with `θ = 2 acosh(ω dt/2)`, and the elastic energy grows by 2 θ per
//! step. The largest ω is that of a dense eigenvalue. Below, the staggered energy is constant and bounds the
//! elastic energy by `1/(1 − (ω dt/2)²)` of it.

use fisura::Simulation;
use fisura::scene::{Boundary, Material, Mesh, Scene, Shape, Side, TimeStep};

use super::total_frame;
use crate::extremes::larger;
use crate::output::history::Table;
use crate::record::{Axis, CurveStyle, Figure, FigureBody, Reference};
use crate::scene::plain::PlainScene;
use crate::study::charts::curve;
use crate::study::dense;
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, other, theory, yes};

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

pub(in super::super) fn offers(_case: &Case, _scenes: &[CaseScene]) -> crate::study::Offered {
    let mut offers = crate::study::Offers::default();
    for degree in 1..=3 {
        for ratio in RATIOS {
            let variant = variant(degree, ratio);
            if ratio > 1.0 {
                offers.held(&variant, ["growth per step over that of theory"]);
            }
            if ratio == BELOW {
                offers.held(&variant, ["largest elastic energy of 10000 steps over its bound"]);
                offers.bare(&variant, ["closure of the ledger after 10000 steps over the energy"]);
            }
            if ratio == ABOVE {
                offers
                    .bare(&variant, ["steps until the run breaks down", "place, time and cause are named (1 is yes)"]);
            }
        }
    }
    Ok(offers)
}

fn variant(degree: usize, ratio: f64) -> String {
    format!("p={degree}, {ratio} of the critical step")
}

pub(in super::super) fn study(case: &Case, _scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let stem = series_stem(case, "energy");
    let mut table = Table::new(&["step"]);
    table.columns = vec![(0..=TO).map(|step| step as f64).collect()];
    let mut curves = Vec::new();
    for degree in 1..=3 {
        let scene = cut_block(degree);
        let frame = total_frame(&scene)?;
        let frequency = dense::highest(&dense::frequencies(&frame)?);
        for ratio in RATIOS {
            let energies = elastic_energies(&scene, ratio * 2.0 / frequency, TO)?;
            let variant = variant(degree, ratio);
            if ratio > 1.0 {
                let rate = (energies[TO] / energies[FROM]).ln() / (2.0 * (TO - FROM) as f64);
                let exact = 2.0 * f64::acosh(ratio);
                let source = theory(1.0, "2 acosh(ω dt/2) of the largest ω");
                findings.add(&variant, "growth per step over that of theory", rate / exact, source);
            }
            let column = format!("p{degree}_{ratio}");
            curves.push(curve(&format!("p = {degree}, {ratio} of it"), &stem, ["step", &column], CurveStyle::Line));
            table.names.push(column);
            table.columns.push(energies);
        }
        below(degree, &scene, frequency, &mut findings)?;
        above(degree, &scene, frequency, &mut findings)?;
    }
    let energy = Axis::logarithmic("elastic energy (J/m)");
    let title = "Elastic energy below and above the critical step";
    let caption = "A block whose free edges cut spans, held at its left side and set in motion.";
    let body = FigureBody::chart([Axis::linear("step"), energy], curves, Vec::new());
    findings.figures.push(Figure::new(&case.suite, [&series_stem(case, "energy"), title, caption], body));
    findings.series.push((stem, table));
    Ok(findings)
}

/// A square of 4.25 spans a side, held at its left side, in motion.
fn cut_block(degree: usize) -> Scene {
    let mut scene = PlainScene::free(
        Mesh::uniform([degree; 2], [0.0; 2], [5.0; 2], [5; 2]),
        Material { young_modulus: 1.0, poisson_ratio: 0.3, density: 1.0, fracture: None },
        degree + 1,
    )
    .scene();
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

fn with_step(scene: &Scene, dt: f64, steps: usize) -> Result<Simulation, StudyError> {
    let mut scene = scene.clone();
    scene.analysis.time_step = TimeStep::Fixed(dt);
    scene.analysis.end_time = dt * steps as f64;
    scene.output.samples = steps.div_ceil(100);
    Ok(Simulation::new(&scene)?)
}

fn below(degree: usize, scene: &Scene, frequency: f64, findings: &mut Findings) -> Result<(), StudyError> {
    let ratio = BELOW;
    let mut simulation = with_step(scene, ratio * 2.0 / frequency, LONG)?;
    let start = simulation.sample();
    let (mut elastic, mut closure) = (0.0_f64, 0.0_f64);
    while !simulation.finished() {
        crate::watch::check()?;
        let sample = simulation.advance_to_next_sample()?;
        elastic = larger(elastic, sample.elastic);
        closure = larger(closure, sample.closure.abs());
    }
    let variant = variant(degree, ratio);
    let energy = start.stored();
    let bound = 1.0 / (1.0 - ratio * ratio);
    let quantity = "largest elastic energy of 10000 steps over its bound";
    let source = theory(1.0, "the staggered energy is constant");
    let source = source.map(|bound| Reference { side: crate::record::Side::AtMost, ..bound });
    findings.add(&variant, quantity, elastic / (bound * energy), source);
    findings.add(&variant, "closure of the ledger after 10000 steps over the energy", closure / energy, None);
    Ok(())
}

/// A step above the critical one has to end the run, with place, time and cause.
fn above(degree: usize, scene: &Scene, frequency: f64, findings: &mut Findings) -> Result<(), StudyError> {
    let ratio = ABOVE;
    let mut simulation = with_step(scene, ratio * 2.0 / frequency, LONG)?;
    let variant = variant(degree, ratio);
    let found = loop {
        crate::watch::check()?;
        match simulation.step() {
            Err(found) => break Some(found),
            Ok(()) if simulation.finished() => break None,
            Ok(()) => (),
        }
    };
    let (mut steps, mut named) = (f64::NAN, 0.0);
    if let Some(found) = found {
        // Control points stand up to a span outside.
        let near = scene.bodies[0].shape.contains_within(found.place, 1.0);
        let timed = found.time > 0.0 && found.time.is_finite() && !found.to_string().contains("NaN");
        steps = found.step as f64;
        named = yes(near && timed && found.cause.contains("times the critical step"));
    }
    findings.add(&variant, "steps until the run breaks down", steps, None);
    findings.add(&variant, "place, time and cause are named (1 is yes)", named, None);
    Ok(())
}
