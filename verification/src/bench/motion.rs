//! What an error costs where bodies move: the axis-aligned displacement of `convergence/axis-aligned` in the
//! total frame, and in the updated frame, where points cross spans, on one thread. The errors are those of
//! the displacement against the exact solution; what is timed is the whole run with its preparation. Points
//! have the best layout and step that are known for them, equally spaced 4 × 4 points and steps in
//! proportion to h (`convergence/moving-axis-aligned`).

use super::record::{AnswerError, BenchRecord};
use super::timing::{Contestant, pool, round_robin, timed};
use super::{BenchError, Settings};
use crate::study::convergence::Meshes;

/// Spans per direction, and those that points alone need: their error falls more slowly.
const MESHES: [usize; 4] = [12, 16, 24, 32];
const FINE: [usize; 2] = [48, 64];

/// Times the motion on all meshes.
///
/// # Errors
/// If a case is missing, or a run breaks down.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let total = settings.case("convergence/axis-aligned", &[])?;
    let updated = settings.case("convergence/moving-axis-aligned", &[])?;
    pool(1)?.install(|| {
        Meshes::with(&total, |total| {
            Meshes::with(&updated, |updated| {
                let mut contestants = contestants(total, settings, false)?;
                contestants.extend(self::contestants(updated, settings, true)?);
                round_robin(contestants, settings.rounds(), settings.budget())
            })
        })??
    })
}

/// Every curve on every mesh; `moving` says that points cross spans.
fn contestants<'a>(meshes: Meshes<'a>, settings: &Settings, moving: bool) -> Result<Vec<Contestant<'a>>, BenchError> {
    let mut contestants = Vec::new();
    for curve in meshes.curves() {
        let degree = meshes.degree(curve);
        if degree == 1 {
            continue; // its error grows under refinement
        }
        let (word, words, fine) = match moving {
            true => ("equal-points", "updated frame, 4 × 4 equally spaced points, step ∝ h", &FINE[..]),
            false => ("total", "total frame", &[][..]),
        };
        let some = if settings.quick { &MESHES[..3] } else { &MESHES[..] };
        let fine = if settings.quick { &[] } else { fine };
        for &cells in some.iter().chain(fine) {
            let first = meshes.level(curve, cells)?;
            let (id, label) = (format!("motion/p{degree}-{word}/{cells}"), format!("p = {degree}, {words}"));
            let mut record = BenchRecord::new(id, label, first.unknowns as f64, "unknown")
                .with("degree", degree)
                .with("spans", cells)
                .with("unknowns", first.unknowns);
            let quantity = "relative error of the displacement";
            record.error = Some(AnswerError::relative(quantity, first.errors[0], "the exact motion"));
            let run = move |record: &mut BenchRecord| {
                let (sample, again) = timed(|| meshes.level(curve, cells));
                record.verify(again?.errors == first.errors, "the same errors bit by bit in every run");
                Ok(sample)
            };
            contestants.push(Contestant { record, run: Box::new(run) });
        }
    }
    Ok(contestants)
}
