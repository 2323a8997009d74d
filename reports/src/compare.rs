//! Two result sets side by side: what is unchanged, a minor or a major change, missing or new, in accuracy
//! and speed.
//!
//! Accuracy is measured in units of what the bounds allow, as the chapter Reproducibility of the book defines
//! it: values of different kinds are comparable then, and round-off of a value far inside its bounds is no
//! change. `speed` holds times against their spread, `work` holds counts against each other; `partners` finds
//! what is to be compared; `words` writes text and Markdown.

mod partners;
mod speed;
mod words;
mod work;

use std::collections::{BTreeMap, HashSet};

use fisura_verification::record::{Environment, Record, Reference, ResultSet, Status, normal_id};
use serde::Serialize;

use partners::partners;
use speed::Lookup;
pub use speed::{Speed, SpeedChange};
pub use words::{render_markdown, render_text};
pub use work::WorkChange;

/// Name of the schema written.
pub const COMPARISON_SCHEMA: &str = "fisura.comparison/1";
/// Moves up to this part of the tolerance are none.
const NO_MOVE: f64 = 0.01;
/// A loss is major if it uses up more than this part of the room to the bound …
const MAJOR_ROOM: f64 = 0.5;
/// … and is more than this part of the tolerance.
const MAJOR_TOLERANCE: f64 = 0.1;
/// Relative change of a value without bounds that is none.
const NO_CHANGE: f64 = 1e-6;

/// How much a record, a count or a time changed between two result sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// Nothing that matters.
    Unchanged,
    /// Something to look at.
    Minor,
    /// A verdict, or most of what was left to the bound.
    Major,
    /// Only in the base: the new results do not have it.
    Missing,
    /// Only in the new results.
    New,
}

/// For better or worse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Effect {
    /// Unchanged, or nothing says which.
    Neutral,
    /// The change is for the better.
    Better,
    /// The change is for the worse.
    Worse,
}

/// How much a cost changed, given what it is beyond, and whether that is a gain.
fn graded(minor: bool, major: bool, worse: bool) -> (Change, Effect) {
    let effect = if worse { Effect::Worse } else { Effect::Better };
    match (minor, major) {
        (_, true) => (Change::Major, effect),
        (true, false) => (Change::Minor, effect),
        (false, false) => (Change::Unchanged, Effect::Neutral),
    }
}

/// Value and verdict of one side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Side {
    /// Value, if there is one.
    pub value: Option<f64>,
    /// Status that its check gave it.
    pub status: Status,
}

/// One record, compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Id of the record in the new results, else in the base.
    pub id: String,
    /// Unit of the value in the new results, else in the base.
    pub unit: String,
    /// How much its accuracy changed.
    pub accuracy: Change,
    /// For better or worse.
    pub effect: Effect,
    /// In words; empty if unchanged.
    pub why: String,
    /// Value and status in the base; absent if the record is new.
    pub base: Option<Side>,
    /// In the new results.
    pub new: Option<Side>,
    /// How much the time of its run changed; absent where times are not comparable.
    pub speed: Option<SpeedChange>,
}

impl Comparison {
    /// Whether a claim that held is lost, or nearly so.
    pub fn is_major_loss(&self) -> bool {
        matches!(self.accuracy, Change::Major | Change::Missing | Change::New) && self.effect == Effect::Worse
    }
}

/// All records, compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedSets {
    /// Name and version of the format, [`COMPARISON_SCHEMA`].
    pub schema: &'static str,
    /// Where and when the base was run.
    pub base: Environment,
    /// Where and when the new results were run.
    pub new: Environment,
    /// How many records of each change there are.
    pub counts: BTreeMap<Change, usize>,
    /// Major losses of accuracy, of work and of speed.
    pub major_losses: usize,
    /// Counts of every run that both have.
    pub work: Vec<WorkChange>,
    /// Times as a whole, and of every measured run.
    pub speed: Speed,
    /// Records of the base in its order, then new ones.
    pub records: Vec<Comparison>,
}

impl ComparedSets {
    /// How many records changed in this way.
    pub fn count(&self, change: Change) -> usize {
        self.counts.get(&change).copied().unwrap_or(0)
    }

    /// Major losses but for those of speed.
    pub fn losses_besides_speed(&self) -> usize {
        self.major_losses - self.speed.runs.iter().filter(|run| run.is_major_loss()).count()
    }

