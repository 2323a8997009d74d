//! A pressure follows the body that it acts on, in both frames.

use crate::common::{elastic_scene, rectangle, run};
use fisura::scene::*;

const CENTER: [f64; 2] = [0.03, 0.03];

/// A soft ring that spins, under a pressure on a circle of this radius (m) and with finite strains.
pub fn spinning_ring(frame: Frame, radius: f64) -> Scene {
    let mut scene = elastic_scene(2, [0.06; 2], [24; 2]);
    let soft = Material { young_modulus: 1e9, poisson_ratio: 0.3, density: 1000.0, fracture: None };
    scene.materials = [("glass".to_string(), soft)].into();
    scene.analysis = Analysis { frame, kinematics: Kinematics::Finite, end_time: 2e-4, ..scene.analysis };
    scene.bodies[0].shape = Shape::Annulus { center: CENTER, inner_radius: 0.01, outer_radius: 0.02 };
    scene.bodies[0].angular_velocity = 5000.0;
    scene.bodies[0].layout = if frame == Frame::Updated { Layout::Uniform } else { Layout::Gauss };
    let edge = Edge::Arc { center: CENTER, radius, angles: [0.0, std::f64::consts::TAU] };
    let time = TimeFactor::ramp(5e-5);
    scene.bodies[0].tractions = vec![Traction { edge, load: Load::Pressure(3e7), time }];
    scene
}

/// Directions that stayed as they were at t = 0 would exert a moment on a ring that turns by a radian.
#[test]
fn a_pressure_all_around_exerts_no_force_and_no_moment() {
    for radius in [0.01, 0.02] {
        let impulse = 3e7 * radius * 2e-4;
        for (frame, tolerance) in [(Frame::Total, 1e-12), (Frame::Updated, 2e-3)] {
            let (_, samples) = run(&spinning_ring(frame, radius));
            let (first, last) = (&samples[0], samples.last().unwrap());
            let [x, y] = last.momentum;
            assert!(x.hypot(y) < tolerance * impulse, "{frame:?}, {radius} m: {x} {y}");
            let lost = 1.0 - last.angular_momentum / first.angular_momentum;
            assert!(lost.abs() < tolerance, "{frame:?}, {radius} m: {lost}");
        }
    }
}

/// A square that turns under a pressure on its lower edge: the force turns with it.
#[test]
fn the_force_of_a_pressure_turns_with_its_edge() {
    for frame in [Frame::Total, Frame::Updated] {
        let mut scene = spinning_ring(frame, 0.01);
        scene.bodies[0].shape = rectangle([0.02; 2], [0.04; 2]);
        let (edge, load) = (Edge::Side(Side::Bottom), Load::Pressure(1e6));
        scene.bodies[0].tractions = vec![Traction { edge, load, time: TimeFactor::default() }];
        scene.output = Output::rows(40);
        let (_, samples) = run(&scene);
        // Of a rigid square: p L ∫ (−sin ωt, cos ωt) dt.
        let (turned, omega) = (5000.0_f64 * 2e-4, 5000.0);
        let exact = [(turned.cos() - 1.0), turned.sin()].map(|part| 1e6 * 0.02 * part / omega);
        for (found, exact) in samples.last().unwrap().momentum.into_iter().zip(exact) {
            let size = 1e6 * 0.02 * 2e-4;
            assert!((found - exact).abs() < 0.01 * size, "{frame:?}: {found} {exact}");
        }
    }
}
