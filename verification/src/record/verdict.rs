//! What a value means beyond pass and fail: agreement within uncertainty, and what was expected but is not
//! met.
//!
//! Validation follows ASME V&V 20-2009. With a value S, a reference D of uncertainty U_ref and the numerical
//! uncertainty U_num of S (the parameters of the scene are those of the reference, and add none):
//!
//! ```text
//! E = S − D,     U_val² = U_ref² + U_num²
//! |E| ≤ U_val    S and D agree: what is between them cannot be told from uncertainty
//! |E| > U_val    model, code or mesh (where U_num is unknown) are off by |E| − U_val at least
//! ```

use fisura::fault;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Accept, Record, Reference, ReferenceKind, Status};

/// Where bounds come from, if not from a reason that was there before the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum BoundKind {
    /// Chosen after the result: they tell a change, not whether the result is right.
    Regression,
    /// The reference, as far as the validation uncertainty reaches to either side.
    Validation,
}

/// Whether a value agrees with its reference within their uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Agreement {
    /// |E| ≤ U_val.
    Agrees,
    /// |E| > U_val.
    Differs,
}

/// A value against a reference of known uncertainty, in the unit of the record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Validation {
    /// Comparison error E: the value less that of the reference; of a distance from a curve, the distance.
    pub error: f64,
    /// Uncertainty of the reference.
    pub u_ref: f64,
    /// Uncertainty of the value, from a study over meshes; absent where one mesh was run.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub u_num: Option<f64>,
    /// Root of the sum of the squares of both.
    pub u_val: f64,
    /// Verdict.
    pub verdict: Agreement,
    /// The least error of model and code (and of the mesh without `u_num`): |E| − U_val; absent where they
    /// agree.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub at_least: Option<f64>,
}

/// A band in which a value was expected, kept beside the bounds of a known limit that lies outside of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Expectation {
    /// Smallest value expected.
    pub min: Option<f64>,
    /// Largest value expected.
    pub max: Option<f64>,
    /// Whether the value lies in the band; one that is missing does not.
    pub met: bool,
    /// Who expects it.
    pub source: String,
}

impl Validation {
    /// Holds a value against a reference; `None` if there is no value or no uncertainty of the reference.
    pub fn of(value: Option<f64>, reference: Option<&Reference>, u_num: Option<f64>) -> Option<Self> {
        let reference = reference?;
        let (value, u_ref) = (value.filter(|v| v.is_finite())?, reference.uncertainty?);
        let error = value - reference.value.unwrap_or(0.0);
        let u_val = u_ref.hypot(u_num.unwrap_or(0.0));
        let excess = error.abs() - u_val;
        let (verdict, at_least) =
            if excess <= 0.0 { (Agreement::Agrees, None) } else { (Agreement::Differs, Some(excess)) };
        Some(Self { error, u_ref, u_num, u_val, verdict, at_least })
    }
}

impl Record {
    /// The verdict that `value` deserves under `accept`: a missing or non-finite value fails unless there are
    /// no bounds.
    pub fn judge(value: Option<f64>, accept: &Accept) -> Status {
        if accept.min.is_none() && accept.max.is_none() {
            return Status::Info;
        }
        let inside = |v: f64| within(v, accept.min, accept.max);
        let holds = fault!("judge-passes-what-is-missing", value.is_some_and(inside) => value.is_none_or(inside));
        if holds { Status::Pass } else { Status::Fail }
    }

    /// Gives the record its verdicts on the value it holds: against bounds (those of the validation
    /// uncertainty, if its bounds are of that kind), against the uncertainty of the reference, and against
    /// what is expected.
    pub fn decide(&mut self, u_num: Option<f64>) {
        self.validation = Validation::of(self.value, self.reference.as_ref(), u_num);
        self.status = match self.accept.kind {
            Some(BoundKind::Validation) => self.decide_by_uncertainty(),
            _ => Self::judge(self.value, &self.accept),
        };
        if self.accept.kind == Some(BoundKind::Regression) && self.reference.is_none() {
            let source = "an earlier result of this code".to_string();
            self.reference = Some(Reference { kind: ReferenceKind::Regression, source, ..Reference::default() });
        }
        if let Some(expectation) = &mut self.expectation {
            expectation.met = self.value.is_some_and(|v| within(v, expectation.min, expectation.max));
        }
    }

    /// Passes if value and reference agree; a value or an uncertainty that is missing fails.
    fn decide_by_uncertainty(&mut self) -> Status {
        let Some(validation) = &self.validation else { return Status::Fail };
        let expected = self.reference.as_ref().and_then(|r| r.value);
        self.accept.min = expected.map(|value| value - validation.u_val);
        self.accept.max = Some(expected.unwrap_or(0.0) + validation.u_val);
        if validation.verdict == Agreement::Agrees { Status::Pass } else { Status::Fail }
    }

