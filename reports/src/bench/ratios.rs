//! The targets of speed, as ratios of times taken in one run.

use fisura_verification::bench::record::{BenchRecord, Spread};

use super::{Exhibit, Grid, Records};
use crate::number::plain;

/// A bound of a ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// At most.
    AtMost(f64),
    /// At least.
    AtLeast(f64),
    /// A number to know.
    None,
}

/// A ratio of sums of times per unit of work: terms are `(sign, id)`.
struct Ratio {
    what: &'static str,
    above: &'static [(f64, &'static str)],
    below: &'static [(f64, &'static str)],
    target: Target,
    /// Times are those of a step of all points, not per point: where the numbers of points differ.
    whole: bool,
}

const fn ratio(
    what: &'static str,
    above: &'static [(f64, &'static str)],
    below: &'static [(f64, &'static str)],
    target: Target,
) -> Ratio {
    Ratio { what, above, below, target, whole: false }
}

const KERNEL: Target = Target::AtMost(1.4);

/// Bytes that an elastic step of the updated frame with p = 2 and four points per span reads and writes per
/// point at least: three times the 104 of a point, and its share of the control points.
const UPDATED_BYTES: f64 = 368.0;

/// What is asked for, and what is good to know beside it.
const RATIOS: [Ratio; 25] = [
    ratio(
        "elastic step over the minimal kernel, total frame, p = 2",
        &[(1.0, "stages/p2/elastic-step")],
        &[(1.0, "stages/p2/minimal-step")],
        KERNEL,
    ),
    ratio("the same, p = 3", &[(1.0, "stages/p3/elastic-step")], &[(1.0, "stages/p3/minimal-step")], KERNEL),
    ratio(
        "elastic step over the minimal kernel, updated frame, p = 2",
        &[(1.0, "stages/p2/elastic-step-updated")],
        &[(1.0, "stages/p2/minimal-step")],
        KERNEL,
    ),
    ratio("the same, p = 3", &[(1.0, "stages/p3/elastic-step-updated")], &[(1.0, "stages/p3/minimal-step")], KERNEL),
    ratio(
        "elastic step over its 368 bytes at the bandwidth of this machine, updated frame, p = 2",
        &[(1.0, "stages/p2/elastic-step-updated")],
        &[(UPDATED_BYTES, "ceilings/triad")],
        Target::AtMost(2.0),
    ),
    ratio(
        "p = 3 over p = 2 per particle-step, total frame",
        &[(1.0, "stages/p3/elastic-step")],
        &[(1.0, "stages/p2/elastic-step")],
        KERNEL,
    ),
    ratio(
        "p = 3 over p = 2 per particle-step, updated frame",
        &[(1.0, "stages/p3/elastic-step-updated")],
        &[(1.0, "stages/p2/elastic-step-updated")],
        KERNEL,
    ),
    ratio(
        "spectral split: its part of a step of the plate",
        &[
            (1.0, "stages/p2/history-sweep"),
            (-1.0, "stages/p2/history-sweep-no-split"),
            (1.0, "stages/p2/stress-sweep"),
            (-1.0, "stages/p2/stress-sweep-no-split"),
        ],
        &[(1.0, "plate/share/step")],
        Target::AtMost(0.1),
    ),
    ratio(
        "split and history, with the second interpolation: part of a step of the plate",
        &[(1.0, "stages/p2/history-sweep"), (1.0, "stages/p2/stress-sweep"), (-1.0, "stages/p2/elastic-sweep")],
        &[(1.0, "plate/share/step")],
        Target::None,
    ),
    ratio(
        "phase field: part of a step of the plate",
        &[(1.0, "plate/share/phase-field")],
        &[(1.0, "plate/share/step")],
        Target::AtMost(0.6),
    ),
    ratio(
        "Jacobi over incomplete Cholesky, cold crack, h = l0/2, p = 2",
        &[(1.0, "solves/p2/l2/jacobi")],
        &[(1.0, "solves/p2/l2/incomplete-cholesky")],
        Target::AtLeast(3.0),
    ),
    ratio(
        "the same, p = 3",
        &[(1.0, "solves/p3/l2/jacobi")],
        &[(1.0, "solves/p3/l2/incomplete-cholesky")],
        Target::AtLeast(9.0),
    ),
    ratio(
        "sparse Cholesky over incomplete Cholesky, h = l0/2, p = 2",
        &[(1.0, "solves/p2/l2/cholesky")],
        &[(1.0, "solves/p2/l2/incomplete-cholesky")],
        Target::None,
    ),
    ratio(
        "the same, p = 3",
        &[(1.0, "solves/p3/l2/cholesky")],
        &[(1.0, "solves/p3/l2/incomplete-cholesky")],
        Target::None,
    ),
    ratio(
        "two threads against one, elastic block",
        &[(1.0, "threads/elastic/1")],
        &[(1.0, "threads/elastic/2")],
        Target::AtLeast(1.7),
    ),
    ratio(
        "two threads against one, plate",
        &[(1.0, "threads/plate/1")],
        &[(1.0, "threads/plate/2")],
        Target::AtLeast(1.7),
    ),
    ratio(
        "two threads against one, moving points",
        &[(1.0, "threads/moving/1")],
        &[(1.0, "threads/moving/2")],
        Target::AtLeast(1.7),
    ),
    ratio(
        "1.6e7 points over 2.6e6, elastic block",
        &[(1.0, "scale/elastic/2000")],
        &[(1.0, "scale/elastic/800")],
        Target::AtMost(1.25),
    ),
    ratio(
        "the same, growing cracks",
        &[(1.0, "scale/cracking/2000")],
        &[(1.0, "scale/cracking/800")],
        Target::AtMost(1.25),
    ),
    ratio("the same, moving points", &[(1.0, "scale/moving/2000")], &[(1.0, "scale/moving/800")], Target::AtMost(1.25)),
    ratio(
        "fracture with a frozen crack over elastic, total frame",
        &[(1.0, "scenes/total/elastic-with-a-frozen-crack")],
        &[(1.0, "scenes/total/elastic")],
        Target::None,
    ),
    ratio(
        "the same, updated frame",
        &[(1.0, "scenes/updated/elastic-with-a-frozen-crack")],
        &[(1.0, "scenes/updated/elastic")],
        Target::AtMost(1.5),
    ),
    Ratio {
        what: "the whole plate over half of it, time per step",
        above: &[(1.0, "scenes/total/the-whole-plate")],
        below: &[(1.0, "scenes/total/half-of-the-plate")],
        target: Target::None,
        whole: true,
    },
    Ratio {
        what: "spans that integrate over points, time per step: discs with 16 spans per radius, p = 2",
        above: &[(1.0, "contact/discs/p2-spans/16/loss")],
        below: &[(1.0, "contact/discs/p2-flip/16/loss")],
        target: Target::AtMost(2.0),
        whole: true,
    },
    Ratio {
        what: "the same, p = 3",
        above: &[(1.0, "contact/discs/p3-spans/16/loss")],
        below: &[(1.0, "contact/discs/p3-flip/16/loss")],
        target: Target::AtMost(2.0),
        whole: true,
    },
];

