//! The board: the errors of all submissions, each beside the uncertainty of its reference.
//!
//! Costs are of other days and machines; they stand on the board only if all results state one, of the same
//! processor and beside the same time of a kernel, which says that one run measured them.

use std::collections::BTreeMap;

use fisura_verification::judge::Judged;
use fisura_verification::output::foreign::line;
use fisura_verification::output::history::Table;
use fisura_verification::record::{Axis, Curve, CurveStyle, Figure, FigureBody};
use minijinja::Value;
use serde::Serialize;

use super::fill;
use crate::figure::render_figure;
use crate::number::{duration, plain};
use crate::series::SeriesSet;

/// One quantity of the board.
#[derive(Debug, Clone, Serialize)]
pub struct Board {
    /// Key of the quantity, for file names.
    pub key: String,
    /// Title of the drawing: the quantity in words.
    pub title: String,
    /// The drawing; empty if no submission has both an error and a spacing.
    pub svg: String,
    /// What the numbers say.
    pub sentence: String,
    /// Names of the columns.
    pub head: Vec<&'static str>,
    /// Name, verdict, error, uncertainty of the reference, reference, and the cost where costs compare.
    pub rows: Vec<Vec<String>>,
}

/// A submission on the board.
struct Entry<'a> {
    name: &'a str,
    outcome: &'static str,
    error: f64,
    /// Uncertainty of the comparison, and that of its reference; none if unknown.
    comparison: Option<f64>,
    uncertainty: Option<f64>,
    reference: &'a str,
    /// Spacing at the crack, mm.
    spacing: Option<f64>,
    cost: Option<f64>,
}

/// Errors by quantity: kinetic, elastic and fracture energy over the whole curve.
pub fn board(judged: &[Judged]) -> Vec<Board> {
    let shown =
        [("kinetic", "kinetic energy"), ("elastic", "elastic energy"), ("fracture", "fracture energy increment")];
    shown.into_iter().map(|(key, words)| one(key, words, judged)).collect()
}

/// The same as a page with every verdict's figures in a table.
///
/// # Errors
/// Only if the template cannot be filled.
pub fn board_page(judged: &[Judged]) -> Result<String, minijinja::Error> {
    let title = format!("{} results and their errors", judged.len());
    fill(title, Value::UNDEFINED, &board(judged))
}

/// The same as Markdown beside the drawings `board-<key>.svg`.
pub fn board_markdown(boards: &[Board]) -> String {
    let cell = |text: &str| line(text).replace('|', "\\|").replace('<', "&lt;");
    let mut out = "# Errors of all results\n".to_string();
    for board in boards {
        out += &format!("\n## {}\n\n", board.title);
        if !board.svg.is_empty() {
            out += &format!("![{}](board-{}.svg)\n\n", board.title, board.key);
        }
        let rule = "---|".repeat(board.head.len());
        out += &format!("{}\n\n| {} |\n|{rule}\n", cell(&board.sentence), board.head.join(" | "));
        let row =
            |row: &Vec<String>| format!("| {} |\n", row.iter().map(|text| cell(text)).collect::<Vec<_>>().join(" | "));
        board.rows.iter().for_each(|cells| out += &row(cells));
    }
    out
}

fn one(key: &str, words: &str, judged: &[Judged]) -> Board {
    let mut entries: Vec<Entry<'_>> = judged.iter().filter_map(|j| entry(j, words)).collect();
    entries.sort_by(|a, b| a.error.total_cmp(&b.error));
    let costs = costs_compare(judged);
    let mut head = vec!["result", "verdict", "error", "U of the comparison", "U of the reference", "reference"];
    head.extend(costs.then_some("processor time"));
    let row = |e: &Entry<'_>| {
        let both = e.comparison.map_or("unknown".into(), percent);
        let error = percent(e.error);
        let mut cells = vec![e.name.to_string(), e.outcome.into(), error, both, e.uncertainty(), e.reference.into()];
        cells.extend(e.cost.filter(|_| costs).map(duration));
        cells
    };
    let title = format!("{words}: error against spacing");
    let svg = draw(key, &title, words, &entries);
    let rows = entries.iter().map(row).collect();
    Board { key: key.into(), title, svg, sentence: sentence(&entries, costs), head, rows }
}

fn percent(value: f64) -> String {
    format!("{} %", plain(100.0 * value, 3))
}

impl Entry<'_> {
    fn uncertainty(&self) -> String {
        self.uncertainty.map_or("unknown".into(), percent)
    }

    fn is_within_uncertainty(&self) -> bool {
        self.uncertainty.is_some_and(|u| self.error <= u)
    }
}