    /// Whether its bounds were chosen after its result.
    pub fn is_regression(&self) -> bool {
        let bounded = self.accept.min.is_some() || self.accept.max.is_some();
        let earlier = self.reference.as_ref().is_some_and(|r| r.kind == ReferenceKind::Regression);
        bounded && (earlier || self.accept.kind == Some(BoundKind::Regression))
    }

    /// Whether something was expected of it that is not met.
    pub fn misses_expectation(&self) -> bool {
        self.expectation.as_ref().is_some_and(|expected| !expected.met)
    }
}

fn within(value: f64, min: Option<f64>, max: Option<f64>) -> bool {
    let held = fault!("judge-takes-magnitudes", value => value.abs());
    let finite = fault!("judge-passes-infinity", held.is_finite() => true);
    let above = fault!("judge-ignores-lower-bounds", min => None).is_none_or(|min| held >= min);
    let below = fault!("judge-ignores-upper-bounds", max => None).is_none_or(|max| held <= max);
    finite && above && below
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(value: Option<f64>, accept: Accept, reference: Option<Reference>, u_num: Option<f64>) -> Record {
        let mut record = Record { value, accept, reference, ..Record::default() };
        record.decide(u_num);
        record
    }

    fn known(value: Option<f64>, uncertainty: f64) -> Option<Reference> {
        Some(Reference { value, uncertainty: Some(uncertainty), ..Reference::default() })
    }

    #[test]
    fn a_value_outside_its_bounds_or_missing_fails() {
        let both = |min, max| Accept { min, max, ..Accept::default() };
        for (accept, inside, outside) in [
            (both(Some(1.0), Some(2.0)), [1.0, 2.0], [0.9, 2.1]),
            (both(None, Some(2.0)), [-9.0, 2.0], [2.1, f64::NAN]),
            (both(Some(1.0), None), [1.0, 9.0], [0.9, f64::INFINITY]),
        ] {
            let status = |value| judged(value, accept.clone(), None, None).status;
            assert_eq!(inside.map(|v| status(Some(v))), [Status::Pass; 2], "{accept:?}");
            assert_eq!(outside.map(|v| status(Some(v))), [Status::Fail; 2], "{accept:?}");
            assert_eq!(status(None), Status::Fail, "{accept:?}");
        }
        assert_eq!(judged(None, Accept::default(), None, None).status, Status::Info);
    }

    /// A judge that leaves out either uncertainty, or the sign of the error, gives another verdict in one of
    /// these rows.
    #[test]
    fn bounds_by_uncertainty_take_both_uncertainties() {
        let accept = || Accept { kind: Some(BoundKind::Validation), ..Accept::default() };
        for (value, u_ref, u_num, status, at_least) in [
            (10.5, 0.6, None, Status::Pass, None),
            (9.5, 0.6, None, Status::Pass, None),
            (10.5, 0.4, None, Status::Fail, Some(0.1)),
            (9.5, 0.4, None, Status::Fail, Some(0.1)),
            (10.5, 0.3, Some(0.4), Status::Pass, None),
            (10.5, 0.4, Some(0.3), Status::Pass, None),
            (10.5, 0.3, Some(0.39), Status::Fail, Some(0.5 - 0.3_f64.hypot(0.39))),
            (10.5, 0.0, Some(0.6), Status::Pass, None),
        ] {
            let record = judged(Some(value), accept(), known(Some(10.0), u_ref), u_num);
            let validation = record.validation.as_ref().unwrap();
            assert_eq!(record.status, status, "{record:?}");
            assert_eq!(validation.verdict == Agreement::Agrees, status == Status::Pass, "{record:?}");
            assert_eq!(validation.at_least.is_some(), at_least.is_some(), "{record:?}");
            let off = validation.at_least.unwrap_or(0.0) - at_least.unwrap_or(0.0);
            assert!(off.abs() < 1e-12 && (validation.error - (value - 10.0)).abs() < 1e-12, "{record:?}");
            let half_width = u_ref.hypot(u_num.unwrap_or(0.0));
            assert!((record.accept.max.unwrap() - 10.0 - half_width).abs() < 1e-12, "{record:?}");
            assert!((record.accept.min.unwrap() - 10.0 + half_width).abs() < 1e-12, "{record:?}");
        }
        let distance = |value| judged(Some(value), accept(), known(None, 0.01), None).status;
        assert_eq!([distance(0.009), distance(0.011)], [Status::Pass, Status::Fail]);
        let unknown = Some(Reference { value: Some(10.0), ..Reference::default() });
        assert_eq!(judged(Some(10.0), accept(), unknown, Some(1.0)).status, Status::Fail, "no uncertainty, no verdict");
        assert_eq!(judged(None, accept(), known(Some(10.0), 1.0), None).status, Status::Fail);
    }

    #[test]
    fn other_bounds_stand_beside_the_uncertainty() {
        let accept = Accept { min: Some(0.0), max: Some(20.0), ..Accept::default() };
        let record = judged(Some(11.0), accept.clone(), known(Some(10.0), 0.5), None);
        assert_eq!((record.status, &record.accept), (Status::Pass, &accept));
        assert_eq!(record.validation.unwrap().verdict, Agreement::Differs);
    }

    #[test]
    fn an_expectation_that_is_not_met_shows_and_fails_nothing() {
        let expecting = |value: Option<f64>| {
            let (min, max) = (Some(1.0), Some(2.0));
            let expectation = Some(Expectation { min, max, met: true, source: "a plan".into() });
            let accept = Accept { min: Some(0.0), max: Some(9.0), ..Accept::default() };
            let mut record = Record { value, accept, expectation, ..Record::default() };
            record.decide(None);
            (record.status, record.misses_expectation())
        };
        assert_eq!(expecting(Some(1.5)), (Status::Pass, false));
        assert_eq!([0.5, 2.5].map(|v| expecting(Some(v))), [(Status::Pass, true); 2]);
        assert_eq!(expecting(None), (Status::Fail, true));
    }

    #[test]
    fn a_bound_chosen_after_the_result_is_one_of_regression() {
        let accept = |max| Accept { max, kind: Some(BoundKind::Regression), ..Accept::default() };
        let record = judged(Some(1.0), accept(Some(2.0)), None, None);
        assert!(record.is_regression() && record.reference.unwrap().kind == ReferenceKind::Regression);
        let exact = judged(Some(1.0), accept(Some(2.0)), known(Some(1.0), 0.0), None);
        assert!(
            exact.is_regression() && exact.reference.unwrap().kind == ReferenceKind::Exact,
            "it keeps its reference"
        );
        assert!(!judged(Some(1.0), accept(None), None, None).is_regression(), "without bounds");
        assert!(!judged(Some(1.0), Accept { max: Some(2.0), ..Accept::default() }, None, None).is_regression());
    }

    /// Records in which every part of the judgement matters, with the verdict they deserve.
    fn table() -> Vec<(Record, Option<f64>, (Status, bool))> {
        let accept = |min, max, kind| Accept { min, max, kind, ..Accept::default() };
        let (validation, pass, fail) = (Some(BoundKind::Validation), Status::Pass, Status::Fail);
        let mut rows = Vec::new();
        for (value, status) in [(0.5, fail), (1.5, pass), (2.5, fail)] {
            let record = Record { value: Some(value), accept: accept(Some(1.0), Some(2.0), None), ..Record::default() };
            rows.push((record, None, (status, false)));
        }
        for (value, u_ref, u_num, status) in [
            (10.5, 0.6, None, pass),
            (9.5, 0.4, None, fail),
            (10.5, 0.4, Some(0.4), pass),
            (10.5, 0.4, Some(0.1), fail),
        ] {
            let (accept, reference) = (accept(None, None, validation), known(Some(10.0), u_ref));
            rows.push((Record { value: Some(value), accept, reference, ..Record::default() }, u_num, (status, false)));
        }
        for (value, missed) in [(0.5, true), (1.5, false), (2.5, true)] {
            let (min, max, source) = (Some(1.0), Some(2.0), String::new());
            let expectation = Some(Expectation { min, max, met: true, source });
            let accept = accept(Some(0.0), Some(9.0), None);
            rows.push((Record { value: Some(value), accept, expectation, ..Record::default() }, None, (pass, missed)));
        }
        rows
    }

    #[test]
    fn a_judge_that_ignores_a_bound_an_uncertainty_or_an_expectation_is_caught() {
        type Ignore = fn(&mut Record, &mut Option<f64>);
        let wrong = |ignore: Ignore| {
            let judged = table().into_iter().map(|(mut record, mut u_num, deserved)| {
                ignore(&mut record, &mut u_num);
                record.decide(u_num);
                (record.status, record.misses_expectation()) != deserved
            });
            judged.filter(|wrong| *wrong).count()
        };
        assert_eq!(wrong(|_, _| {}), 0);
        let ignorant: [(&str, Ignore); 8] = [
            ("the lower bound", |r, _| r.accept.min = None),
            ("the upper bound", |r, _| r.accept.max = None),
            ("the uncertainty of the reference", |r, _| r.reference.iter_mut().for_each(|r| r.uncertainty = Some(0.0))),
            ("that there is an uncertainty", |r, _| r.reference.iter_mut().for_each(|r| r.uncertainty = None)),
            ("the uncertainty of the mesh", |_, u_num| *u_num = None),
            ("that the uncertainty bounds", |r, _| r.accept.kind = None),
            ("the lower end of what is expected", |r, _| r.expectation.iter_mut().for_each(|e| e.min = None)),
            ("the upper end of what is expected", |r, _| r.expectation.iter_mut().for_each(|e| e.max = None)),
        ];
        for (what, ignore) in ignorant {
            assert!(wrong(ignore) > 0, "a judge may ignore {what}");
        }
        assert!(wrong(|r, _| r.expectation = None) > 0, "a judge may ignore what is expected");
    }
}
