//! What the transfers of the updated frame lose of a bar's vibration while points cross spans.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::standing_wave::StandingWave;
use crate::common::{rectangle, unit_solid, updated_scene};
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::linear_algebra::extremes::larger;
use fisura::particles::points::Point;
use fisura::scene::*;

/// A bar of two rows of spans without lateral contraction, held in x at both ends.
fn bar(degree: usize, cells: usize, transfer: Transfer) -> Scene {
    let h = 1.0 / cells as f64;
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [1.0, 2.0 * h], [cells, 2]);
    let mut scene = updated_scene(unit_solid(), mesh, rectangle([0.0; 2], [1.0, 2.0 * h]));
    scene.materials.get_mut("solid").unwrap().poisson_ratio = 0.0;
    let hold = |side| Boundary::fixed(side, [true, false]);
    scene.boundaries = [Side::Left, Side::Right].map(hold).into();
    scene.analysis.transfer = transfer;
    scene
}

/// Losses per period over the first energy, for points that cross 1.28 of 32 spans and back: mean of four
/// periods.
fn loss_per_period(degree: usize, transfer: Transfer) -> f64 {
    let wave = StandingWave(0.04);
    let mut scene = bar(degree, 32, transfer);
    scene.bodies[0].layout = Layout::Uniform;
    scene.bodies[0].particles_per_cell = [4; 2];
    scene.analysis.kinematics = Kinematics::Finite;
    let mut frame = UpdatedFrame::new(&scene).unwrap();
    frame.set_initial_velocity(|[x, _]| [0.04 * PI * (PI * x).sin(), 0.0]);
    frame.apply_forcing(Arc::new(StandingWave(0.04)));
    let dt = 0.2 / 32.0;
    let start = frame.sample(dt);
    (0..320 * 4).for_each(|_| frame.step(dt).unwrap());
    let mut end = frame.sample(dt);
    end.close(start.stored());
    // The wave is followed up to the dispersion of lumped mass (0.12 % of the frequency, 3 % of a radian per
    // period) and the noise of points that cross spans, and the work of the forcing is booked.
    let off = |p: &Point| (p.displacement[0] - wave.displacement(p.reference()[0], frame.time())).abs();
    let off = frame.fields[0].points.iter().map(off).fold(0.0, larger);
    assert!(off <= 0.04 * 0.08, "{transfer:?}, p = {degree}: {off:e} m off the wave");
    assert!(end.closure.abs() <= 1e-4 * start.kinetic, "{transfer:?}, p = {degree}: closure {:e}", end.closure);
    end.transfer_loss.unwrap() / start.kinetic / 4.0
}

#[test]
fn losses_per_period_stay_small_when_points_cross_spans() {
    for (degree, flip) in [(2, 0.005), (3, 0.0015)] {
        for (transfer, most) in [(Transfer::Flip, flip), (Transfer::Apic, 0.005)] {
            let loss = loss_per_period(degree, transfer);
            println!("{transfer:?}, p = {degree}: {loss:.2e} of the energy per period");
            assert!((0.0..=most).contains(&loss), "{transfer:?}, p = {degree}: {loss:e}");
        }
    }
}
