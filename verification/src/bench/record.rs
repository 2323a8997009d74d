//! The data model of `bench.json`, schema `fisura.bench/1`.

use std::collections::BTreeMap;

use fisura::simulation::Extent;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::record::Environment;

/// Name of the schema written and read.
pub const SCHEMA: &str = "fisura.bench/1";

/// Answer of a record of which nothing is known.
const NOTHING: &str = "nothing was verified";

/// Everything one invocation measured; all of it is exempt from byte-for-byte comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchSet {
    /// Name and version of the format, [`SCHEMA`].
    pub schema: String,
    /// Commit, compiler and machine, and when the measurement began.
    pub environment: Environment,
    /// Few meshes and repetitions.
    pub quick: bool,
    /// Records, in the order of the families.
    pub records: Vec<BenchRecord>,
    /// Stored ratios to other codes.
    pub peers: Vec<NamedPeer>,
    /// Why the finite elements were not run in this session, if they were to be.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub fem_unbuilt: Option<String>,
}

/// One run of one thing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Wall time of the sample, s.
    pub wall_s: f64,
    /// Processor time of all threads of the process, s; the wall time where the system does not tell.
    pub cpu_s: f64,
}

/// Median and extremes of samples.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Median of the samples.
    pub median: f64,
    /// Smallest of the samples.
    pub min: f64,
    /// Largest of the samples.
    pub max: f64,
}

impl Spread {
    /// Spread of some values; zeros if there are none. The median of an even number is the mean of the middle
    /// two.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let (Some(&min), Some(&max)) = (sorted.first(), sorted.last()) else { return Self::default() };
        let (low, high) = (sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2]);
        Self { median: 0.5 * (low + high), min, max }
    }

    /// All three times a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self { median: factor * self.median, min: factor * self.min, max: factor * self.max }
    }
}

/// The error of an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AnswerError {
    /// Name of the quantity whose error this is, in words.
    pub quantity: String,
    /// Error, relative if it has no unit.
    pub value: f64,
    /// Unit of error and uncertainty; empty if they are relative.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub unit: String,
    /// What it is measured against.
    pub reference: String,
    /// Uncertainty of the reference in the norm of the error; zero if it is exact.
    pub uncertainty: f64,
}

impl AnswerError {
    /// A relative error against a reference without uncertainty.
    pub fn relative(quantity: &str, value: f64, reference: &str) -> Self {
        let [quantity, reference] = [quantity, reference].map(String::from);
        Self { quantity, value, unit: String::new(), reference, uncertainty: 0.0 }
    }
}

/// How much of what one sample does.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// How many units of work it does.
    pub amount: f64,
    /// `particle-step`, `solve`, `byte` or `flop`.
    pub unit: String,
}

/// Clock whose time is given per unit of work.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// That of the processor, over all threads: what other programs do meanwhile does not count.
    #[default]
    Processor,
    /// That on the wall: what more threads bring.
    Wall,
}

/// One contestant of a benchmark: its work, the error of its answer, and its times.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BenchRecord {
    /// Name of the record: `family/…`.
    pub id: String,
    /// First part of the id.
    pub family: String,
    /// Curve or row it belongs to.
    pub label: String,
    /// Parameters of what was run, by name, such as `degree` and `steps`.
    pub parameters: BTreeMap<String, Value>,
    /// Number of threads that the samples ran on.
    pub threads: usize,
    /// Clock whose time is given in `ns_per_unit`.
    pub clock: Clock,
    /// Error of the answer, where there is a reference for it.
    pub error: Option<AnswerError>,
    /// Errors of further quantities of the same answer.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub further_errors: Vec<AnswerError>,
    /// Work of one sample.
    pub work: Work,
    /// Heap memory of the model, bytes; zero where it was not counted.
    pub memory_bytes: u64,
    /// Whether the answer held.
    pub verified: bool,
    /// What was verified, with the number found.
    pub answer: String,
    /// Every sample, in the order of the rounds.
    pub samples: Vec<Sample>,
    /// Wall time of a sample, s: median and extremes.
    pub wall_s: Spread,
    /// Processor time of a sample, s: median and extremes.
    pub cpu_s: Spread,
    /// Time per unit of work by the clock that counts, ns.
    pub ns_per_unit: Spread,
}

impl BenchRecord {
    /// A record of one thread and nothing measured, whose work is counted in `unit`.
    pub fn new(id: impl Into<String>, label: impl Into<String>, amount: f64, unit: &str) -> Self {
        let id = id.into();
        Self {
            family: id.split('/').next().unwrap_or_default().to_string(),
            id,
            label: label.into(),
            threads: 1,
            work: Work { amount, unit: unit.to_string() },
            answer: NOTHING.into(),
            ..Self::default()
        }
    }

