//! Verdicts on results of other codes: terminal, page, and the board of all submissions.

mod board;
mod stored;

use fisura_verification::judge::verdict::{Comparison, Verdict, VerdictSet};
use fisura_verification::judge::{Judged, QUANTITIES};
use fisura_verification::output::foreign::line;
use fisura_verification::output::history::Table;
use fisura_verification::record::{Curve, Figure, FigureBody};
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};

use crate::figure::render_figure;
use crate::number::{duration, plain};
use crate::series::SeriesSet;
use crate::template::filled;

pub use board::{Board, board, board_markdown, board_page};
pub use stored::{StoredBoard, board_of_the_book, stored_boards};

const TEMPLATE: &str = include_str!("../templates/judge.html");
const STYLE: &str = include_str!("../templates/report.css");
/// The page draws the curves of at most this many submissions.
const MOST_DRAWN: usize = 12;

/// The verdicts for a terminal.
pub fn render_text(set: &VerdictSet) -> String {
    let verdicts: Vec<_> = set.verdicts.iter().map(|verdict| (verdict, rows(verdict))).collect();
    filled("judge.txt", include_str!("../templates/judge.txt"), context! { verdicts => Serde(verdicts) })
}

/// Name, figures, outcome and reason of every comparison.
fn rows(verdict: &Verdict) -> Vec<[String; 4]> {
    let mut out = Vec::new();
    for quantity in &verdict.quantities {
        for comparison in &quantity.comparisons {
            let name = match comparison.window_s {
                Some(window) => {
                    let [from, to] = window.map(|time| plain(1e6 * time, 3));
                    format!("{}, {} ({from}–{to} µs)", quantity.quantity, comparison.name)
                }
                None => quantity.quantity.clone(),
            };
            out.push([name, figures(comparison), comparison.outcome.word().into(), comparison.why.clone()]);
        }
    }
    for event in &verdict.events {
        out.push([event.name.clone(), figures(event), event.outcome.word().into(), event.why.clone()]);
    }
    if let Some(balance) = &verdict.balance {
        let figures = format!("open by {} % of the work", plain(100.0 * balance.open, 2));
        out.push(["balance of energies".into(), figures, balance.outcome.word().into(), String::new()]);
    }
    out
}

/// `|E| 2.3 %, U_val 0.5 % (U_ref 0.2, U_num 0.4)`, in units of people.
fn figures(comparison: &Comparison) -> String {
    let (scale, unit) = match comparison.unit.as_str() {
        "1" if comparison.reference.is_none() => (100.0, "%"),
        "s" => (1e6, "µs"),
        "m" => (1e3, "mm"),
        other => (1.0, other),
    };
    let Some(error) = comparison.error else { return String::new() };
    let show = |value: f64| plain(value * scale, 3);
    let value = match (comparison.value, comparison.reference) {
        (Some(value), Some(reference)) => format!("{} for {} {unit}, ", show(value), show(reference)),
        _ => String::new(),
    };
    let u_val = comparison.u_val.map_or(String::new(), |u_val| format!(", U_val {}", plain(u_val * scale, 2)));
    format!("{value}|E| {}{u_val} {unit}", show(error.abs()))
}

/// One page with every verdict and its curves over the band of the reference; complete in itself.
///
/// # Errors
/// Only if the template cannot be filled, which has no cause in the verdicts.
pub fn page(judged: &[Judged]) -> Result<String, minijinja::Error> {
    let part = |(i, one): (usize, &Judged)| {
        context! {
            verdict => Serde(&one.verdict),
            word => one.verdict.outcome.word(),
            facts => Serde(facts(&one.verdict)),
            rows => Serde(rows(&one.verdict)),
            pictures => if i < MOST_DRAWN { pictures(one, i) } else { Vec::new() },
        }
    };
    let title = match judged {
        [one] => format!("{}: {}", one.verdict.code.name, one.verdict.outcome.word()),
        _ => format!("{} results judged", judged.len()),
    };
    fill(title, judged.iter().enumerate().map(part).collect(), &[])
}

fn fill(title: String, verdicts: Value, boards: &[Board]) -> Result<String, minijinja::Error> {
    let page = context! { style => STYLE, title, verdicts, boards => Serde(boards) };
    Environment::new().render_named_str("judge.html", TEMPLATE, page)
}

fn facts(verdict: &Verdict) -> Vec<(&'static str, String)> {
    let unknown = || "not stated".to_string();
    let (code, cost) = (&verdict.code, &verdict.cost);
    let version = [&code.version, &code.commit].into_iter().flatten().cloned().collect::<Vec<_>>().join(", ");
    let spacing = verdict.spacing_m.map_or_else(unknown, |h| format!("{} mm", plain(h * 1e3, 4)));
    let cores = cost.cores.map_or(String::new(), |n| format!(", {n} cores"));
    vec![
        ("Folder", verdict.folder.clone()),
        ("Benchmark", verdict.benchmark.clone()),
        ("Version", if version.is_empty() { unknown() } else { version }),
        ("Source", code.url.clone().unwrap_or_else(unknown)),
        ("Run by", code.run_by.clone().unwrap_or_else(unknown)),
        ("Method", verdict.method.clone().unwrap_or_else(unknown)),
        ("Spacing at the crack", spacing),
        ("Processor time", cost.cpu_s.map_or_else(unknown, |s| duration(s) + &cores)),
        ("Processor", cost.processor.clone().unwrap_or_else(unknown)),
        ("Peak memory", cost.memory_mb.map_or_else(unknown, |mb| format!("{} MB", plain(mb, 4)))),
        (
            "Reference",
            format!("{} ({}): {}", verdict.reference.id, verdict.reference.label, verdict.reference.uncertainty),
        ),
        ("Numerical uncertainty", verdict.numerical_uncertainty.clone()),
    ]
}

/// The curves of a submission over the bands of its reference.
fn pictures(judged: &Judged, number: usize) -> Vec<String> {
    let mut out = Vec::new();
    for (i, quantity) in QUANTITIES.iter().enumerate() {
        let (Some(curve), Some(reference)) = (&judged.curves[i], &judged.references[i]) else { continue };
        let (scale, unit) = quantity.drawn;
        let (band, table) = reference.series(1e6, scale);
        let mut set = SeriesSet::default();
        set.insert(band.series.clone(), table);
        let mut own = Table::new(&["t", "y"]);
        curve.t.iter().zip(&curve.y).for_each(|(t, y)| own.push(&[*t, *y]));
        set.insert("series/own.csv", own);
        let name = line(&judged.verdict.code.name).into_owned();
        let line = Curve::line(&name, "series/own.csv", ["t", "y"]);
        let result = Curve { x_scale: 1e6, y_scale: scale, ..line };
        let (id, title) = (format!("judge-{number}-{}", quantity.key), format!("{}: {name}", quantity.words));
        let label = format!("{} ({unit})", quantity.words);
        let body = FigureBody::over_time(&label, vec![band, result], Vec::new());
        let words = [id.as_str(), &title, "band: uncertainty of the reference"];
        out.extend(render_figure(&Figure::new("judge", words, body), &set).ok());
    }
    out
}
