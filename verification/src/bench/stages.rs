//! Where the time of a step goes, phase by phase, and what a straightforward kernel of the same degree takes.
//!
//! Blocks of 2 × 2 points per span, one thread. Phases are called through the solver's own functions on a
//! state of their own; ids are `stages/p<degree>/<phase>`.

use std::hint::black_box;

use fisura::Simulation;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::linear_algebra::incomplete_cholesky::IncompleteCholesky;
use fisura::scene::Split;
use fisura::transfer::sweep::StripForces;

use super::block::{Block, elastic_scene, moving_scene};
use super::moving_block::{MovingBlock, minimal};
use super::record::{BenchRecord, Sample};
use super::timing::{Contestant, pool, round_robin, time, timed};
use super::{BenchError, Settings};
use crate::extremes::larger;

/// Points per span and direction.
const POINTS: usize = 2;
/// Steps before a block in motion is timed.
const RUN_UP: usize = 5;
/// Grid phases in a sample.
const GRIDS: usize = 20;
/// Spans per direction of the small block on which the minimal kernel is held against the solver.
const SMALL: usize = 16;

/// Times the phases.
///
/// # Errors
/// If a block cannot be prepared or stepped.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    pool(1)?.install(|| {
        let mut records = phases::<2>(settings)?;
        records.extend(phases::<3>(settings)?);
        Ok(records)
    })
}

/// All phases of one degree.
fn phases<const P: usize>(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let cells = if settings.quick { 128 } else { 256 };
    let block = Block::new(P, POINTS, cells, 0)?;
    let moving = MovingBlock::new(P, POINTS, cells, RUN_UP)?;
    let mut contestants = sweeps::<P>(&block)?;
    contestants.extend(phase_field::<P>(&block)?);
    contestants.extend(moving_phases::<P>(moving));
    contestants.extend(steps::<P>(&block, cells)?);
    let mut records = round_robin(contestants, settings.rounds(), settings.budget())?;
    for record in &mut records {
        record.parameters.extend([
            ("degree".to_string(), P.into()),
            ("cells".to_string(), cells.into()),
            ("points_per_direction".to_string(), POINTS.into()),
        ]);
    }
    Ok(records)
}

fn record<const P: usize>(phase: &str, label: &str, points: usize) -> BenchRecord {
    BenchRecord::new(format!("stages/p{P}/{phase}"), label, points as f64, "particle-step")
}

/// The sweeps over the points, with the split and without.
fn sweeps<'a, const P: usize>(block: &'a Block) -> Result<Vec<Contestant<'a>>, BenchError> {
    let lattice = &block.lattice;
    let mut strips = StripForces::new(lattice);
    let mut contestants = Vec::new();

    let mut elastic = record::<P>("elastic-sweep", "elastic sweep", block.points);
    block.elastic_sweep(&mut strips);
    elastic.verify_at_most("total of the forces over their size", block.force_imbalance(&strips), 1e-12);
    elastic.memory_bytes = (strips.bytes() + 16 * lattice.grid.len()) as u64;
    let mut own = strips.clone();
    contestants.push(Contestant::short(elastic, move || block.elastic_sweep(&mut own)));

    let phase = block.phase_field()?;
    for (split, name) in [(Split::Spectral, "spectral split"), (Split::None, "no split")] {
        let suffix = if split == Split::Spectral { "" } else { "-no-split" };
        let mut history = block.history.clone();
        block.history_sweep(split, &mut history);
        let grew = history.iter().zip(&block.history).all(|(new, old)| (0..8).all(|lane| new[lane] >= old[lane]));
        let mut of_history =
            record::<P>(&format!("history-sweep{suffix}"), &format!("history sweep, {name}"), block.points);
        of_history.verify(grew && history != block.history, "H grew and never decreased");
        let mut of_stress =
            record::<P>(&format!("stress-sweep{suffix}"), &format!("degraded stress sweep, {name}"), block.points);
        let mut at_points = block.at_points();
        block.degraded_sweep(split, phase.control_values(), &mut history, &mut at_points, &mut strips);
        of_stress.verify_at_most("total of the forces over their size", block.force_imbalance(&strips), 1e-12);
        let (mut own, phase, mut grown) = (strips.clone(), phase.control_values().to_vec(), history.clone());
        contestants.push(Contestant::short(of_history, move || block.history_sweep(split, &mut history)));
        contestants.push(Contestant::short(of_stress, move || {
            block.degraded_sweep(split, &phase, &mut grown, &mut at_points, &mut own);
        }));
    }

    let mut sum = record::<P>("sum-of-strips", "sum of the strips", block.points);
    let mut forces = [lattice.grid.zeros(), lattice.grid.zeros()];
    strips.assemble(lattice.grid.stride, &mut forces);
    sum.verify(forces[0].iter().any(|f| *f != 0.0), "the forces are summed");
    contestants.push(Contestant::short(sum, move || strips.assemble(lattice.grid.stride, &mut forces)));
    Ok(contestants)
}

