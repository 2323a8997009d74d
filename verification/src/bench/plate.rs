//! What an error of the impact-loaded plate costs: whole runs to 80 µs, from the scene in memory to the last
//! row of the history, in processor time of all threads. The error is the kinetic energy against the
//! independent finite elements, as the cases of the suite measure it. The finite elements themselves run in
//! the same rounds ([`elements`]); where they cannot be built, what they took elsewhere
//! stands beside it.
//!
//! Besides equal spans and the tolerance of the suite there is what someone in a hurry would run: spans twice
//! as long where no crack runs, and a tolerance of the phase field that changes the energies by about as much
//! as the finest meshes are off. What a tolerance does to the energies is a diagram of its own, against a run
//! with 2e-8.

use std::sync::Arc;

use fisura::Simulation;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::scene::Scene;

use super::plate_error::{TIGHT_TOLERANCE, difference_of_energies, error_of_kinetic};
use super::record::{AnswerError, BenchRecord, CostPoint};
use super::timing::{Contestant, Stopwatch, pool, round_robin};
use super::{BenchError, Settings, elements};
use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::extremes::larger;
use crate::output::history::Table;
use crate::reference::Library;
use crate::scene_run::run_scene;

/// Quantity of the reference.
const KINETIC: &str = "plate/kinetic-energy";
/// Its folder.
const REFERENCE: &str = "independent-fem";
/// What the finite elements took, and the error they had.
const COST: &str = "plate/kinetic-error-against-processor-time";
/// The suite asks for the same closure of the ledger.
const CLOSURE: f64 = 1e-3;

/// Tolerances of the phase field whose effect is shown.
const TOLERANCES: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 2e-6];
/// Finest mesh for p = 4, length scales: a finer one would take as long as all others together.
const FINEST_QUARTIC: f64 = 1.0;
/// Tolerance of the phase field for someone in a hurry.
const LOOSE_TOLERANCE: f64 = 1e-3;
/// Where the short spans begin in x and end in y for someone in a hurry, m: the crack starts at x = 50 mm and
/// is 14.3 mm off the axis at the right edge.
const SHORT_SPANS: [f64; 2] = [44e-3, 36e-3];

/// Runs the half plate on its meshes.
///
/// # Errors
/// If a case or the reference is missing, or a run breaks down.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let library = settings.library()?;
    let missing = || BenchError::input(format!("there is no curve {KINETIC} in {REFERENCE}"));
    let reference = library.curve(REFERENCE, KINETIC).ok_or_else(missing)?;
    let meshes: &[f64] = if settings.quick { &[2.0, 1.0] } else { &[2.0, 1.0, 0.5] };
    let hurried: &[f64] = if settings.quick { &[1.0, 0.7] } else { &[1.0, 0.7, 0.5, 0.4] };
    let threads = settings.threads;
    let elements = settings.elements.get_or_init(|| elements::build(&settings.workspace));
    pool(threads)?
        .install(|| {
            let mut contestants = Vec::new();
            let against_elements = |history: &Table, factor: f64| {
                error_of_kinetic(history.column("time_s")?, history.column("kinetic_j")?, factor, reference)
            };
            for degree in if settings.quick { 2..=3 } else { 1..=4 } {
                for &h in meshes.iter().filter(|&&h| degree < 4 || h >= FINEST_QUARTIC) {
                    let name = (format!("plate/p{degree}/h{h}"), format!("p = {degree}"));
                    contestants.push(plate(half(settings, degree, h)?, name, h, threads, against_elements)?);
                }
                let hurried = if [2, 3].contains(&degree) { hurried } else { &[] };
                for &h in hurried {
                    let label = format!("p = {degree}, graded, tolerance {LOOSE_TOLERANCE:e}");
                    let name = (format!("plate/p{degree}-graded/h{h}"), label);
                    contestants.push(plate(graded(settings, degree, h)?, name, h, threads, against_elements)?);
                }
            }
            if let Ok(program) = elements {
                contestants.extend(elements::contestants(settings, program, reference)?);
            }
            contestants.extend(tolerances(settings, if settings.quick { 2.0 } else { 1.0 })?);
            round_robin(contestants, if settings.quick { 1 } else { 3 }, settings.budget())
        })
        .and_then(|mut records| {
            records.extend(pool(1)?.install(|| share(settings))?);
            Ok(records)
        })
}

