//! A program of the user on the block of points that is timed here: `bench --peer CMD`.
//!
//! The folder it gets as its last argument holds
//!
//! - `particles.csv`: `x, y, volume, vx, vy` (m, m², m/s), one row per point;
//! - `block.json`: material, time step, number of steps, splines and the grid they live on.
//!
//! It runs the steps and leaves `result.csv` there, the same columns and rows at the end, which are held
//! against ours ([`block`]). It is run with two numbers of steps, and the difference of its times counts:
//! start and end of the program cancel.

pub mod block;
pub(super) mod program;

use super::record::{BenchRecord, Sample};
use super::timing::{Contestant, pool, round_robin, timed};
use super::{BenchError, Settings};
use crate::output::OutputFolder;
use crate::output::history::Table;
use block::PeerBlock;
use program::Program;

/// Least processor time of the steps that counts, s: the system tells the time of other programs to 10 ms.
const SHORTEST: f64 = 0.1;
/// Relative difference from our positions and velocities that counts as the same answer: other shape
/// functions at the edges and other transfers that lose next to nothing are allowed.
pub const SAME: f64 = 0.05;

/// Folders of the exchange: few steps, and many.
const FOLDERS: [&str; 2] = ["peer/short", "peer/long"];

/// Spans of the block in each direction.
pub fn cells(quick: bool) -> usize {
    if quick { 64 } else { 128 }
}

/// Times the peer and our updated frame on the same block.
///
/// # Errors
/// If the files cannot be written, or the peer cannot be started, fails or takes too long.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let Some(command) = &settings.peer else { return Ok(Vec::new()) };
    let program = Program::new(command, settings.peer_timeout)?;
    pool(1)?.install(|| {
        let block = PeerBlock::new(cells(settings.quick))?;
        for (folder, steps) in FOLDERS.into_iter().zip(block.steps) {
            block.write(settings.out, folder, steps)?;
        }
        let contestants = vec![ours(&block), theirs(&block, program, settings.out)];
        round_robin(contestants, settings.rounds(), f64::INFINITY)
    })
}

/// Steps of our updated frame on the block: as many as count for the peer.
fn ours(block: &PeerBlock) -> Contestant<'_> {
    let steps = block.steps[1] - block.steps[0];
    let label = "fisura, updated frame";
    let mut record = BenchRecord::new("peer/fisura", label, (block.points() * steps) as f64, "particle-step");
    record.memory_bytes = block.start.bytes()[0] as u64;
    let run = move |record: &mut BenchRecord| {
        let mut frame = block.start.clone();
        let stored = frame.sample(block.step).stored();
        let (sample, advanced) = timed(|| block.advance(&mut frame, steps));
        advanced?;
        let mut found = frame.sample(block.step);
        found.close(stored);
        let closure = found.closure.abs() / found.largest_term();
        record.verify_at_most("closure of the ledger over its largest term", closure, 1e-9);
        Ok(sample)
    };
    Contestant { record, run: Box::new(run) }
}

/// The peer, from its own processes.
fn theirs<'a>(block: &'a PeerBlock, program: Program, out: &'a OutputFolder) -> Contestant<'a> {
    let work = (block.points() * (block.steps[1] - block.steps[0])) as f64;
    let record = BenchRecord::new("peer/command", program.command.clone(), work, "particle-step")
        .with("steps", block.steps.to_vec());
    let run_in = move |folder: &str| {
        let result = format!("{folder}/result.csv");
        out.remove(&result)?; // the answer of the round before is none
        let ended = program.run(&out.path().join(folder));
        if out.path().join(&result).exists() {
            out.adopt(&result)?;
        }
        ended
    };
    let run = move |record: &mut BenchRecord| {
        let [short, long] = [run_in(FOLDERS[0])?, run_in(FOLDERS[1])?];
        let answer = Table::read(&out.path().join(FOLDERS[1]).join("result.csv")).map_err(|error| error.to_string());
        match answer.and_then(|answer| block.difference(&answer)) {
            Ok(difference) => {
                let what = "positions and velocities against fisura, relative rms difference";
                record.verify_at_most(what, difference, SAME);
            }
            Err(reason) => record.verify(false, format!("its answer differs from that of the block: {reason}")),
        }
        let sample = Sample { wall_s: long.wall_s - short.wall_s, cpu_s: long.cpu_s - short.cpu_s };
        if record.verified && sample.cpu_s < SHORTEST {
            let message = format!(
                "its steps take {:.2} s, too short to separate from start and end of the program",
                sample.cpu_s
            );
            record.verify(false, message);
        }
        Ok(sample)
    };
    Contestant { record, run: Box::new(run) }
}
