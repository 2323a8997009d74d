//! The test of Kalthoff and Winkler: energies at two times, and times and angles at which the crack has a
//! length, against bilinear elements extrapolated to h = 0 (`reference-data/kalthoff`).

use super::curves::{self, AGREES, DECIDES, SAFETY, WIDEST, decide};
use super::submission::{Plane, Submission};
use super::table::Curve;
use super::verdict::{Comparison, Outcome, QuantityVerdict, ReferenceUsed, Verdict};
use super::{Judged, QUANTITIES, TIP_X, TIP_Y};
use crate::reference::{Library, ReferenceValue};
use crate::scene::SceneFileError;

/// Folder of the reference.
const FOLDER: &str = "kalthoff";
/// Tip of the slit, m.
const TIP: [f64; 2] = [50e-3, 25e-3];
/// Spacing of the finest elements, whose distance from the limit is the uncertainty of the reference, m.
const FINEST: f64 = 0.125e-3;
/// l0 of the cracked reference, half of b, m.
const LENGTH_SCALE: f64 = 0.75e-3;
/// Times of energies, µs, and lengths of the crack, mm, of which the reference has some.
const TIMES: [u32; 3] = [20, 30, 45];
const LENGTHS: [u32; 4] = [5, 15, 25, 35];
/// Speed of the crack, by which an uncertain tip is an uncertain time, m/s.
const SPEED: f64 = 1850.0;

/// Judges the curves of a submission.
///
/// # Errors
/// No curve is there, or the reference is damaged.
pub fn judge(
    folder: &str,
    submission: &Submission,
    mut curves: [Option<Curve>; 6],
    library: &Library,
) -> Result<Judged, SceneFileError> {
    if curves.iter().all(Option::is_none) {
        let remedy = "add [curves] with time and kinetic, elastic, work, fracture, or tip_x and tip_y";
        return Err(submission.key_error("benchmark", "nothing to judge", remedy));
    }
    let (mut notes, mut findings) = (Vec::new(), Vec::new());
    curves::prepare(submission, &mut curves, &mut notes, &mut findings);
    let elastic = submission.model.phase_field == "none";
    let plane = if submission.model.plane == Plane::Stress { "plane-stress" } else { "plane-strain" };
    if submission.model.plane == Plane::Unknown {
        notes.push("the plane state is unknown; plane strain is assumed".into());
    }
    let variant = format!("{}/{plane}", if elastic { "elastic" } else { "at1" });
    let missing = || submission.key_error("benchmark", format!("no reference {variant}"), "restore reference-data");
    let of = |name: String| library.value(FOLDER, &format!("{variant}/{name}"));
    let mut quantities = Vec::new();
    let mut take = |words: String, unit: &str, value: Option<f64>, reference: &ReferenceValue, u_num: Option<f64>| {
        let mut row = Comparison { name: words.clone(), unit: unit.into(), value, ..Comparison::default() };
        row.reference = Some(reference.value);
        row.error = value.map(|value| value - reference.value);
        decide(&mut row, reference.uncertainty.unwrap_or(0.0), u_num);
        let coarse = |limit: f64| u_num.is_some_and(|u| u > limit * reference.value.abs());
        if value.is_none() {
            row.why = "not given, not reached, or between rows more than 2 µs apart".into();
        } else if coarse(DECIDES[0]) || row.outcome == Outcome::Pass && coarse(AGREES[0]) {
            row.outcome = Outcome::Diagnostic;
            row.why = "the numerical uncertainty is too large to decide".into();
        }
        quantities.push(QuantityVerdict { quantity: words, outcome: row.outcome, comparisons: vec![row] });
    };
    // The error of elements is in proportion to their size.
    let of_elements =
        |reference: &ReferenceValue| Some(SAFETY * reference.uncertainty? * submission.spacing.map(|h| h / FINEST)?);
    for (k, quantity) in QUANTITIES[..TIP_X].iter().enumerate() {
        for time in TIMES {
            let Some(reference) = of(format!("{}-{time}-us", quantity.reference)) else { continue };
            let value = curves[k].as_ref().and_then(|curve| near(curve, f64::from(time) * 1e-6));
            let u_num = submission.stated[k].map(|u| u * reference.value.abs()).or_else(|| of_elements(reference));
            take(format!("{} at {time} µs", quantity.words), "J/m", value, reference, u_num);
        }
    }
    for length in LENGTHS {
        let metres = f64::from(length) * 1e-3;
        let grown = curves[TIP_X].as_ref().zip(curves[TIP_Y].as_ref()).and_then(|(x, y)| grown(x, y, metres));
        let uncertain = submission.stated[TIP_X].map(|u| [u / SPEED, (u / metres).atan().to_degrees()]);
        let asked = [("time", "s", "time at which the crack is"), ("angle", "degree", "angle of the crack at")];
        for (i, (name, unit, words)) in asked.into_iter().enumerate() {
            let Some(reference) = of(format!("{name}-at-{length}-mm")) else { continue };
            let u_num = uncertain.map(|u| u[i]).or_else(|| of_elements(reference));
            let of = if i == 0 { " long" } else { "" };
            take(format!("{words} {length} mm{of}"), unit, grown.map(|g| g[i]), reference, u_num);
        }
    }
    if quantities.is_empty() {
        return Err(missing());
    }
    let differences = differences(submission);
    if !differences.is_empty() {
        for verdict in quantities.iter_mut().filter(|verdict| verdict.outcome == Outcome::Fail) {
            verdict.outcome = Outcome::Diagnostic;
            verdict.comparisons.iter_mut().for_each(|row| row.outcome = Outcome::Diagnostic);
        }
    }
    let source = library.source(FOLDER);
    let reference = ReferenceUsed {
        id: format!("{FOLDER}/{variant}"),
        label: source.map_or_else(String::new, |source| source.citation.clone()),
        uncertainty: "distance of the finest of three meshes from the limit h to 0".into(),
    };
    let numerical = match (submission.stated.iter().any(Option::is_some), submission.spacing) {
        (true, _) => "stated by the submission",
        (false, Some(_)) => "not stated; 1.25 times what bilinear elements of the same spacing are off by",
        (false, None) => "unknown: neither stated nor to be had from a spacing",
    };
    let base = Verdict::of(folder, submission, reference, numerical);
    let mut verdict = Verdict { differences, findings, notes, quantities, ..base };
    verdict.conclude();
    Ok(Judged { verdict, curves, references: Default::default() })
}

