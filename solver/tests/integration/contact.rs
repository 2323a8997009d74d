//! Bodies that meet: momentum, energy, onset, friction.

use crate::common::{body, elastic_scene, rectangle, run};
use fisura::linear_algebra::extremes::larger;
use fisura::scene::*;

/// Two bars of unit wave speed in head-on impact, one span of gap between them.
fn bars(degree: usize, spans: usize) -> Scene {
    let h = 1.0 / spans as f64;
    let cells = 2 * spans + 16;
    let mut scene = elastic_scene(degree, [cells as f64 * h, 4.0 * h], [cells, 4]);
    scene
        .materials
        .insert("glass".into(), Material { young_modulus: 1.0, poisson_ratio: 0.0, density: 1.0, fracture: None });
    let bar = |name: &str, left: f64, speed: f64| Body {
        name: name.into(),
        velocity: [speed, 0.0],
        ..body(rectangle([left, 0.0], [left + 1.0, 4.0 * h]), [degree.max(2); 2])
    };
    scene.bodies = vec![bar("left", 7.0 * h, 0.01), bar("right", 8.0 * h + 1.0, 0.0)];
    scene.contact = Some(Contact::default());
    scene.analysis.frame = Frame::Updated;
    scene.analysis.end_time = 4.0 + h / 0.01;
    scene.analysis.safety = 0.5;
    scene.output.samples = 20;
    scene
}

#[test]
fn two_equal_bars_exchange_their_velocities() {
    // A step front disperses over (L/h)^(1/3) spans, so the release is not sharp: the error falls as h^(2/3).
    for (degree, spans, most) in [(2, 16, 0.06), (2, 32, 0.04), (3, 16, 0.09), (3, 32, 0.05)] {
        let scene = bars(degree, spans);
        fisura::validate::validate(&scene).unwrap();
        let (simulation, samples) = run(&scene);
        let fields = simulation.updated_frame().unwrap().fields();
        let [left, right] = [0, 1].map(|i| fields[i].momentum()[0] / fields[i].mass() / 0.01);
        assert!(left.abs() < most && (right - 1.0).abs() < most, "p = {degree}, {spans} spans: {left} and {right}");
        let momentum = 0.01 * fields[0].mass();
        for sample in &samples {
            assert!((sample.momentum[0] - momentum).abs() < 1e-12 * momentum);
            assert!(sample.closure.abs() < 1e-12 * samples[0].kinetic, "closure {:e}", sample.closure);
        }
        assert!(samples.last().unwrap().contact.unwrap().loss > 0.0);
    }
}

fn elastic(young_modulus: f64, poisson_ratio: f64, density: f64) -> Material {
    Material { young_modulus, poisson_ratio, density, fracture: None }
}

/// Two blocks that fly into each other.
fn blocks(contact: Option<Contact>) -> Scene {
    let mut scene = elastic_scene(2, [4.0, 0.5], [80, 10]);
    scene.materials.insert("glass".into(), elastic(1e4, 0.3, 1.0));
    let block = |name: &str, left: f64, speed: f64| Body {
        name: name.into(),
        velocity: [speed, 0.0],
        ..body(rectangle([left, 0.123], [left + 0.3, 0.377]), [2; 2])
    };
    scene.bodies = vec![block("left", 0.5, 1.0), block("right", 3.2, -1.0)];
    scene.contact = contact;
    scene.analysis.frame = Frame::Updated;
    scene.analysis.end_time = 2.0;
    scene
}

#[test]
fn bodies_pass_through_each_other_without_a_contact_table() {
    let (simulation, samples) = run(&blocks(None));
    let frame = simulation.updated_frame().unwrap();
    assert!(frame.contact().is_none() && frame.fields().iter().all(|field| field.surface().is_none()));
    assert!(samples.iter().all(|s| s.contact.is_none()));
    for (field, speed) in frame.fields().iter().zip([1.0, -1.0]) {
        assert!(field.points().iter().all(|p| (p.velocity[0] - speed).abs() < 1e-12 && p.velocity[1].abs() < 1e-12));
    }
    let (simulation, samples) = run(&blocks(Some(Contact { friction: 0.3, ..Contact::default() })));
    let fields = simulation.updated_frame().unwrap().fields();
    assert!(fields[0].momentum()[0] < 0.0 && fields[1].momentum()[0] > 0.0, "they bounce with contact");
    let one = fields[0].mass();
    assert!(samples.iter().all(|s| s.momentum.iter().all(|p| p.abs() < 1e-12 * one)));
}

#[test]
fn nodal_fields_follow_a_body_with_its_phase_field() {
    let mut scene = blocks(None);
    scene.materials.get_mut("glass").unwrap().fracture = Some(Fracture {
        critical_energy_release_rate: 1.0,
        length_scale: 0.05,
        residual_stiffness: 0.0,
        split: Split::Spectral,
    });
    scene.bodies.truncate(1);
    scene.bodies[0].cracks = vec![Crack::seed([0.6, 0.25], [0.7, 0.25])];
    let (simulation, samples) = run(&scene);
    let field = &simulation.updated_frame().unwrap().fields()[0];
    let (part, whole) = (field.nodes().grid, simulation.updated_frame().unwrap().patch().control_grid());
    assert!(part.columns < whole.columns / 3, "{} of {} columns", part.columns, whole.columns);
    assert!(field.points().iter().all(|p| (p.velocity[0] - 1.0).abs() < 1e-11 && p.velocity[1].abs() < 1e-11));
    let energies: Vec<f64> = samples.iter().map(|s| s.fracture.as_ref().unwrap().energy).collect();
    let spread = energies.iter().map(|e| (e / energies[0] - 1.0).abs()).fold(0.0, larger);
    // 40 spans of flight: the energy of the crack swings with its place in the span and does not drift.
    assert!(spread < 0.1, "{energies:?}");
    assert!(samples.iter().all(|s| s.closure.abs() < 2e-3 * energies[0]), "the ledger is open");
}
