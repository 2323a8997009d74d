//! What an error costs where points cross spans: the axis-aligned displacement of
//! `convergence/gauss-axis-aligned`, by points and by spans, on one thread. The errors are those of the
//! displacement at the points, against the exact solution; what is timed is the whole run with its
//! preparation.

use fisura::scene::Quadrature;

use super::record::{AnswerError, BenchRecord};
use super::timing::{Contestant, Stopwatch, pool, round_robin};
use super::{BenchError, Settings};
use crate::case::Case;
use crate::study::convergence::Meshes;

/// Spans per direction, and the one that points alone need: their error falls more slowly.
const MESHES: [usize; 4] = [12, 16, 24, 32];
const FINE: usize = 64;

/// Times the motion on all meshes.
///
/// # Errors
/// If the case is missing, or a run breaks down.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let path = settings.workspace.join("verification/cases/convergence/gauss-axis-aligned.toml");
    let case = Case::load(&path, &[])?;
    pool(1)?.install(|| Meshes::with(&case, |meshes| timed(&meshes, settings))?)
}

fn timed(meshes: &Meshes, settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let mut contestants = Vec::new();
    for curve in meshes.curves() {
        let (degree, quadrature) = meshes.degree_and_quadrature(curve);
        let (word, fine) = match quadrature {
            Quadrature::Points => ("points", (!settings.quick).then_some(FINE)),
            Quadrature::Gauss => ("spans", None),
        };
        let some = if settings.quick { &MESHES[..3] } else { &MESHES[..] };
        for cells in some.iter().copied().chain(fine) {
            let first = meshes.level(curve, cells)?;
            let (id, label) =
                (format!("motion/p{degree}-{word}/{cells}"), format!("p = {degree}, quadrature by {word}"));
            let mut record = BenchRecord::new(id, label, first.unknowns as f64, "unknown")
                .with("degree", degree)
                .with("spans", cells)
                .with("unknowns", first.unknowns);
            record.error = Some(AnswerError {
                quantity: "relative error of the displacement at the points".into(),
                value: first.errors[0],
                reference: "the exact motion".into(),
                uncertainty: 0.0,
            });
            let run = move |record: &mut BenchRecord| {
                let watch = Stopwatch::start();
                let again = meshes.level(curve, cells)?;
                let sample = watch.read();
                record.verify(again.errors == first.errors, "the same errors bit by bit in every run");
                Ok(sample)
            };
            contestants.push(Contestant { record, run: Box::new(run) });
        }
    }
    round_robin(contestants, settings.rounds(), settings.budget())
}
