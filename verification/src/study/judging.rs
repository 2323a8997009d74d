//! The judging of results itself: verdicts on values whose verdict is known, and measures on histories whose
//! measure is.
//!
//! A judge that ignores a bound passes every other case of the suites. Here wrong verdicts are held from
//! above and right ones from below, so that a judge which ignores either bound still meets the other, and one
//! that passes everything ends the study.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use fisura::scene::{Mesh, Scene};
use serde::Deserialize;

use super::{Findings, StudyError, exact, other};
use crate::case::expand::CaseScene;
use crate::case::{Case, Check};
use crate::extremes::largest;
use crate::measure::{Run, measure};
use crate::output::history::Table;
use crate::record::{Accept, Discretisation, Limit, Record, Reference, Side, Status, worst};
use crate::reference::{Library, ReferenceBand, ReferenceCurve, relative_rms};
use crate::scene::plain::PlainScene;
use crate::study::orders::observed_order;

/// Quantities, and the variants of the last.
const MEASURES: [&str; 8] = [
    "drift downwards",
    "fall over two rows",
    "closure",
    "difference from a higher run",
    "half model",
    "curve above and below",
    "order of cubes",
    "largest with a gap",
];

pub(super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let right = verdicts(&case.checks[0]);
    let quantities = [
        ("wrong verdicts on known values", by_hand(0.0)),
        ("right verdicts on known values", by_hand(right.len() as f64)),
    ];
    findings.measure("", quantities, || {
        let wrong = right.iter().filter(|right| !**right).count();
        if !right.iter().any(|right| *right)
            || of_accept(bounds(None, Some(0.0))).status_of(Some(1.0)) != Status::Fail && wrong > 0
        {
            return Err(other(format!("{wrong} verdicts are wrong, but the judge passes this")));
        }
        Ok([wrong as f64, (right.len() - wrong) as f64])
    })?;
    let found = findings.compute(|| known_measures(case))?;
    for (index, name) in MEASURES.into_iter().enumerate() {
        let error = found.map(|found| {
            let (found, expected) = found[index];
            let error = if expected.is_nan() && found.is_nan() { 0.0 } else { (found - expected).abs() };
            if error.is_nan() { 1.0 } else { error }
        });
        findings.add(name, "measure of a known history, error", error, by_hand(0.0));
    }
    Ok(())
}

fn by_hand(value: f64) -> Option<Reference> {
    exact(value, "by hand")
}

fn bounds(min: Option<f64>, max: Option<f64>) -> Accept {
    Accept { min, max, ..Accept::default() }
}

fn of_accept(accept: Accept) -> Record {
    Record { accept, ..Record::default() }
}

/// What `templates/verdicts.toml` has.
#[derive(Deserialize)]
struct Verdicts {
    known: Vec<Known>,
}

/// A value whose verdict is known, and what it is held against.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Known {
    value: Option<f64>,
    unit: String,
    min: Option<f64>,
    max: Option<f64>,
    reference: Option<f64>,
    side: Side,
    uncertainty: Option<f64>,
    discretisation: Option<f64>,
    limited: bool,
    expected: Status,
}

static VERDICTS: LazyLock<Verdicts> = LazyLock::new(|| {
    toml::from_str(include_str!("../../templates/verdicts.toml"))
        .expect("verdicts.toml lists known verdicts; every run of the study reads it")
});

impl Known {
    /// Whether the verdict is right.
    fn is_right(&self) -> bool {
        let is_compared = self.reference.or(self.uncertainty).is_some();
        let reference = Reference { side: self.side, uncertainty: self.uncertainty, ..Reference::default() };
        let limit = Limit { min: Some(20.0), max: Some(30.0), why: String::new(), regression: false };
        let mut record = Record {
            value: self.value,
            unit: self.unit.clone(),
            reference: is_compared.then_some(Reference { value: self.reference, ..reference }),
            discretisation: self.discretisation.map(|value| Discretisation { value, from: String::new() }),
            limit: self.limited.then_some(limit),
            ..of_accept(bounds(self.min, self.max))
        };
        record.decide();
        record.status == self.expected
    }
}

