//! The transfers of the updated frame: what each keeps, and that every loss is booked. See
//! `transfer_losses.rs` for what they lose.

use std::sync::Arc;

use crate::common::standing_wave::StandingWave;
use crate::common::{rectangle, relative_closure, run, unit_solid, updated_scene, with_threads};
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::scene::*;
use fisura::simulation::Simulation;

const ALL: [Transfer; 6] =
    [Transfer::Flip, Transfer::Pic, Transfer::Apic, Transfer::Tpic, Transfer::Xpic(2), Transfer::Xpic(5)];

/// A rectangle of modulus and density 1 on a mesh of equal spans.
fn scene(degree: usize, mesh: [f64; 2], cells: [usize; 2], min: [f64; 2], max: [f64; 2]) -> Scene {
    updated_scene(unit_solid(), Mesh::uniform([degree; 2], [0.0; 2], mesh, cells), rectangle(min, max))
}

/// Every condition at once: a driven side, a fixed one, gravity, a traction, and a flight that meets them.
fn eventful(transfer: Transfer, degree: usize) -> Scene {
    let mut scene = scene(degree, [1.0, 1.0], [16, 16], [0.0, 0.49], [0.813, 1.0]);
    scene.bodies[0].velocity = [-2e-3, 3.5e-3];
    scene.bodies[0].tractions = vec![Traction::on(Side::Right, [1e-3, 2e-3], TimeFactor::ramp(1.0))];
    scene.boundaries =
        vec![Boundary::driven(Side::Left, [true, false], [1.5e-3, 0.0]), Boundary::fixed(Side::Top, [false, true])];
    scene.analysis = Analysis { gravity: [0.0, 0.02], transfer, end_time: 6.0, ..scene.analysis };
    scene.output.samples = 40;
    scene
}

/// Closure over the largest energy of a finitely strained body in a run with `fraction` of the critical step.
fn finite_closure(transfer: Transfer, fraction: f64) -> f64 {
    let mut scene = eventful(transfer, 2);
    scene.bodies[0].velocity = [-0.05, 0.09];
    scene.bodies[0].angular_velocity = 0.1;
    scene.analysis.gravity = [0.0, 0.1];
    scene.analysis.kinematics = Kinematics::Finite;
    scene.analysis.safety = fraction;
    scene.analysis.end_time = 3.0;
    scene.output.samples = 20;
    relative_closure(&run(&scene).1)
}

#[test]
fn the_ledger_of_finite_strains_closes_at_second_order_in_the_step_with_every_transfer() {
    for transfer in ALL {
        let closures = [0.4, 0.2, 0.1].map(|fraction| finite_closure(transfer, fraction));
        let orders = [(closures[0] / closures[1]).log2(), (closures[1] / closures[2]).log2()];
        println!("{transfer:?}: closures {:.1e}, orders {orders:.2?}", closures[0]);
        assert!(closures[0] <= 1e-3, "{transfer:?}: closure {:e}", closures[0]);
        assert!(closures[2] <= 0.1 * closures[0], "{transfer:?}: {closures:?}");
    }
}

/// A body that is struck on one side and otherwise left alone, after 400 steps of `fraction` of the critical
/// step.
fn struck(transfer: Transfer, degree: usize, fraction: f64) -> bool {
    let mut scene = scene(degree, [1.0, 1.0], [16, 16], [0.237, 0.25], [0.75, 0.75]);
    let kick = Traction::on(Side::Left, [1e-6, 7e-7], TimeFactor::ramp(1e6));
    scene.bodies[0].tractions = vec![kick];
    scene.analysis.transfer = transfer;
    let critical = Simulation::new(&scene).unwrap().plan().critical;
    scene.analysis.time_step = TimeStep::Fixed(fraction * critical);
    scene.analysis.end_time = 400.0 * fraction * critical;
    scene.output.samples = 1;
    Simulation::new(&scene).unwrap().advance_to_next_sample().is_ok()
}

#[test]
fn the_critical_step_is_stable_with_every_transfer_and_the_limit_with_flip() {
    for degree in 2..=3 {
        assert!(!struck(Transfer::Flip, degree, 1.15), "p = {degree}: stable 15 % above the critical step");
        for transfer in ALL {
            assert!(struck(transfer, degree, 0.98), "{transfer:?}, p = {degree}: broke down below the critical step");
            let mut flying = scene(degree, [2.0, 2.0], [32, 32], [0.113, 0.517], [0.671, 1.013]);
            flying.bodies[0].velocity = [0.05, 0.03];
            flying.analysis.transfer = transfer;
            flying.analysis.safety = 0.8;
            flying.analysis.end_time = 12.5; // ten spans
            let (_, samples) = run(&flying);
            let end = samples.last().unwrap();
            let noise = end.elastic / end.kinetic;
            let most = if transfer == Transfer::Flip { 1e-24 } else { 1e-22 };
            assert!(noise <= most, "{transfer:?}, p = {degree}: noise of {noise:e} of the kinetic energy");
        }
    }
}

#[test]
fn one_thread_and_two_give_the_same_bits_with_every_transfer() {
    for transfer in ALL {
        let mut scene = eventful(transfer, 2);
        scene.analysis.kinematics = Kinematics::Finite;
        scene.analysis.end_time = 1.0;
        let on = |threads: usize| {
            with_threads(threads, || {
                let mut frame = UpdatedFrame::new(&scene).unwrap();
                frame.apply_forcing(Arc::new(StandingWave(1e-3)));
                (0..100).for_each(|_| frame.step(0.01).unwrap());
                (frame.fields[0].points.to_vec(), frame.sample(0.01))
            })
        };
        assert_eq!(on(1), on(2), "{transfer:?}");
    }
}
