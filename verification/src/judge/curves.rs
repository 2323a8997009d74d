//! Quantities over the whole curve and by phase: |E| against U_val.

use super::family::{LENGTH_SCALE, MeshStudy, Variant};
use super::submission::Submission;
use super::table::Curve;
use super::verdict::{Comparison, Finding, Outcome, QuantityVerdict};
use super::{FRACTURE, QUANTITIES, TIP_X, TIP_Y};
use crate::extremes::larger;
use crate::reference::{ReferenceCurve, relative_rms, relative_uncertainty, rms_difference, rms_uncertainty};

/// Part of a window that has to be covered.
const COVERED: f64 = 0.95;
/// Widest interval between rows that is interpolated across, s.
pub(super) const WIDEST: f64 = 2e-6;
/// Safety factor on what bilinear elements of the same spacing are off by.
pub(super) const SAFETY: f64 = 1.25;
/// In a phase, at least this part of the uncertainty over the whole curve: small figures of one mesh may be
/// chance.
const LEAST: f64 = 0.1;
/// Events are decided on meshes up to this spacing over l0; bilinear elements of l0 miss several.
pub(super) const EVENTS_DECIDE: f64 = 0.5;
/// Numerical uncertainties beyond these decide nothing: relative, and of the tip in m.
pub(super) const DECIDES: [f64; 2] = [0.20, 5e-3];
/// Uncertainties U_val beyond these show no agreement, though they may show a difference: 5 %, as for the
/// status of a record, and the same part of what decides for the tip.
pub(super) const AGREES: [f64; 2] = [0.05, 1.25e-3];
/// An increment that starts above this is none, J/m.
const INCREMENT_STARTS: f64 = 0.02;
/// End of the initial crack, m.
const NOTCH: f64 = 0.05;

/// Columns of the mesh study.
const STUDIED: [&str; 5] = ["kinetic", "elastic", "external_work", "fracture_increment", "tip_x"];

/// The value of a curve at a time, interpolated; none beyond its ends.
pub fn at(curve: &Curve, t: f64) -> Option<f64> {
    let next = curve.t.partition_point(|row| *row < t);
    if next < curve.t.len() && curve.t[next] == t {
        return Some(curve.y[next]).filter(|y| y.is_finite());
    }
    if next == 0 || next == curve.t.len() {
        return None;
    }
    let weight = (t - curve.t[next - 1]) / (curve.t[next] - curve.t[next - 1]);
    Some(curve.y[next - 1] + weight * (curve.y[next] - curve.y[next - 1])).filter(|y| y.is_finite())
}

/// Fracture energies to increments, and a tip where there is none yet to the end of the initial crack; what
/// is done is noted.
pub fn prepare(
    submission: &Submission,
    curves: &mut [Option<Curve>; 6],
    notes: &mut Vec<String>,
    findings: &mut Vec<Finding>,
) {
    if let (Some(curve), Some(mapping)) = (&mut curves[FRACTURE], &submission.curves[FRACTURE]) {
        let first = curve.y[0];
        if mapping.increment && first.abs() > INCREMENT_STARTS {
            let text = format!(
                "the fracture energy is said to be an increment and starts at {first:.4} J/m: these are absolute values; \
                 say form = \"absolute\" and their first row is subtracted"
            );
            findings.push(Finding { id: "absolute-fracture-energy".into(), text });
        } else if !mapping.increment && curve.t[0] > 0.5e-6 {
            notes.push(format!(
                "the fracture energy starts at {:.2} µs: its increment cannot be formed without the row at 0",
                1e6 * curve.t[0]
            ));
            curves[FRACTURE] = None;
        } else if !mapping.increment {
            notes.push(format!("the first row of the fracture energy, {first:.4} J/m, is subtracted"));
            curve.y.iter_mut().for_each(|y| *y -= first);
        }
    }
    if let Some(curve) = &mut curves[TIP_X] {
        let missing = curve.y.iter().take_while(|y| !y.is_finite()).count();
        if missing > 0 {
            notes.push(format!(
                "{missing} rows have no tip before the crack runs: the end of the initial crack is taken"
            ));
            curve.y[..missing].fill(NOTCH);
        }
    }
}