/// Whether each of some statuses is right.
fn verdicts(base: &Check) -> Vec<bool> {
    use Status::{Error, Fail, Info, KnownLimit, Pass};
    let mut right: Vec<bool> = VERDICTS.known.iter().map(Known::is_right).collect();
    for (statuses, expected) in [
        (&[Fail, Pass, Info][..], Some(Fail)),
        (&[Pass, Error, Fail, Pass], Some(Error)),
        (&[Info, Pass, Info], Some(Pass)),
        (&[KnownLimit, Pass], Some(KnownLimit)),
        (&[], None),
    ] {
        right.push(worst(statuses.iter().copied()) == expected);
    }
    let around = Check { around_reference: Some([1.0, 2.0]), ..base.clone() };
    right.push(around.bounds_around(by_hand(10.0).as_ref()) == Ok(Some([9.0, 12.0])));
    let band = ReferenceBand { min: 2e-6, max: 5e-6, ..ReferenceBand::default() };
    let Reference { value, uncertainty, .. } = band.reference(1e6);
    let near = |found: Option<f64>, wanted: f64| found.is_some_and(|found| (found - wanted).abs() < 1e-12);
    right.push(near(value, 3.5) && near(uncertainty, 1.5));
    right
}

/// What is measured of a known history, and what it should be, in the order of [`MEASURES`].
fn known_measures(case: &Case) -> Result<[(f64, f64); 8], StudyError> {
    let scene = scene();
    let rows = [[0.0, 2.0, 1.0, 0.0], [1.0, 1.75, 3.0, -0.5], [2.0, 1.0, 2.0, 0.25], [3.0, 2.0, 1.5, 0.0]];
    let history = Table::of_rows(&["time_s", "kinetic_j", "elastic_j", "closure_j"], rows);
    let mut higher = history.clone();
    higher.columns[1].iter_mut().for_each(|kinetic| *kinetic += 2.0);
    let values = BTreeMap::new();
    let whole =
        Run { name: "lower", scene: &scene, history: &history, frames: &[], energy_factor: 1.0, values: &values };
    let half = Run { energy_factor: 2.0, ..whole };
    let other = Run { name: "higher", history: &higher, ..whole };
    let library = Library::default();
    let base = &case.checks[0];
    let of = |name: &str, column: &str, run: &Run, at: Option<f64>| {
        let check = Check {
            measure: Some(name.into()),
            column: Some(column.into()),
            window: [0.0, f64::INFINITY],
            at,
            against: Some("higher".into()),
            ..base.clone()
        };
        let found = measure(&check, run, &[*run, other], &library).map_err(StudyError::Other)?;
        Ok::<f64, StudyError>(found.value.unwrap_or(f64::NAN))
    };
    // of mean zero
    let curve = ReferenceCurve {
        x: vec![1.0, 2.0, 3.0, 4.0],
        y: vec![1.0, -1.0, 1.0, -1.0],
        x_unit: "s",
        y_unit: "J",
        ..ReferenceCurve::default()
    };
    let zeros = vec![0.0; curve.x.len()];
    let rms = relative_rms(&curve, &curve.x, &zeros, 0.0, 4.0).unwrap_or(f64::NAN);
    let levels: Vec<(f64, f64)> = [1.0_f64, 0.5, 0.25].into_iter().map(|h| (h, 3.0 * h.powi(3))).collect();
    Ok([
        (of("drift", "kinetic_j", &whole, None)?, 0.5),
        (of("largest-decrease", "elastic_j", &whole, None)?, 0.5),
        (of("closure", "closure_j", &whole, None)?, 0.5 / 3.0),
        (of("difference", "kinetic_j", &whole, None)?, 0.5),
        (of("value-at", "kinetic_j", &half, Some(1.5))?, 2.75),
        (rms, 1.0),
        (observed_order(&levels, 0.0).unwrap_or(f64::NAN), 3.0),
        (largest([1.0, f64::NAN, 0.5]), f64::NAN),
    ])
}

/// Any scene: the measures above do not look at it.
fn scene() -> Scene {
    let mesh = Mesh::uniform([1; 2], [0.0; 2], [1.0; 2], [1; 2]);
    PlainScene { points: 1, ..PlainScene::unit(mesh, 0.0) }.scene()
}
