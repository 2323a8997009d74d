//! A program of the user on the block of points that is timed here: `bench --peer CMD`.
//!
//! The folder it gets as its last argument holds
//!
//! - `particles.csv`: `x, y, volume, vx, vy` (m, m², m/s), one row per point;
//! - `block.json`: material, time step, number of steps, splines and the grid they live on.
//!
//! It runs the steps and may leave `result.csv` there, the same columns at the end; its kinetic energy is then held against
//! ours. It is run with two numbers of steps, and the difference of its times counts: start and end of the program cancel.

use std::process::{Command, Stdio};

use fisura::Simulation;
use fisura::scene::Scene;
use serde_json::json;

use super::block::{DENSITY, SPAN};
use super::moving_block::moving_scene;
use super::record::{BenchRecord, Sample};
use super::timing::{Contestant, Stopwatch, pool, round_robin};
use super::{BenchError, Settings};
use crate::history::Table;
use crate::output::OutputFolder;

/// Degree of the splines, and points per span and direction.
const DEGREE: usize = 2;
const POINTS: usize = 2;
/// Relative difference of kinetic energies that counts as the same answer: other shape functions at the edges and other
/// Least processor time of the steps that counts, s: the system tells the time of other programs to 10 ms.
const SHORTEST: f64 = 0.1;
/// transfers are allowed.
const SAME: f64 = 0.02;

/// Folders of the exchange: few steps, and many.
const FOLDERS: [&str; 2] = ["peer/short", "peer/long"];

/// The block as the peer finds it.
struct Exchange<'a> {
    command: String,
    out: &'a OutputFolder,
    steps: [usize; 2],
    /// Our kinetic energy after the larger number of steps, J/m.
    kinetic: f64,
}

/// Times the peer and our updated frame on the same block.
///
/// # Errors
/// If the files cannot be written, or the peer cannot be started or fails.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let Some(command) = &settings.peer else { return Ok(Vec::new()) };
    let (cells, steps) = if settings.quick { (64, [20, 220]) } else { (128, [20, 220]) };
    pool(1)?.install(|| {
        let scene = moving_scene(DEGREE, POINTS, cells);
        let mut simulation = Simulation::new(&scene)?;
        let mut exchange = Exchange { command: command.clone(), out: settings.out, steps, kinetic: 0.0 };
        for (folder, steps) in FOLDERS.into_iter().zip(steps) {
            write((settings.out, folder), &scene, &simulation, steps)?;
        }
        (0..steps[1]).try_for_each(|_| simulation.step())?;
        exchange.kinetic = simulation.sample().kinetic;
        let contestants = vec![ours(&scene, steps[1] - steps[0])?, exchange.contestant(simulation.extent().particles)];
        round_robin(contestants, settings.rounds(), f64::INFINITY)
    })
}

/// Our own steps.
fn ours(scene: &Scene, steps: usize) -> Result<Contestant<'static>, BenchError> {
    let mut simulation = Simulation::new(scene)?;
    let extent = simulation.extent();
    let label = "fisura, updated frame";
    let mut record = BenchRecord::new("peer/fisura", label, (extent.particles * steps) as f64, "particle-step");
    record.memory_bytes = extent.mechanics_bytes as u64;
    let run = move |record: &mut BenchRecord| {
        let watch = Stopwatch::start();
        (0..steps).try_for_each(|_| simulation.step())?;
        let sample = watch.read();
        let found = simulation.sample();
        let closure = found.closure.abs() / found.largest_term();
        record.verify_at_most("closure of the ledger over its largest term", closure, 1e-9);
        Ok(sample)
    };
    Ok(Contestant { record, run: Box::new(run) })
}