/// What the declared model has that the reference has not.
fn differences(submission: &Submission) -> Vec<String> {
    let model = &submission.model;
    let mut out = model.differences.clone();
    if !["AT1", "none"].contains(&model.phase_field.as_str()) {
        out.push(format!("phase-field model {} instead of AT1", model.phase_field));
    }
    if !["spectral", "unknown"].contains(&model.split.as_str()) {
        out.push(format!("split {:?} instead of the spectral one", model.split));
    }
    if let Some(l) = model.length_scale.filter(|l| (l / LENGTH_SCALE - 1.0).abs() > 0.01) {
        out.push(format!("l0 = {} mm in Borden's convention instead of 0.75 mm", l * 1e3));
    }
    out
}

/// The value at a time between two rows that are close.
fn near(curve: &Curve, t: f64) -> Option<f64> {
    let next = curve.t.partition_point(|row| *row < t);
    let close = next > 0 && next < curve.t.len() && curve.t[next] - curve.t[next - 1] <= WIDEST * (1.0 + 1e-9);
    curves::at(curve, t).filter(|_| close)
}

/// Time (s) at which the tip has first been at the distance `length` from that of the slit, ahead of it, and
/// the angle of the chord with the slit (degrees).
fn grown(x: &Curve, y: &Curve, length: f64) -> Option<[f64; 2]> {
    let tips = x.t.iter().zip(x.y.iter().zip(&y.y)).map(|(t, (x, y))| [*t, x - TIP[0], y - TIP[1]]);
    let tips: Vec<[f64; 3]> = tips.filter(|tip| tip[1] > 0.0 && tip[2].is_finite()).collect();
    let distance = |tip: &[f64; 3]| tip[1].hypot(tip[2]);
    let after = tips.iter().position(|tip| distance(tip) >= length)?;
    let [before, tip] = [tips[after.checked_sub(1)?], tips[after]];
    if tip[0] - before[0] > WIDEST * (1.0 + 1e-9) {
        return None;
    }
    let part = (length - distance(&before)) / (distance(&tip) - distance(&before));
    let [time, x, y] = [0, 1, 2].map(|k| before[k] + part * (tip[k] - before[k]));
    Some([time, y.atan2(x).to_degrees()])
}
