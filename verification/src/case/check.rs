//! The `[[check]]` tables of a case file.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Map, Value};

use super::Check;
use super::formula::Amount;
use super::value::{AnyAmount, Column, Factor, Id, Quantity, Time, Uncertainty, Words, identifier};
use crate::record::{Accept, Limit, ReferenceKind, Side};
use crate::scene::fields::Item;
use crate::scene::units::{self, Dimension};

/// What a check makes of the values of its measure on all meshes: the key `meshes`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Estimate {
    /// The order p in h.
    ObservedOrder,
    /// The value extrapolated to h = 0, in the unit of the check.
    Richardson,
    /// Relative uncertainty of the value on the finest mesh.
    GridConvergenceIndex,
    /// The value on the finest mesh, with its numerical uncertainty.
    FinestMesh,
}

/// A check as it stands in the file, or a set of checks or one for each entry of a list, which are written
/// out before it is read.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CheckTable {
    /// Last part of the id of its records, by which later results are compared with earlier ones: lower-case
    /// words joined by dashes. The words of `quantity`, if absent.
    id: Option<Id>,
    /// Ids it had before.
    #[serde(default)]
    formerly: Vec<Id>,
    /// What is measured, in words.
    quantity: Option<Words>,
    /// Unit of the value; 1 if absent.
    unit: Option<String>,
    /// The measure, `final` if absent; a study other than `scene` measures the quantity itself.
    measure: Option<String>,
    /// Column of the history, or a formula of columns.
    column: Option<Column>,
    /// Reference curve or value: `reference = "folder/quantity"`.
    reference: Option<String>,
    /// Begin of the window in time.
    from: Option<Time>,
    /// End of the window in time.
    to: Option<Time>,
    /// Position, time or threshold that the measure needs.
    at: Option<AnyAmount>,
    /// Expected value, if it is one number.
    expect: Option<AnyAmount>,
    /// Kind of the expected value.
    expect_kind: Option<ReferenceKind>,
    /// Where the expected value comes from.
    expect_source: Option<String>,
    /// On which side of the expected value a measured one agrees with it.
    expect_side: Option<Side>,
    /// Half width of the uncertainty of the expected value, in its unit.
    uncertainty: Option<Uncertainty>,
    /// Discretisation error of the value as a formula, an order and a constant: `"= 0.6*span/radius"`.
    discretisation: Option<AnyAmount>,
    /// Factor from the measured to the reported unit; absent: that from SI to a unit of time or length.
    scale: Option<Factor>,
    /// Reference band that gives the bounds: `band = "folder/name"`.
    band: Option<String>,
    /// The variant it is about, or a pattern of variants; each, if absent.
    variant: Option<String>,
    /// The variant it is compared with.
    against: Option<String>,
    /// What to make of the values on all meshes.
    meshes: Option<Estimate>,
    /// Order of theory in the span length, for `meshes`.
    order: Option<Quantity>,
    /// Least value, with the reason in `why`.
    min: Option<Quantity>,
    /// Largest value, with the reason in `why`.
    max: Option<Quantity>,
    /// How far from its reference the value may lie, on either side.
    within: Option<Quantity>,
    /// How far below its reference the value may lie, if not `within`.
    below: Option<Quantity>,
    /// How far above its reference the value may lie, if not `within`.
    above: Option<Quantity>,
    /// `regression`: bounds chosen after the result.
    bounds: Option<Bounds>,
    /// Where the bounds come from, or the discretisation error.
    #[serde(default)]
    why: String,
    /// Why the value is shown beside its reference and not judged, whatever bounds its set of checks gives.
    shown: Option<Words>,
    /// A documented limit, in which a value may lie that does not agree with its reference.
    limit: Option<LimitTable>,
    /// A set of checks of `check-sets.toml`, in place of id and quantity.
    #[schemars(with = "Option<String>")]
    set: Option<IgnoredAny>,
    /// What changes in checks of the set: `with = { id-of-a-check = { max = 1 } }`.
    #[schemars(with = "Option<BTreeMap<String, Map<String, Value>>>")]
    with: Option<IgnoredAny>,
    /// A check for each entry: `each = [{ variant = "p=2", max = 1 }]`; lists in the list are combined, and
    /// an entry may have `each`, too.
    #[schemars(with = "Option<Vec<Value>>")]
    each: Option<IgnoredAny>,
}

