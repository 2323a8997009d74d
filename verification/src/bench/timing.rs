//! Clocks, repetitions in round robin, pools of threads.

use std::time::Instant;

use fisura::Simulation;
use fisura::scene::Scene;

use super::BenchError;
use super::record::{BenchRecord, Sample};
use crate::output::history::Table;
use crate::scene_run::run_scene;

/// Wall and processor time since it was started.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch {
    wall: Instant,
    cpu: Option<f64>,
}

impl Stopwatch {
    /// Starts to measure wall time and processor time.
    pub fn start() -> Self {
        Self { cpu: process_seconds(), wall: Instant::now() }
    }

    /// What has passed since.
    pub fn read(&self) -> Sample {
        let wall_s = self.wall.elapsed().as_secs_f64();
        let cpu = self.cpu.zip(process_seconds()).map(|(start, now)| now - start);
        Sample { wall_s, cpu_s: cpu.unwrap_or(wall_s) }
    }
}

/// Processor time of all threads of this process, s, where the system tells.
#[cfg(unix)]
fn process_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

/// Processor time of all threads of this process, s, where the system tells.
#[cfg(not(unix))]
fn process_seconds() -> Option<f64> {
    None
}

/// Wall time and processor time of some work.
pub fn time(work: impl FnOnce()) -> Sample {
    timed(work).0
}

/// Time of some work, and what it gives.
pub fn timed<T>(work: impl FnOnce() -> T) -> (Sample, T) {
    let watch = Stopwatch::start();
    let result = work();
    (watch.read(), result)
}

/// Calls of a short piece of work, given the time of one, that make a sample of about a twentieth of a
/// second.
fn calls_of(once: Sample) -> usize {
    ((0.05 / once.cpu_s.max(1e-7)).ceil() as usize).clamp(1, 2000)
}

/// One contestant: its record, and what runs it once. It may note in the record what it found.
pub struct Contestant<'a> {
    /// Record without samples.
    pub record: BenchRecord,
    /// Runs the contestant once and measures its time.
    pub run: Run<'a>,
}

/// A run of a scene from memory to the last row of its history, whose ledger has to close to `closure` of the
/// largest energy; `answer` notes what its history gave.
pub fn whole_run<'a>(
    record: BenchRecord,
    scene: Scene,
    closure: f64,
    answer: impl Fn(&mut BenchRecord, &Table) + 'a,
) -> Contestant<'a> {
    let run = move |record: &mut BenchRecord| {
        let (sample, run) = timed(|| run_scene(&scene, &mut |_| {}, &mut |_, _| {}));
        if let Some(breakdown) = run.breakdown {
            return Err(breakdown.into());
        }
        let open = run.summary.largest_closure_over_largest_energy;
        record.verify_at_most("closure of the ledger over the largest energy", open, closure);
        answer(record, &run.history);
        Ok(sample)
    };
    Contestant { record, run: Box::new(run) }
}

/// Runs a contestant once.
pub type Run<'a> = Box<dyn FnMut(&mut BenchRecord) -> Result<Sample, BenchError> + 'a>;

impl<'a> Contestant<'a> {
    /// A short piece of work, `amount` units a call, called as often as a sample needs.
    pub fn short(mut record: BenchRecord, mut work: impl FnMut() + 'a) -> Self {
        let calls = calls_of(time(&mut work));
        record.work.amount *= calls as f64;
        Self { record, run: Box::new(move |_| Ok(time(|| (0..calls).for_each(|_| work())))) }
    }

    /// Steps of a simulation, as many as a sample needs.
    ///
    /// # Errors
    /// A step that breaks down; so does the run of the contestant.
    pub fn steps(mut record: BenchRecord, mut simulation: Simulation) -> Result<Self, BenchError> {
        let (sample, stepped) = timed(|| simulation.step());
        stepped?;
        let calls = calls_of(sample);
        record.work.amount *= calls as f64;
        let run = move |_: &mut BenchRecord| time_steps(&mut simulation, calls);
        Ok(Self { record, run: Box::new(run) })
    }
}

/// Time of steps of a simulation.
///
/// # Errors
/// A step that breaks down.
pub fn time_steps(simulation: &mut Simulation, steps: usize) -> Result<Sample, BenchError> {
    let (sample, stepped) = timed(|| super::advance(simulation, steps));
    stepped?;
    Ok(sample)
}

/// Runs the contestants one after the other, round after round: what disturbs the machine meets all of them.
/// One whose samples add up to more than `budget` seconds is left out of further rounds.
///
/// # Errors
/// The first contestant that cannot be run.
pub fn round_robin(
    mut contestants: Vec<Contestant<'_>>,
    rounds: usize,
    budget: f64,
) -> Result<Vec<BenchRecord>, BenchError> {
    for _ in 0..rounds {
        for Contestant { record, run } in &mut contestants {
            if record.samples.iter().map(|s| s.wall_s).sum::<f64>() <= budget {
                let sample = run(record)?;
                record.samples.push(sample);
            }
        }
    }
    let finished = contestants.into_iter().map(|Contestant { mut record, .. }| {
        record.summarise();
        record
    });
    Ok(finished.collect())
}

/// A pool of `threads` threads.
///
/// # Errors
/// If they cannot be started.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, BenchError> {
    let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    built.map_err(|e| BenchError::input(format!("{threads} threads cannot be started: {e}")))
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    #[test]
    fn contestants_take_turns_and_a_long_one_is_not_repeated() {
        let order = RefCell::new(Vec::new());
        let contestant = |name: &'static str, seconds: f64| {
            let order = &order;
            let run = move |_: &mut BenchRecord| {
                order.borrow_mut().push(name);
                Ok(Sample { wall_s: seconds, cpu_s: seconds })
            };
            Contestant { record: BenchRecord::new(name, name, 1.0, "solve"), run: Box::new(run) }
        };
        let records = round_robin(vec![contestant("short", 0.1), contestant("long", 3.0)], 3, 2.0).unwrap();
        assert_eq!(*order.borrow(), ["short", "long", "short", "short"]);
        assert_eq!(records.iter().map(|r| r.samples.len()).collect::<Vec<_>>(), [3, 1]);
        assert_eq!(records[0].wall_s.median, 0.1);
    }

    #[test]
    fn processor_time_of_busy_work_and_wall_time_of_sleep_are_counted() {
        let mut x = 1.0_f64;
        let busy = time(|| (0..20_000_000).for_each(|i| x += (i as f64).sqrt()));
        assert!(x > 1.0 && busy.cpu_s > 0.0 && busy.wall_s > 0.0);
        let idle = time(|| std::thread::sleep(std::time::Duration::from_millis(50)));
        assert!(idle.wall_s >= 0.05);
    }
}
