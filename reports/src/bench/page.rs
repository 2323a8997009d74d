//! The report as Markdown, as one HTML page, and its samples as CSV.

use fisura_verification::bench::record::{BenchRecord, BenchSet};
use fisura_verification::output::history::format_number;
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};

use super::{Exhibit, Plot, Section, range};
use crate::number::plain;
use crate::svg::slug;
use crate::template::filled;

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

/// What the templates take. Of an exhibit, only a table has a head.
fn values(set: &BenchSet, sections: &[Section]) -> Value {
    let shown = |exhibit: &Exhibit| match exhibit {
        Exhibit::Plot(plot) => context! {
            title => &plot.title,
            svg => plot.svg.as_deref().ok(),
            file => file(plot),
            error => plot.svg.as_ref().err().map(ToString::to_string),
            caption => &plot.caption,
            text => &plot.reading,
        },
        Exhibit::Grid(grid) => {
            context! { title => &grid.title, text => &grid.note, head => &grid.head, rows => Serde(&grid.rows) }
        }
    };
    let part = |section: &Section| {
        let exhibits: Value = section.exhibits.iter().map(shown).collect();
        context! { anchor => slug(&section.title), title => &section.title, exhibits }
    };
    context! { conditions => conditions(set), parts => sections.iter().map(part).collect::<Value>() }
}

/// The report with links to its figures.
pub fn markdown(set: &BenchSet, sections: &[Section]) -> String {
    filled("bench.md", include_str!("../../templates/bench.md"), values(set, sections))
}

/// The page, complete in itself.
///
/// # Errors
/// Only if the template cannot be filled, which has no cause in the records.
pub fn html(set: &BenchSet, sections: &[Section]) -> Result<String, minijinja::Error> {
    Environment::new().render_named_str("bench.html", TEMPLATE, values(set, sections))
}
