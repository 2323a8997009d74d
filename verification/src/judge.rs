//! Results of any code held against the benchmarks of this project.
//!
//! A submission is a folder with a `submission.toml` ([`submission`]) and files of numbers in any layout
//! ([`table`]). The nearest reference is chosen by what the submission declares ([`family`]); each quantity
//! is compared with it over the whole curve and by phase ([`curves`]), events by themselves ([`events`]),
//! and common mistakes are looked for ([`mistakes`]). Every comparison error E is held against the validation
//! uncertainty of ASME V&V 20, U_val² = U_ref² + U_num². Nothing is extrapolated, and nothing is corrected
//! in silence.

pub mod curves;
pub mod elements;
pub mod events;
mod exchanged;
pub mod family;
mod kalthoff;
pub mod mapping;
pub mod mistakes;
pub mod model;
pub mod numbers;
mod origin;
pub mod submission;
pub mod table;
pub mod template;
pub mod verdict;

use std::path::Path;

use crate::reference::{Library, ReferenceCurve};
use crate::scene::SceneFileError;

use family::{MeshStudy, Variant};
use submission::Submission;
use table::Curve;
use verdict::{Balance, Outcome, ReferenceUsed, Verdict};

/// A quantity of the plate.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Key of the quantity in the table `[curves]` of `submission.toml`.
    pub key: &'static str,
    /// Name of the quantity in words.
    pub words: &'static str,
    /// Quantity in the reference data, after `plate-family/` or `plate/`.
    pub reference: &'static str,
    /// SI to what is drawn, and its unit.
    pub drawn: (f64, &'static str),
}

/// Quantities of the plate, energies first.
pub const QUANTITIES: [Quantity; 6] = [
    Quantity { key: "kinetic", words: "kinetic energy", reference: "kinetic-energy", drawn: (1.0, "J/m") },
    Quantity { key: "elastic", words: "elastic energy", reference: "elastic-energy", drawn: (1.0, "J/m") },
    Quantity { key: "work", words: "external work", reference: "external-work", drawn: (1.0, "J/m") },
    Quantity {
        key: "fracture",
        words: "fracture energy increment",
        reference: "fracture-increment",
        drawn: (1.0, "J/m"),
    },
    Quantity { key: "tip_x", words: "crack tip x", reference: "tip-x", drawn: (1e3, "mm") },
    Quantity { key: "tip_y", words: "crack tip y", reference: "tip-y", drawn: (1e3, "mm") },
];
/// Places in [`QUANTITIES`].
pub(crate) const KINETIC: usize = 0;
pub(crate) const ELASTIC: usize = 1;
pub(crate) const WORK: usize = 2;
pub(crate) const FRACTURE: usize = 3;
pub(crate) const TIP_X: usize = 4;
pub(crate) const TIP_Y: usize = 5;

/// A benchmark that results can be judged on.
#[derive(Debug, Clone, Copy)]
pub struct Benchmark {
    /// Name under which results ask for it.
    pub name: &'static str,
    /// Description of the benchmark in a few words.
    pub what: &'static str,
}

/// All benchmarks that a submission can name.
pub const BENCHMARKS: [Benchmark; 13] = [
    Benchmark { name: "plate", what: "impact-loaded plate and its family: a crack that runs and branches" },
    Benchmark { name: "kalthoff", what: "test of Kalthoff and Winkler, elastic or with a crack in shear (AT1, AT2)" },
    Benchmark { name: "strip", what: "pre-strained strip: a crack that runs steadily (AT1)" },
    Benchmark { name: "ring", what: "ring of random toughness that a pressure pulse breaks into pieces (AT1)" },
    Benchmark { name: "arrest", what: "plate with two holes that stop a crack (AT1)" },
    Benchmark { name: "brazilian-disc", what: "disc pressed on two arcs: stress and strength, closed form" },
    Benchmark { name: "pmma-strip", what: "pre-strained strip of PMMA (PF-CZM): speeds, diagnostic only" },
    Benchmark { name: "patch-bar", what: "bar under uniform tension at rest, closed form" },
    Benchmark { name: "homogeneous-bar", what: "uniform damage under growing strain, closed form" },
    Benchmark { name: "seeded-crack", what: "fracture energy of a crack made by a history field, closed form" },
    Benchmark { name: "plane-waves", what: "two waves that enter an uncracked plate, closed form" },
    Benchmark { name: "crack-speed", what: "largest speed of the tip in the plate, below the Rayleigh speed" },
    Benchmark { name: "rings", what: "two brittle rings in collision: times of events, diagnostic only" },
];

/// A balance open by less than this part of the work fails nobody.
const BALANCE: f64 = 0.02;

/// A verdict with the curves behind it.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Outcome on the whole, with every comparison behind it.
    pub verdict: Verdict,
    /// Curves as they were judged, by quantity.
    pub curves: [Option<Curve>; 6],
    /// Reference curves, by quantity.
    pub references: [Option<ReferenceCurve>; 6],
}

