//! Bodies that meet: momentum, energy, onset, friction.

mod common;

use common::{body, elastic_scene, rectangle, run};
use fisura::scene::*;

/// Two bars of unit wave speed in head-on impact, one span of gap between them.
fn bars(degree: usize, spans: usize) -> Scene {
    let h = 1.0 / spans as f64;
    let cells = 2 * spans + 16;
    let mut scene = elastic_scene(degree, [cells as f64 * h, 4.0 * h], [cells, 4]);
    scene.materials.insert(
        "glass".into(),
        Material { young_modulus: 1.0, poisson_ratio: 0.0, density: 1.0, fracture: None },
    );
    let bar = |name: &str, left: f64, speed: f64| Body {
        name: name.into(),
        velocity: [speed, 0.0],
        ..body(rectangle([left, 0.0], [left + 1.0, 4.0 * h]), [degree.max(2); 2])
    };
    scene.bodies = vec![bar("left", 7.0 * h, 0.01), bar("right", 8.0 * h + 1.0, 0.0)];
    scene.contact = Some(Contact { friction: 0.0 });
    scene.analysis.frame = Frame::Updated;
    scene.analysis.end_time = 4.0 + h / 0.01;
    scene.analysis.safety = 0.5;
    scene.output.samples = 20;
    scene
}

#[test]
fn two_equal_bars_exchange_their_velocities() {
    for (degree, spans) in [(2, 16), (2, 32), (3, 16), (3, 32)] {
        let scene = bars(degree, spans);
        fisura::validate::validate(&scene).unwrap();
        let (simulation, samples) = run(&scene);
        let frame = simulation.updated_frame().unwrap();
        let [left, right] = [0, 1].map(|i| frame.fields()[i].momentum()[0] / frame.fields()[i].mass() / 0.01);
        let last = samples.last().unwrap();
        println!("p {degree} n {spans} left {left:.5} right {right:.5} K {:.4e} loss {:?} transfer {:.3e} closure {:.3e} p0 {:.3e}",
            last.kinetic, last.contact, last.transfer_loss.unwrap(), last.closure, last.momentum[0] - samples[0].momentum[0]);
    }
}

#[test]
fn explore() {
    let report = |what: &str, scene: &Scene| {
        let (simulation, samples) = run(scene);
        let frame = simulation.updated_frame().unwrap();
        let [left, right] = [0, 1].map(|i| frame.fields()[i].momentum()[0] / frame.fields()[i].mass() / scene.bodies[0].velocity[0]);
        let last = samples.last().unwrap();
        let k0 = samples[0].kinetic;
        println!("{what}: left {left:.5} right {right:.5} K {:.4} E {:.4} loss {:.4} transfer {:.4} closure {:.1e}",
            last.kinetic / k0, last.elastic / k0, last.contact.unwrap().loss / k0, last.transfer_loss.unwrap() / k0, last.closure / k0);
    };
    let base = bars(2, 32);
    report("base", &base);
    let mut s = base.clone(); s.bodies.iter_mut().for_each(|b| b.particles_per_cell = [4, 4]); report("4x4", &s);
    let mut s = base.clone(); s.bodies.iter_mut().for_each(|b| b.layout = Layout::Uniform); report("uniform", &s);
    let mut s = base.clone(); s.analysis.safety = 0.1; report("safety 0.1", &s);
    let mut s = base.clone(); s.analysis.safety = 0.9; report("safety 0.9", &s);
    for t in [Transfer::Apic, Transfer::Tpic, Transfer::Musl, Transfer::Xpic(5), Transfer::Xpic(2)] {
        let mut s = base.clone(); s.analysis.transfer = t; report(&format!("{t:?}"), &s);
    }
    let mut s = base.clone(); s.bodies[0].velocity[0] = 0.001; s.analysis.end_time = 4.0 + 1.0 / 32.0 / 0.001; report("slow", &s);
    for f in [0.1, 0.3, 0.5, 0.7] {
        let mut s = base.clone();
        let h = 1.0 / 32.0;
        for b in &mut s.bodies { if let Shape::Rectangle { min, max } = &mut b.shape { min[0] += f * h; max[0] += f * h; } }
        report(&format!("offset {f}"), &s);
    }
    let mut s = bars(2, 64); s.analysis.safety = 0.5; report("64", &s);
    let mut s = bars(2, 128); s.analysis.safety = 0.5; report("128", &s);
}