/// The word of `bounds`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum Bounds {
    Regression,
}

/// `limit = { min = 0.82, max = 1.24, why = "…" }`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LimitTable {
    /// Smallest value within the limit.
    min: Option<Quantity>,
    /// Largest value within the limit.
    max: Option<Quantity>,
    /// Cause of the limit, and where its bounds come from; that of the check, if absent.
    #[serde(default)]
    why: String,
    /// `regression`: bounds chosen after the result.
    bounds: Option<Bounds>,
}

fn number(quantity: Option<Quantity>) -> Option<f64> {
    quantity.map(|quantity| quantity.0)
}

/// The check of a table; `item` is the table.
pub(super) fn check(table: CheckTable, item: &Item<'_>) -> Option<Check> {
    if table.quantity.is_none() {
        item.missing::<()>("quantity", "quantity = \"what is measured, in words\"");
    }
    for (key, _) in [("set", &table.set), ("with", &table.with), ("each", &table.each)]
        .into_iter()
        .filter(|(_, given)| given.is_some())
    {
        item.at(key)?
            .fail::<()>(format!("{key} together with the keys of one check"), "see \"Adding a case\" in the book");
    }
    let mut formulas = Vec::new();
    let mut value = |key: &'static str, amount: Option<Amount>| {
        amount.map(|amount| match amount {
            Amount::Given(value) => value,
            Amount::Formula(formula) => {
                formulas.push((key, *formula));
                f64::NAN
            }
        })
    };
    let from = value("from", table.from.as_ref().map(|time| time.0.clone()));
    let to = value("to", table.to.as_ref().map(|time| time.0.clone()));
    let at = value("at", table.at.as_ref().map(|at| at.0.clone()));
    let expect = value("expect", table.expect.as_ref().map(|expect| expect.0.clone()));
    let scale = value("scale", table.scale.as_ref().map(|scale| scale.0.clone()));
    if from.zip(to).is_some_and(|(from, to)| from > to) {
        item.at("to")?.fail::<()>("to is before from", "give the earlier time as from");
    }
    if let Some(given) = item.at("discretisation").filter(|_| table.meshes.is_some()) {
        given.fail::<()>("discretisation beside meshes, which give it", "remove one of the two");
    }
    let discretisation = value("discretisation", table.discretisation.as_ref().map(|error| error.0.clone()));
    let of_expect = ["expect_kind", "expect_source", "expect_side", "uncertainty"];
    for given in of_expect.into_iter().filter(|_| expect.is_none()).filter_map(|key| item.at(key)) {
        let key = given.path.rsplit('.').next().unwrap_or_default();
        given.fail::<()>(format!("{key} without expect"), "add expect, or remove it");
    }
    let around_reference = around(&table, item);
    let accept = accept(&table, item);
    let limit = table.limit.map(|limited| limit(limited, &table.why, &item.at("limit").expect("it is read")));
    let quantity = table.quantity?.0;
    let unit = table.unit.unwrap_or("1".into());
    Some(Check {
        id: table.id.map_or_else(|| identifier(&quantity), |id| id.0),
        formerly: table.formerly.into_iter().map(|id| id.0).collect(),
        quantity,
        measure: table.measure,
        column: table.column.map(|column| column.0),
        reference: table.reference,
        window: [from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY)],
        at,
        expect,
        expect_kind: table.expect_kind.unwrap_or_default(),
        expect_source: table.expect_source.unwrap_or_default(),
        expect_side: table.expect_side.unwrap_or_default(),
        uncertainty: table.uncertainty.map(|uncertainty| uncertainty.0),
        scale: scale.unwrap_or_else(|| per_si(&unit)),
        unit,
        band: table.band,
        variant: table.variant,
        against: table.against,
        around_reference: around_reference?,
        meshes: table.meshes,
        order: number(table.order),
        accept: accept?,
        limit: limit.map_or(Some(None), |read| read.map(Some))?,
        shown: table.shown.map(|why| why.0),
        discretisation,
        formulas,
    })
}

