//! The `[[check]]` tables of a case file.

use super::formula::{Amount, Formula};
use super::{Check, ExpectedBand};
use crate::record::{Accept, BoundKind, ReferenceKind};
use crate::scene::fields::{Fields, Item};
use crate::scene::units::{self, Dimension};

const KEYS: [&str; 27] = [
    "id",
    "formerly",
    "quantity",
    "unit",
    "measure",
    "column",
    "reference",
    "from",
    "to",
    "at",
    "expect",
    "expect_kind",
    "expect_source",
    "uncertainty",
    "scale",
    "band",
    "variant",
    "against",
    "meshes",
    "order",
    "min",
    "max",
    "below",
    "above",
    "bounds",
    "why",
    "expectation",
];

/// What a check makes of the values of its measure on all meshes: the key `meshes`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

impl Estimate {
    /// Words of the key.
    pub const WORDS: [(&str, Self); 4] = [
        ("observed-order", Self::ObservedOrder),
        ("richardson", Self::Richardson),
        ("grid-convergence-index", Self::GridConvergenceIndex),
        ("finest-mesh", Self::FinestMesh),
    ];
}

/// A key of a check that takes a formula in place of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberKey {
    /// `from`
    From,
    /// `to`
    To,
    /// `at`
    At,
    /// `expect`
    Expect,
    /// `scale`
    Scale,
}

impl NumberKey {
    /// As it stands in a file.
    pub fn name(self) -> &'static str {
        match self {
            Self::From => "from",
            Self::To => "to",
            Self::At => "at",
            Self::Expect => "expect",
            Self::Scale => "scale",
        }
    }
}

/// All checks, at least one.
pub(super) fn read(item: &Item<'_>) -> Option<Vec<Check>> {
    let tables = item.tables()?;
    if tables.is_empty() {
        return item.fail("there is no check", "add at least one [[check]]");
    }
    let checks: Vec<Option<Check>> = tables.iter().map(read_check).collect();
    checks.into_iter().collect()
}

fn read_check(item: &Item<'_>) -> Option<Check> {
    let fields = item.fields(&KEYS)?;
    let text = |key: &str| fields.maybe(key, Item::text);
    let number = |key: &str| fields.maybe(key, any_quantity);
    let mut formulas = Vec::new();
    let mut formula_or = |meant: NumberKey, dimension: Option<Dimension>| {
        fields
            .maybe(meant.name(), |item| number_or_formula(item, dimension, &mut |found| formulas.push((meant, found))))
    };
    let quantity = fields.need("quantity", "quantity = \"what is measured, in words\"", Item::words);
    let like = format!(
        "id = {:?}, by which later results are compared with earlier ones",
        quantity.as_deref().map_or("…".into(), identifier)
    );
    let id = fields.need("id", &like, read_id);
    let formerly = fields.or("formerly", Vec::new(), |i| i.each(read_id));
    let unit = fields.or("unit", "1".to_string(), Item::text);
    let (measure, column, reference) = (text("measure"), fields.maybe("column", read_column), text("reference"));
    let from = formula_or(NumberKey::From, Some(Dimension::TIME));
    let to = formula_or(NumberKey::To, Some(Dimension::TIME));
    if let (Some(Some(from)), Some(Some(to))) = (from, to)
        && from > to
    {
        fields.get("to").and_then(|i| i.fail::<()>("to is before from", "give the earlier time as from"));
    }
    let (at, expect) = (formula_or(NumberKey::At, None), formula_or(NumberKey::Expect, None));
    let scale = formula_or(NumberKey::Scale, Some(Dimension::NONE));
    let kind = fields.or("expect_kind", ReferenceKind::Exact, reference_kind);
    let expect_source = fields.or("expect_source", String::new(), Item::text);
    let uncertainty = fields.maybe("uncertainty", positive);
    for key in ["expect_kind", "expect_source", "uncertainty"].into_iter().filter(|_| fields.get("expect").is_none()) {
        fields.get(key).and_then(|i| i.fail::<()>(format!("{key} without expect"), "add expect, or remove it"));
    }
    let (band, variant, against) = (text("band"), text("variant"), text("against"));
    let around_reference = read_around(&fields);
    let meshes = fields.maybe("meshes", |i| i.choice(&Estimate::WORDS));
    let order = number("order");
    let accept = read_accept(&fields);
    let expectation = fields.maybe("expectation", read_expectation);
    Some(Check {
        id: id?,
        formerly: formerly?,
        quantity: quantity?,
        unit: unit?,
        measure: measure?,
        column: column?,
        reference: reference?,
        window: [from?.unwrap_or(f64::NEG_INFINITY), to?.unwrap_or(f64::INFINITY)],
        at: at?,
        expect: expect?,
        expect_kind: kind?,
        expect_source: expect_source?,
        uncertainty: uncertainty?,
        scale: scale?.unwrap_or(1.0),
        band: band?,
        variant: variant?,
        against: against?,
        around_reference: around_reference?,
        meshes: meshes?,
        order: order?,
        accept: accept?,
        expectation: expectation?,
        formulas,
    })
}

/// `expectation = { min = 0.165, max = 0.2, source = "…" }`, or `{ band = "plate-events/…" }`.
fn read_expectation(item: &Item<'_>) -> Option<ExpectedBand> {
    let fields = item.fields(&["min", "max", "band", "source"])?;
    let number = |key: &str| fields.maybe(key, any_quantity);
    let (min, max) = (number("min")?, number("max")?);
    let (band, source) = (fields.maybe("band", Item::text)?, fields.or("source", String::new(), Item::text)?);
    if band.is_some() != (min.is_none() && max.is_none()) {
        return item.fail("an expectation is a band of the reference data or has bounds", "give band, or min and max");
    }
    if band.is_none() && source.trim().is_empty() {
        return item.fail("an expectation without a source", "add source = \"who expects it\"");
    }
    if min.zip(max).is_some_and(|(min, max)| min > max) {
        return item.fail("min is above max", "swap the two");
    }
    Some(ExpectedBand { range: [min, max], band, source })
}

