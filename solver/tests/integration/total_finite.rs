//! Finite kinematics in the total frame: objectivity, the limit of small strains, and the ledger.

use std::sync::Arc;

use crate::common::{Random, closure_of_any_sample, elastic_scene, relative_closure, run};
use fisura::dynamics::forcing::{Forcing, VolumeLoad};
use fisura::dynamics::total_frame::TotalFrame;
use fisura::scene::*;

/// No loads.
#[derive(Debug)]
struct NoLoads;

impl Forcing for NoLoads {
    fn acts_inside(&self) -> bool {
        false
    }

    fn volume(&self, _position: [f64; 2], _time: f64) -> VolumeLoad {
        VolumeLoad::default()
    }
}

/// Elastic energy (J) under the displacement `(A − I) X`.
fn energy(degree: usize, kinematics: Kinematics, a: [[f64; 2]; 2]) -> f64 {
    let mut scene = elastic_scene(degree, [0.01, 0.008], [5, 4]);
    scene.analysis.kinematics = kinematics;
    let mut frame = TotalFrame::new(&scene).unwrap();
    let [x, y] = frame.patch.control_positions();
    let component = |i: usize| -> Vec<f64> {
        let moved = |(x, y): (&f64, &f64)| a[i][0] * x + a[i][1] * y - [*x, *y][i];
        x.iter().zip(&y).map(moved).collect()
    };
    let still = [vec![0.0; x.len()], vec![0.0; x.len()]];
    frame.start_from([component(0), component(1)], still, Arc::new(NoLoads)).unwrap();
    frame.elastic_energy()
}

fn rotation(angle: f64) -> [[f64; 2]; 2] {
    let (sin, cos) = angle.sin_cos();
    [[cos, -sin], [sin, cos]]
}

fn product(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

#[test]
fn a_rotation_costs_no_energy_and_changes_none() {
    let stretch = [[1.2, 0.1], [0.1, 0.9]];
    for degree in 1..=4 {
        let stretched = energy(degree, Kinematics::Finite, stretch);
        for angle in [0.3, 1.5, 3.0] {
            assert!(energy(degree, Kinematics::Finite, rotation(angle)) <= 1e-24 * stretched);
            let both = energy(degree, Kinematics::Finite, product(rotation(angle), stretch));
            approx::assert_relative_eq!(both, stretched, max_relative = 1e-12);
            assert!(energy(degree, Kinematics::Small, rotation(angle)) > 1e-3 * stretched, "small strains see it");
        }
    }
}

#[test]
fn small_strains_are_the_limit() {
    let difference = |size: f64| {
        let a = [[1.0 + size, 0.4 * size], [-0.2 * size, 1.0 - 0.5 * size]];
        energy(2, Kinematics::Finite, a) / energy(2, Kinematics::Small, a) - 1.0
    };
    let (coarse, fine) = (difference(1e-3), difference(1e-4));
    assert!(coarse.abs() < 5e-3 && coarse.abs() > 1e-5, "{coarse}");
    approx::assert_relative_eq!(coarse / fine, 10.0, max_relative = 0.02);
}

/// A clamped block that falls onto nothing at a tenth of the wave speed: strains of several per cent.
#[test]
fn the_ledger_closes_with_the_square_of_the_step() {
    let closure = |safety: f64| {
        let mut scene = elastic_scene(2, [0.01, 0.008], [10, 8]);
        scene.analysis = Analysis { kinematics: Kinematics::Finite, safety, end_time: 8e-6, ..scene.analysis };
        scene.bodies[0].velocity = [200.0, 100.0];
        scene.boundaries = vec![Boundary::fixed(Side::Left, [true, true])];
        scene.output.samples = 4;
        relative_closure(&run(&scene).1)
    };
    let (coarse, fine) = (closure(0.4), closure(0.1));
    assert!(coarse < 1e-3 && fine < 1e-4, "{coarse} {fine}");
    assert!((coarse / fine).log(4.0) > 1.7, "order {}", (coarse / fine).log(4.0));
}

/// Lanes without a point must not take part: control points outside a disk have next to no mass. The angular
/// momentum is about present positions.
#[test]
fn a_spinning_disk_in_a_larger_mesh_keeps_running() {
    let mut scene = elastic_scene(2, [0.01, 0.01], [8, 8]);
    scene.analysis.kinematics = Kinematics::Finite;
    scene.bodies[0].shape = Shape::Disk { center: [0.005, 0.005], radius: 0.004 };
    scene.bodies[0].angular_velocity = 1e4;
    scene.analysis.end_time = 1e-3;
    scene.output.samples = 4;
    let samples = run(&scene).1;
    assert!(closure_of_any_sample(&samples) <= 1e-2);
    let [first, last] = [&samples[0], &samples[4]].map(|sample| sample.angular_momentum);
    approx::assert_relative_eq!(last, first, max_relative = 1e-10);
}

/// A block squeezed between clamped sides, at rest under a uniform stretch.
fn squeezed(stretch: [f64; 2], safety: f64) -> (TotalFrame, f64) {
    let mut scene = elastic_scene(2, [0.01, 0.008], [6, 5]);
    scene.analysis.kinematics = Kinematics::Finite;
    let clamped = |side| Boundary::fixed(side, [true, true]);
    scene.boundaries = [Side::Left, Side::Right, Side::Bottom, Side::Top].map(clamped).to_vec();
    let mut frame = TotalFrame::new(&scene).unwrap();
    let positions = frame.patch.control_positions();
    let squeezed = [0, 1].map(|d| positions[d].iter().map(|x| (stretch[d] - 1.0) * x).collect::<Vec<_>>());
    let mut random = Random::new(7);
    let velocity = [0, 1].map(|_| positions[0].iter().map(|_| 1e-6 * random.next()).collect::<Vec<_>>());
    frame.start_with(squeezed, velocity).unwrap();
    let undeformed = frame.critical_step();
    let critical = frame.retake_critical_step(1e3 * undeformed, undeformed).unwrap();
    assert_eq!(frame.retake_critical_step(1e3 * undeformed, undeformed), None, "no stiffer than before");
    (frame, safety * critical)
}

/// Small vibrations about a compressed state last just below the critical step of that state, and grow just
/// above it.
#[test]
fn the_critical_step_of_a_compressed_body_is_where_vibrations_begin_to_grow() {
    for stretch in [[0.8, 0.8], [0.7, 1.0], [0.9, 0.75]] {
        let fastest = |safety: f64| {
            let (mut frame, step) = squeezed(stretch, safety);
            assert!(step < 0.85 * frame.critical_step(), "{stretch:?} stiffens");
            (0..1500).for_each(|_| frame.step(step).unwrap());
            frame.fastest_control_point().1
        };
        assert!(fastest(0.99) < 1e-4, "{stretch:?}: {}", fastest(0.99));
        assert!(fastest(1.03) > 1.0, "{stretch:?}: {}", fastest(1.03));
    }
}
