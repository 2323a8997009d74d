//! A comparison as text for a terminal and as Markdown for a step summary.

use super::{Change, ComparedSets, Comparison, Effect, SpeedChange, WorkChange};
use crate::markdown::{cell, code};
use crate::number::{DIGITS, duration, grouped, plain};
use crate::view::with_unit;

/// Largest size in bytes of a comparison; a step summary over 1 MiB is dropped whole by GitHub.
const LIMIT: usize = 900_000;

/// Headings of the changes that are listed, in the order of reading.
const LISTED: [(Change, &str); 4] =
    [(Change::Major, "major"), (Change::New, "new"), (Change::Missing, "missing"), (Change::Minor, "minor")];

/// One line: no change, or how many losses and changes there are.
pub fn headline(sets: &ComparedSets) -> String {
    let records = sets.records.len();
    if sets.is_unchanged() {
        return format!("No change: {records} records unchanged");
    }
    let counts: Vec<String> =
        sets.counts.iter().map(|(change, n)| format!("{n} {}", format!("{change:?}").to_lowercase())).collect();
    let losses = match sets.major_losses {
        0 => "No major loss".to_string(),
        1 => "1 major loss".to_string(),
        n => format!("{n} major losses"),
    };
    format!("{losses}: of {records} records {}", counts.join(", "))
}

/// The comparison for a terminal.
pub fn render_text(sets: &ComparedSets) -> String {
    let mut out = String::new();
    for (change, word) in LISTED {
        for record in of_change(sets, change) {
            let mark = mark(record.effect);
            out.push_str(&format!("{mark} {word:7}  {}  {}  ({})\n", record.id, values(record), record.why));
        }
    }
    for count in changed_counts(sets) {
        out.push_str(&format!("{} work     {}  {}: {}\n", mark(count.effect), count.run, count.what, counts(count)));
    }
    for run in changed_runs(sets) {
        out.push_str(&format!("{} speed    {}  {}\n", mark(run.effect), run.run, times(run)));
    }
    format!("{out}{}\n{}\n", speed(sets), headline(sets))
}

/// The comparison as Markdown, cut at the size of a step summary with a note.
pub fn render_markdown(sets: &ComparedSets) -> String {
    let mut out = format!("# {}\n\n", headline(sets));
    for (name, environment) in [("Base", &sets.base), ("New", &sets.new)] {
        let dirty = if environment.dirty { " with uncommitted changes" } else { "" };
        let commit = if environment.commit.is_empty() { "unknown commit" } else { &environment.commit };
        out.push_str(&format!("{name}: {}{dirty}, {}. ", cell(commit), cell(&environment.cpu)));
    }
    out.push_str(&format!("\n\n{}\n\n", speed(sets)));
    let mut sections: Vec<(String, Vec<String>)> = Vec::new();
    for (change, word) in LISTED {
        let row = |r: &Comparison| {
            format!("| {} | {} | {} | {} |\n", mark(r.effect), code(&r.id), cell(&values(r)), cell(&r.why))
        };
        let rows: Vec<String> = of_change(sets, change).map(row).collect();
        let head = format!("## {word}: {}\n\n| | check | base → new | what |\n|---|---|---|---|\n", rows.len());
        sections.push((head, rows));
    }
    let row = |count: &&WorkChange| {
        format!("| {} | {} | {} | {} |\n", mark(count.effect), code(&count.run), count.what, counts(count))
    };
    let head = "## work\n\n| | run | count | base → new |\n|---|---|---|---|\n".to_string();
    sections.push((head, changed_counts(sets).iter().map(row).collect()));
    let row = |run: &&SpeedChange| format!("| {} | {} | {} |\n", mark(run.effect), code(&run.run), times(run));
    let head = "## speed\n\n| | run | wall time |\n|---|---|---|\n".to_string();
    sections.push((head, changed_runs(sets).iter().map(row).collect()));
    let last = sections.len() - 1;
    let mut left_out = 0;
    for (at, (head, rows)) in sections.iter().enumerate().filter(|(_, (_, rows))| !rows.is_empty()) {
        for line in std::iter::once(head).chain(rows) {
            if out.len() + line.len() > LIMIT { left_out += 1 } else { out.push_str(line) }
        }
        out.push_str(if at < last { "\n" } else { "" });
    }
    if left_out > 0 {
        out.push_str(&format!("\n{left_out} more lines are omitted; `comparison.json` has all lines.\n"));
    }
    out
}

/// Records of one change, losses first.
fn of_change(sets: &ComparedSets, change: Change) -> impl Iterator<Item = &Comparison> {
    let with = move |worse: bool| {
        sets.records.iter().filter(move |r| r.accuracy == change && (r.effect == Effect::Worse) == worse)
    };
    with(true).chain(with(false))
}

fn changed_runs(sets: &ComparedSets) -> Vec<&SpeedChange> {
    let mut runs: Vec<&SpeedChange> = sets.speed.runs.iter().filter(|run| run.change != Change::Unchanged).collect();
    runs.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
    runs
}

/// Counts that changed, the largest growth first.
fn changed_counts(sets: &ComparedSets) -> Vec<&WorkChange> {
    let mut changed: Vec<&WorkChange> = sets.work.iter().filter(|count| count.change != Change::Unchanged).collect();
    changed.sort_by(|a, b| ratio(b).total_cmp(&ratio(a)));
    changed
}

fn ratio(count: &WorkChange) -> f64 {
    count.new as f64 / count.base.max(1) as f64
}

fn counts(count: &WorkChange) -> String {
    format!("{} → {}, ×{}", grouped(count.base), grouped(count.new), plain(ratio(count), 4))
}

fn mark(effect: Effect) -> &'static str {
    match effect {
        Effect::Worse => "✗",
        Effect::Better => "✓",
        Effect::Neutral => "·",
    }
}

fn values(record: &Comparison) -> String {
    let show = |side: &Option<super::Side>| match side.as_ref().and_then(|s| s.value) {
        Some(value) => plain(value, DIGITS + 1),
        None => "none".to_string(),
    };
    with_unit(&format!("{} → {}", show(&record.base), show(&record.new)), &record.unit)
}

fn times(run: &SpeedChange) -> String {
    format!("{} → {}, ×{}", duration(run.base_s), duration(run.new_s), plain(run.ratio, 3))
}

/// Times in one sentence.
fn speed(sets: &ComparedSets) -> String {
    let speed = &sets.speed;
    match (&speed.not_compared, speed.median_ratio) {
        (None, Some(ratio)) => format!(
            "Speed: {} runs of a second or more, median time ×{}, spread {} %.",
            speed.runs.len(),
            plain(ratio, 3),
            plain(100.0 * speed.spread.exp_m1(), 2)
        ),
        (why, _) => format!("Speed is not compared: {}.", why.as_deref().unwrap_or("no times were recorded")),
    }
}