    /// Whether nothing at all changed, times included.
    pub fn is_unchanged(&self) -> bool {
        self.count(Change::Unchanged) == self.records.len()
            && self.work.iter().all(|count| count.change == Change::Unchanged)
            && self.speed.runs.iter().all(|run| run.change == Change::Unchanged)
    }
}

/// Compares two result sets record by record.
pub fn compare(base: &ResultSet, new: &ResultSet) -> ComparedSets {
    let (work, speed) = (work::of(base, new), Speed::of(base, new));
    let mut records = Vec::new();
    let lookup = speed.lookup();
    let partners = partners(&base.records, &new.records);
    for (old, partner) in base.records.iter().zip(&partners) {
        records.push(match partner {
            Some(at) => both(old, &new.records[*at], &lookup),
            None => one_sided(old, Change::Missing),
        });
    }
    let known: HashSet<usize> = partners.into_iter().flatten().collect();
    let added = new.records.iter().enumerate().filter(|(at, _)| !known.contains(at));
    records.extend(added.map(|(_, record)| one_sided(record, Change::New)));
    let mut counts = BTreeMap::new();
    for change in [Change::Unchanged, Change::Minor, Change::Major, Change::Missing, Change::New] {
        counts.insert(change, records.iter().filter(|r| r.accuracy == change).count());
    }
    let more = work.iter().filter(|count| count.is_major_loss()).count();
    let slower = speed.runs.iter().filter(|run| run.is_major_loss()).count();
    let major_losses = records.iter().filter(|r| r.is_major_loss()).count() + more + slower;
    ComparedSets {
        schema: COMPARISON_SCHEMA,
        base: base.environment.clone(),
        new: new.environment.clone(),
        counts,
        major_losses,
        work,
        speed,
        records,
    }
}

fn side(record: &Record) -> Option<Side> {
    Some(Side { value: record.value, status: record.status })
}

/// A record that only one side has. A check that is gone is a loss: nothing shows any more that its claim
/// holds. A new one that does not hold is a loss, too: a study that breaks down has fewer records, with ids
/// of their own.
fn one_sided(record: &Record, accuracy: Change) -> Comparison {
    let holds = rank(record.status) <= rank(Status::KnownLimit);
    let (base, new) = if accuracy == Change::New { (None, side(record)) } else { (side(record), None) };
    let (effect, why) = match (accuracy, holds) {
        (Change::New, false) => (Effect::Worse, format!("new, and does not hold: {}", crate::view::reason(record))),
        (Change::New, true) => (Effect::Neutral, "new".to_string()),
        _ if matches!(record.status, Status::Pass | Status::KnownLimit | Status::Fail) => {
            let remedy = "if the id changed, give the former id in formerly of its case";
            (Effect::Worse, format!("the check is missing; {remedy}"))
        }
        _ => (Effect::Neutral, "missing".to_string()),
    };
    Comparison { id: record.id.clone(), unit: record.unit.clone(), accuracy, effect, why, base, new, speed: None }
}

fn both(base: &Record, new: &Record, speed: &Lookup) -> Comparison {
    let (mut accuracy, effect, mut why) = accuracy(base, new);
    let renamed = (normal_id(&base.id) != normal_id(&new.id)).then(|| format!("formerly {}", base.id));
    let reworded = (base.quantity != new.quantity).then(|| format!("the quantity was {:?}", base.quantity));
    for note in [renamed, reworded].into_iter().flatten() {
        accuracy = accuracy.max(Change::Minor);
        why = if why.is_empty() { note } else { format!("{why}; {note}") };
    }
    Comparison {
        id: new.id.clone(),
        unit: new.unit.clone(),
        accuracy,
        effect,
        why,
        base: side(base),
        new: side(new),
        speed: speed.of_record(base, new),
    }
}

/// Holds, lies within a known limit, does not hold, broke down.
fn rank(status: Status) -> u8 {
    match status {
        Status::Pass | Status::Info => 0,
        Status::KnownLimit => 1,
        Status::Fail => 2,
        Status::Error => 3,
    }
}

/// The bounds that a value has to keep: those of the limit, where it is in one.
fn bounds_of(record: &Record) -> [Option<f64>; 2] {
    match &record.limit {
        Some(limit) if record.status == Status::KnownLimit => [limit.min, limit.max],
        _ => [record.accept.min, record.accept.max],
    }
}

