//! `summary.md`: what a step summary of a CI run shows first.

use fisura_verification::output::foreign::line;
use fisura_verification::record::{Record, ResultSet, Status};

use crate::number::plain;
use crate::rates::rates;
use crate::view::{
    Counts, accepted, broken, by_suite, comparison, environment, kind, limited, reason, reference_value, symbol, value,
    word,
};

/// Largest size in bytes; a step summary over 1 MiB is dropped whole by GitHub.
pub const LIMIT: usize = 900_000;

/// The summary: verdict, environment, what does not hold, then a table per suite; cut at [`LIMIT`] with a
/// note.
pub fn render_markdown(set: &ResultSet) -> String {
    render_limited(set, LIMIT)
}

fn render_limited(set: &ResultSet, limit: usize) -> String {
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
    let mut budget = Budget { out, limit, left_out: 0 };
    let broken = broken(set);
    if !broken.is_empty() {
        budget.table("## Does not hold", "| | check | value | accepted | why |\n|---|---|---|---|---|", &broken, |r| {
            let why = format!("{}. {}", r.claim.trim_end_matches('.'), reason(r));
            [verdict(r.status), code(&r.id), cell(&value(r, plain)), accepted(r, plain), cell(&why)]
        });
    }
    let limited = limited(set);
    if !limited.is_empty() {
        let head = "| check | value | reference | agrees within | limit | cause |\n|---|---|---|---|---|---|";
        budget.table("## Known limits", head, &limited, |r| {
            let cause = r.limit.as_ref().map(|limit| cell(&limit.why)).unwrap_or_default();
            let [value, reference] = [value(r, plain), reference(r)].map(|text| cell(&text));
            [code(&r.id), value, reference, accepted(r, plain), crate::view::limit(r, plain).unwrap_or_default(), cause]
        });
    }
    for (suite, mut records) in by_suite(set).into_iter().filter(|(_, records)| !records.is_empty()) {
        let rates = rates(&records);
        records.sort_by_key(|r| rank(r.status));
        let title = format!("## {}: {}", cell(suite), Counts::of(records.iter().copied()).list());
        let head = "| | check | quantity | value | reference | accepted |\n|---|---|---|---|---|---|";
        budget.table(&title, head, &records, |r| {
            let [quantity, value, reference] = [&r.quantity, &value(r, plain), &reference(r)].map(|text| cell(text));
            [verdict(r.status), code(&r.id), quantity, value, reference, accepted(r, plain)]
        });
        if !rates.is_empty() {
            let title = format!("### Orders of convergence: {}", cell(suite));
            let head = "| | problem | degree | norm | theory | observed | accepted | error on the finest mesh |\n\
                        |---|---|---|---|---|---|---|---|";
            budget.table(&title, head, &rates, |rate| {
                let [degree, norm, theory, observed, band, error] = rate.cells(plain).map(|text| cell(&text));
                let problem = code(&rate.record.case);
                [verdict(rate.record.status), problem, degree, norm, theory, observed, band, error]
            });
        }
    }
    budget.finish()
}

/// Failures first, then errors, known limits, passes, and what has no bounds.
fn rank(status: Status) -> u8 {
    match status {
        Status::Fail => 0,
        Status::Error => 1,
        Status::KnownLimit => 2,
        Status::Pass => 3,
        Status::Info => 4,
    }
}

fn verdict(status: Status) -> String {
    format!("{} {}", symbol(status), word(status))
}

fn reference(record: &Record) -> String {
    match &record.reference {
        None => "none".to_string(),
        Some(r) => {
            let number = match reference_value(r, &record.unit, plain) {
                none if none.is_empty() => kind(r).to_string(),
                number => format!("{number} ({})", kind(r)),
            };
            comparison(record, plain).map_or(number.clone(), |words| format!("{number}; {words}"))
        }
    }
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

/// Output that stops growing at a limit and remembers what it left out.
struct Budget {
    out: String,
    limit: usize,
    left_out: usize,
}

impl Budget {
    /// A table of finished cells.
    fn table<T, const N: usize>(&mut self, title: &str, head: &str, records: &[T], row: impl Fn(&T) -> [String; N]) {
        let top = format!("{title}\n\n{head}\n");
        if self.out.len() + top.len() > self.limit {
            self.left_out += records.len();
            return;
        }
        self.out.push_str(&top);
        for record in records {
            let line = format!("| {} |\n", row(record).join(" | "));
            if self.out.len() + line.len() > self.limit {
                self.left_out += 1;
            } else {
                self.out.push_str(&line);
            }
        }
        self.out.push('\n');
    }

    fn finish(mut self) -> String {
        if self.left_out > 0 {
            let note = format!("{} more rows are left out here; `report.html` has them all.\n", self.left_out);
            self.out.push_str(&note);
        }
        self.out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::results;

    #[test]
    fn a_long_summary_is_cut_with_a_note() {
        let mut set = results();
        set.records = std::iter::repeat_n(set.records, 50).flatten().collect();
        let text = render_limited(&set, 4000);
        assert!(text.len() < 4100, "{}", text.len());
        assert!(text.ends_with("more rows are left out here; `report.html` has them all.\n"), "{text}");
        assert!(text.contains("## Does not hold"));
    }

    #[test]
    fn cells_stay_cells() {
        assert_eq!(cell("a | b\n<c>"), "a \\| b &lt;c>");
        assert_eq!(cell("![x](javascript:y) **z** `q` $e$"), r"\!\[x\](javascript:y) \*\*z\*\* \`q\` \$e\$");
        assert_eq!(code("a|b`c\u{1b}"), "`a\\|b'c\u{fffd}`");
    }
}
