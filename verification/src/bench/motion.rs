//! What an error costs where points cross spans: the axis-aligned displacement of
//! `convergence/gauss-axis-aligned`, by points and by spans, on one thread. The errors are those of the
//! displacement at the points, against the exact solution; what is timed is the whole run with its
//! preparation.
//!
//! Points run twice: with the Gauss points and the step of the spans, and with the best layout and step that
//! are known for them, equally spaced 4 × 4 points and steps in proportion to h
//! (`convergence/moving-axis-aligned`).

use fisura::scene::Quadrature;

use super::record::{AnswerError, BenchRecord};
use super::timing::{Contestant, Stopwatch, pool, round_robin};
use super::{BenchError, Settings};
use crate::case::Case;
use crate::study::convergence::Meshes;

/// Spans per direction, and those that points alone need: their error falls more slowly.
const MESHES: [usize; 4] = [12, 16, 24, 32];
const FINE: [usize; 2] = [48, 64];

/// Times the motion on all meshes.
///
/// # Errors
/// If a case is missing, or a run breaks down.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let load = |name: &str| {
        let path = settings.workspace.join("verification/cases/convergence").join(name).with_extension("toml");
        Case::load(&path, &[])
    };
    let same = load("gauss-axis-aligned")?;
    let best = load("moving-axis-aligned")?;
    pool(1)?.install(|| {
        Meshes::with(&same, |same| {
            Meshes::with(&best, |best| {
                let mut contestants = contestants(same, settings, false)?;
                contestants.extend(self::contestants(best, settings, true)?);
                round_robin(contestants, settings.rounds(), settings.budget())
            })
        })??
    })
}

/// Every curve on every mesh; `best` says that points have a layout and a step of their own.
fn contestants<'a>(meshes: Meshes<'a>, settings: &Settings, best: bool) -> Result<Vec<Contestant<'a>>, BenchError> {
    let mut contestants = Vec::new();
    for curve in meshes.curves() {
        let (degree, quadrature) = meshes.degree_and_quadrature(curve);
        if degree == 1 {
            continue; // its error grows under refinement
        }
        let (word, words, fine) = match (quadrature, best) {
            (Quadrature::Points, true) => ("equal-points", "4 × 4 equally spaced points, step ∝ h", &FINE[..]),
            (Quadrature::Points, false) => ("points", "quadrature by points, layout and step of spans", &FINE[..]),
            (Quadrature::Gauss, _) => ("spans", "quadrature by spans", &[][..]),
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
            let quantity = "relative error of the displacement at the points";
            record.error = Some(AnswerError::relative(quantity, first.errors[0], "the exact motion"));
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
    Ok(contestants)
}
