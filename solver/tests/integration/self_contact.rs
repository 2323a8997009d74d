//! A body that meets itself: where its parts do not touch nothing changes, and where they do nothing is lost.

use crate::common::{body, horseshoe, rectangle, run, unit_solid, updated_scene};
use fisura::Simulation;
use fisura::linear_algebra::extremes::{larger, smaller};
use fisura::scene::*;

/// A free ring with a slit whose ends fly at each other and past each other.
fn closing_ring(degree: usize) -> Scene {
    let ring = Shape::Annulus { center: [1.0, 1.0], inner_radius: 0.6, outer_radius: 0.8 };
    let slit = rectangle([1.5, 0.97], [1.9, 1.03]);
    let shape = Shape::Difference { of: Box::new(ring), minus: vec![slit] };
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [4.0, 2.0], [80, 40]);
    let mut scene = updated_scene(unit_solid(), mesh, Shape::Patch);
    let velocity_gradient = [[0.0, 0.02], [0.0, -0.1]];
    let ring = body(shape, [degree + 1; 2]);
    scene.bodies = vec![Body { material: "solid".into(), velocity_gradient, ..ring }];
    scene.analysis = Analysis { frame: Frame::Total, kinematics: Kinematics::Finite, end_time: 3.0, ..scene.analysis };
    scene.contact = Some(Contact { friction: 0.3, self_contact: true, stiffness: Some(4.0), ..Contact::default() });
    scene.output.bodies = true;
    scene
}

#[test]
fn a_ring_that_closes_keeps_momentum_and_energy() {
    for degree in [2, 3] {
        let (simulation, samples) = run(&closing_ring(degree));
        let (first, last) = (&samples[0], samples.last().unwrap());
        assert!(last.contact.unwrap().friction > 0.0, "the ends meet and rub");
        let gaps = samples.iter().filter_map(|sample| sample.bodies.as_ref()?.smallest_gap).filter(|gap| !gap.is_nan());
        assert!(gaps.fold(0.0, smaller) > -0.2 * 0.05, "the sides of the slit pass through each other");
        let scale = simulation.momenta()[0].0 * 0.1;
        for sample in &samples {
            (0..2).for_each(|d| assert!((sample.momentum[d] - first.momentum[d]).abs() < 1e-12 * scale));
            assert!((sample.angular_momentum - first.angular_momentum).abs() < 1e-12 * scale);
        }
        let closure = samples.iter().map(|sample| sample.closure.abs()).fold(0.0, larger);
        assert!(closure < 1e-2 * first.kinetic, "{closure:e} of {:e}", first.kinetic);
    }
}

/// The two faces of a wall one span thick are behind each other, and do not meet.
#[test]
fn a_body_that_does_not_touch_itself_feels_nothing() {
    let thin = Shape::Annulus { center: [1.0, 1.0], inner_radius: 0.7, outer_radius: 0.73 };
    let bar = rectangle([0.2, 0.95], [1.8, 0.99]);
    let ell = Shape::Polygon { points: vec![[0.2, 0.2], [1.8, 0.2], [1.8, 0.3], [0.3, 0.3], [0.3, 1.8], [0.2, 1.8]] };
    for shape in [thin, bar, ell] {
        let spinning = |self_contact| {
            let mut scene = closing_ring(2);
            scene.bodies[0] = Body { shape: shape.clone(), angular_velocity: 0.3, ..scene.bodies[0].clone() };
            scene.bodies[0].velocity_gradient = [[0.0; 2]; 2];
            scene.contact = Some(Contact { self_contact, ..Contact::default() });
            scene.analysis.end_time = 1.0;
            let mut simulation = Simulation::new(&scene).unwrap();
            while !simulation.finished() {
                simulation.step().unwrap();
                assert!(simulation.contact_forces().is_empty());
            }
            simulation.sample()
        };
        let [alone, itself] = [false, true].map(spinning);
        assert_eq!((alone.kinetic, alone.elastic), (itself.kinetic, itself.elastic));
    }
}

#[test]
fn the_sides_of_a_horseshoe_rub() {
    let (_, samples) = run(&horseshoe());
    assert!(samples.last().unwrap().contact.unwrap().friction > 0.0, "its sides meet");
}
