//! The report as Markdown, as one HTML page, and its samples as CSV.

use fisura_verification::bench::record::{BenchRecord, BenchSet};
use fisura_verification::output::history::format_number;
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};

use super::{Exhibit, Grid, Plot, Section, range};
use crate::markdown::cell;
use crate::number::plain;
use crate::svg::slug;

const TEMPLATE: &str = include_str!("../../templates/bench.html");

/// File of a figure, relative to the folder.
pub fn file(plot: &Plot) -> String {
    format!("figures/{}.svg", plot.id)
}

/// Every sample: `id, round, wall_s, cpu_s, work, unit`.
pub fn samples(set: &BenchSet) -> String {
    let mut out = String::from("id,round,wall_s,cpu_s,work,unit\n");
    for record in &set.records {
        for (round, sample) in record.samples.iter().enumerate() {
            let [wall, cpu, work] = [sample.wall_s, sample.cpu_s, record.work.amount].map(format_number);
            out.push_str(&format!("{},{round},{wall},{cpu},{work},{}\n", record.id, record.work.unit));
        }
    }
    out
}

/// One row per record.
pub fn all_records(set: &BenchSet) -> Exhibit {
    let row = |record: &BenchRecord| {
        let ns = record.ns_per_unit;
        let error = record.error.as_ref().map_or("–".into(), |e| plain(e.value, 3));
        let memory = if record.memory_bytes == 0 { "–".into() } else { plain(record.memory_bytes as f64 / 1e6, 3) };
        vec![
            record.id.clone(),
            record.threads.to_string(),
            plain(record.cpu_s.median, 3),
            plain(record.wall_s.median, 3),
            format!("{} ({}) per {}", plain(ns.median, 3), range(ns), record.work.unit),
            error,
            memory,
            if record.verified { record.answer.clone() } else { format!("NOT verified: {}", record.answer) },
        ]
    };
    let broken = set.records.iter().filter(|r| !r.verified).count();
    let note = match broken {
        0 => format!("All {} records are verified.", set.records.len()),
        n => format!("{n} of {} records are NOT verified; their times are not valid.", set.records.len()),
    };
    let head = ["record", "threads", "processor s", "wall s", "ns", "error", "MB", "verified"];
    Exhibit::grid("Every record", &head, set.records.iter().map(row), note)
}

/// Where and when, in a line.
fn conditions(set: &BenchSet) -> String {
    let e = &set.environment;
    let commit: String = e.commit.chars().take(12).collect();
    let dirty = if e.dirty { ", with uncommitted changes" } else { "" };
    let size = if set.quick { "quick" } else { "full" };
    format!("{size} run on {} with {} threads, {}; commit {commit}{dirty}; {}", e.cpu, e.threads, e.started, e.rustc)
}

/// The report with links to its figures.
pub fn markdown(set: &BenchSet, sections: &[Section]) -> String {
    let mut out = format!("# Speed against error\n\n{}.\n", cell(&conditions(set)));
    for section in sections {
        out.push_str(&format!("\n## {}\n", section.title));
        for exhibit in &section.exhibits {
            match exhibit {
                Exhibit::Plot(plot) => out.push_str(&of_plot(plot)),
                Exhibit::Grid(grid) => out.push_str(&of_grid(grid)),
            }
        }
    }
    out
}

fn of_plot(plot: &Plot) -> String {
    let picture = match &plot.svg {
        Ok(_) => format!("![{}]({})", cell(&plot.title), file(plot)),
        Err(error) => format!("Not drawn: {}", cell(&error.to_string())),
    };
    let [reading, title, caption] = [&plot.reading, &plot.title, &plot.caption].map(|text| cell(text));
    format!("\n{picture}\n\n{reading}\n\n*{title}. {caption}.*\n")
}

fn of_grid(grid: &Grid) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.iter().map(|c| cell(c)).collect::<Vec<_>>().join(" | "));
    let rule = format!("|{}\n", "---|".repeat(grid.head.len()));
    let rows: String = grid.rows.iter().map(|row| line(row)).collect();
    format!("\n### {}\n\n{}{rule}{rows}\n{}\n", cell(&grid.title), line(&grid.head), cell(&grid.note))
}

/// An exhibit as the template takes it: only a table has a head.
fn shown(exhibit: &Exhibit) -> Value {
    match exhibit {
        Exhibit::Plot(plot) => context! {
            title => &plot.title,
            svg => plot.svg.as_deref().ok(),
            error => plot.svg.as_ref().err().map(ToString::to_string),
            caption => &plot.caption,
            text => &plot.reading,
        },
        Exhibit::Grid(grid) => {
            context! { title => &grid.title, text => &grid.note, head => &grid.head, rows => Serde(&grid.rows) }
        }
    }
}

/// The page, complete in itself.
///
/// # Errors
/// Only if the template cannot be filled, which has no cause in the records.
pub fn html(set: &BenchSet, sections: &[Section]) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.add_template("bench.html", TEMPLATE)?;
    let part = |section: &Section| {
        let exhibits: Value = section.exhibits.iter().map(shown).collect();
        context! { anchor => slug(&section.title), title => &section.title, exhibits }
    };
    let page = context! { conditions => conditions(set), parts => sections.iter().map(part).collect::<Value>() };
    environment.get_template("bench.html")?.render(page)
}