/// Steps of the plate while it cracks, on one thread, and in each of them the part of the phase field: the
/// same solve, from the same start with the same history, done once more and timed on its own.
fn share(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let (scene, run_up, steps) = if settings.quick {
        (half(settings, 2, 1.0)?.scene, 400, 20)
    } else {
        let paper = Case::load(&settings.plate_case("paper-p2-262144"), &[])?.scenes()?;
        let first = paper.into_iter().next().ok_or_else(|| BenchError::input("the case of the paper has no scene"))?;
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

/// The half plate of the cases with square spans of `h` length scales, as many Gauss points per direction as
/// the degree but at least two, without pictures.
///
/// # Errors
/// If the case is missing or wrong.
pub fn half(settings: &Settings, degree: usize, h: f64) -> Result<CaseScene, BenchError> {
    let cells = [400.0, 80.0].map(|n| (n / h).round());
    let cells = format!("mesh.cells=[{}, {}]", cells[0], cells[1]);
    let points = degree.max(2);
    let points = format!("body.0.particles_per_cell=[{points}, {points}]");
    let overrides = [cells, points, format!("mesh.degree={degree}"), "output.frames=[]".to_string()];
    let case = Case::load(&settings.plate_case("half-p2-h1"), &overrides)?;
    case.scenes()?.into_iter().next().ok_or_else(|| BenchError::input("the case of the plate has no scene"))
}

/// The same with spans of twice `h` where no crack runs, and [`LOOSE_TOLERANCE`].
fn graded(settings: &Settings, degree: usize, h: f64) -> Result<CaseScene, BenchError> {
    let mut case = half(settings, degree, h)?;
    let materials = case.scene.materials.values();
    let span = h * materials.filter_map(|m| m.fracture.as_ref()).map(|f| f.length_scale).fold(0.0, larger);
    let (low, high) = (case.scene.mesh.origin(), case.scene.mesh.end());
    let parts = [
        [(low[0], SHORT_SPANS[0], 2.0 * span), (SHORT_SPANS[0], high[0], span)],
        [(low[1], SHORT_SPANS[1], span), (SHORT_SPANS[1], high[1], 2.0 * span)],
    ];
    case.scene.mesh.knots = parts.map(|parts| open_knots(degree, &parts));
    case.scene.solver.phase_field_tolerance = LOOSE_TOLERANCE;
    Ok(case)
}

/// Open knots with spans of about the given length in each part `(from, to, length)`.
fn open_knots(degree: usize, parts: &[(f64, f64, f64)]) -> Vec<f64> {
    let (start, end) = (parts[0].0, parts[parts.len() - 1].1);
    let mut knots = vec![start; degree];
    for &(from, to, length) in parts {
        let spans = ((to - from) / length).round();
        knots.extend((0..spans as usize).map(|i| from + (to - from) * (i as f64 / spans)));
    }
    knots.extend(std::iter::repeat_n(end, degree + 1));
    knots
}

/// The half plate with looser and looser tolerances of the phase field, p = 2.
fn tolerances<'a>(settings: &Settings, h: f64) -> Result<Vec<Contestant<'a>>, BenchError> {
    let with = |tolerance: f64| {
        let mut case = half(settings, 2, h)?;
        case.scene.solver.phase_field_tolerance = tolerance;
        Ok::<_, BenchError>(case)
    };
    let tight = run_scene(&with(TIGHT_TOLERANCE)?.scene, &mut |_| {}, &mut |_, _| {});
    if let Some(breakdown) = tight.breakdown {
        return Err(breakdown.into());
    }
    let tight = Arc::new(tight.history);
    let contestant = |tolerance: f64| {
        let tight = Arc::clone(&tight);
        let name = (format!("plate/tolerance/{tolerance:e}"), format!("p = 2, h = {h} l0"));
        plate(with(tolerance)?, name, h, settings.threads, move |history, _| difference_of_energies(history, &tight))
    };
    TOLERANCES.into_iter().map(contestant).collect()
}

/// Stored costs of the finite elements, on another machine.
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
    (id, label): (String, String),
    h: f64,
    threads: usize,
    error: impl Fn(&Table, f64) -> Option<AnswerError> + 'a,
) -> Result<Contestant<'a>, BenchError> {
    let prepared = Simulation::new(&case.scene)?;
    let (extent, steps) = (prepared.extent(), prepared.plan().steps());
    drop(prepared);
    let work = (extent.particles * steps) as f64;
    let mut record = BenchRecord::new(id, label, work, "particle-step")
        .with("degree", case.scene.mesh.degree[0])
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
        let closure = run.summary.largest_closure_over_largest_energy;
        record.verify_at_most("closure of the ledger over the largest energy", closure, CLOSURE);
        record.error = error(&run.history, case.energy_factor);
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
    fn the_half_plate_has_spans_of_the_size_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let out = crate::output::OutputFolder::open(folder.path(), "bench").unwrap();
        let settings = Settings {
            quick: true,
            threads: 1,
            workspace: crate::bench::own_workspace(),
            out: &out,
            baseline: None,
            peer: None,
            peer_timeout: std::time::Duration::ZERO,
            families: vec![],
            elements: Default::default(),
        };
        let case = half(&settings, 3, 2.0).unwrap();
        let spans = case.scene.mesh.knots.each_ref().map(|knots| knots.len() - 7);
        assert_eq!((spans, case.energy_factor, case.scene.output.frames.len()), ([200, 40], 2.0, 0));
        let knots = &graded(&settings, 2, 1.0).unwrap().scene.mesh.knots;
        let spans = knots.each_ref().map(|knots| knots.windows(2).map(|k| k[1] - k[0]).filter(|d| *d > 0.0));
        for ((spans, count), length) in spans.into_iter().zip([88 + 224, 64 + 8]).zip([0.1, 0.02]) {
            let spans: Vec<f64> = spans.collect();
            assert!((spans.iter().sum::<f64>() - length).abs() < 1e-15 && spans.len() == count);
            assert!(spans.iter().all(|d| (d / 0.25e-3 - 1.0).abs() < 1e-9 || (d / 0.5e-3 - 1.0).abs() < 1e-9));
        }
    }
}
