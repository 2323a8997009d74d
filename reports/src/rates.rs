//! Orders of convergence as a table: theory, what was observed, the band, and the error on the finest mesh.
//!
//! A record is a rate when its quantity begins with `order of`; what follows names the error. Its theory is
//! the value of its reference. The error itself is the record of the same run whose quantity is that name
//! with `on the finest mesh` or `with the smallest step`.

use std::collections::HashMap;

use fisura_verification::record::Record;

use crate::view::{bounds, shown, with_unit};

/// Digits of an order.
const ORDER_DIGITS: usize = 4;
/// Digits of an error.
const ERROR_DIGITS: usize = 3;

/// How the quantity of the error itself ends.
const ENDS: [&str; 2] = [" on the finest mesh", " with the smallest step"];

/// Digits of a number, for a table or for reading: `plain` or `pretty`.
pub type Show = fn(f64, usize) -> String;

/// One row of the table: an order of convergence, and the error that falls with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate<'a> {
    /// Record of the observed order.
    pub record: &'a Record,
    /// What falls at this order: `displacement error in L2`.
    pub norm: &'a str,
    /// Variant of the run: `p=2`; empty for the only one.
    pub variant: &'a str,
    /// The error on the finest mesh, if it is a record.
    pub finest: Option<&'a Record>,
}

/// The rates among records, in their order.
pub fn rates<'a>(records: &[&'a Record]) -> Vec<Rate<'a>> {
    let mut found: HashMap<_, &'a Record> = HashMap::new();
    for record in records {
        let name = ENDS.iter().find_map(|end| record.quantity.strip_suffix(end));
        if let Some(name) = name {
            found.entry((&record.suite, &record.case, variant(record), name)).or_insert(record);
        }
    }
    let rate = |record: &&'a Record| {
        let (norm, variant) = (norm(record)?, variant(record));
        let finest = found.get(&(&record.suite, &record.case, variant, norm)).copied();
        Some(Rate { record, norm, variant, finest })
    };
    records.iter().filter_map(rate).collect()
}

/// Name of the error whose order a record is.
fn norm(record: &Record) -> Option<&str> {
    let name = record.quantity.strip_prefix("order of ")?;
    Some(name.strip_prefix("the ").unwrap_or(name))
}

/// The part of an id between its case and its quantity.
fn variant(record: &Record) -> &str {
    let run = crate::view::run_id(record);
    let rest = run.strip_prefix(record.suite.as_str()).and_then(|r| r.strip_prefix('/'));
    let rest = rest.and_then(|r| r.strip_prefix(record.case.as_str())).unwrap_or_default();
    rest.trim_start_matches('/')
}

impl Rate<'_> {
    /// Degree, and what else sets the run apart: `p = 2, lumped`; the degree of its parameters where the
    /// variant has none.
    fn degree(&self) -> String {
        if !self.variant.is_empty() {
            return self.variant.replace('=', " = ").replace(',', ", ");
        }
        match self.record.parameters.get("degree") {
            Some(serde_json::Value::Array(both)) if both.first() == both.last() && !both.is_empty() => {
                format!("p = {}", both[0])
            }
            Some(degree) => format!("p = {degree}"),
            None => String::new(),
        }
    }

    /// Order of theory as text; `none` if the record has no reference value.
    fn theory(&self, show: Show) -> String {
        let value = self.record.reference.as_ref().and_then(|r| r.value);
        value.map_or_else(|| "none".to_string(), |v| show(v, ORDER_DIGITS))
    }

    /// Observed order, with the digits that its bounds need.
    fn observed(&self, show: Show) -> String {
        self.record.value.map_or("none".to_string(), |value| shown(self.record, value, ORDER_DIGITS, show))
    }

    /// Bounds of the accepted order as text.
    fn band(&self, show: Show) -> String {
        bounds(&self.record.accept, show)
    }

    /// All columns but the problem: degree, norm, theory, observed, accepted, error on the finest mesh.
    pub fn cells(&self, show: Show) -> [String; 6] {
        [
            self.degree(),
            self.norm.to_string(),
            self.theory(show),
            self.observed(show),
            self.band(show),
            self.error(show),
        ]
    }

    /// Error on the finest mesh.
    fn error(&self, show: Show) -> String {
        let value = |record: &Record| record.value.map(|v| with_unit(&show(v, ERROR_DIGITS), &record.unit));
        self.finest.and_then(value).unwrap_or_else(|| "none".to_string())
    }
}