/// How a record changed, in accuracy. The bounds of the base count: looser ones must not hide a loss.
fn accuracy(base: &Record, new: &Record) -> (Change, Effect, String) {
    let word = crate::view::word;
    let under_base = match new.status {
        Status::Error => Status::Error,
        _ if base.unit != new.unit => new.status, // the bounds of the base are numbers of another unit
        _ => base.status_of(new.value),
    };
    let found = if rank(under_base) > rank(new.status) { under_base } else { new.status };
    if rank(found) > rank(base.status) {
        let whose = if found == new.status { "" } else { " with the bounds of the base" };
        return (Change::Major, Effect::Worse, format!("{} → {}{whose}", word(base.status), word(found)));
    }
    if rank(found) < rank(base.status) {
        return (Change::Major, Effect::Better, format!("{} → {}", word(base.status), word(found)));
    }
    if base.status != Status::Info && new.status == Status::Info {
        let why = "the check no longer has a verdict: its bounds are missing or too wide to show agreement";
        return (Change::Major, Effect::Worse, why.to_string());
    }
    if base.unit != new.unit {
        let why = format!("the unit changed from {:?} to {:?}: values are not compared", base.unit, new.unit);
        return match base.status {
            Status::Info => (Change::Minor, Effect::Neutral, why),
            _ => (Change::Major, Effect::Worse, why),
        };
    }
    let bounds = bounds_of(base);
    let rebound = bounds != bounds_of(new);
    let (change, effect, why) = match (base.value, new.value) {
        (None, None) => (Change::Unchanged, Effect::Neutral, String::new()),
        (Some(_), None) => (Change::Minor, Effect::Neutral, "the value is missing".to_string()),
        (None, Some(_)) => (Change::Minor, Effect::Neutral, "the value is new".to_string()),
        (Some(from), Some(to)) if bounds == [None, None] => unbounded(from, to),
        (Some(from), Some(to)) => bounded(from, to, bounds, base.reference.as_ref()),
    };
    if rebound && change < Change::Major {
        let why = if why.is_empty() { "bounds changed".to_string() } else { format!("bounds changed; {why}") };
        return (Change::Minor, effect, why);
    }
    (change, effect, why)
}

/// A value that nothing bounds: nothing says how much is too much, or which way is better.
fn unbounded(from: f64, to: f64) -> (Change, Effect, String) {
    let relative = (to - from).abs() / from.abs().max(to.abs()).max(f64::MIN_POSITIVE);
    if relative <= NO_CHANGE {
        return (Change::Unchanged, Effect::Neutral, String::new());
    }
    (Change::Minor, Effect::Neutral, format!("changed by {} %, no bounds", crate::number::plain(100.0 * relative, 2)))
}

/// A value within, or outside, bounds: the move in parts of the tolerance and of the room to the bound.
fn bounded(from: f64, to: f64, bounds: [Option<f64>; 2], reference: Option<&Reference>) -> (Change, Effect, String) {
    let room = |value: f64| {
        let below = bounds[0].map_or(f64::INFINITY, |min| value - min);
        let above = bounds[1].map_or(f64::INFINITY, |max| max - value);
        below.min(above)
    };
    let tolerance = tolerance(bounds, reference);
    let part = (to - from).abs() / tolerance;
    if part <= NO_MOVE {
        return (Change::Unchanged, Effect::Neutral, String::new());
    }
    let loss = room(from) - room(to);
    let effect = if loss > 0.0 { Effect::Worse } else { Effect::Better };
    let percent = |part: f64| crate::number::plain(100.0 * part, 2);
    if loss > MAJOR_ROOM * room(from) && loss > MAJOR_TOLERANCE * tolerance && room(from) > 0.0 {
        let used = percent(loss / room(from));
        return (Change::Major, effect, format!("the margin to the bound is smaller by {used} %"));
    }
    let towards = if loss > 0.0 { "towards" } else { "away from" };
    (Change::Minor, effect, format!("changed by {} % of the tolerance, {towards} the bound", percent(part)))
}

/// What the bounds allow: half the width of a band, or the distance of a single bound from the reference, or
/// from zero.
fn tolerance(bounds: [Option<f64>; 2], reference: Option<&Reference>) -> f64 {
    let width = match bounds {
        [Some(min), Some(max)] => 0.5 * (max - min),
        [Some(bound), None] | [None, Some(bound)] => {
            let from_reference = reference.and_then(|r| r.value).map(|r| (bound - r).abs()).filter(|d| *d > 0.0);
            from_reference.unwrap_or(bound.abs())
        }
        [None, None] => 0.0,
    };
    width.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests;
