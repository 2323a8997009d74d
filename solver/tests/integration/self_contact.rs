//! A body that meets itself: cut into slices it is the same body, and its parts meet as bodies do.

use crate::common::{body, rectangle, run, unit_solid, updated_scene};
use fisura::Simulation;
use fisura::dynamics::energy::Sample;
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::linear_algebra::extremes::{larger, smaller};
use fisura::scene::*;

/// A scene with gravity in which bodies of a soft solid may meet, in a mesh of 4 by 2 m with 20 spans to a
/// metre.
fn soft(bodies: Vec<Body>) -> Scene {
    let mesh = Mesh::uniform([2; 2], [0.0; 2], [4.0, 2.0], [80, 40]);
    let mut scene = updated_scene(unit_solid(), mesh, Shape::Patch);
    scene.bodies = bodies.into_iter().map(|body| Body { material: "solid".into(), ..body }).collect();
    scene.analysis.kinematics = Kinematics::Finite;
    scene.analysis.transfer = Transfer::Apic;
    scene.contact = Some(Contact { friction: 0.3, self_contact: true, ..Contact::default() });
    scene
}

fn fields(simulation: &Simulation) -> usize {
    simulation.updated_frame().unwrap().fields().len()
}

/// Energies and momenta of two runs agree to a fraction of the largest energy.
fn assert_same(one: &[Sample], other: &[Sample], tolerance: f64) {
    let scale = one.iter().map(Sample::largest_term).fold(0.0, larger);
    assert_eq!(one.len(), other.len());
    for (a, b) in one.iter().zip(other) {
        let pairs = [
            (a.kinetic, b.kinetic),
            (a.stagger, b.stagger),
            (a.elastic, b.elastic),
            (a.external_work, b.external_work),
            (a.transfer_loss.unwrap(), b.transfer_loss.unwrap()),
            (a.contact.unwrap().loss, b.contact.unwrap().loss),
            (a.contact.unwrap().friction, b.contact.unwrap().friction),
        ];
        for (index, (x, y)) in pairs.into_iter().enumerate() {
            assert!((x - y).abs() <= tolerance * scale, "term {index} at {} s: {x:e} and {y:e} of {scale:e}", a.time);
        }
        assert!((a.time_step - b.time_step).abs() < 1e-9 * a.time_step, "{} and {} s", a.time_step, b.time_step);
    }
}

/// A beam with loads, gravity and a side that is held, and the same scene with a floor on which it slides.
fn beams(transfer: Transfer, kinematics: Kinematics) -> [Scene; 2] {
    let beam = body(rectangle([0.0, 0.95], [3.6, 1.2]), [2, 2]);
    let floor = Body { name: "floor".into(), rigid: true, ..body(rectangle([1.0, 0.5], [3.9, 0.949]), [2, 2]) };
    [vec![beam.clone()], vec![beam, floor]].map(|bodies| {
        let mut scene = soft(bodies);
        scene.bodies[0].tractions = vec![Traction::on(Side::Top, [2e-3, -1e-3], TimeFactor::ramp(0.5))];
        scene.boundaries = vec![Boundary::fixed(Side::Left, [true, true])];
        scene.analysis = Analysis { transfer, kinematics, gravity: [0.0, -2e-3], end_time: 3.0, ..scene.analysis };
        fisura::validate::validate(&scene).unwrap();
        scene
    })
}

/// Where a body does not meet itself, slices change the order of sums and no more; on a floor, the line from
/// a slice to the next has no corner where that of the body has one.
#[test]
fn slices_are_the_whole_body() {
    for (transfer, kinematics) in [(Transfer::Flip, Kinematics::Small), (Transfer::Apic, Kinematics::Finite)] {
        for (mut scene, tolerance) in beams(transfer, kinematics).into_iter().zip([1e-10, 1e-4]) {
            let (simulation, slices) = run(&scene);
            assert_eq!(fields(&simulation), 5);
            scene.contact.as_mut().unwrap().self_contact = false;
            let (simulation, whole) = run(&scene);
            assert_eq!(fields(&simulation), 1);
            let friction = whole.last().unwrap().contact.unwrap().friction;
            assert_eq!(friction > 0.0, scene.bodies.len() > 1, "it slides on the floor");
            assert_same(&whole, &slices, tolerance);
        }
    }
}