/// Assembly and solves of the phase field.
fn phase_field<'a, const P: usize>(block: &'a Block) -> Result<Vec<Contestant<'a>>, BenchError> {
    let (mut matrix, imbalance) = block.matrix();
    let mut contestants = Vec::new();
    let mut assembly = record::<P>("assembly", "assembly of the whole matrix", block.points);
    assembly.verify_at_most("1·K·1 against the integral of the reaction", imbalance, 1e-10);
    assembly.memory_bytes = matrix.bytes() as u64;
    let fixed = matrix.clone();
    contestants.push(Contestant::short(assembly, move || block.assemble(&mut matrix)));

    let mut factorisation = record::<P>("factorisation", "incomplete factorisation", block.points);
    let mut factor = IncompleteCholesky::new(&fixed, false);
    let (mut ones, mut image) = (vec![0.0; block.lattice.grid.len()], vec![0.0; block.lattice.grid.len()]);
    block.lattice.grid.indices().for_each(|at| ones[at] = 1.0);
    factorisation
        .verify(factor.apply(fixed.active(), &ones, &mut image) > 0.0, "the preconditioner is positive definite");
    contestants.push(Contestant::short(factorisation, move || factor.refactor(&fixed)));

    let tolerance = block.scene.solver.phase_field_tolerance;
    let start = block.phase_field()?;
    for (phase, label, history) in [
        ("solve-unchanged", "phase-field solve, nothing grew", block.history.clone()),
        ("solve-warm", "phase-field solve, H grew at the tip", block.grown_history()),
    ] {
        let mut of_solve = record::<P>(phase, label, block.points);
        let found = start.clone().solve(&block.lattice, &history);
        let outcome = found.map_err(|_| BenchError::other("the phase field does not converge"))?;
        of_solve.verify_at_most("estimated error", outcome.error, tolerance);
        of_solve.parameters.insert("iterations".into(), outcome.iterations.into());
        of_solve.memory_bytes = start.bytes() as u64;
        let start = start.clone();
        // a solve changes its start: each begins from a copy, which is not timed
        let run = move |_: &mut BenchRecord| {
            let mut field = start.clone();
            let (sample, solved) = timed(|| black_box(field.solve(&block.lattice, &history)));
            solved.map_err(|_| BenchError::other("the phase field does not converge"))?;
            Ok(sample)
        };
        contestants.push(Contestant { record: of_solve, run: Box::new(run) });
    }
    Ok(contestants)
}

/// Phases of the updated frame.
fn moving_phases<const P: usize>(block: MovingBlock) -> Vec<Contestant<'static>> {
    let block = std::rc::Rc::new(std::cell::RefCell::new(block));
    let (count, deviation) = (block.borrow().count(), block.borrow().deviation());
    let verified = |phase: &str, label: &str| {
        let mut record = record::<P>(phase, label, count);
        record.verify_at_most("accelerations against those of the solver's step", deviation, 1e-12);
        record
    };
    let [one, two, three, four] = [0; 4].map(|_| block.clone());
    let mut grid = verified("grid", "grid, updated frame");
    grid.work.amount *= GRIDS as f64;
    let mut basis = record::<P>("basis", "shape functions at the points", count);
    basis.verify_at_most("their sum", (one.borrow().basis() / count as f64 - 1.0).abs(), 1e-13);
    vec![
        Contestant::short(basis, move || {
            black_box(one.borrow().basis());
        }),
        Contestant::short(verified("p2g", "P2G, updated frame"), move || two.borrow_mut().points_to_grid()),
        Contestant { record: grid, run: Box::new(move |_| Ok(time_grid(&mut three.borrow_mut()))) },
        Contestant::short(verified("g2p", "G2P, updated frame"), move || {
            black_box(four.borrow_mut().grid_to_points(0.0));
        }),
    ]
}

