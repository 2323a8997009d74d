//! What keys of a case file may hold, as types: read by serde, described by their JSON schemas.

use std::borrow::Cow;

use fisura::scene::Transfer;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::formula::{Amount, Formula};
use crate::scene::fields::{self, Item};
use crate::scene::read::transfer;
use crate::scene::typed::through;
use crate::scene::units::{self, Dimension};

/// Types of values: what each holds, its JSON schema, and how an item is read.
macro_rules! values {
    ($(
        $(#[$doc:meta])*
        $name:ident $([$($generics:tt)+] <$($arguments:ident),+>)? ($held:ty): $schema:tt, $read:expr;
    )+) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $name $(<$($generics)+>)? (pub $held);

        impl<'de $(, $($generics)+)?> Deserialize<'de> for $name $(<$($arguments),+>)? {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                through(deserializer, $read).map(Self)
            }
        }

        impl $(<$($generics)+>)? JsonSchema for $name $(<$($arguments),+>)? {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn inline_schema() -> bool {
                true
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
    )+};
}

values! {
    /// A string that says something.
    Words(String): { "type": "string", "minLength": 1 }, |item| item.words();
    /// Lower-case words joined by dashes.
    Id(String): { "type": "string", "pattern": "^[^\\sA-Z_]+$" }, read_id;
    /// A formula of columns.
    Column(String): { "type": "string", "minLength": 1 }, read_column;
    /// A number, or a quantity of any unit, in SI.
    Quantity(f64): { "type": ["number", "string"] }, any_quantity;
    /// As [`Quantity`], above zero.
    Uncertainty(f64): { "type": ["number", "string"] }, uncertainty;
    /// A plain number.
    Number(f64): { "type": "number" }, |item| item.quantity(Dimension::NONE);
    /// A plain number above zero.
    Positive(f64): { "type": "number", "exclusiveMinimum": 0 }, |item| item.positive(Dimension::NONE);
    /// A time above zero, s.
    Duration(f64): { "type": ["number", "string"] }, |item| item.positive(Dimension::TIME);
    /// A length above zero, m.
    Length(f64): { "type": ["number", "string"] }, |item| item.positive(Dimension::LENGTH);
    /// A number, a quantity of any unit, or a formula.
    AnyAmount(Amount): { "type": ["number", "string"] }, |item| amount(item, None);
    /// A time, or a formula.
    Time(Amount): { "type": ["number", "string"] }, |item| amount(item, Some(Dimension::TIME));
    /// A plain number, or a formula.
    Factor(Amount): { "type": ["number", "string"] }, |item| amount(item, Some(Dimension::NONE));
    /// A transfer of the updated frame.
    TransferName(Transfer):
        { "anyOf": [{ "type": "string" }, { "type": "object", "properties": { "xpic": { "type": "integer" } } }] },
        transfer;
    /// One of the words of a type.
    Word[T: fields::Words] <T> (T):
        { "enum": T::WORDS.iter().map(|(word, _)| *word).collect::<Vec<_>>() }, |item| item.word();
    /// A whole number between `MIN` and `MAX`.
    Whole[const MIN: usize, const MAX: usize] <MIN, MAX> (usize):
        { "type": "integer", "minimum": MIN, "maximum": MAX }, |item| item.whole(MIN, MAX);
}

/// A list with at least one entry.
#[derive(Debug, Clone, PartialEq, JsonSchema)]
#[schemars(inline)]
pub(super) struct Filled<T>(#[schemars(length(min = 1))] pub(super) Vec<T>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Filled<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let entries = Vec::deserialize(deserializer)?;
        if entries.is_empty() {
            Err(D::Error::custom("the list is empty\u{1f}give at least one entry\u{1f}"))
        } else {
            Ok(Self(entries))
        }
    }
}

/// Words of letters and digits joined by dashes.
fn read_id(item: &Item<'_>) -> Option<String> {
    let text = item.text()?;
    let plain = identifier(&text);
    if plain == text && !text.is_empty() {
        return Some(text);
    }
    let like = if plain.is_empty() { "largest-error" } else { &plain };
    item.fail(format!("{text:?} is not a valid id"), format!("join lower-case words by dashes: {like:?}"))
}

/// Turns words into an id: lower case, letters and digits only, with a dash between words.
pub(super) fn identifier(words: &str) -> String {
    let mapped: String = words.to_lowercase().chars().map(|c| if c.is_alphanumeric() { c } else { ' ' }).collect();
    mapped.split_whitespace().collect::<Vec<_>>().join("-")
}

fn read_column(item: &Item<'_>) -> Option<String> {
    let text = item.text()?;
    match text.parse::<Formula>() {
        Ok(_) => Some(text),
        Err(message) => item.fail(message, "name a column of the history, or write a formula of columns"),
    }
}

fn uncertainty(item: &Item<'_>) -> Option<f64> {
    let value = any_quantity(item)?;
    let remedy = "give a positive number, or remove it if it is unknown";
    if value > 0.0 { Some(value) } else { item.fail(format!("{value} is not a valid uncertainty"), remedy) }
}

fn any_quantity(item: &Item<'_>) -> Option<f64> {
    match item.node.as_str() {
        None => item.quantity(Dimension::NONE),
        Some(text) => match units::parse(text) {
            Ok(quantity) => Some(quantity.value),
            Err(e) => item.fail(e.message, e.remedy),
        },
    }
}

/// A formula, or a number of a dimension if one is given.
fn amount(item: &Item<'_>, dimension: Option<Dimension>) -> Option<Amount> {
    let formula = item.node.as_str().and_then(|text| text.strip_prefix('='));
    let Some(formula) = formula else {
        return dimension.map_or_else(|| any_quantity(item), |d| item.quantity(d)).map(Amount::Given);
    };
    match formula.trim().parse() {
        Ok(formula) => Some(Amount::Formula(Box::new(formula))),
        Err(message) => item.fail(message, "write a formula such as \"= 2*length/speed\""),
    }
}