/// Judges the submission in `folder`. `against` names another reference of the plate than the nearest, by
/// its id in the library.
///
/// # Errors
/// Everything that cannot be read, with file, line, column and remedy.
pub fn judge(folder: &Path, library: &Library, data: &Path, against: Option<&str>) -> Result<Judged, SceneFileError> {
    let submission = Submission::load(folder)?;
    let curves = table::curves(folder, &submission)?;
    let name = folder.display().to_string();
    match submission.benchmark.as_str() {
        "plate" => {}
        "kalthoff" => return kalthoff::judge(&name, &submission, curves, library),
        _ => return numbers::judge(&name, &submission, curves, library),
    }
    if curves.iter().all(Option::is_none) {
        let remedy = "add [curves] with time and kinetic, elastic, work, fracture, tip_x or tip_y";
        return Err(submission.key_error("benchmark", "nothing to judge", remedy));
    }
    let variant = match against {
        Some(id) => Variant::named(library, id),
        None => Variant::nearest(library, &submission.model),
    };
    let variant = variant.map_err(|(message, remedy)| submission.key_error("model", message, remedy))?;
    let study = MeshStudy::load(data).map_err(|e| submission.key_error("benchmark", e.to_string(), "restore it"))?;
    Ok(plate(&name, &submission, curves, &variant, library, &study))
}

fn plate(
    folder: &str,
    submission: &Submission,
    mut curves: [Option<Curve>; 6],
    variant: &Variant<'_>,
    library: &Library,
    study: &MeshStudy,
) -> Judged {
    let (mut notes, mut findings) = (variant.notes.clone(), Vec::new());
    curves::prepare(submission, &mut curves, &mut notes, &mut findings);
    let numerics = curves::Numerics::new(submission, study);
    let differences = variant.differences(&submission.model);
    let mut quantities = curves::quantities(&curves, variant, &numerics);
    let mut events = events::events(&curves, variant, &numerics, library);
    let balance = balance(&curves);
    let failing =
        quantities.iter().any(|q| q.outcome == Outcome::Fail) || events.iter().any(|e| e.outcome == Outcome::Fail);
    if failing {
        let off = quantities.iter().any(|q| q.outcome == Outcome::Fail).then(|| numerics.of_elements());
        let found = mistakes::find(submission, &curves, variant, library, off);
        let known: Vec<String> = findings.iter().map(|f: &verdict::Finding| f.id.clone()).collect();
        findings.extend(found.into_iter().filter(|f| !known.contains(&f.id)));
    }
    let differs = failing && !(differences.is_empty() && variant.notes.is_empty());
    if differs {
        let known = !differences.is_empty();
        let all = quantities.iter_mut().flat_map(|q| &mut q.comparisons).chain(&mut events);
        all.for_each(|comparison| explained_by_difference(comparison, known));
        quantities.iter_mut().for_each(curves::conclude);
    }
    let reference = ReferenceUsed {
        id: variant.id.clone(),
        label: variant.label.clone(),
        uncertainty: variant.uncertainty.clone(),
    };
    let base = Verdict::of(folder, submission, reference, numerics.words());
    let mut verdict = Verdict { differences, findings, notes, quantities, events, balance, ..base };
    verdict.conclude();
    if verdict.outcome == Outcome::Fail && verdict.findings.is_empty() && verdict.differences.is_empty() {
        let text = "no declared difference and no common mistake explains what fails: it is unexplained".into();
        verdict.findings.push(verdict::Finding { id: "unexplained".into(), text });
    }
    if differs && verdict.outcome == Outcome::Pass {
        verdict.outcome = Outcome::Diagnostic; // of another model: neither right nor wrong
    }
    let references = std::array::from_fn(|i| variant.curves[i].cloned());
    Judged { verdict, curves, references }
}

/// What fails where the model differs from all references, or is not known, cannot be told from that.
fn explained_by_difference(comparison: &mut verdict::Comparison, known: bool) {
    if comparison.outcome == Outcome::Fail {
        let what =
            if known { "the declared difference of the model has no reference" } else { "the model is not known" };
        comparison.outcome = Outcome::Diagnostic;
        comparison.why = format!("beyond the uncertainty; {what}");
    }
}

/// Largest |W − K − S − F| over the largest work, at the rows of the work.
fn balance(curves: &[Option<Curve>; 6]) -> Option<Balance> {
    let [k, s, w, f] = [KINETIC, ELASTIC, WORK, FRACTURE].map(|i| curves[i].as_ref());
    let (k, s, w, f) = (k?, s?, w?, f?);
    let at = |curve: &Curve, t: f64| curves::at(curve, t);
    let open = w.t.iter().zip(&w.y).filter_map(|(&t, &w)| Some((w - at(k, t)? - at(s, t)? - at(f, t)?).abs()));
    let most = crate::extremes::largest(w.y.iter().map(|w| w.abs()));
    let open = crate::extremes::largest(open) / most;
    let outcome = if open < BALANCE { Outcome::Pass } else { Outcome::Fail };
    open.is_finite().then_some(Balance { open, outcome })
}

#[cfg(test)]
mod tests;
