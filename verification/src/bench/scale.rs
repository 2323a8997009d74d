//! Time and memory per point against the number of points: square blocks from 10⁴ to 1.6·10⁷ points, p = 2
//! with 2 × 2 points per span, on one thread.
//!
//! | block | what a step does |
//! |---|---|
//! | `elastic` | the total frame, without fracture |
//! | `cracking` | the same with fracture: a row of cracks at both edges, which are pulled; all tips grow |
//! | `moving` | elastic points that move through the mesh, FLIP |
//!
//! The cracks are as close to the pulled edges on every mesh, so that they grow after the same number of
//! steps, and their number grows with the width. One block is in memory at a time. Besides the bytes of the
//! model, which are counted, there are those of the process at its peak, with the program and what making the
//! block ready took.

use fisura::Simulation;
use fisura::scene::{Crack, Scene, Side, TimeFactor, Traction};

use super::block::{MARGIN, SPAN, cracked_scene, elastic_scene, moving_scene};
use super::record::BenchRecord;
use super::timing::{pool, time_steps};
use super::{BenchError, Settings, advance};
use crate::scene_run::peak_memory_mb;

const DEGREE: usize = 2;
/// Spans between neighbouring cracks, of which each is half as long, and between cracks and the pulled edge.
const PITCH: usize = 32;
const DEPTH: usize = 12;
/// Stress on the pulled edges, Pa: a crack of four millimetres grows in glass at half of it.
const PULL: f64 = 20e6;
/// Steps until tips grow.
const RUN_UP: usize = 100;
/// Least and most steps of a sample.
const STEPS: [usize; 2] = [5, 40];
/// Particle-steps of a sample within these.
const PARTICLE_STEPS: usize = 1_000_000;
/// Closure of the ledger over its largest term.
const CLOSURE: f64 = 1e-3;

/// A block with its name.
struct Block {
    name: &'static str,
    label: &'static str,
    scene: fn(usize) -> Scene,
    run_up: usize,
}

const BLOCKS: [Block; 3] = [
    Block { name: "elastic", label: "elastic, total frame", scene: elastic, run_up: 2 },
    Block { name: "cracking", label: "with growing cracks, total frame", scene: cracking, run_up: RUN_UP },
    Block { name: "moving", label: "elastic, moving points", scene: moving, run_up: 2 },
];

fn elastic(cells: usize) -> Scene {
    elastic_scene(DEGREE, 2, cells, 0)
}

fn moving(cells: usize) -> Scene {
    moving_scene(DEGREE, 2, cells, MARGIN)
}

fn cracking(cells: usize) -> Scene {
    let mut scene = cracked_scene(DEGREE, 2, cells, 0);
    let body = &mut scene.bodies[0];
    let height = [DEPTH, cells - DEPTH].map(|row| SPAN * row as f64);
    let starts = (PITCH / 4..cells - PITCH / 2).step_by(PITCH).map(|column| SPAN * column as f64);
    let length = SPAN * (PITCH / 2) as f64;
    let crack = |x: f64, y: f64| Crack::seed([x, y], [x + length, y]);
    body.cracks = starts.flat_map(|x| height.map(|y| crack(x, y))).collect();
    let pulled = |side, stress| Traction::on(side, [0.0, stress], TimeFactor::default());
    body.tractions = vec![pulled(Side::Top, PULL), pulled(Side::Bottom, -PULL)];
    scene
}

/// Times every block of every size.
///
/// # Errors
/// If a scene cannot be run.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let sizes: &[usize] = if settings.quick { &[50, 100, 200, 400] } else { &[50, 100, 200, 400, 800, 1600, 2000] };
    pool(1)?.install(|| {
        let all = BLOCKS.iter().flat_map(|block| sizes.iter().map(move |&cells| (block, cells)));
        all.map(|(block, cells)| measure(block, cells, settings.rounds().min(5))).collect()
    })
}

fn measure(block: &Block, cells: usize, rounds: usize) -> Result<BenchRecord, BenchError> {
    let alone = std::fs::write("/proc/self/clear_refs", "5").is_ok(); // forgets the peak of the memory
    let mut simulation = Simulation::new(&(block.scene)(cells))?;
    advance(&mut simulation, block.run_up)?;
    let extent = simulation.extent();
    let steps = (PARTICLE_STEPS / extent.particles).clamp(STEPS[0], STEPS[1]);
    let id = format!("scale/{}/{cells}", block.name);
    let mut record = BenchRecord::of_steps(id, block.label, &extent, steps);
    let before = simulation.phase_field_counts();
    for _ in 0..rounds {
        record.samples.push(time_steps(&mut simulation, steps)?);
    }
    let after = simulation.phase_field_counts();
    let [solves, iterations] = [after.solves - before.solves, after.iterations - before.iterations];
    if let Some(peak_mb) = peak_memory_mb().filter(|_| alone) {
        record = record.with("peak_bytes", 1e6 * peak_mb);
    }
    let found = simulation.sample();
    let closure = found.closure.abs() / found.largest_term();
    let expected = if block.name == "cracking" { rounds * steps } else { 0 };
    let answer = format!("ledger closed to {closure:.0e}, {iterations} iterations in {solves} solves");
    record.verify(closure <= CLOSURE && solves == expected && iterations >= expected, answer);
    record.summarise();
    Ok(record)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_of_the_smallest_size_is_verified() {
        for block in &BLOCKS {
            let record = measure(block, 50, 1).unwrap();
            assert!(record.verified, "{}: {}", record.id, record.answer);
            assert_eq!(record.number("particles"), Some(1e4));
            let peak = record.number("peak_bytes");
            assert!(peak.is_none_or(|peak| peak > record.memory_bytes as f64), "{peak:?}");
        }
    }

    #[test]
    fn the_cracks_grow() {
        let mut simulation = Simulation::new(&cracking(50)).unwrap();
        let before = simulation.sample().fracture.unwrap().energy;
        advance(&mut simulation, 2 * RUN_UP).unwrap();
        let after = simulation.sample().fracture.unwrap().energy;
        assert!(after > 1.05 * before, "{before} {after}");
    }
}