    /// The same of steps of a scene, with its size.
    pub fn of_steps(id: impl Into<String>, label: impl Into<String>, extent: &Extent, steps: usize) -> Self {
        let record = Self::new(id, label, (extent.particles * steps) as f64, "particle-step");
        Self { memory_bytes: (extent.mechanics_bytes + extent.phase_field_bytes) as u64, ..record }
            .with("particles", extent.particles)
            .with("steps", steps)
            .with("phase_field_bytes", extent.phase_field_bytes)
    }

    /// The same record with one more parameter, or another value of it.
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.parameters.insert(name.to_string(), value.into());
        self
    }

    /// Notes whether the answer held, and what it was. Of several answers the last is kept, unless one did
    /// not hold: then the first of those.
    pub fn verify(&mut self, holds: bool, answer: impl Into<String>) {
        if self.verified || self.answer == NOTHING {
            (self.verified, self.answer) = (holds, answer.into());
        }
    }

    /// The same with a number that is to be at most `limit`; not-a-number fails.
    pub fn verify_at_most(&mut self, what: &str, value: f64, limit: f64) {
        self.verify(value <= limit, format!("{what}: {value:.1e}, at most {limit:.0e}"));
    }

    /// Notes the errors of an answer, the first as that of the record; without any it does not hold.
    pub fn note_errors(&mut self, errors: Option<Vec<AnswerError>>) {
        let mut errors = errors.unwrap_or_default().into_iter();
        self.error = errors.next();
        self.further_errors = errors.collect();
        if self.error.is_none() {
            self.verify(false, "the history does not cover the window of the comparison");
        }
    }

    /// All errors of the answer: that of the record first, then those of further quantities.
    pub fn errors(&self) -> impl Iterator<Item = &AnswerError> {
        self.error.iter().chain(&self.further_errors)
    }

    /// A numeric parameter.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.parameters.get(name)?.as_f64()
    }

    /// Spreads of the samples.
    pub fn summarise(&mut self) {
        self.wall_s = Spread::of(self.samples.iter().map(|s| s.wall_s));
        self.cpu_s = Spread::of(self.samples.iter().map(|s| s.cpu_s));
        self.ns_per_unit = Spread::of(self.times());
    }

    /// Time per unit of work of each sample, ns.
    pub fn times(&self) -> Vec<f64> {
        let time = |sample: &Sample| match self.clock {
            Clock::Processor => sample.cpu_s,
            Clock::Wall => sample.wall_s,
        };
        self.samples.iter().map(|sample| 1e9 * time(sample) / self.work.amount).collect()
    }
}

/// A stored ratio to another code.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NamedPeer {
    /// Name of the other code, with its version where that is stored.
    pub code: String,
    /// Degree of its splines.
    pub degree: usize,
    /// `over-tuned-kernel` or `over-naive-kernel`: the kernel timed beside it in that run.
    pub quantity: String,
    /// Ratio of its time to that of the kernel.
    pub value: f64,
    /// What to know before quoting it.
    pub remark: String,
    /// Date, machine and clock of the stored measurement, in words.
    pub conditions: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_extremes() {
        assert_eq!(Spread::of([3.0, 1.0, 2.0]), Spread { median: 2.0, min: 1.0, max: 3.0 });
        assert_eq!(Spread::of([4.0, 1.0, 2.0, 100.0]), Spread { median: 3.0, min: 1.0, max: 100.0 });
        assert_eq!(Spread::of([]), Spread::default());
    }

    #[test]
    fn each_record_has_its_clock() {
        let mut record = BenchRecord::new("stages/p2/sweep", "sweep", 1e9, "particle-step");
        record.samples = vec![Sample { wall_s: 4.0, cpu_s: 2.0 }, Sample { wall_s: 8.0, cpu_s: 3.0 }];
        record.summarise();
        assert_eq!(record.family, "stages");
        assert_eq!(record.ns_per_unit, Spread { median: 2.5, min: 2.0, max: 3.0 });
        record.clock = Clock::Wall;
        record.summarise();
        assert_eq!(record.ns_per_unit.median, 6.0);
    }

    #[test]
    fn an_answer_that_is_no_number_does_not_hold() {
        let mut record = BenchRecord::new("a/b", "b", 1.0, "solve");
        assert!(!record.verified);
        record.verify_at_most("closure", 1e-13, 1e-12);
        assert!(record.verified);
        record.verify_at_most("closure", f64::NAN, 1e-12);
        assert!(!record.verified && record.answer.contains("NaN"));
        record.verify_at_most("closure", 1e-13, 1e-12);
        assert!(!record.verified && record.answer.contains("NaN"), "a later one does not make it good");
    }
}
