//! The data model of results: schema `fisura.results/1`.
//!
//! `results.json` holds one [`ResultSet`]; the numbers behind its figures stand beside it in `series/*.csv`.
//! Everything a report shows is a pure function of that folder.

mod figure;
mod id;
mod status;
mod unfinished;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use figure::{Axis, Curve, CurveStyle, Figure, FigureBody, Floor, Region, Scale, SlopeTriangle};
pub use id::{LONGEST, normal_id};
pub use status::{Discretisation, Limit, worst};

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
    /// Name and version of the format, [`SCHEMA`].
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
    /// Name of the processor.
    pub cpu: String,
    /// Threads used.
    pub threads: usize,
    /// Start, UTC, ISO 8601.
    pub started: String,
}

/// Status of one check; [`Record::decide`] says how it is found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// The value agrees with its reference; without a reference, it lies within its bounds.
    Pass,
    /// The value does not agree with its reference, but lies within a documented limit.
    KnownLimit,
    /// The value lies outside its bounds and outside every documented limit.
    Fail,
    /// The run broke down.
    Error,
    /// Nothing bounds the value, or its reference is too uncertain to decide.
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

/// On which side of its reference a value has to lie.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The reference is the value itself.
    #[default]
    Both,
    /// The reference is a lower bound, such as an order of convergence.
    AtLeast,
    /// The reference is an upper bound.
    AtMost,
}

impl Side {
    fn is_both(&self) -> bool {
        *self == Self::Both
    }
}

/// What a value is compared with.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    /// Value, if it is one number.
    pub value: Option<f64>,
    /// Kind of source it comes from.
    pub kind: ReferenceKind,
    /// Where it comes from.
    pub source: String,
    /// On which side of it values agree with it.
    #[serde(skip_serializing_if = "Side::is_both", default)]
    pub side: Side,
    /// Half width of its uncertainty, in the unit of the record: of the value, or of the curve in the norm of
    /// the record; absent where none is known.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub uncertainty: Option<f64>,
}

impl Reference {
    /// A reference whose uncertainty is not known, or is zero.
    pub fn new(value: Option<f64>, kind: ReferenceKind, source: impl Into<String>) -> Self {
        Self { value, kind, source: source.into(), ..Self::default() }
    }

    /// A lower bound, such as the order of convergence that theory guarantees.
    pub fn at_least(value: f64, kind: ReferenceKind, source: impl Into<String>) -> Self {
        Self { side: Side::AtLeast, ..Self::new(Some(value), kind, source) }
    }
}

/// Bounds and why they are what they are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Accept {
    /// Smallest value that passes.
    pub min: Option<f64>,
    /// Largest value that passes.
    pub max: Option<f64>,
    /// Reason for these bounds.
    pub why: String,
    /// Whether they were chosen after the result: they tell a change, not whether the result is right.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub regression: bool,
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
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// One check and what it found.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Record {
    /// Id of the record: `suite/case[/variant]/check`.
    pub id: String,
    /// Ids that earlier results have for it.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub formerly: Vec<String>,
    /// Suite of the case.
    pub suite: String,
    /// Case that has the check.
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
    /// What it is compared with.
    pub reference: Option<Reference>,
    /// Discretisation error of the value, computed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub discretisation: Option<Discretisation>,
    /// Bounds within which the value agrees with its reference, or holds without one.
    pub accept: Accept,
    /// Documented limit, in which the value may lie instead.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub limit: Option<Limit>,
    /// What came of the check.
    pub status: Status,
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
