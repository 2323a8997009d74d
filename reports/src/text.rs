//! The verdict for a terminal.

use fisura_verification::output::foreign::line;
use fisura_verification::record::{Record, ResultSet};

use crate::number::plain;
use crate::style::wrap_columns;
use crate::view::{Counts, accepted, broken, by_suite, expected, reason, unmet, value, word};

/// A plain-text table: what does not hold with value, bounds and reason, counts per suite, the verdict on the
/// whole in the last line.
pub fn render_text(set: &ResultSet) -> String {
    let mut out = String::new();
    for record in broken(set) {
        out.push_str(&block(record));
    }
    for record in unmet(set) {
        let expected = expected(record, plain).unwrap_or_default();
        let text = format!("NOT MET {}: {}, expected {expected}", record.id, value(record, plain));
        out.push_str(&(wrap_columns(&line(&text), 106).join("\n  ") + "\n"));
    }
    let suites: Vec<_> = by_suite(set).into_iter().map(|(suite, records)| (line(suite), records)).collect();
    let widest = suites.iter().map(|s| s.0.chars().count()).max().unwrap_or(0).max("suite".len());
    if !set.records.is_empty() {
        out.push_str(&format!("{:widest$}  {:>5} {:>5} {:>5} {:>5}\n", "suite", "pass", "fail", "error", "info"));
    }
    for (suite, records) in suites {
        let c = Counts::of(records);
        if c != Counts::default() {
            out.push_str(&format!("{suite:widest$}  {:>5} {:>5} {:>5} {:>5}\n", c.pass, c.fail, c.error, c.info));
        }
    }
    let counts = Counts::of(&set.records);
    let remarks = counts.remarks();
    if !remarks.is_empty() {
        out.push_str(&(remarks + "\n"));
    }
    let verdict = word(counts.verdict()).to_uppercase();
    out.push_str(&format!("{verdict}: {} ({})\n", counts.sentence().to_lowercase(), counts.list()));
    out
}

/// One record that does not hold.
fn block(record: &Record) -> String {
    let mut out = format!("{} {}\n", word(record.status).to_uppercase(), line(&record.id));
    let lines = [
        ("claim", record.claim.clone()),
        ("value", format!("{} ({})", value(record, plain), record.quantity)),
        ("accepted", accepted(record, plain)),
        ("why", reason(record)),
    ];
    for (name, text) in lines {
        for (i, line) in wrap_columns(&text, 96).iter().enumerate() {
            out.push_str(&format!("  {:9} {line}\n", if i == 0 { name } else { "" }));
        }
    }
    out.push('\n');
    out
}
