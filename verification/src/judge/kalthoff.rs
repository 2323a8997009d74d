//! The test of Kalthoff and Winkler: energies at two times, and times and angles at which the crack has a
//! length, against bilinear elements extrapolated to h = 0 (`reference-data/kalthoff`).

use super::curves::{self, WIDEST};
use super::elements::{Elements, differences};
use super::model::Plane;
use super::submission::Submission;
use super::table::Curve;
use super::verdict::{Comparison, QuantityVerdict, ReferenceUsed, Verdict};
use super::{Judged, QUANTITIES, TIP_X, TIP_Y, balance, explained_by_difference, numbers};
use crate::measure::{chord, grown};
use crate::reference::{Library, ReferenceValue};
use crate::scene::SceneFileError;

/// Ends of the slit, m.
const SLIT: [[f64; 2]; 2] = [[0.0, 25e-3], [50e-3, 25e-3]];
/// Times of energies, µs, and lengths of the crack, mm, of which the reference has some.
const TIMES: [u32; 3] = [20, 30, 45];
const LENGTHS: [u32; 4] = [5, 15, 25, 35];
/// A submission and the reference that it is held against.
struct Comparer<'a> {
    submission: &'a Submission,
    elements: &'a Elements,
    library: &'a Library,
    /// `at1/plane-strain`, …
    variant: String,
}

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
    if submission.model.plane == Plane::Unknown {
        notes.push("the plane state is unknown; plane strain is assumed".into());
    }
    let cracks = match submission.model.phase_field.as_str() {
        "none" => "elastic",
        "AT2" => "at2",
        _ => "at1",
    };
    let plane = if submission.model.plane == Plane::Stress { "plane-stress" } else { "plane-strain" };
    let elements = numbers::elements("kalthoff").expect("numbers.toml has them");
    let comparer = Comparer { submission, elements, library, variant: format!("{cracks}/{plane}") };
    let mut quantities = comparer.energies(&curves);
    quantities.extend(comparer.path(&curves));
    let Some(source) = library.source(&elements.folder).filter(|_| !quantities.is_empty()) else {
        let message = format!("no reference {}/{}", elements.folder, comparer.variant);
        return Err(submission.key_error("benchmark", message, "restore reference-data"));
    };
    let differences = differences(submission, elements);
    if !differences.is_empty() {
        for verdict in &mut quantities {
            verdict.comparisons.iter_mut().for_each(|row| explained_by_difference(row, true));
            verdict.outcome = verdict.comparisons[0].outcome;
        }
    }
    let reference = ReferenceUsed {
        id: format!("{}/{}", elements.folder, comparer.variant),
        label: source.citation.clone(),
        uncertainty:
            "distance of the finest of three meshes from the limit h to 0; a quarter of their spread at least, \
                      all of it without an order"
                .into(),
    };
    let numerical = match (submission.stated.iter().any(Option::is_some), submission.spacing) {
        (true, _) => "stated by the submission",
        (false, Some(_)) => "not stated; 1.25 times what bilinear elements of the same spacing are off by",
        (false, None) => "unknown: neither stated nor to be had from a spacing",
    };
    let base = Verdict::of(folder, submission, reference, numerical);
    let mut verdict = Verdict { differences, findings, notes, quantities, balance: balance(&curves), ..base };
    verdict.conclude();
    Ok(Judged { verdict, curves, references: Default::default() })
}

impl Comparer<'_> {
    /// Energies and work at the times of the reference.
    fn energies(&self, curves: &[Option<Curve>; 6]) -> Vec<QuantityVerdict> {
        let mut found = Vec::new();
        for (k, quantity) in QUANTITIES[..TIP_X].iter().enumerate() {
            for time in TIMES {
                let Some(reference) = self.reference(&format!("{}-{time}-us", quantity.reference)) else { continue };
                let value = curves[k].as_ref().and_then(|curve| near(curve, f64::from(time) * 1e-6));
                let stated = self.submission.stated[k].map(|part| part * reference.value.abs());
                found.push(self.compared(format!("{} at {time} µs", quantity.words), "J/m", value, reference, stated));
            }
        }
        found
    }

    /// Times at which the crack has a length, and the angles of its chord with the slit.
    fn path(&self, curves: &[Option<Curve>; 6]) -> Vec<QuantityVerdict> {
        let tips = curves[TIP_X].as_ref().zip(curves[TIP_Y].as_ref());
        let rows = |(x, y): (&Curve, &Curve)| -> Vec<[f64; 3]> {
            let rows = x.t.iter().zip(x.y.iter().zip(&y.y)).map(|(t, (x, y))| [*t, *x, *y]);
            rows.filter(|row| row[2].is_finite()).collect()
        };
        let rows = tips.map(rows).unwrap_or_default();
        let time = |length: u32| self.reference(&format!("time-at-{length}-mm")).map(|reference| reference.value);
        // an uncertain tip is an uncertain time, by the speed of the crack of the reference
        let slowness = time(15).zip(time(25)).map(|(t15, t25)| (t25 - t15) / 10e-3);
        let mut found = Vec::new();
        for length in LENGTHS {
            let metres = f64::from(length) * 1e-3;
            let tip = grown(&rows, SLIT, metres).filter(|tip| tips.is_some_and(|(x, _)| near(x, tip[0]).is_some()));
            let stated = self.submission.stated[TIP_X];
            if let Some(reference) = self.reference(&format!("time-at-{length}-mm")) {
                let words = format!("time at which the crack is {length} mm long");
                let stated = stated.zip(slowness).map(|(u, slowness)| u * slowness);
                found.push(self.compared(words, "s", tip.map(|tip| tip[0]), reference, stated));
            }
            if let Some(reference) = self.reference(&format!("angle-at-{length}-mm")) {
                let words = format!("angle of the crack at {length} mm");
                let angle = tip.map(|[_, x, y]| chord(SLIT, [x, y]));
                let stated = stated.map(|u| (u / metres).atan().to_degrees());
                found.push(self.compared(words, "degree", angle, reference, stated));
            }
        }
        found
    }

    fn reference(&self, name: &str) -> Option<&ReferenceValue> {
        self.elements.value(self.library, &self.variant, name)
    }

    fn compared(
        &self,
        words: String,
        unit: &str,
        value: Option<f64>,
        reference: &ReferenceValue,
        stated: Option<f64>,
    ) -> QuantityVerdict {
        let mut row = Comparison { name: words.clone(), unit: unit.into(), value, ..Comparison::default() };
        let missing = "not given, not reached, or between rows more than 2 µs apart";
        self.elements.compare(&mut row, reference, self.submission.spacing, stated, missing);
        QuantityVerdict { quantity: words, outcome: row.outcome, comparisons: vec![row] }
    }
}

/// The value at a time between two rows that are close.
fn near(curve: &Curve, t: f64) -> Option<f64> {
    let next = curve.t.partition_point(|row| *row < t);
    let close = next > 0 && next < curve.t.len() && curve.t[next] - curve.t[next - 1] <= WIDEST * (1.0 + 1e-9);
    curves::at(curve, t).filter(|_| close)
}
