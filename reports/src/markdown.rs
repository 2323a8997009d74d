//! `summary.md`: what a step summary of a CI run shows first.

use fisura_verification::output::foreign::line;
use fisura_verification::record::ResultSet;

use crate::number::plain;
use crate::view::{Counts, accepted, broken, by_suite, environment, reason, symbol, value, word};

/// Most failures that are listed.
const LISTED: usize = 50;

/// The summary, one screen if nothing fails: verdict, environment, what does not hold, counts of every suite.
pub fn render_markdown(set: &ResultSet) -> String {
    let counts = Counts::of(&set.records);
    let mut out = format!("# {} {}\n\n{}.", symbol(counts.verdict()), counts.sentence(), counts.list());
    let remarks = counts.remarks();
    if !remarks.is_empty() {
        out.push_str(&format!(" {remarks}."));
    }
    for (name, text) in environment(set) {
        out.push_str(&format!(" {name}: {}.", cell(&text)));
    }
    out.push_str("\n\n");
    let broken = broken(set);
    if !broken.is_empty() {
        out.push_str("## Does not hold\n\n| | check | value | accepted | why |\n|---|---|---|---|---|\n");
        for record in broken.iter().take(LISTED) {
            let status = format!("{} {}", symbol(record.status), word(record.status));
            let why = cell(&format!("{}. {}", record.claim.trim_end_matches('.'), reason(record)));
            let (value, accepted) = (cell(&value(record, plain)), accepted(record, plain));
            out.push_str(&format!("| {status} | {} | {value} | {accepted} | {why} |\n", code(&record.id)));
        }
        if broken.len() > LISTED {
            out.push_str(&format!("\n{} more are in `report.html`.\n", broken.len() - LISTED));
        }
        out.push('\n');
    }
    out.push_str("| suite | pass | known limits | fail | errors | info |\n|---|---|---|---|---|---|\n");
    for (suite, records) in by_suite(set).into_iter().filter(|(_, records)| !records.is_empty()) {
        let c = Counts::of(records);
        let row = [c.pass, c.known_limit, c.fail, c.error, c.info].map(|count| count.to_string()).join(" | ");
        out.push_str(&format!("| {} | {row} |\n", cell(suite)));
    }
    out + "\n`report.html` lists every record, and the known limits with their causes.\n"
}

/// Text as itself: one line, nothing that Markdown or HTML would take for its own.
pub(crate) fn cell(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in line(text).split_whitespace().collect::<Vec<_>>().join(" ").chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '|' | '\\' | '`' | '*' | '_' | '[' | ']' | '~' | '$' | '#' | '!' => out.extend(['\\', c]),
            c => out.push(c),
        }
    }
    out
}

/// An id as code in a table, where a bar needs a backslash and nothing else can be escaped.
pub(crate) fn code(id: &str) -> String {
    format!("`{}`", line(id).replace('`', "'").replace('\\', "/").replace('|', "\\|"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stay_cells() {
        assert_eq!(cell("a | b\n<c>"), "a \\| b &lt;c>");
        assert_eq!(cell("![x](javascript:y) **z** `q` $e$"), r"\!\[x\](javascript:y) \*\*z\*\* \`q\` \$e\$");
        assert_eq!(code("a|b`c\u{1b}"), "`a\\|b'c\u{fffd}`");
    }
}
