//! The targets of speed, as ratios of times taken in one run: `ratios.toml` lists them.

use std::sync::LazyLock;

use fisura_verification::bench::record::{BenchRecord, Spread};
use serde::Deserialize;

use super::{Exhibit, Records, range};
use crate::number::plain;

/// A ratio of sums of times, as the list has it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Ratio {
    what: String,
    above: Vec<String>,
    below: Vec<String>,
    at_most: Option<f64>,
    at_least: Option<f64>,
    /// Why this is asked for, and what bounds it.
    #[serde(default)]
    why: String,
    #[serde(default)]
    whole: bool,
}

#[derive(Debug, Deserialize)]
struct Ratios {
    ratio: Vec<Ratio>,
}

static RATIOS: LazyLock<Ratios> =
    LazyLock::new(|| toml::from_str(include_str!("ratios.toml")).expect("ratios.toml lists ratios; a test reads it"));

/// A bound of a ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// The ratio has to be at most this.
    AtMost(f64),
    /// The ratio has to be at least this.
    AtLeast(f64),
    /// Nothing is asked of the ratio: it is shown only.
    None,
}

impl Target {
    /// In a table; a dash without one.
    pub fn words(self) -> String {
        match self {
            Self::AtMost(limit) => format!("≤ {}", plain(limit, 3)),
            Self::AtLeast(limit) => format!("≥ {}", plain(limit, 3)),
            Self::None => "–".into(),
        }
    }
}

/// A ratio with its spread and whether its target is met; `verified` if all answers behind it hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Description of the ratio in words.
    pub what: String,
    /// Value: of the ratios of all rounds where all records have as many, else of medians alone.
    pub value: Spread,
    /// Value that the ratio has to stay below or reach.
    pub target: Target,
    /// Whether all answers hold.
    pub verified: bool,
    /// Why this is asked for, and what bounds it.
    pub why: String,
}

impl Found {
    /// Verdict in words; a dash where there is no target.
    pub fn word(&self) -> &'static str {
        match (self.verified, self.holds()) {
            (false, _) => "not verified",
            (true, Some(true)) => "met",
            (true, Some(false)) => "missed",
            (true, None) => "–",
        }
    }

    /// Whether the median meets the target, if there is one.
    pub fn holds(&self) -> Option<bool> {
        match self.target {
            Target::AtMost(limit) => Some(self.verified && self.value.median <= limit),
            Target::AtLeast(limit) => Some(self.verified && self.value.median >= limit),
            Target::None => None,
        }
    }
}

/// All ratios whose records are there and took any time.
pub fn found(records: Records) -> Vec<Found> {
    let of_records = RATIOS.ratio.iter().filter_map(|ratio| value(ratio, records));
    of_records.chain(super::plate_match::targets(records)).collect()
}

fn value(ratio: &Ratio, records: Records) -> Option<Found> {
    let term = |id: &String| match id.strip_prefix('-') {
        Some(id) => Some((-1.0, records.find(id)?)),
        None => Some((1.0, records.find(id)?)),
    };
    let terms = |ids: &[String]| ids.iter().map(term).collect::<Option<Vec<(f64, &BenchRecord)>>>();
    let (above, below) = (terms(&ratio.above)?, terms(&ratio.below)?);
    let all = || above.iter().chain(&below).map(|(_, record)| *record);
    let rounds = above[0].1.samples.len();
    let paired = rounds > 0 && all().all(|record| record.samples.len() == rounds);
    let unit = |record: &BenchRecord| match ratio.whole {
        true => record.work.amount / record.number("steps").unwrap_or(1.0),
        false => 1.0,
    };
    let sum = |terms: &[(f64, &BenchRecord)], time: &dyn Fn(&BenchRecord) -> f64| {
        terms.iter().map(|(sign, record)| sign * unit(record) * time(record)).sum::<f64>()
    };
    let quotient = |time: &dyn Fn(&BenchRecord) -> f64| sum(&above, time) / sum(&below, time);
    let value = if paired {
        Spread::of((0..rounds).map(|round| quotient(&|record| record.times()[round])))
    } else {
        Spread::of([quotient(&|record| record.ns_per_unit.median)])
    };
    let verified = all().all(|record| record.verified);
    let target = match (ratio.at_most, ratio.at_least) {
        (Some(limit), _) => Target::AtMost(limit),
        (_, Some(limit)) => Target::AtLeast(limit),
        _ => Target::None,
    };
    let found = Found { what: ratio.what.clone(), value, target, verified, why: ratio.why.clone() };
    [value.median, value.min, value.max].iter().all(|v| v.is_finite()).then_some(found)
}

/// The table of targets.
pub fn exhibit(records: Records) -> Option<Exhibit> {
    let found = found(records);
    found.first()?;
    let judged: Vec<bool> = found.iter().filter_map(Found::holds).collect();
    let met = judged.iter().filter(|holds| **holds).count();
    let rows = found.iter().map(|ratio| {
        let [what, median, word, why] =
            [ratio.what.clone(), plain(ratio.value.median, 3), ratio.word().into(), ratio.why.clone()];
        vec![what, median, range(ratio.value), ratio.target.words(), word, why]
    });
    let mut note = format!("{met} of {} targets are met in this run.", judged.len());
    let unknown = super::plate_match::not_judged(records);
    if !unknown.is_empty() {
        note += &format!(" Not judged, since twice the uncertainty of the reference is larger: {unknown}.");
    }
    let head = ["ratio", "median", "rounds", "target", "verdict", "why, and what bounds it"];
    Some(Exhibit::grid("Ratios within this run", &head, rows, note))
}

#[cfg(test)]
mod tests {
    use fisura_verification::bench::record::Sample;

    use super::*;

    fn record(id: &str, seconds: &[f64]) -> BenchRecord {
        let mut record = BenchRecord::new(id, id, 1.0, "particle-step");
        record.samples = seconds.iter().map(|&s| Sample { wall_s: s, cpu_s: s }).collect();
        record.verify(true, "");
        record.summarise();
        record
    }

    fn first(records: &[BenchRecord]) -> Found {
        found(Records(records)).remove(0)
    }

    #[test]
    fn the_list_is_read() {
        let list: Ratios = toml::from_str(include_str!("ratios.toml")).unwrap();
        assert!(!list.ratio.is_empty() && list.ratio.iter().all(|ratio| !ratio.above.is_empty()));
        assert!(list.ratio.iter().all(|r| r.why.is_empty() == (r.at_most.is_none() && r.at_least.is_none())));
    }

    #[test]
    fn ratios_are_taken_round_by_round_and_judged_by_the_median() {
        let mut records = vec![
            record("stages/p2/elastic-step-updated", &[1.0, 2.0, 3.0]),
            record("stages/p2/minimal-step", &[1.0, 1.0, 4.0]),
        ];
        let ratio = first(&records);
        assert_eq!(ratio.value, Spread { median: 1.0, min: 0.75, max: 2.0 });
        assert_eq!(ratio.holds(), Some(true));
        records[1].samples.pop();
        records[1].summarise();
        let ratio = first(&records);
        assert_eq!((ratio.value, ratio.word()), (Spread { median: 2.0, min: 2.0, max: 2.0 }, "missed"));
        records[1].samples.clear();
        records[1].summarise();
        assert!(found(Records(&records)).is_empty(), "nothing is a multiple of no time");
    }
}
