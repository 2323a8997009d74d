//! Finite kinematics in the total frame: objectivity, the limit of small strains, and the ledger.

mod common;

use std::sync::Arc;

use common::elastic_scene;
use fisura::Simulation;
use fisura::forcing::NoLoads;
use fisura::scene::*;
use fisura::total_frame::TotalFrame;

/// Elastic energy (J) under the displacement `(A − I) X`.
fn energy(degree: usize, kinematics: Kinematics, a: [[f64; 2]; 2]) -> f64 {
    let mut scene = elastic_scene(degree, [0.01, 0.008], [5, 4]);
    scene.analysis.kinematics = kinematics;
    let mut frame = TotalFrame::new(&scene).unwrap();
    let [x, y] = frame.patch().control_positions();
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
        scene.analysis.kinematics = Kinematics::Finite;
        scene.analysis.safety = safety;
        scene.analysis.end_time = 8e-6;
        scene.bodies[0].velocity = [200.0, 100.0];
        scene.boundaries = vec![Boundary { side: Side::Left, fix: [true, true], velocity: [0.0; 2] }];
        scene.output.samples = 4;
        let mut simulation = Simulation::new(&scene).unwrap();
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        while !simulation.finished() {
            let sample = simulation.advance_to_next_sample().unwrap();
            worst = worst.max(sample.closure.abs());
            largest = largest.max(sample.largest_term());
        }
        worst / largest
    };
    let (coarse, fine) = (closure(0.4), closure(0.1));
    assert!(coarse < 1e-3 && fine < 1e-4, "{coarse} {fine}");
    assert!((coarse / fine).log(4.0) > 1.7, "order {}", (coarse / fine).log(4.0));
}

/// Lanes without a point must not take part: control points outside a disk have next to no mass.
#[test]
fn a_spinning_disk_in_a_larger_mesh_keeps_running() {
    let mut scene = elastic_scene(2, [0.01, 0.01], [8, 8]);
    scene.analysis.kinematics = Kinematics::Finite;
    scene.bodies[0].shape = Shape::Disk { center: [0.005, 0.005], radius: 0.004 };
    scene.bodies[0].angular_velocity = 1e4;
    scene.analysis.end_time = 1e-3;
    scene.output.samples = 4;
    let mut simulation = Simulation::new(&scene).unwrap();
    while !simulation.finished() {
        let sample = simulation.advance_to_next_sample().unwrap();
        assert!(sample.closure.abs() <= 1e-2 * sample.largest_term());
    }
}
