//! The verdict for a terminal.

use fisura_verification::output::foreign::line;
use fisura_verification::record::{Record, ResultSet};

use crate::number::plain;
use crate::style::wrap_columns;
use crate::view::{Counts, accepted, broken, by_suite, limit, reason, value, word};

/// Where the known limits are listed one by one.
const LISTED: &str = "report.html#limits lists them";

/// A plain-text table: what does not hold with value, bounds and reason, one line per suite with known
/// limits, counts per suite, the status of the whole in the last line.
pub fn render_text(set: &ResultSet) -> String {
    let mut out = String::new();
    for record in broken(set) {
        out.push_str(&block(record));
    }
    for (suite, records) in by_suite(set) {
        let count = Counts::of(records).known_limit;
        if count > 0 {
            let limits = if count == 1 { "known limit" } else { "known limits" };
            out.push_str(&format!("{}: {count} {limits}; {LISTED}\n", line(suite)));
        }
    }
    let suites: Vec<_> = by_suite(set).into_iter().map(|(suite, records)| (line(suite), records)).collect();
    let widest = suites.iter().map(|s| s.0.chars().count()).max().unwrap_or(0).max("suite".len());
    if !set.records.is_empty() {
        let head = ["pass", "limit", "fail", "error", "info"].map(|word| format!("{word:>5}")).join(" ");
        out.push_str(&format!("{:widest$}  {head}\n", "suite"));
    }
    for (suite, records) in suites {
        let c = Counts::of(records);
        if c != Counts::default() {
            let row = [c.pass, c.known_limit, c.fail, c.error, c.info].map(|count| format!("{count:>5}")).join(" ");
            out.push_str(&format!("{suite:widest$}  {row}\n"));
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
        ("limit", limit(record, plain).unwrap_or_default()),
        ("why", reason(record)),
    ];
    for (name, text) in lines.into_iter().filter(|(_, text)| !text.is_empty()) {
        for (i, line) in wrap_columns(&text, 96).iter().enumerate() {
            out.push_str(&format!("  {:9} {line}\n", if i == 0 { name } else { "" }));
        }
    }
    out.push('\n');
    out
}