/// A documented limit has bounds, a cause, which may be the reason of the check, and nothing the wrong way
/// round.
fn limit(table: LimitTable, reason: &str, item: &Item<'_>) -> Option<Limit> {
    let LimitTable { min, max, mut why, bounds } = table;
    if why.trim().is_empty() {
        why = reason.to_string();
    }
    let (min, max) = (number(min), number(max));
    if min.is_none() && max.is_none() {
        return item.fail("a limit without bounds", "give min, max or both");
    }
    if why.trim().is_empty() {
        return item
            .fail("a limit without a cause", "add why = \"what limits the value, and where the bounds come from\"");
    }
    if min.zip(max).is_some_and(|(min, max)| min > max) {
        return item.fail("min is above max", "swap the two");
    }
    Some(Limit { min, max, why, regression: bounds.is_some() })
}

/// `within = 0.1`, or `below = 0.1, above = 0.5`: bounds around the reference value.
fn around(table: &CheckTable, item: &Item<'_>) -> Option<Option<[f64; 2]>> {
    let side = |own: &Option<Quantity>| own.as_ref().or(table.within.as_ref()).map(|distance| distance.0);
    match [side(&table.below), side(&table.above)] {
        [None, None] => Some(None),
        [Some(below), Some(above)] if below >= 0.0 && above >= 0.0 => Some(Some([below, above])),
        [Some(_), Some(_)] => item.fail("a distance from the reference is negative", "give that allowed on each side"),
        _ => item.fail("one of below and above is missing", "give both distances from the reference value"),
    }
}

/// How many of a unit make one of SI, which measures give, if it is one of time or length.
fn per_si(unit: &str) -> f64 {
    let one = units::parse(&format!("1 {unit}")).ok();
    let one = one.filter(|one| [Dimension::TIME, Dimension::LENGTH].contains(&one.dimension));
    one.map_or(1.0, |one| 1.0 / one.value)
}

/// Bounds need a reason, and there are none beside an uncertainty, which bounds the value itself.
fn accept(table: &CheckTable, item: &Item<'_>) -> Option<Accept> {
    let bound = |quantity: &Option<Quantity>| quantity.as_ref().map(|bound| bound.0);
    let (min, max, regression) = (bound(&table.min), bound(&table.max), table.bounds.is_some());
    let around = [&table.within, &table.below, &table.above].into_iter().any(Option::is_some);
    let own = min.is_some() || max.is_some();
    if [own, around, table.band.is_some()].into_iter().filter(|kind| *kind).count() > 1 {
        return item.fail("bounds of two kinds", "give min and max, or below and above, or band");
    }
    if let (Some(low), Some(high)) = (min, max)
        && low > high
    {
        return item.at("min")?.fail(format!("min {low} is above max {high}"), "no value lies between them");
    }
    let bounded = own || around;
    let computed = table.uncertainty.is_some() || table.discretisation.is_some();
    if bounded && computed {
        let remedy = "remove min, max, within, below and above, or write them as limit = { max = …, why = \"…\" }";
        return item.fail("bounds in addition to those of the uncertainty", remedy);
    }
    if (bounded || regression || table.discretisation.is_some()) && table.why.trim().is_empty() {
        return item.fail("bounds without a reason", "add why = \"where the bound comes from\"");
    }
    if regression && !bounded {
        let remedy = "give min and max, or below and above";
        return item.at("bounds")?.fail("bounds = \"regression\" without bounds", remedy);
    }
    Some(Accept { min, max, why: table.why.clone(), regression })
}
