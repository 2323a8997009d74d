//! The status of a record as a function of what it holds.
//!
//! A value S agrees with its reference D within the uncertainty of the comparison (after ASME V&V 20-2009):
//!
//! ```text
//! |S − D| ≤ U,     U² = U_ref² + U_num²
//! ```
//!
//! with the uncertainty U_ref of the reference and the discretisation error U_num of the value, which is
//! computed, from a family of meshes or from a stated order and constant. Where one is unknown it counts as
//! zero; where both are, the check states bounds with their reason. Both are half widths. The criterion
//! follows that standard, which estimates the error of a model and has no pass.
//!
//! [`Record::decide`] gives, in this order:
//!
//! 1. `info`, if nothing bounds the value;
//! 2. `fail`, if there is no finite value;
//! 3. `pass`, if the value agrees: it lies within bounds that contain the reference, and that leave at most
//!    [`WIDEST`] of a reference that is not zero, or of a curve ([`WIDEST_ON_A_SIDE`] of a lower or upper
//!    bound);
//! 4. `info`, if it lies within bounds that are wider than that: these cannot show agreement, only the lack
//!    of it;
//! 5. `known-limit`, if it lies within the documented limit;
//! 6. `fail` otherwise.
//!
//! Bounds that exclude their reference therefore never make a pass, and an uncertain reference makes none.

use fisura::fault;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Accept, Record, Reference, ReferenceKind, Side, Status};

/// Uncertainty of a comparison over the reference, beyond which agreement says nothing.
pub const WIDEST: f64 = 0.05;
/// The same of a reference that is a lower or an upper bound. Orders of convergence are small numbers that
/// are observed on finite meshes: a tenth of 1.
pub const WIDEST_ON_A_SIDE: f64 = 0.1;
/// Unit of a distance from a curve that is divided by the size of the curve.
const RELATIVE: &str = "1";
/// Bounds are typed with a few digits, and references computed: this much of the reference is round-off.
const ROUND_OFF: f64 = 1e-9;

/// Discretisation error of a value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Discretisation {
    /// Half width, in the unit of the record.
    pub value: f64,
    /// How it was computed.
    pub from: String,
}

/// A documented limit: where values lie that do not agree with their reference, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Limit {
    /// Smallest value within the limit.
    pub min: Option<f64>,
    /// Largest value within the limit.
    pub max: Option<f64>,
    /// Cause of the limit, and where its bounds come from.
    pub why: String,
    /// Whether its bounds were chosen after the result.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub regression: bool,
}

/// What bounds say about a reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Standing {
    /// The record has no bounds.
    Absent,
    /// A value within them agrees with the reference, or there is no reference value.
    Decide,
    /// The reference lies outside of them.
    ExcludeReference,
    /// They leave too much of the reference.
    TooWide,
}

impl Record {
    /// Gives the record its status. Where the uncertainty of the reference or the discretisation error is
    /// known, the bounds are computed from them.
    pub fn decide(&mut self) {
        self.bound_by_uncertainty();
        self.status = self.status_of(self.value);
        if self.accept.regression && self.reference.is_none() {
            let source = "an earlier result of this code";
            self.reference = Some(Reference::new(None, ReferenceKind::Regression, source));
        }
    }

    /// The status that a value has under the bounds of this record.
    pub fn status_of(&self, value: Option<f64>) -> Status {
        let finite = |value: &f64| fault!("judge-passes-infinity", value.is_finite() => true);
        let within_limit = |value| self.limit.as_ref().is_some_and(|limit| within(value, limit.min, limit.max));
        match (self.standing(), value.filter(finite)) {
            (Standing::Absent, _) if self.limit.is_none() => Status::Info,
            (_, None) => fault!("judge-passes-what-is-missing", Status::Fail => Status::Pass),
            (Standing::Decide, Some(value)) if within(value, self.accept.min, self.accept.max) => Status::Pass,
            (Standing::TooWide, Some(value)) if within(value, self.accept.min, self.accept.max) => Status::Info,
            (_, Some(value)) if within_limit(value) => Status::KnownLimit,
            _ => fault!("judge-fails-nothing", Status::Fail => Status::KnownLimit),
        }
    }

