//! The data model of results: schema `fisura.results/1`.
//!
//! `results.json` holds one [`ResultSet`]; the numbers behind its figures stand beside it in `series/*.csv`.
//! Everything a report shows is a pure function of that folder.

mod figure;
mod unfinished;
mod verdict;

use std::collections::BTreeMap;

use fisura::fault;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use figure::{Axis, Curve, CurveStyle, Figure, FigureBody, Floor, Region, Scale, SlopeTriangle};
pub use verdict::{Agreement, BoundKind, Expectation, Validation};

/// Name of the schema written and read.
pub const SCHEMA: &str = "fisura.results/1";

/// JSON Schema of `results.json`, made from the types below; committed as
/// `verification/schema/results.schema.json`.
pub fn json_schema() -> serde_json::Value {
    schemars::schema_for!(ResultSet).to_value()
}

/// Everything one invocation found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ResultSet {
    /// [`SCHEMA`].
    #[schemars(extend("const" = SCHEMA))]
    pub schema: String,
    /// Where and when it was run.
    pub environment: Environment,
    /// Fingerprint of what each case simulated, by its id.
    #[serde(default)]
    pub inputs: BTreeMap<String, String>,
    /// One record per check, in the order of the plan.
    pub records: Vec<Record>,
    /// Figures, in the order of the report.
    pub figures: Vec<Figure>,
}

/// Where and when; exempt from byte-for-byte comparison.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Environment {
    /// Commit of the work tree, or empty.
    pub commit: String,
    /// Whether the work tree had uncommitted changes.
    pub dirty: bool,
    /// Compiler version.
    pub rustc: String,
    /// Processor.
    pub cpu: String,
    /// Threads used.
    pub threads: usize,
    /// Start, UTC, ISO 8601.
    pub started: String,
}

/// Verdict of one check.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Within its bounds.
    Pass,
    /// Outside its bounds.
    Fail,
    /// The run broke down.
    Error,
    /// No bounds: a figure to read.
    #[default]
    Info,
}

/// Kind of reference.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceKind {
    /// A closed form.
    #[default]
    Exact,
    /// A theorem or an asymptotic rate.
    Theory,
    /// Published numbers.
    Literature,
    /// Another code.
    IndependentCode,
    /// Finer runs of this code.
    SelfConvergence,
    /// An earlier result of this code.
    Regression,
}

/// What a value is held against.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    /// Value, if it is one number.
    pub value: Option<f64>,
    /// Kind.
    pub kind: ReferenceKind,
    /// Where it comes from.
    pub source: String,
    /// Half width of its uncertainty, in the unit of the record: of the value, or of the curve in the norm of
    /// the record; absent where none is known.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub uncertainty: Option<f64>,
}

impl Reference {
    /// A reference whose uncertainty is not known, or does not matter.
    pub fn new(value: Option<f64>, kind: ReferenceKind, source: impl Into<String>) -> Self {
        Self { value, kind, source: source.into(), uncertainty: None }
    }
}

/// Bounds and why they are what they are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Accept {
    /// Smallest value that passes.
    pub min: Option<f64>,
    /// Largest value that passes.
    pub max: Option<f64>,
    /// Reason.
    pub why: String,
    /// Where they come from, if they were not set before the result.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub kind: Option<BoundKind>,
}

/// Measured time; exempt from byte-for-byte comparison.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Timing {
    /// Wall time of the runs behind the record, s.
    pub wall_s: f64,
    /// Material points times steps.
    pub particle_steps: u64,
    /// Wall time per particle-step, ns.
    pub ns_per_particle_step: f64,
}

/// What a run computed, counted: the same numbers on every run of one program, whatever the number of
/// threads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Work {
    /// Material points times steps.
    pub particle_steps: u64,
    /// Phase-field systems solved.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub phase_field_solves: u64,
    /// Iterations of these solves.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub phase_field_iterations: u64,
    /// Passes of these iterations over matrices and factors, each times its size, bytes.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub phase_field_bytes: u64,
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// One check and what it found.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Record {
    /// `suite/case[/variant]/check`.
    pub id: String,
    /// Ids that earlier results have for it.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub formerly: Vec<String>,
    /// Suite.
    pub suite: String,
    /// Case.
    pub case: String,
    /// `quick` or `full`.
    pub tier: String,
    /// The sentence the check can refute.
    pub claim: String,
    /// Parameters of the run.
    pub parameters: BTreeMap<String, serde_json::Value>,
    /// What was modelled.
    pub models: Vec<String>,
    /// What differs from the cited source.
    pub deviations: Vec<String>,
    /// The quantity, in words.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Its value; absent when the run broke down or the event did not occur.
    pub value: Option<f64>,
    /// What it is held against.
    pub reference: Option<Reference>,
    /// Bounds.
    pub accept: Accept,
    /// Verdict.
    pub status: Status,
    /// Comparison with the uncertainty of the reference, where it has one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub validation: Option<Validation>,
    /// A band in which the value was expected; missing it fails nothing and is counted.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub expectation: Option<Expectation>,
    /// How, where and when, for errors and remarks.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub message: Option<String>,
    /// Series with the numbers behind it, relative to the results folder.
    pub series: Option<String>,
    /// What the run behind the record computed; absent for studies that run no scene.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub work: Option<Work>,
    /// Measured time.
    pub timing: Timing,
}

/// The worst of some verdicts.
pub fn worst(verdicts: impl IntoIterator<Item = Status>) -> Option<Status> {
    let rank = |status: &Status| match status {
        Status::Info => 0,
        Status::Pass => 1,
        Status::Fail => 2,
        Status::Error => 3,
    };
    let verdicts = verdicts.into_iter();
    fault!("last-verdict-counts", verdicts.max_by_key(rank) => verdicts.last())
}