/// What the peer reads.
fn write(
    (out, folder): (&OutputFolder, &str),
    scene: &Scene,
    simulation: &Simulation,
    steps: usize,
) -> Result<(), BenchError> {
    out.remove(&format!("{folder}/result.csv"))?; // an old answer is none
    let frame = simulation.updated_frame();
    let frame = frame.ok_or_else(|| BenchError::input("the block is not in the updated frame"))?;
    let mut table = Table::new(&["x", "y", "volume", "vx", "vy"]);
    for point in frame.fields()[0].points() {
        table.push(&[point.position[0], point.position[1], point.volume, point.velocity[0], point.velocity[1]]);
    }
    out.write_table(&format!("{folder}/particles.csv"), &table)?;
    let material = &scene.materials[&scene.bodies[0].material];
    let block = json!({
        "young_modulus": material.young_modulus,
        "poisson_ratio": material.poisson_ratio,
        "density": DENSITY,
        "plane": "strain",
        "thickness": 1.0,
        "degree": DEGREE,
        "span": SPAN,
        "grid_origin": scene.mesh.origin(),
        "grid_end": scene.mesh.end(),
        "time_step": simulation.plan().step,
        "steps": steps,
        "transfer": "flip",
    });
    Ok(out.write(&format!("{folder}/block.json"), format!("{block:#}\n"))?)
}

impl<'a> Exchange<'a> {
    fn failed(&self, message: impl Into<String>) -> BenchError {
        BenchError::Peer { command: self.command.clone(), message: message.into() }
    }

    fn contestant(self, particles: usize) -> Contestant<'a> {
        let work = (particles * (self.steps[1] - self.steps[0])) as f64;
        let record = BenchRecord::new("peer/command", self.command.clone(), work, "particle-step")
            .with("steps", vec![self.steps[0], self.steps[1]]);
        let run = move |record: &mut BenchRecord| {
            let [short, long] = [self.run(0)?, self.run(1)?];
            match self.kinetic_energy() {
                Ok(kinetic) => {
                    let difference = (kinetic / self.kinetic - 1.0).abs();
                    record.verify_at_most("kinetic energy against ours, relative difference", difference, SAME);
                }
                Err(reason) => record.verify(false, format!("its answer is unknown: {reason}")),
            }
            let sample = Sample { wall_s: long.wall_s - short.wall_s, cpu_s: long.cpu_s - short.cpu_s };
            if record.verified && sample.cpu_s < SHORTEST {
                let message = format!("its steps take {:.2} s, too little to be told from start and end", sample.cpu_s);
                record.verify(false, message);
            }
            Ok(sample)
        };
        Contestant { record, run: Box::new(run) }
    }

    /// Runs the command on one of the folders.
    fn run(&self, which: usize) -> Result<Sample, BenchError> {
        let mut words = self.command.split_whitespace();
        let program = words.next().ok_or_else(|| self.failed("the command is empty"))?;
        let mut command = Command::new(program);
        command.args(words).arg(self.out.path().join(FOLDERS[which])).stdout(Stdio::null()).stdin(Stdio::null());
        let before = seconds_of_children();
        let watch = Stopwatch::start();
        let status = command.status().map_err(|e| self.failed(format!("it cannot be started: {e}")))?;
        let wall_s = watch.read().wall_s;
        let result = format!("{}/result.csv", FOLDERS[which]);
        if self.out.path().join(&result).exists() {
            self.out.adopt(&result)?;
        }
        if !status.success() {
            return Err(self.failed(format!("it ended with {status}")));
        }
        let cpu = before.zip(seconds_of_children()).map(|(before, after)| after - before);
        Ok(Sample { wall_s, cpu_s: cpu.unwrap_or(wall_s) })
    }

    /// Kinetic energy of the result, J/m, or why there is none.
    fn kinetic_energy(&self) -> Result<f64, String> {
        let table =
            Table::read(&self.out.path().join(FOLDERS[1]).join("result.csv")).map_err(|error| error.to_string())?;
        let column = |name: &str| table.column(name).ok_or_else(|| format!("result.csv has no column {name}"));
        let (volume, vx, vy) = (column("volume")?, column("vx")?, column("vy")?);
        let energies = volume.iter().zip(vx.iter().zip(vy)).map(|(v, (x, y))| 0.5 * DENSITY * v * (x * x + y * y));
        Ok(energies.sum())
    }
}

/// Processor time of all programs this process has started and seen to their end, s, where `/proc` tells it.
fn seconds_of_children() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let [user, system] = [fields.get(13)?, fields.get(14)?].map(|f| f.parse::<f64>());
    Some((user.ok()? + system.ok()?) / 100.0) // clock ticks of 10 ms
}