    /// Uncertainty U of the comparison, in the unit of the record: absent where neither that of the reference
    /// nor the discretisation error is known.
    pub fn uncertainty(&self) -> Option<f64> {
        let u_ref = self.reference.as_ref().and_then(|reference| reference.uncertainty);
        let of_mesh = self.discretisation.as_ref().map(|error| error.value);
        let u_num = fault!("judge-forgets-the-mesh", of_mesh => None);
        let known = u_ref.or(u_num).is_some();
        known.then(|| u_ref.unwrap_or(0.0).hypot(u_num.unwrap_or(0.0)))
    }

    /// Bounds from the uncertainty of the comparison: around the reference value, or of a distance from a
    /// curve.
    fn bound_by_uncertainty(&mut self) {
        let Some((reference, uncertainty)) = self.reference.as_ref().zip(self.uncertainty()) else { return };
        let value = reference.value.unwrap_or(0.0);
        if reference.side != Side::AtMost && reference.value.is_some() {
            self.accept.min = Some(value - uncertainty);
        }
        if reference.side != Side::AtLeast {
            self.accept.max = Some(value + uncertainty);
        }
    }

    fn standing(&self) -> Standing {
        let Accept { min, max, .. } = self.accept;
        if min.is_none() && max.is_none() {
            return Standing::Absent;
        }
        let Some(reference) = self.reference.as_ref() else { return Standing::Decide };
        let Some(value) = reference.value else {
            // a relative distance from a curve has the same widest bound; an earlier result is no curve
            let relative = self.unit == RELATIVE && reference.kind != ReferenceKind::Regression;
            let wide = relative && max.is_some_and(|max| max > WIDEST * (1.0 + ROUND_OFF));
            return if fault!("judge-takes-wide-curves", wide => false) { Standing::TooWide } else { Standing::Decide };
        };
        let slack = ROUND_OFF * value.abs();
        let below = min.map_or(f64::INFINITY, |min| value - min);
        let above = max.map_or(f64::INFINITY, |max| max - value);
        if fault!("judge-takes-any-bounds", below < -slack || above < -slack => false) {
            return Standing::ExcludeReference;
        }
        let (leaves, widest) = match reference.side {
            Side::Both => (below.max(above), WIDEST),
            Side::AtLeast => (fault!("judge-exchanges-the-sides", below => above), WIDEST_ON_A_SIDE),
            Side::AtMost => (above, WIDEST_ON_A_SIDE),
        };
        let wide = value != 0.0 && leaves > widest * value.abs() + slack;
        if fault!("judge-takes-wide-bounds", wide => false) { Standing::TooWide } else { Standing::Decide }
    }

    /// Whether its bounds were chosen after its result.
    pub fn is_regression(&self) -> bool {
        let bounded = self.accept.min.is_some() || self.accept.max.is_some();
        let earlier = self.reference.as_ref().is_some_and(|r| r.kind == ReferenceKind::Regression);
        bounded && (earlier || self.accept.regression)
    }
}

fn within(value: f64, min: Option<f64>, max: Option<f64>) -> bool {
    let held = fault!("judge-takes-magnitudes", value => value.abs());
    let above = fault!("judge-ignores-lower-bounds", min => None).is_none_or(|min| held >= min);
    let below = fault!("judge-ignores-upper-bounds", max => None).is_none_or(|max| held <= max);
    above && below
}

/// The worst of some statuses.
pub fn worst(statuses: impl IntoIterator<Item = Status>) -> Option<Status> {
    let rank = |status: &Status| match status {
        Status::Info => 0,
        Status::Pass => 1,
        Status::KnownLimit => 2,
        Status::Fail => 3,
        Status::Error => 4,
    };
    let statuses = statuses.into_iter();
    fault!("last-verdict-counts", statuses.max_by_key(rank) => statuses.last())
}

#[cfg(test)]
mod tests;