/// A body of two parts that fall on each other is two bodies.
#[test]
fn parts_meet_as_bodies_do() {
    let around = || Box::new(rectangle([1.0, 0.0], [1.6, 0.9]));
    let without =
        |from: f64, to: f64| Shape::Difference { of: around(), minus: vec![rectangle([0.9, from], [1.7, to])] };
    let of = |bodies: Vec<Body>| {
        let mut scene = soft(bodies);
        scene.contact.as_mut().unwrap().friction = 0.0;
        scene.boundaries = vec![Boundary::fixed(Side::Bottom, [true, true])];
        scene.analysis = Analysis { gravity: [0.0, -5e-2], end_time: 3.0, ..scene.analysis };
        fisura::validate::validate(&scene).unwrap();
        run(&scene)
    };
    let named = |name: &str, shape| Body { name: name.into(), ..body(shape, [2, 2]) };
    let (simulation, one) = of(vec![named("both", without(0.5, 0.525))]);
    assert_eq!(fields(&simulation), 2);
    let (_, two) = of(vec![named("low", without(0.5, 1.0)), named("high", without(-0.1, 0.525))]);
    assert!(two.last().unwrap().contact.unwrap().loss.abs() > 1e-6, "they meet: {:?}", two.last());
    assert_same(&two, &one, 1e-9);
}

/// A free ring with a slit whose ends fly at each other.
fn closing_ring() -> Scene {
    let ring = Shape::Annulus { center: [1.0, 1.0], inner_radius: 0.6, outer_radius: 0.8 };
    let slit = rectangle([1.5, 0.97], [1.9, 1.03]);
    let shape = Shape::Difference { of: Box::new(ring), minus: vec![slit] };
    let mut scene = soft(vec![body(shape, [2, 2])]);
    scene.analysis.end_time = 3.0;
    scene
}

/// Upper and lower half fly at each other, sliding in x.
fn towards_the_middle(x: [f64; 2]) -> [f64; 2] {
    let above = (x[1] - 1.0) * (x[0] - 0.2).max(0.0);
    [0.02 * above, -0.1 * above]
}

/// Momentum and angular momentum of a ring that meets itself are kept, the energy has names, and the slit
/// does not close further than it is open.
#[test]
fn a_ring_that_closes_keeps_momentum_and_energy() {
    let scene = closing_ring();
    let mut frame = UpdatedFrame::new(&scene).unwrap();
    frame.set_initial_velocity(towards_the_middle);
    let dt = 0.5 * frame.critical_step();
    frame.prepare(dt).unwrap();
    let first = frame.sample(dt);
    while frame.time() < scene.analysis.end_time {
        frame.step(dt).unwrap();
        let gaps = frame.contact().unwrap().constraints().iter().map(|constraint| constraint.gap);
        assert!(gaps.fold(0.0, smaller) > -0.1 * 0.05, "the sides of the slit pass through each other");
    }
    let mut last = frame.sample(dt);
    last.close(first.stored());
    assert!(last.contact.unwrap().friction > 0.0, "the ends meet and rub");
    let scale = frame.fields().iter().map(|f| f.mass()).sum::<f64>() * 0.1;
    for d in 0..2 {
        assert!((last.momentum[d] - first.momentum[d]).abs() < 1e-12 * scale, "{:?}", last.momentum);
    }
    assert!((last.angular_momentum - first.angular_momentum).abs() < 1e-12 * scale, "{}", last.angular_momentum);
    assert!(last.closure.abs() < 1e-4 * first.kinetic, "{:e} of {:e}", last.closure, first.kinetic);
}