/// `below = 0.1, above = 0.5`: bounds around the reference value.
fn read_around(fields: &Fields<'_>) -> Option<Option<[f64; 2]>> {
    let (below, above) = (fields.maybe("below", any_quantity)?, fields.maybe("above", any_quantity)?);
    match (below, above) {
        (None, None) => Some(None),
        (Some(below), Some(above)) if below >= 0.0 && above >= 0.0 => Some(Some([below, above])),
        (Some(_), Some(_)) => {
            fields.get("below")?.fail("below or above is negative", "give how far the value may lie to either side")
        }
        _ => fields.item().fail("one of below and above is missing", "give both: how far from the reference value"),
    }
}

/// Bounds need a reason, and those by uncertainty an uncertainty.
fn read_accept(fields: &Fields<'_>) -> Option<Accept> {
    let number = |key: &str| fields.maybe(key, any_quantity);
    let (min, max) = (number("min"), number("max"));
    let why = fields.or("why", String::new(), Item::text);
    let known = [("regression", BoundKind::Regression), ("validation", BoundKind::Validation)];
    let kind = fields.maybe("bounds", |i| i.choice(&known));
    let (min, max, why, kind) = (min?, max?, why?, kind?);
    let given = |keys: &[&str]| keys.iter().any(|key| fields.get(key).is_some());
    let kinds = [given(&["min", "max"]), given(&["below", "above"]), given(&["band"])];
    if kinds.into_iter().filter(|kind| *kind).count() > 1 {
        return fields.item().fail("bounds of two kinds", "give min and max, or below and above, or band");
    }
    if let (Some(low), Some(high)) = (min, max)
        && low > high
    {
        return fields.get("min")?.fail(format!("min {low} is above max {high}"), "no value lies between them");
    }
    let bounded = given(&["min", "max", "below", "above"]);
    if (bounded || kind.is_some()) && why.trim().is_empty() {
        return fields.item().fail("bounds without a reason", "add why = \"where the bound comes from\"");
    }
    let wrong = |message, remedy| fields.get("bounds")?.fail(message, remedy);
    match kind {
        Some(BoundKind::Validation) if bounded || given(&["band"]) => {
            wrong("bounds of its own beside those of the uncertainty", "remove min, max, below, above and band")
        }
        Some(BoundKind::Validation) if given(&["expect"]) && !given(&["uncertainty"]) => {
            wrong("bounds by an uncertainty that is not given", "add uncertainty, the half width of that of expect")
        }
        Some(BoundKind::Regression) if !bounded => {
            wrong("bounds = \"regression\" without bounds", "give min and max, or below and above")
        }
        _ => Some(Accept { min, max, why, kind }),
    }
}

fn reference_kind(item: &Item<'_>) -> Option<ReferenceKind> {
    item.choice(&[
        ("exact", ReferenceKind::Exact),
        ("theory", ReferenceKind::Theory),
        ("literature", ReferenceKind::Literature),
        ("independent-code", ReferenceKind::IndependentCode),
        ("self-convergence", ReferenceKind::SelfConvergence),
        ("regression", ReferenceKind::Regression),
    ])
}

/// Words of letters and digits joined by dashes.
fn read_id(item: &Item<'_>) -> Option<String> {
    let text = item.text()?;
    let plain = identifier(&text);
    if plain == text && !text.is_empty() {
        return Some(text);
    }
    let like = if plain.is_empty() { "largest-error" } else { &plain };
    item.fail(format!("{text:?} is no id"), format!("join lower-case words by dashes: {like:?}"))
}

/// Words as an id.
fn identifier(words: &str) -> String {
    let mapped: String = words.to_lowercase().chars().map(|c| if c.is_alphanumeric() { c } else { ' ' }).collect();
    mapped.split_whitespace().collect::<Vec<_>>().join("-")
}

/// A number or quantity, of a dimension if one is given; not a number for a formula, which `found` takes.
fn number_or_formula(item: &Item<'_>, dimension: Option<Dimension>, found: &mut dyn FnMut(Formula)) -> Option<f64> {
    if item.node.as_str().is_none_or(|text| !text.starts_with('=')) {
        return dimension.map_or_else(|| any_quantity(item), |dimension| item.quantity(dimension));
    }
    if let Amount::Formula(formula) = Amount::read(item)? {
        found(*formula);
    }
    Some(f64::NAN)
}

/// A formula of columns.
pub(super) fn read_column(item: &Item<'_>) -> Option<String> {
    let text = item.text()?;
    match text.parse::<Formula>() {
        Ok(_) => Some(text),
        Err(message) => item.fail(message, "name a column of the history, or write a formula of columns"),
    }
}

/// As [`any_quantity`], above zero.
fn positive(item: &Item<'_>) -> Option<f64> {
    match any_quantity(item)? {
        value if value > 0.0 => Some(value),
        value => item.fail(format!("{value} is no uncertainty"), "give a positive number, or none if it is unknown"),
    }
}

/// A number, or a string with any unit, in SI.
fn any_quantity(item: &Item<'_>) -> Option<f64> {
    match item.node.as_str() {
        None => item.quantity(Dimension::NONE),
        Some(text) => match units::parse(text) {
            Ok(quantity) => Some(quantity.value),
            Err(e) => item.fail(e.message, e.remedy),
        },
    }
}
