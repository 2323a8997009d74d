//! What the judge says: schema `fisura.verdict/1`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::submission::{Code, Cost, Submission};

/// Name of the schema written.
pub const SCHEMA: &str = "fisura.verdict/1";

/// JSON Schema of `verdict.json`; committed as `verification/schema/verdict.schema.json`.
pub fn json_schema() -> serde_json::Value {
    schemars::schema_for!(VerdictSet).to_value()
}

/// Everything one invocation judged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VerdictSet {
    /// Name and version of the format, [`SCHEMA`].
    #[schemars(extend("const" = SCHEMA))]
    pub schema: String,
    /// One verdict per submission.
    pub verdicts: Vec<Verdict>,
}

/// What became of a comparison.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// There is no reference, or none that decides.
    #[default]
    Diagnostic,
    /// Within the validation uncertainty.
    Pass,
    /// Missing, or not over the whole of what is compared.
    Incomplete,
    /// Outside the validation uncertainty.
    Fail,
}

impl Outcome {
    /// Name of the outcome, such as `pass`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Diagnostic => "diagnostic",
            Self::Pass => "pass",
            Self::Incomplete => "incomplete",
            Self::Fail => "fail",
        }
    }
}

/// One comparison error against its validation uncertainty. Energies: relative; tip: m; events and numbers:
/// their SI unit.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Comparison {
    /// `whole`, `before onset`, `one crack`, `branched`; the name of an event or a number.
    pub name: String,
    /// Unit of the figures below; `1` for relative ones.
    pub unit: String,
    /// Start and end of what was compared, s; absent for events.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub window_s: Option<[f64; 2]>,
    /// Value, of events and numbers.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub value: Option<f64>,
    /// Reference, of events and numbers.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub reference: Option<f64>,
    /// Comparison error |E|.
    pub error: Option<f64>,
    /// Uncertainty of the reference.
    pub u_ref: Option<f64>,
    /// Numerical uncertainty of the result.
    pub u_num: Option<f64>,
    /// Root of the sum of the squares.
    pub u_val: Option<f64>,
    /// What becomes of it.
    pub outcome: Outcome,
    /// Why, where it is not plain.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub why: String,
}

/// A quantity over the whole curve and by phase.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct QuantityVerdict {
    /// Name of the quantity in words.
    pub quantity: String,
    /// Fail where a comparison fails, else that of the whole curve.
    pub outcome: Outcome,
    /// Whole curve first, then phases.
    pub comparisons: Vec<Comparison>,
}

/// Something that was recognised: a common mistake, or what the curves say about load and plane state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Finding {
    /// Stable name.
    pub id: String,
    /// A sentence.
    pub text: String,
}

/// How the energies add up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Balance {
    /// Largest |W − K − S − F| over the largest work.
    pub open: f64,
    /// Fails only beyond 2 %.
    pub outcome: Outcome,
}

/// What the result was held against.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReferenceUsed {
    /// Folder and variant in the reference data, or the closed form.
    pub id: String,
    /// Its text in legends.
    pub label: String,
    /// Where its uncertainty comes from.
    pub uncertainty: String,
}

/// The verdict on one submission.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Verdict {
    /// Folder, as given.
    pub folder: String,
    /// Name of the benchmark.
    pub benchmark: String,
    /// Code that computed the results.
    pub code: Code,
    /// Method in words.
    pub method: Option<String>,
    /// Spacing at the crack, m.
    pub spacing_m: Option<f64>,
    /// Further figures of the discretisation.
    pub discretisation: Vec<(String, String)>,
    /// What the run cost.
    pub cost: Cost,
    /// The nearest reference.
    pub reference: ReferenceUsed,
    /// Where the numerical uncertainty comes from.
    pub numerical_uncertainty: String,
    /// Differences of the model that were declared and that the reference does not have.
    pub differences: Vec<String>,
    /// Common mistakes that were recognised, and what the curves say about load and plane state.
    pub findings: Vec<Finding>,
    /// What was done with the numbers.
    pub notes: Vec<String>,
    /// By quantity.
    pub quantities: Vec<QuantityVerdict>,
    /// By event.
    pub events: Vec<Comparison>,
    /// The balance of energies, where all are there.
    pub balance: Option<Balance>,
    /// On the whole.
    pub outcome: Outcome,
    /// The same in a sentence.
    pub sentence: String,
}

impl Verdict {
    /// What a submission says of itself, with nothing compared yet.
    pub(super) fn of(
        folder: &str,
        submission: &Submission,
        reference: ReferenceUsed,
        numerical_uncertainty: impl Into<String>,
    ) -> Self {
        Self {
            folder: folder.into(),
            benchmark: submission.benchmark.clone(),
            code: submission.code.clone(),
            method: submission.method.clone(),
            spacing_m: submission.spacing,
            discretisation: submission.discretisation.clone(),
            cost: submission.cost.clone(),
            reference,
            numerical_uncertainty: numerical_uncertainty.into(),
            ..Self::default()
        }
    }

    /// Every comparison: those of the quantities, then those of the events.
    pub fn comparisons(&self) -> impl Iterator<Item = &Comparison> {
        self.quantities.iter().flat_map(|q| &q.comparisons).chain(&self.events)
    }

    /// Gives the verdict on the whole: fail if anything fails; pass if a quantity or an event passes and
    /// nothing fails. The balance can fail only: one that closes says nothing of the reference.
    pub(super) fn conclude(&mut self) {
        let balance = self.balance.as_ref().map(|b| b.outcome).filter(|outcome| *outcome == Outcome::Fail);
        let of_quantities = self.quantities.iter().map(|q| q.outcome);
        let all: Vec<Outcome> = of_quantities.chain(self.events.iter().map(|e| e.outcome)).chain(balance).collect();
        let count = |outcome| all.iter().filter(|o| **o == outcome).count();
        let [pass, fail, incomplete, diagnostic] =
            [Outcome::Pass, Outcome::Fail, Outcome::Incomplete, Outcome::Diagnostic].map(count);
        self.outcome = match (fail, pass, incomplete) {
            (1.., ..) => Outcome::Fail,
            (0, 1.., _) => Outcome::Pass,
            (0, 0, 1..) => Outcome::Incomplete,
            (0, 0, 0) => Outcome::Diagnostic,
        };
        self.sentence = format!("{pass} pass, {fail} fail, {incomplete} incomplete, {diagnostic} diagnostic");
    }
}
