//! What more threads bring: steps of an elastic block, of moving points and of the plate while it cracks, in
//! wall time. All points must be the same bit by bit for any number of threads.

use fisura::Simulation;
use fisura::scene::Scene;
use rayon::ThreadPool;

use super::block::{MARGIN, elastic_scene, moving_scene};
use super::plate_scene;
use super::record::{BenchRecord, Clock};
use super::timing::{Stopwatch, pool};
use super::{BenchError, Settings, advance};

/// Largest closure of the ledger over its largest term, as for the plate.
const CLOSURE: f64 = 1e-3;

/// A scene on its way with some number of threads.
struct Runner {
    pool: ThreadPool,
    simulation: Simulation,
    record: BenchRecord,
}

/// Numbers of threads to try: 1, 2, 4, … and the most.
fn numbers(most: usize) -> Vec<usize> {
    let mut numbers: Vec<usize> = std::iter::successors(Some(1), |n| Some(2 * n)).take_while(|n| *n < most).collect();
    numbers.push(most.max(1));
    numbers.dedup();
    numbers
}

/// Times the steps.
///
/// # Errors
/// If a scene cannot be run.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let cells = if settings.quick { 192 } else { 256 };
    let plate = plate_scene::half(settings, 2, if settings.quick { 1.0 } else { 0.5 })?.scene;
    let mut records = scaled(settings, "elastic", "elastic block, p = 2", &elastic_scene(2, 2, cells, 0), [5, 20])?;
    records.extend(scaled(settings, "moving", "moving points, p = 2", &moving_scene(2, 2, cells, MARGIN), [5, 20])?);
    let steps = if settings.quick { [400, 10] } else { [800, 20] };
    records.extend(scaled(settings, "plate", "plate with a growing crack, p = 2", &plate, steps)?);
    Ok(records)
}

/// One scene with every number of threads: `run_up` steps, then samples of `steps` steps in turn.
fn scaled(
    settings: &Settings,
    name: &str,
    label: &str,
    scene: &Scene,
    [run_up, steps]: [usize; 2],
) -> Result<Vec<BenchRecord>, BenchError> {
    let mut runners = Vec::new();
    for threads in numbers(settings.threads) {
        let pool = pool(threads)?;
        let mut simulation = pool.install(|| Simulation::new(scene))?;
        pool.install(|| advance(&mut simulation, run_up))?;
        let extent = simulation.extent();
        let id = format!("threads/{name}/{threads}");
        let mut record = BenchRecord::of_steps(id, label, &extent, steps).with("threads", threads);
        (record.threads, record.clock) = (threads, Clock::Wall);
        runners.push(Runner { pool, simulation, record });
    }
    for _ in 0..settings.rounds() {
        for Runner { pool, simulation, record } in &mut runners {
            let watch = Stopwatch::start();
            pool.install(|| advance(simulation, steps))?;
            record.samples.push(watch.read());
        }
    }
    let first = bits(&runners[0].simulation);
    let finish = |mut runner: Runner| {
        let sample = runner.simulation.sample();
        let closure = sample.closure.abs() / sample.largest_term();
        runner.record.verify_at_most("closure of the ledger over the largest term", closure, CLOSURE);
        if bits(&runner.simulation) != first {
            runner.record.verify(false, "points are not the same bits as with one thread");
        }
        runner.record.summarise();
        runner.record
    };
    Ok(runners.into_iter().map(finish).collect())
}

/// Position, velocity, stress and phase field of every point, bit by bit.
fn bits(simulation: &Simulation) -> Vec<u64> {
    let mut bits = Vec::new();
    simulation.for_each_point(&mut |point| {
        let numbers = point.present.into_iter().chain(point.velocity).chain(point.stress);
        bits.extend(numbers.chain(point.fracture.map(|fracture| fracture.phase)).map(f64::to_bits));
    });
    bits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_threads_double_and_end_with_the_most() {
        assert_eq!(numbers(1), [1]);
        assert_eq!(numbers(2), [1, 2]);
        assert_eq!(numbers(6), [1, 2, 4, 6]);
    }
}
