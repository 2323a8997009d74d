//! The board: error against cost of all submissions.

use fisura_verification::judge::Judged;
use fisura_verification::output::foreign::line;
use fisura_verification::output::history::Table;
use fisura_verification::record::{Axis, Curve, CurveStyle, Figure, FigureBody, Scale};
use serde::Serialize;

use super::{Page, STYLE, fill};
use crate::figure::render_figure;
use crate::number::{duration, plain};
use crate::series::SeriesSet;

/// One quantity of the board.
#[derive(Debug, Clone, Serialize)]
pub struct Board {
    /// Key of the quantity, for file names.
    pub key: String,
    /// Title.
    pub title: String,
    /// The drawing; empty if no submission has both an error and a cost.
    pub svg: String,
    /// What the numbers say.
    pub sentence: String,
    /// Name, verdict, error, cost.
    pub rows: Vec<[String; 4]>,
}

/// A submission on the board.
struct Entry<'a> {
    name: &'a str,
    outcome: &'static str,
    error: f64,
    cost: Option<f64>,
}

/// Error against processor time, by quantity: kinetic, elastic and fracture energy over the whole curve.
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
    let title = format!("{} results: error against cost", judged.len());
    fill(Page { style: STYLE, title, verdicts: Vec::new(), boards: board(judged) })
}

/// The same as Markdown beside the drawings `board-<key>.svg`.
pub fn board_markdown(boards: &[Board]) -> String {
    let cell = |text: &str| line(text).replace('|', "\\|").replace('<', "&lt;");
    let mut out = "# Error against cost\n".to_string();
    for board in boards {
        out += &format!("\n## {}\n\n", board.title);
        if !board.svg.is_empty() {
            out += &format!("![{}](board-{}.svg)\n\n", board.title, board.key);
        }
        out +=
            &format!("{}\n\n| result | verdict | error | processor time |\n|---|---|---|---|\n", cell(&board.sentence));
        board
            .rows
            .iter()
            .for_each(|row| out += &format!("| {} |\n", row.each_ref().map(|text| cell(text)).join(" | ")));
    }
    out
}

fn one(key: &str, words: &str, judged: &[Judged]) -> Board {
    let mut entries: Vec<Entry<'_>> = judged.iter().filter_map(|j| entry(j, words)).collect();
    entries.sort_by(|a, b| a.error.total_cmp(&b.error));
    let rated: Vec<(&Entry<'_>, f64)> = entries.iter().filter_map(|e| Some((e, cost(judged, e)?))).collect();
    let normalised = normalised(judged);
    let title = format!("{words}: error against processor time");
    let axis = if normalised { "processor time over that of a kernel step (10⁹)" } else { "processor time (s)" };
    let rows = entries.iter().map(|e| {
        let cost = e.cost.map_or("cost not stated".to_string(), duration);
        [e.name.to_string(), e.outcome.to_string(), format!("{} %", plain(100.0 * e.error, 3)), cost]
    });
    let svg = draw(key, &title, axis, words, &rated);
    Board { key: key.into(), title, svg, sentence: sentence(&entries, &rated, normalised), rows: rows.collect() }
}

/// Submissions that compare the quantity over the whole curve; the reference itself has no error.
fn entry<'a>(judged: &'a Judged, words: &str) -> Option<Entry<'a>> {
    let verdict = &judged.verdict;
    let quantity = verdict.quantities.iter().find(|q| q.quantity == words)?;
    let error = quantity.comparisons.iter().find(|c| c.name == "whole")?.error?;
    let reference = error < 1e-5;
    (!reference && error.is_finite()).then(|| Entry {
        name: &verdict.code.name,
        outcome: quantity.outcome.word(),
        error,
        cost: verdict.cost.cpu_s,
    })
}

/// Whether every submission with a cost also measured a kernel, so that machines can be told apart.
fn normalised(judged: &[Judged]) -> bool {
    let mut costs = judged.iter().map(|j| &j.verdict.cost).filter(|c| c.cpu_s.is_some()).peekable();
    costs.peek().is_some() && costs.all(|c| c.kernel_ns.is_some())
}

fn cost(judged: &[Judged], entry: &Entry<'_>) -> Option<f64> {
    let cpu = entry.cost?;
    if !normalised(judged) {
        return Some(cpu);
    }
    let own = judged.iter().find(|j| j.verdict.code.name == entry.name)?;
    Some(cpu / own.verdict.cost.kernel_ns?)
}

/// A code at several resolutions is one line: the name up to the spacing.
fn family(name: &str) -> &str {
    name.split(", h =").next().unwrap_or(name)
}

fn draw(key: &str, title: &str, axis: &str, words: &str, rated: &[(&Entry<'_>, f64)]) -> String {
    let mut families: Vec<&str> = rated.iter().map(|(e, _)| family(e.name)).collect();
    families.sort_unstable();
    families.dedup();
    let (mut set, mut curves) = (SeriesSet::default(), Vec::new());
    for name in families {
        let mut points: Vec<(f64, f64)> =
            rated.iter().filter(|(e, _)| family(e.name) == name).map(|(e, cost)| (*cost, 100.0 * e.error)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut table = Table::new(&["cost", "error"]);
        points.iter().for_each(|p| table.push(&[p.0, p.1]));
        let series = format!("series/{}.csv", curves.len());
        curves.push(Curve { style: CurveStyle::Markers, ..Curve::line(name, &series, ["cost", "error"]) });
        set.insert(series, table);
    }
    let log = |label: String| Axis { label, scale: Scale::Log, range: None };
    let figure = Figure {
        id: format!("board-{key}"),
        suite: "judge".into(),
        title: title.into(),
        caption: "relative rms over the whole curve against the reference of the declared variant".into(),
        deviations: Vec::new(),
        body: FigureBody::chart([log(axis.into()), log(format!("error of the {words} (%)"))], curves, Vec::new()),
    };
    if rated.is_empty() { String::new() } else { render_figure(&figure, &set).unwrap_or_default() }
}

fn sentence(entries: &[Entry<'_>], rated: &[(&Entry<'_>, f64)], normalised: bool) -> String {
    let Some((best, _)) = rated.first() else { return "No submission states both this quantity and its cost.".into() };
    let told = |e: &Entry<'_>| {
        format!("{} ({} % for {})", e.name, plain(100.0 * e.error, 2), e.cost.map_or(String::new(), duration))
    };
    let beaten = |(e, cost): &&(&Entry<'_>, f64)| !rated.iter().any(|(o, c)| o.error < e.error && c < cost);
    let mut front: Vec<&(&Entry<'_>, f64)> = rated.iter().filter(beaten).collect();
    front.sort_by(|a, b| a.1.total_cmp(&b.1));
    let front: Vec<String> = front.iter().map(|(e, _)| told(e)).collect();
    let silent: Vec<String> = entries
        .iter()
        .filter(|e| e.cost.is_none())
        .map(|e| format!("{} ({} %)", e.name, plain(100.0 * e.error, 2)))
        .collect();
    let machines =
        if normalised { "" } else { " Costs are as stated and not normalised: not all measured a kernel beside." };
    let silent = if silent.is_empty() { String::new() } else { format!(" Cost not stated: {}.", silent.join(", ")) };
    let count = rated.len();
    format!(
        "Of {count} results with a stated cost the least error is that of {}. No other is both cheaper and more accurate \
         than: {}.{machines}{silent}",
        told(best),
        front.join("; ")
    )
}