/// A ratio with its spread and whether its target is met; `verified` if all answers behind it hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// In words.
    pub what: String,
    /// Value: of the ratios of all rounds where all records have as many, else of medians alone.
    pub value: Spread,
    /// Target.
    pub target: Target,
    /// Whether all answers hold.
    pub verified: bool,
}

impl Found {
    /// Verdict in words; a dash where there is no target.
    pub fn word(&self) -> &'static str {
        match (self.verified, self.holds()) {
            (false, _) => "answer does not hold",
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
    let of_records = RATIOS.iter().filter_map(|ratio| value(ratio, records));
    of_records.chain(super::plate::against_elements(records)).collect()
}

fn value(ratio: &Ratio, records: Records) -> Option<Found> {
    let terms = |terms: &[(f64, &str)]| -> Option<Vec<(f64, &BenchRecord)>> {
        terms.iter().map(|(sign, id)| Some((*sign, records.find(id)?))).collect()
    };
    let (above, below) = (terms(ratio.above)?, terms(ratio.below)?);
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
    let found = Found { what: ratio.what.into(), value, target: ratio.target, verified };
    [value.median, value.min, value.max].iter().all(|v| v.is_finite()).then_some(found)
}

/// The table of targets.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let found = found(records);
    if found.is_empty() {
        return Vec::new();
    }
    let judged: Vec<bool> = found.iter().filter_map(Found::holds).collect();
    let met = judged.iter().filter(|holds| **holds).count();
    let rows = found.iter().map(|ratio| {
        let target = match ratio.target {
            Target::AtMost(limit) => format!("≤ {}", plain(limit, 3)),
            Target::AtLeast(limit) => format!("≥ {}", plain(limit, 3)),
            Target::None => "–".into(),
        };
        let Spread { median, min, max } = ratio.value;
        vec![
            ratio.what.clone(),
            plain(median, 3),
            format!("{} to {}", plain(min, 3), plain(max, 3)),
            target,
            ratio.word().into(),
        ]
    });
    vec![Exhibit::Grid(Grid {
        title: "Ratios within this run".into(),
        head: ["ratio", "median", "rounds", "target", "verdict"].map(String::from).to_vec(),
        rows: rows.collect(),
        note: format!("{met} of {} targets are met in this run.", judged.len()),
    })]
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
    fn ratios_are_taken_round_by_round_and_judged_by_the_median() {
        let mut records = vec![
            record("stages/p2/elastic-step", &[1.0, 2.0, 3.0]),
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

    #[test]
    fn an_answer_that_does_not_hold_meets_no_target() {
        let mut records = vec![record("stages/p2/elastic-step", &[1.0]), record("stages/p2/minimal-step", &[1.0])];
        assert_eq!(first(&records).holds(), Some(true));
        records[0].verified = false;
        assert_eq!((first(&records).holds(), first(&records).word()), (Some(false), "answer does not hold"));
        assert!(found(Records(&[])).is_empty());
    }
}
