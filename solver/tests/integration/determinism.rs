//! The same bits for any number of threads, and for every repetition.

use crate::common::{horseshoe, make_at1, make_cohesive, notched_plate, pulled_plate, run, two_discs, with_threads};
use fisura::scene::*;

/// Every value of every sample, and place, velocity and strain of every point at the end, as bits.
fn bits(scene: &Scene) -> Vec<u64> {
    let (simulation, samples) = run(scene);
    assert!(simulation.steps() >= 10, "{} steps", simulation.steps());
    let mut numbers: Vec<f64> = samples.iter().flat_map(|s| s.named_values()).map(|(_, value)| value).collect();
    if let Some(frame) = simulation.total_frame() {
        numbers.extend(frame.displacement.iter().chain(&frame.velocity).flatten());
    }
    simulation.for_each_point(&mut |point| {
        numbers.extend(point.present.iter().chain(&point.velocity).chain(&point.strain));
    });
    numbers.into_iter().map(f64::to_bits).collect()
}

#[track_caller]
pub fn check(scene: &Scene) {
    let one = with_threads(1, || bits(scene));
    for threads in [2, 2, 5] {
        let other = with_threads(threads, || bits(scene));
        let differ = one.iter().zip(&other).filter(|(a, b)| a != b).count();
        assert!(one == other, "{threads} threads: {differ} of {} values differ", one.len());
    }
}

/// A mesh with several strips, chunks and blocks of rows.
fn tall(mut scene: Scene) -> Scene {
    scene.mesh = Mesh::uniform([2; 2], [0.0; 2], [0.01, 0.005], [30, 90]);
    scene.analysis.end_time = 1.5e-6;
    scene
}

#[test]
fn in_the_total_frame() {
    check(&tall(pulled_plate(1e6)));
    check(&tall(notched_plate(6e6)));
    let mut interval = tall(notched_plate(6e6));
    interval.solver.phase_field_interval = PhaseFieldInterval::Automatic;
    check(&interval);
    for split in [Split::Spectral, Split::Rankine] {
        let mut threshold = tall(notched_plate(6e6));
        make_at1(&mut threshold, split);
        check(&threshold);
    }
    let mut cohesive = tall(notched_plate(6e6));
    make_cohesive(&mut cohesive, 7.5e6, Softening::Linear, Split::Rankine);
    check(&cohesive);
    check(&crate::refinement::refined(2, [32, 16], 1));
    let mut direct = tall(notched_plate(6e6));
    direct.solver.phase_field_solver = PhaseFieldSolver::Cholesky;
    direct.analysis.end_time = 0.3e-6;
    check(&direct);
}

#[test]
fn in_the_updated_frame() {
    let mut scene = tall(notched_plate(6e6));
    scene.mesh = Mesh::uniform([2; 2], [-0.001; 2], [0.012, 0.007], [36, 84]);
    scene.analysis = Analysis { frame: Frame::Updated, safety: 0.5, end_time: 0.5e-6, ..scene.analysis };
    check(&scene);
}

#[test]
fn of_bodies_in_contact() {
    let mut scene = two_discs();
    scene.analysis.transfer = Transfer::Apic;
    check(&scene);
    check(&horseshoe());
    let mut total = two_discs();
    (total.analysis.frame, total.analysis.kinematics) = (Frame::Total, Kinematics::Finite);
    total.contact = Some(Contact { friction: 0.3, ..Contact::default() });
    total.bodies[0].angular_velocity = 2e3;
    check(&total);
}
