//! Steps without a solve of the phase field.

use crate::common::{notched_plate, relative_closure, run};
use fisura::Simulation;
use fisura::dynamics::energy::Sample;
use fisura::material::split::driving_energy;
use fisura::scene::*;

fn cracking(interval: PhaseFieldInterval) -> (usize, Vec<Sample>) {
    let mut scene = notched_plate(4e6);
    scene.analysis.end_time = 3.2e-6;
    scene.solver.phase_field_interval = interval;
    let (simulation, samples) = run(&scene);
    (simulation.phase_field_counts().solves, samples)
}

#[test]
fn the_ledger_closes_with_the_work_between_solves_and_is_open_without_it() {
    let (all, every_step) = cracking(PhaseFieldInterval::Steps(1));
    assert!(every_step.iter().all(|s| s.fracture.as_ref().unwrap().works.len() == 1));
    for interval in [PhaseFieldInterval::Steps(2), PhaseFieldInterval::Steps(3), PhaseFieldInterval::Automatic] {
        let (solves, samples) = cracking(interval);
        assert!(solves < 2 * all / 3, "{interval:?}: {solves} solves of {all}");
        let closure = relative_closure(&samples);
        assert!(closure <= 1e-3 && closure <= 2.0 * relative_closure(&every_step), "{interval:?}: closure {closure:e}");
        let end = samples.last().unwrap();
        let work = end.fracture.as_ref().unwrap().works[1].1;
        assert!(
            work.abs() > 3.0 * end.closure.abs(),
            "{interval:?}: {work:e} J is no part of closure {:e}",
            end.closure
        );
        let apart = (end.stored() / every_step.last().unwrap().stored() - 1.0).abs();
        assert!(apart < 0.02, "{interval:?}: the stored energy is {apart:e} from that with a solve in every step");
    }
}

#[test]
fn an_interval_that_is_too_long_warns() {
    let warnings = |interval| {
        let mut scene = notched_plate(4e6);
        scene.analysis.end_time = 3.2e-6;
        scene.output.samples = 2;
        scene.solver.phase_field_interval = PhaseFieldInterval::Steps(interval);
        run(&scene).0.warnings().to_vec()
    };
    assert_eq!(warnings(2), [""; 0]);
    let found = warnings(20);
    assert!(found.iter().any(|warning| warning.contains("lower solver.phase_field_interval")), "{found:?}");
}

/// Also between solves, where the sweep of the stress updates it.
#[test]
fn the_history_is_never_below_the_present_driving_energy() {
    let mut scene = notched_plate(4e6);
    scene.analysis.end_time = 3.2e-6;
    scene.output.samples = 2;
    scene.solver.phase_field_interval = PhaseFieldInterval::Steps(5);
    let mut simulation = Simulation::new(&scene).unwrap();
    for step in 0..simulation.plan().steps() {
        simulation.step().unwrap();
        let frame = simulation.total_frame().unwrap();
        let (fracture, lattice) = (frame.fracture.as_ref().unwrap(), &frame.lattice);
        for (batch, history) in fracture.history.iter().enumerate() {
            let [(_, x), (_, y)] = frame.displacement.each_ref().map(|u| lattice.interpolate(batch, u));
            let energy = driving_energy(&frame.moduli, fracture.model.split, [x[0], y[1], (x[1] + y[0]) * 0.5]);
            let below = energy.0.iter().zip(history.0).any(|(energy, history)| history < energy * (1.0 - 1e-9) - 1e-6);
            assert!(!below, "step {step}, batch {batch}: H = {history:?}, psi+ = {energy:?}");
        }
    }
}
