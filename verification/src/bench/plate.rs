//! What an error of the impact-loaded plate costs: whole runs to 80 µs, from the scene in memory to the last row of the
//! history, in processor time of all threads. The error is the kinetic energy against the independent finite elements, as
//! the cases of the suite measure it; the finite elements themselves stand beside it with what they took.

use fisura::Simulation;
use fisura::scene::Scene;
use fisura::total_frame::TotalFrame;

use super::record::{AnswerError, BenchRecord, CostPoint};
use super::timing::{Contestant, Stopwatch, pool, round_robin};
use super::{BenchError, Settings};
use crate::case::Case;
use crate::expand::CaseScene;
use crate::reference::{Library, ReferenceCurve, relative_rms};
use crate::scene_run::run_scene;

/// Quantity of the reference.
const KINETIC: &str = "plate/kinetic-energy";
/// Its folder.
const REFERENCE: &str = "independent-fem";
/// What the finite elements took, and the error they had.
const COST: &str = "plate/kinetic-error-against-processor-time";
/// Window of the comparison, s.
const WINDOW: [f64; 2] = [5e-6, 80e-6];
/// The suite asks for the same closure of the ledger.
const CLOSURE: f64 = 1e-3;

/// Runs the half plate on its meshes.
///
/// # Errors
/// If a case or the reference is missing, or a run breaks down.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let library = settings.library()?;
    let missing = || BenchError::other(format!("there is no curve {KINETIC} in {REFERENCE}"));
    let reference = library.curve(REFERENCE, KINETIC).ok_or_else(missing)?;
    let meshes: &[f64] = if settings.quick { &[2.0, 1.0] } else { &[2.0, 1.0, 0.5] };
    let threads = settings.threads;
    pool(threads)?
        .install(|| {
            let mut contestants = Vec::new();
            for degree in [2, 3] {
                for &h in meshes {
                    contestants.push(plate(half(settings, degree, h)?, degree, h, threads, reference)?);
                }
            }
            round_robin(contestants, if settings.quick { 1 } else { 3 }, settings.budget())
        })
        .and_then(|mut records| {
            records.extend(pool(1)?.install(|| share(settings))?);
            Ok(records)
        })
}

/// Steps of the plate while it cracks, on one thread, and in each of them the part of the phase field: the same solve, from the
/// same start with the same history, done once more and timed on its own.
fn share(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let (scene, run_up, steps) = if settings.quick {
        (half(settings, 2, 1.0)?.scene, 400, 20)
    } else {
        let paper = Case::load(&settings.plate_case("paper-p2-262144"), &[])?.scenes()?;
        let first = paper.into_iter().next().ok_or_else(|| BenchError::other("the case of the paper has no scene"))?;
        (first.scene, 900, 100)
    };
    share_of(&scene, run_up, steps)
}

/// The same of a scene in the total frame, after some steps.
fn share_of(scene: &Scene, run_up: usize, steps: usize) -> Result<Vec<BenchRecord>, BenchError> {
    let dt = Simulation::new(scene)?.plan().step;
    let broken = || BenchError::other("the phase field of the plate does not converge");
    let mut frame = TotalFrame::new(scene).map_err(|_| broken())?;
    (0..run_up).try_for_each(|_| frame.step(dt)).map_err(|_| broken())?;
    let points = frame.lattice().count();
    let record = |name: &str, label: &str| {
        BenchRecord::new(format!("plate/share/{name}"), label, points as f64, "particle-step").with("particles", points)
    };
    let mut whole = record("step", "step of the plate with a growing crack");
    let mut solve = record("phase-field", "its phase field: assembly and solve");
    whole.memory_bytes = frame.bytes().iter().sum::<usize>() as u64;
    let (mut same, mut iterations) = (true, 0);
    for _ in 0..steps {
        let mut before = frame.fracture.clone().ok_or_else(|| BenchError::other("the plate does not fracture"))?;
        let watch = Stopwatch::start();
        frame.step(dt).map_err(|_| broken())?;
        whole.samples.push(watch.read());
        let after = frame.fracture.as_ref().ok_or_else(|| BenchError::other("the plate does not fracture"))?;
        before.history.clone_from(&after.history);
        let watch = Stopwatch::start();
        before.solve_phase_field(frame.lattice()).map_err(|_| broken())?;
        solve.samples.push(watch.read());
        same &= before.field.control_values() == after.field.control_values();
        iterations += after.iterations;
    }
    for record in [&mut whole, &mut solve] {
        record.verify(
            same && iterations > 0,
            format!("the same bits both times; {iterations} iterations in {steps} steps"),
        );
        record.summarise();
    }
    Ok(vec![whole, solve])
}