/// What is known of the numerical uncertainty of a result.
#[derive(Debug, Clone)]
pub struct Numerics<'a> {
    stated: [Option<f64>; 6],
    /// Mesh spacing at the crack over l0; absent if the submission does not state a spacing.
    spacing: Option<f64>,
    study: &'a MeshStudy,
}

impl<'a> Numerics<'a> {
    /// From what is stated, else from the spacing.
    pub fn new(submission: &Submission, study: &'a MeshStudy) -> Self {
        let l0 = submission.model.length_scale.unwrap_or(LENGTH_SCALE);
        Self { stated: submission.stated, spacing: submission.spacing.map(|h| h / l0), study }
    }

    /// Where it comes from.
    pub fn words(&self) -> String {
        let stated = self.stated.iter().any(Option::is_some);
        match (stated, self.spacing) {
            (true, _) => "stated by the submission; carried to the phases with the mesh study of the reference".into(),
            (false, Some(h)) => {
                format!("not stated; {SAFETY} times what bilinear elements of the same spacing, {h:.3} l0, are off by")
            }
            (false, None) => {
                "unknown: neither stated nor to be had from a spacing; |E| is held against U_ref alone".into()
            }
        }
    }

    /// What elements of the spacing are off by: root of the mean square over the energies, relative; 0
    /// without a spacing.
    pub fn of_elements(&self) -> f64 {
        let at = |name: &&str| self.study.at(&format!("{name}_whole"), self.spacing?);
        let squares: Vec<f64> = STUDIED[..TIP_X].iter().filter_map(at).map(|error| error * error).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    }

    /// Of a quantity in a phase: relative, of the tip in m.
    pub fn of(&self, quantity: usize, phase: &str) -> Option<f64> {
        let name = STUDIED.get(quantity)?;
        let [column, whole] = [phase, "whole"].map(|p| format!("{name}_{}", p.replace(' ', "_")));
        match self.stated[quantity] {
            Some(stated) => Some(stated * larger(LEAST, self.study.ratio(&column, &whole))),
            None => {
                let at = |column: &str| self.study.at(column, self.spacing?);
                Some(SAFETY * larger(at(&column)?, LEAST * at(&whole)?))
            }
        }
    }

    /// The spacing over l0 by which events are judged: that at which bilinear elements have the stated
    /// uncertainty of the tip, else that of the result.
    pub fn spacing(&self) -> Option<f64> {
        let of_tip = |tip: f64| {
            let mut spacings = (1..=80).map(|i| 0.025 * f64::from(i));
            spacings.find(|h| self.study.at("tip_x_whole", *h).is_some_and(|e| SAFETY * e >= tip))
        };
        self.stated[TIP_X].and_then(of_tip).or(self.spacing)
    }

    /// Numerical uncertainty of an event, SI, from its `column` of the mesh study; absent if it is not known.
    pub fn of_event(&self, column: &str) -> Option<f64> {
        Some(SAFETY * self.study.at(column, self.spacing()?)?)
    }
}

/// Verdicts by quantity. The height of the tip has its verdict in the events.
pub fn quantities(curves: &[Option<Curve>; 6], variant: &Variant<'_>, numerics: &Numerics<'_>) -> Vec<QuantityVerdict> {
    let judged = (0..TIP_Y).map(|quantity| {
        let words = QUANTITIES[quantity].words.to_string();
        let missing = |outcome, why: &str| Comparison { outcome, why: why.into(), ..row("whole", quantity) };
        let comparisons = match (&curves[quantity], variant.curves[quantity]) {
            (None, _) => vec![missing(Outcome::Incomplete, "not given")],
            (Some(_), None) => vec![missing(Outcome::Diagnostic, "the reference does not have it")],
            (Some(curve), Some(reference)) => {
                let windows = variant.windows(quantity).into_iter();
                windows
                    .filter_map(|(phase, window)| compare(quantity, phase, window, curve, reference, numerics))
                    .collect()
            }
        };
        let mut verdict = QuantityVerdict { quantity: words, outcome: Outcome::Diagnostic, comparisons };
        conclude(&mut verdict);
        verdict
    });
    judged.collect()
}

