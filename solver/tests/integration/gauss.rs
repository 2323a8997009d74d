//! Gauss quadrature by spans in the updated frame: what is conserved, and that cut spans do no harm.

use crate::common::{run, unit_solid, updated_scene};
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::linear_algebra::extremes::larger;
use fisura::scene::*;
use std::f64::consts::PI;

/// A block that flies through a mesh whose spans it cuts.
fn flying(degree: usize, cells: usize) -> Scene {
    let mesh = Mesh::uniform([degree; 2], [-0.5, -0.53], [2.5, 2.0], [5 * cells / 2, 2 * cells]);
    let mut scene = updated_scene(unit_solid(), mesh, Shape::Rectangle { min: [0.0; 2], max: [1.0; 2] });
    scene.bodies[0].particles_per_cell = [degree + 1; 2];
    scene.bodies[0].layout = Layout::Gauss;
    scene.bodies[0].velocity = [0.6, 0.3];
    scene.analysis.kinematics = Kinematics::Finite;
    scene.analysis.quadrature = Quadrature::Gauss;
    scene.analysis.end_time = 0.5;
    scene
}

/// Sets it vibrating; its energies, elastic at most, and closure over that after half a second.
fn vibrate(degree: usize, cells: usize) -> (f64, f64) {
    let mut frame = UpdatedFrame::new(&flying(degree, cells)).unwrap();
    let velocity = |[x, y]: [f64; 2]| [0.6 + 0.05 * (PI * x).cos(), 0.3 + 0.05 * (PI * y).cos() * (PI * x).cos()];
    frame.set_initial_velocity(velocity);
    let dt = 0.25 * frame.critical_step();
    let left = |frame: &UpdatedFrame| {
        let s = frame.sample(dt);
        (s.kinetic - s.stagger + s.elastic + s.transfer_loss.unwrap() - s.external_work, s)
    };
    // the first step is a kick of half a step
    frame.step(dt).unwrap();
    let (first, start) = left(&frame);
    let (mut largest, mut apart) = (0.0_f64, 0.0_f64);
    for _ in 0..(0.5 / dt) as usize {
        frame.step(dt).unwrap();
        let (now, sample) = left(&frame);
        largest = larger(largest, sample.elastic);
        apart = larger(apart, (now - first).abs());
        let drift = (0..2).map(|c| (sample.momentum[c] - start.momentum[c]).abs()).fold(0.0, larger);
        assert!(drift <= 1e-12, "momentum drifts by {drift:e}");
    }
    let mass: f64 = frame.fields()[0].points().iter().map(|p| p.volume).sum();
    assert!((mass - 1.0).abs() <= 1e-12);
    assert!(frame.transfer_losses().relaxation >= 0.0);
    (largest, apart / largest)
}

#[test]
fn momentum_is_kept_and_the_ledger_closes_with_the_mesh() {
    for degree in [2, 3] {
        let ((elastic, coarse), (_, fine)) = (vibrate(degree, 8), vibrate(degree, 16));
        println!("p = {degree}: elastic energy {elastic:.2e}, closure over it {coarse:.1e} and {fine:.1e}");
        assert!(elastic > 1e-4);
        // the trapezoidal sum of the work is of order dt², fit and quadrature are of higher order; dt
        // goes with h
        assert!(fine <= coarse / 4.0, "p = {degree}: {coarse:e}, {fine:e}");
        assert!(fine <= 1e-2, "p = {degree}: {fine:e}");
    }
}

#[test]
fn a_rigid_flight_strains_nothing() {
    for degree in [2, 3] {
        let mut scene = flying(degree, 8);
        scene.analysis.gravity = [0.0, -0.2];
        let mut frame = UpdatedFrame::new(&scene).unwrap();
        let dt = 0.3 * frame.critical_step();
        let steps = (0.5 / dt).ceil();
        (0..steps as usize).for_each(|_| frame.step(dt).unwrap());
        assert!(frame.elastic_energy() <= 1e-24, "p = {degree}: {:e}", frame.elastic_energy());
        for point in frame.fields()[0].points() {
            let expected = [0.6 * frame.time(), 0.3 * frame.time() - 0.1 * frame.time().powi(2)];
            (0..2).for_each(|d| assert!((point.displacement[d] - expected[d]).abs() <= 1e-11, "p = {degree}"));
        }
    }
}

#[test]
fn points_show_the_strain_and_stress_that_spans_integrate() {
    let mut scene = flying(2, 16);
    scene.bodies[0].angular_velocity = 0.6;
    let (simulation, _) = run(&scene);
    let frame = simulation.updated_frame().unwrap();
    let volumes: Vec<f64> = frame.fields()[0].points().iter().map(|point| point.volume).collect();
    let mut energy = 0.0;
    simulation.for_each_point(&mut |point| {
        let ([xx, yy, xy], stress) = (point.strain, point.stress);
        energy += 0.5 * volumes[point.point] * (stress[0] * xx + stress[1] * yy + 2.0 * stress[2] * xy);
    });
    // two quadratures of one energy: points of three by three a cell, and Gauss points of cut spans
    let elastic = frame.elastic_energy();
    assert!(elastic > 1e-6 && (energy / elastic - 1.0).abs() <= 0.02, "{energy:e} instead of {elastic:e}");
}