/// The half plate of the cases with square spans of `h` length scales, without pictures.
///
/// # Errors
/// If the case is missing or wrong.
pub fn half(settings: &Settings, degree: usize, h: f64) -> Result<CaseScene, BenchError> {
    let cells = [400.0, 80.0].map(|n| (n / h).round());
    let cells = format!("mesh.cells=[{}, {}]", cells[0], cells[1]);
    let overrides = [cells, "output.frames=[]".to_string()];
    let case = Case::load(&settings.plate_case(&format!("half-p{degree}-h1")), &overrides)?;
    case.scenes()?.into_iter().next().ok_or_else(|| BenchError::other("the case of the plate has no scene"))
}

/// Costs of the finite elements.
pub fn finite_elements(library: &Library) -> Vec<CostPoint> {
    let curves = library.curves(COST).into_iter();
    let points = curves.flat_map(|curve| {
        let source = library.source(curve.id.split('/').next().unwrap_or_default());
        let conditions = source.map(|s| s.resolution.clone()).unwrap_or_default();
        let point = move |(&cpu_s, &error): (&f64, &f64)| CostPoint {
            label: curve.label.clone(),
            cpu_s,
            error,
            conditions: conditions.clone(),
        };
        curve.x.iter().zip(&curve.y).map(point).collect::<Vec<_>>()
    });
    points.collect()
}

fn plate<'a>(
    case: CaseScene,
    degree: usize,
    h: f64,
    threads: usize,
    reference: &'a ReferenceCurve,
) -> Result<Contestant<'a>, BenchError> {
    let prepared = Simulation::new(&case.scene)?;
    let (extent, steps) = (prepared.extent(), prepared.plan().steps());
    drop(prepared);
    let work = (extent.particles * steps) as f64;
    let mut record = BenchRecord::new(format!("plate/p{degree}/h{h}"), format!("p = {degree}"), work, "particle-step")
        .with("degree", degree)
        .with("h_over_l0", h)
        .with("particles", extent.particles)
        .with("steps", steps);
    record.threads = threads;
    record.memory_bytes = (extent.mechanics_bytes + extent.phase_field_bytes) as u64;
    let run = move |record: &mut BenchRecord| {
        let watch = Stopwatch::start();
        let run = run_scene(&case.scene, &mut |_| {}, &mut |_, _| {});
        let sample = watch.read();
        if let Some(breakdown) = run.breakdown {
            return Err(breakdown.into());
        }
        let column = |name| run.history.column(name).unwrap_or_default();
        let kinetic: Vec<f64> = column("kinetic_j").iter().map(|k| case.energy_factor * k).collect();
        let error = relative_rms(reference, column("time_s"), &kinetic, WINDOW[0], WINDOW[1]);
        let closure = run.summary.largest_closure_over_largest_energy;
        record.verify_at_most("closure of the ledger over the largest energy", closure, CLOSURE);
        record.error = error.map(|value| AnswerError {
            quantity: "kinetic energy, relative rms from 5 to 80 µs".into(),
            value,
            reference: reference.label.clone(),
            uncertainty: reference.uncertainty_relative,
        });
        if record.error.is_none() {
            record.verify(false, "the history does not cover the window of the comparison");
        }
        Ok(sample)
    };
    Ok(Contestant { record, run: Box::new(run) })
}

#[cfg(test)]
mod tests {
    use fisura::scene::{Edge, Side, Traction};

    use super::*;
    use crate::bench::block::cracked_scene;

    #[test]
    fn the_solve_of_a_step_done_once_more_gives_the_same_bits() {
        let mut scene = cracked_scene(2, 2, 16, 0);
        let pulled = |side, stress| Traction { edge: Edge::Side(side), stress: [0.0, stress], ramp: None };
        scene.bodies[0].tractions = vec![pulled(Side::Top, 4e6), pulled(Side::Bottom, -4e6)];
        let records = share_of(&scene, 10, 5).unwrap();
        assert!(records.iter().all(|r| r.verified && r.samples.len() == 5), "{records:?}");
    }

    #[test]
    fn the_half_plate_has_square_spans_of_the_size_asked_for() {
        let settings = Settings {
            quick: true,
            threads: 1,
            workspace: crate::bench::own_workspace(),
            out: std::path::PathBuf::new(),
            peer: None,
            families: vec![],
        };
        let case = half(&settings, 3, 2.0).unwrap();
        let spans = case.scene.mesh.knots.each_ref().map(|knots| knots.len() - 7);
        assert_eq!((spans, case.energy_factor, case.scene.output.frames.len()), ([200, 40], 2.0, 0));
    }
}