/// Submissions that compare the quantity over the whole curve; the reference itself has no error.
fn entry<'a>(judged: &'a Judged, words: &str) -> Option<Entry<'a>> {
    let verdict = &judged.verdict;
    let quantity = verdict.quantities.iter().find(|q| q.quantity == words)?;
    let whole = quantity.comparisons.iter().find(|c| c.name == "whole")?;
    let error = whole.error.filter(|error| error.is_finite() && *error >= 1e-5)?;
    Some(Entry {
        name: &verdict.code.name,
        outcome: quantity.outcome.word(),
        error,
        comparison: whole.u_val,
        uncertainty: whole.u_ref,
        reference: &verdict.reference.id,
        spacing: verdict.spacing_m.map(|h| 1e3 * h),
        cost: verdict.cost.cpu_s,
    })
}

/// Whether one run on one machine measured all costs.
fn costs_compare(judged: &[Judged]) -> bool {
    let of = |j: &Judged| {
        let cost = &j.verdict.cost;
        cost.cpu_s.and(cost.processor.clone()).zip(cost.kernel_ns.map(f64::to_bits))
    };
    let runs: Vec<_> = judged.iter().map(of).collect();
    runs.first().is_some_and(Option::is_some) && runs.windows(2).all(|pair| pair[0] == pair[1])
}

/// A code at several resolutions is one line: the name up to the spacing.
fn family(name: &str) -> &str {
    name.split(", h =").next().unwrap_or(name)
}

fn draw(key: &str, title: &str, words: &str, entries: &[Entry<'_>]) -> String {
    let mut families: BTreeMap<&str, Vec<[f64; 2]>> = BTreeMap::new();
    for (entry, spacing) in entries.iter().filter_map(|entry| Some((entry, entry.spacing?))) {
        families.entry(family(entry.name)).or_default().push([spacing, 100.0 * entry.error]);
    }
    let (mut set, mut curves) = (SeriesSet::default(), Vec::new());
    for (name, mut points) in families {
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut table = Table::new(&["spacing", "error"]);
        points.iter().for_each(|point| table.push(point));
        let series = format!("series/{}.csv", curves.len());
        curves.push(Curve { style: CurveStyle::Markers, ..Curve::line(name, &series, ["spacing", "error"]) });
        set.insert(series, table);
    }
    if curves.is_empty() {
        return String::new();
    }
    let axes = ["spacing at the crack (mm)", &format!("error of the {words} (%)")].map(Axis::logarithmic);
    let caption = "relative rms over the whole curve against the reference of the declared variant";
    let body = FigureBody::chart(axes, curves, Vec::new());
    let figure = Figure::new("judge", [&format!("board-{key}"), title, caption], body);
    render_figure(&figure, &set).unwrap_or_default()
}

fn sentence(entries: &[Entry<'_>], costs: bool) -> String {
    let Some(best) = entries.first() else { return "Of no result is this quantity known.".into() };
    let (count, within) = (entries.len(), entries.iter().filter(|e| e.is_within_uncertainty()).count());
    let mut text = match within {
        0 => format!(
            "Of {count} results the least error is that of {} ({}, uncertainty of its reference {}).",
            best.name,
            percent(best.error),
            best.uncertainty()
        ),
        1 => format!("Of {count} results one error is within the uncertainty of its reference."),
        n => format!(
            "Of {count} results {n} errors are within the uncertainty of their reference: their order says nothing."
        ),
    };
    let mut references: Vec<(&str, String)> = entries.iter().map(|e| (e.reference, e.uncertainty())).collect();
    references.sort();
    references.dedup();
    if references.iter().any(|r| r.1 != references[0].1) {
        let of = |(reference, uncertainty): &(&str, String)| {
            let held = entries.iter().filter(|e| e.reference == *reference && e.uncertainty() == *uncertainty).count();
            format!("{reference} ({uncertainty}, {held})")
        };
        let list: Vec<String> = references.iter().map(of).collect();
        text += &format!(
            " The references differ in uncertainty, and errors against different ones do not rank: {}.",
            list.join(", ")
        );
    }
    if !costs {
        text += " Costs are not shown: they are of different days and machines. cargo xtask bench --family plate measures costs in one run.";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(name: &'static str, error: f64, uncertainty: f64, reference: &'static str) -> Entry<'static> {
        let (uncertainty, spacing) = (Some(uncertainty), Some(0.25));
        Entry { name, outcome: "pass", error, comparison: uncertainty, uncertainty, reference, spacing, cost: None }
    }

    #[test]
    fn references_of_different_uncertainty_are_named() {
        let mut entries = [entry("a", 0.003, 0.004, "one"), entry("b", 0.02, 0.01, "other")];
        let text = sentence(&entries, false);
        for part in [
            "Of 2 results one error is within the uncertainty of its reference.",
            "differ in uncertainty, and errors against different ones do not rank: one (0.4 %, 1), other (1 %, 1).",
            "Costs are not shown",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        entries = [entry("a", 0.01, 0.004, "one"), entry("b", 0.02, 0.004, "one")];
        let text = sentence(&entries, true);
        assert!(
            text.starts_with("Of 2 results the least error is that of a (1 %, uncertainty of its reference 0.4 %).")
        );
        assert!(!text.contains("differ") && !text.contains("Costs"), "{text}");
    }
}