/// Time of the grid phase, again and again on what the points give, which it uses up.
fn time_grid(block: &mut MovingBlock) -> Sample {
    let mut sum = Sample { wall_s: 0.0, cpu_s: 0.0 };
    for _ in 0..GRIDS {
        block.points_to_grid();
        let part = time(|| block.grid(0.0));
        (sum.wall_s, sum.cpu_s) = (sum.wall_s + part.wall_s, sum.cpu_s + part.cpu_s);
    }
    sum
}

/// Whole steps: of the solver in both frames, with fracture, and of the minimal kernel.
fn steps<'a, const P: usize>(block: &'a Block, cells: usize) -> Result<Vec<Contestant<'a>>, BenchError> {
    let mut contestants = Vec::new();
    let moving = moving_scene(P, POINTS, cells, P);
    let elastic = elastic_scene(P, POINTS, cells, 0);
    for (scene, phase, label) in [
        (&elastic, "elastic-step", "elastic step, total frame"),
        (&moving, "elastic-step-updated", "elastic step, updated frame"),
        (&block.scene, "fracture-step-at-rest", "fracture step, nothing grows"),
    ] {
        let mut simulation = Simulation::new(scene)?;
        for _ in 0..RUN_UP {
            simulation.step()?;
        }
        let (sample, extent) = (simulation.sample(), simulation.extent());
        let mut of_step = record::<P>(phase, label, extent.particles);
        of_step.memory_bytes = (extent.mechanics_bytes + extent.phase_field_bytes) as u64;
        let closure = sample.closure.abs() / sample.largest_term();
        of_step.verify_at_most("closure of the ledger over the largest term", closure, 1e-11);
        contestants.push(Contestant::steps(of_step, simulation)?);
    }
    let (mut kernel, dt) = minimal::<P>(POINTS, cells)?;
    let mut of_kernel = record::<P>("minimal-step", "elastic step, minimal kernel", kernel.count());
    of_kernel.verify_at_most("accelerations against those of the total frame", sweep_deviation::<P>()?, 1e-10);
    (0..RUN_UP).for_each(|_| kernel.step(dt));
    contestants.push(Contestant::short(of_kernel, move || kernel.step(dt)));
    Ok(contestants)
}

/// Accelerations of the minimal kernel against those of the sweep of the total frame under the same
/// displacement: the largest difference over the largest acceleration.
fn sweep_deviation<const P: usize>() -> Result<f64, BenchError> {
    let block = Block::new(P, POINTS, SMALL, P)?;
    let grid = block.lattice.grid;
    let (mut strips, mut forces) = (StripForces::new(&block.lattice), [grid.zeros(), grid.zeros()]);
    block.elastic_sweep(&mut strips);
    strips.assemble(grid.stride, &mut forces);
    let frame = TotalFrame::new(&elastic_scene(P, POINTS, SMALL, P));
    let frame = frame.map_err(|_| BenchError::other("the block cannot be started"))?;
    let (mut kernel, _) = minimal::<P>(POINTS, SMALL)?;
    kernel.strain_by(|column, row| [0, 1].map(|d: usize| block.displacement[d][grid.index(column, row)]));
    let (mut difference, mut size) = (0.0, 0.0);
    for at in grid.indices().filter(|&at| frame.mass.moves(at)) {
        let other = kernel.acceleration(grid.column_of(at), grid.row_of(at));
        for d in 0..2 {
            let own = -forces[d][at] / frame.mass.row_sums[at];
            (difference, size) = (larger(difference, (own - other[d]).abs()), larger(size, own.abs()));
        }
    }
    Ok(difference / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimal_kernel_and_the_sweep_pull_alike() {
        for deviation in [sweep_deviation::<2>(), sweep_deviation::<3>()] {
            let deviation = deviation.unwrap();
            assert!(deviation <= 1e-10 && deviation > 0.0, "{deviation:e}");
        }
    }
}
