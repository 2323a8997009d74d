//! The part of the phase field in a step of the plate while it cracks.

use fisura::Simulation;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::scene::Scene;

use super::plate_scene::half;
use super::record::BenchRecord;
use super::timing::timed;
use super::{BenchError, Settings};

/// Steps of the plate while it cracks, on one thread, and in each of them the part of the phase field: the
/// same solve, from the same start with the same history, done once more and timed on its own.
///
/// # Errors
/// If the case is missing, or a run breaks down.
pub fn share(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let (scene, run_up, steps) = if settings.quick {
        (half(settings, 2, 1.0)?.scene, 400, 20)
    } else {
        (settings.scene("plate/paper-p2-262144", &[])?.scene, 900, 100)
    };
    share_of(&scene, run_up, steps)
}

/// The same of a scene in the total frame, after some steps.
fn share_of(scene: &Scene, run_up: usize, steps: usize) -> Result<Vec<BenchRecord>, BenchError> {
    let dt = Simulation::new(scene)?.plan().step;
    let broken = || BenchError::other("the phase field of the plate does not converge");
    let mut frame = TotalFrame::new(scene).map_err(|_| broken())?;
    (0..run_up).try_for_each(|_| frame.step(dt)).map_err(|_| broken())?;
    let points = frame.lattice.count();
    let record = |name: &str, label: &str| {
        BenchRecord::new(format!("plate/share/{name}"), label, points as f64, "particle-step").with("particles", points)
    };
    let mut whole = record("step", "step of the plate with a growing crack");
    let mut solve = record("phase-field", "its phase field: assembly and solve");
    whole.memory_bytes = frame.bytes().iter().sum::<usize>() as u64;
    let (mut same, mut iterations) = (true, 0);
    for _ in 0..steps {
        let mut before = frame.fracture.clone().ok_or_else(|| BenchError::other("the plate does not fracture"))?;
        let (sample, stepped) = timed(|| frame.step(dt));
        stepped.map_err(|_| broken())?;
        whole.samples.push(sample);
        let after = frame.fracture.as_ref().ok_or_else(|| BenchError::other("the plate does not fracture"))?;
        before.history.clone_from(&after.history);
        let (sample, solved) = timed(|| before.field.solve(&frame.lattice, &before.history));
        solved.map_err(|_| broken())?;
        solve.samples.push(sample);
        same &= before.field.control_values() == after.field.control_values();
        iterations += after.iterations;
    }
    for record in [&mut whole, &mut solve] {
        let answer = format!("the same bits both times; {iterations} iterations in {steps} steps");
        record.verify(same && iterations > 0, answer);
        record.summarise();
    }
    Ok(vec![whole, solve])
}

#[cfg(test)]
mod tests {
    use fisura::scene::{Side, TimeFactor, Traction};

    use super::*;
    use crate::bench::block::cracked_scene;

    #[test]
    fn the_solve_of_a_step_done_once_more_gives_the_same_bits() {
        let mut scene = cracked_scene(2, 2, 16, 0);
        let pulled = |side, stress| Traction::on(side, [0.0, stress], TimeFactor::default());
        scene.bodies[0].tractions = vec![pulled(Side::Top, 4e6), pulled(Side::Bottom, -4e6)];
        let records = share_of(&scene, 10, 5).unwrap();
        assert!(records.iter().all(|r| r.verified && r.samples.len() == 5), "{records:?}");
    }
}