/// The verdict on a quantity: it fails where any phase fails, and is that on the whole curve otherwise. One
/// phase that agrees hides no curve that does not.
pub fn conclude(verdict: &mut QuantityVerdict) {
    let fails = verdict.comparisons.iter().any(|c| c.outcome == Outcome::Fail);
    let whole = verdict.comparisons.first().map(|c| c.outcome).unwrap_or_default();
    verdict.outcome = if fails { Outcome::Fail } else { whole };
}

/// Nothing known yet of a quantity in a phase; errors are relative, those of the tip in m.
fn row(phase: &str, quantity: usize) -> Comparison {
    let unit = if quantity == TIP_X { "m" } else { "1" };
    Comparison { name: phase.into(), unit: unit.into(), ..Comparison::default() }
}

/// `None` where the reference has nothing in the window.
fn compare(
    quantity: usize,
    phase: &str,
    [from, to]: [f64; 2],
    curve: &Curve,
    reference: &ReferenceCurve,
    numerics: &Numerics<'_>,
) -> Option<Comparison> {
    let absolute = quantity == TIP_X;
    let uncertainty = if absolute { rms_uncertainty } else { relative_uncertainty };
    let u_ref = uncertainty(reference, from, to)?;
    let mut out = row(phase, quantity);
    let (first, last) = (curve.t[0], curve.t[curve.t.len() - 1]);
    let window = [larger(from, first), if last < to { last } else { to }];
    out.window_s = (window[0] < window[1]).then_some(window);
    if window[1] - window[0] < COVERED * (to - from) {
        out.outcome = Outcome::Incomplete;
        out.why = format!("the curve covers {:.1} to {:.1} µs", 1e6 * first, 1e6 * last);
        return Some(out);
    }
    let rows = curve.t.windows(2).filter(|pair| pair[1] > window[0] && pair[0] < window[1]);
    if rows.into_iter().any(|pair| pair[1] - pair[0] > WIDEST * (1.0 + 1e-9)) {
        out.outcome = Outcome::Incomplete;
        out.why = format!("rows are more than {} µs apart", 1e6 * WIDEST);
        return Some(out);
    }
    let distance = if absolute { rms_difference } else { relative_rms };
    out.error = distance(reference, &curve.t, &curve.y, window[0], window[1]);
    let rows = curve.t.iter().filter_map(|t| Some((*t, reference.at(*t)?)));
    let (t, y): (Vec<f64>, Vec<f64>) = rows.unzip(); // what the output interval does to the reference itself
    let output = distance(reference, &t, &y, window[0], window[1]).filter(|u| *u > 1e-9);
    let u_num = match (numerics.of(quantity, phase), output) {
        (u_num, None) => u_num,
        (u_num, Some(output)) => Some(u_num.unwrap_or(0.0).hypot(output)),
    };
    decide(&mut out, u_ref, u_num);
    let [decides, agrees] = [DECIDES, AGREES].map(|limits| limits[usize::from(absolute)]);
    doubt(&mut out, [decides, agrees]);
    Some(out)
}

/// Takes a verdict back where the numerical uncertainty exceeds what decides, or U_val what shows agreement.
pub(super) fn doubt(out: &mut Comparison, [decides, agrees]: [f64; 2]) {
    if out.u_num.is_some_and(|u| u > decides) {
        (out.outcome, out.why) = (Outcome::Diagnostic, "the numerical uncertainty is too large to decide".into());
    } else if out.outcome == Outcome::Pass && out.u_val.is_some_and(|u| u > agrees) {
        (out.outcome, out.why) = (Outcome::Diagnostic, "within an uncertainty too large to show agreement".into());
    }
}

/// |E| against U_val; a value that is missing is incomplete.
pub(super) fn decide(comparison: &mut Comparison, u_ref: f64, u_num: Option<f64>) {
    let u_val = u_ref.hypot(u_num.unwrap_or(0.0));
    (comparison.u_ref, comparison.u_num, comparison.u_val) = (Some(u_ref), u_num, Some(u_val));
    comparison.outcome = match comparison.error {
        None => Outcome::Incomplete,
        Some(error) if error.abs() <= u_val => Outcome::Pass,
        Some(_) => Outcome::Fail,
    };
    if comparison.outcome == Outcome::Incomplete {
        comparison.why = "no value over the whole window".into();
    }
}
