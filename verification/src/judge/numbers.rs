//! Benchmarks that ask for a few numbers instead of curves: closed forms, problems whose reference is
//! independent finite elements with AT1 (`reference-data/at1-benchmarks`), and values that decide nothing,
//! because their uncertainty or the geometry behind them is not known.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use super::curves::decide;
use super::elements::{Elements, differences};
use super::model::Plane;
use super::submission::Submission;
use super::table::Curve;
use super::verdict::{Comparison, Outcome, QuantityVerdict, ReferenceUsed, Verdict};
use super::{BENCHMARKS, Judged, explained_by_difference};
use crate::arithmetic::Arithmetic;
use crate::reference::Library;
use crate::scene::SceneFileError;
use crate::scene::units::{self, Dimension};

/// What `templates/numbers.toml` has.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Numbers {
    /// Formulas of other formulas, by name.
    formulas: BTreeMap<String, String>,
    /// Why values decide nothing.
    reasons: BTreeMap<String, String>,
    /// The elements behind a benchmark.
    elements: BTreeMap<String, Elements>,
    /// What is asked for, by benchmark.
    numbers: BTreeMap<String, Vec<Asked>>,
}

static NUMBERS: LazyLock<Numbers> = LazyLock::new(|| {
    toml::from_str(include_str!("../../templates/numbers.toml"))
        .expect("numbers.toml lists numbers; a test judges each of them")
});

/// A number that a benchmark asks for.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    /// Key of the number in the table `[values]` of `submission.toml`.
    pub name: String,
    /// Description of the number in words.
    pub what: String,
    /// Unit of the number, SI; `1` for a plain number.
    pub unit: String,
    /// What it is held against.
    pub basis: Basis,
}

impl Asked {
    /// Dimension of the unit, as a value in `submission.toml` has to have it.
    pub fn dimension(&self) -> Dimension {
        units::parse(&format!("1 {}", self.unit)).map_or(Dimension::NONE, |one| one.dimension)
    }
}

/// What a number is held against, SI.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The formula of a closed form, and what a sound mesh may be off by, relative.
    ClosedForm(String, f64),
    /// An upper bound, which a positive value has to stay below.
    Below(f64),
    /// A value that decides nothing, and the name of the reason.
    Undecided(f64, String),
    /// The name of a value of independent finite elements.
    Elements(String),
}

/// What a benchmark asks for; nothing for those that ask for curves.
pub fn values(benchmark: &str) -> &'static [Asked] {
    NUMBERS.numbers.get(benchmark).map_or(&[], Vec::as_slice)
}

/// Value of a closed form, SI.
pub fn closed_form(formula: &str) -> f64 {
    let known = |name: &String| NUMBERS.formulas.get(name).map_or(f64::NAN, |formula| closed_form(formula));
    let value = |formula: Arithmetic| formula.value(&formula.names().iter().map(known).collect::<Vec<_>>());
    formula.parse().map_or(f64::NAN, value)
}

/// The elements behind a benchmark, if there are any.
pub fn elements(benchmark: &str) -> Option<&'static Elements> {
    NUMBERS.elements.get(benchmark)
}

/// Judges the numbers of a benchmark.
///
/// # Errors
/// No number of the benchmark is there, or the reference is not.
pub fn judge(
    folder: &str,
    submission: &Submission,
    curves: [Option<Curve>; 6],
    library: &Library,
) -> Result<Judged, SceneFileError> {
    let asked = values(&submission.benchmark);
    if submission.values.is_empty() {
        let names: Vec<&str> = asked.iter().map(|a| a.name.as_str()).collect();
        let remedy = format!("add [values] with {}", names.join(", "));
        return Err(submission.key_error("benchmark", "nothing to judge", remedy));
    }
    let elements = elements(&submission.benchmark);
    let differences = match elements {
        Some(elements) => differences(submission, elements),
        None => submission.model.differences.clone(),
    };
    let mut quantities = Vec::new();
    for asked in asked {
        let find = |all: &[(String, f64)]| all.iter().find(|v| v.0 == asked.name).map(|v| v.1);
        let value = find(&submission.values);
        let mut row = Comparison { name: asked.name.clone(), unit: asked.unit.clone(), value, ..Comparison::default() };
        match &asked.basis {
            Basis::Elements(name) => {
                let elements = elements.expect("numbers.toml has the elements of the benchmark");
                let Some(reference) = elements.value(library, &submission.benchmark, name) else {
                    let message = format!("no reference {}/{}/{name}", elements.folder, submission.benchmark);
                    return Err(submission.key_error("benchmark", message, "restore reference-data"));
                };
                let stated = find(&submission.stated_values);
                elements.compare(&mut row, reference, submission.spacing, stated, "not given");
                if !differences.is_empty() {
                    explained_by_difference(&mut row, true);
                }
            }
            Basis::ClosedForm(formula, tolerance) => {
                let known = closed_form(formula);
                hold(&mut row, known);
                decide(&mut row, 0.0, Some(tolerance * known.abs()));
            }
            Basis::Below(bound) => {
                hold(&mut row, *bound);
                let below = value.is_some_and(|v| v > 0.0 && v < *bound);
                row.outcome = if below { Outcome::Diagnostic } else { Outcome::Fail };
                row.why = "an upper bound shows no agreement".into();
            }
            Basis::Undecided(known, why) => {
                hold(&mut row, *known);
                row.why.clone_from(&NUMBERS.reasons[why]);
            }
        }
        quantities.push(QuantityVerdict { quantity: asked.what.clone(), outcome: row.outcome, comparisons: vec![row] });
    }
    let (uncertainty, numerical) = match (elements, &asked[0].basis) {
        (Some(_), _) => (
            "distance of the finest of three meshes from the limit h to 0; a quarter of their spread at least, all of it \
             below order 1",
            "stated for each number, else 1.25 times what elements of the same spacing are off by",
        ),
        (None, Basis::Undecided(..)) => ("unknown: diagnostic only", "nothing is decided"),
        _ => ("a closed form", "what a sound mesh may be off by, stated with the benchmark"),
    };
    let id = submission.benchmark.clone();
    let label = BENCHMARKS.iter().find(|b| b.name == id).map_or("", |b| b.what).into();
    let reference = ReferenceUsed { id, label, uncertainty: uncertainty.into() };
    let base = Verdict::of(folder, submission, reference, numerical);
    let unknown = elements.is_some() && submission.model.plane == Plane::Unknown;
    let notes = unknown.then(|| "the plane state is unknown; plane stress is assumed".into()).into_iter().collect();
    let mut verdict = Verdict { differences, notes, quantities, ..base };
    verdict.conclude();
    Ok(Judged { verdict, curves, references: Default::default() })
}

fn hold(row: &mut Comparison, known: f64) {
    row.reference = Some(known);
    row.error = row.value.map(|value| value - known);
}
