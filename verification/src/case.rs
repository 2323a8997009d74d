//! Case files: a claim, a scene, what is measured, and the bounds within which the claim holds.
//!
//! A case is one TOML file `cases/<suite>/<case>.toml`. Its `[scene]` table has the form of a scene file,
//! and may have a list where a scene has one value: a study axis. `[[variant]]` tables change several
//! keys together. `[values]` names numbers, which formulas of checks and charts ([`formula`]) use. What
//! several cases or checks have in common stands once: a case may name a `base`, a `[[check]]` a `set` of
//! checks, and `each` lists what differs between them (`repeat.rs`).

mod chart;
mod check;
pub mod convergence;
pub mod expand;
pub mod formula;
pub mod geometry;
mod read;
mod repeat;
mod rings;
mod value;

pub use chart::{Chart, ChartCurve};
pub use check::Estimate;

use std::path::{Path, PathBuf};
use std::str::FromStr;

use fisura::fault;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::case::formula::{Amount, Formula};
use crate::case::geometry::Geometry;
use crate::output::fingerprint::fingerprint;
use crate::record::{Accept, Limit, Reference, ReferenceKind, Side};
use crate::scene::document::{Document, Node};
use crate::scene::fields::{Item, Problems};
use crate::scene::{Problem, SceneFileError};

/// How much a run may cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Tier {
    /// Minutes in all; what CI runs.
    #[default]
    Quick,
    /// Paper resolution.
    Full,
}

impl std::fmt::Display for Tier {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == Self::Quick { "quick" } else { "full" })
    }
}

impl FromStr for Tier {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "quick" => Ok(Self::Quick),
            "full" => Ok(Self::Full),
            _ => Err(format!("unknown tier {text:?}; known: quick, full")),
        }
    }
}

/// What a check measures, and the parameters of the measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Last part of the ids of its records: it stays when the words of `quantity` change.
    pub id: String,
    /// Earlier values of `id`, by which records of older results are still found.
    pub formerly: Vec<String>,
    /// Name of the measured quantity in words.
    pub quantity: String,
    /// Unit of the reported value; `1` if the file gives none.
    pub unit: String,
    /// Name of the measure; absent where the study itself measures `quantity`.
    pub measure: Option<String>,
    /// Column of the history.
    pub column: Option<String>,
    /// Reference curve or value: `folder/quantity`.
    pub reference: Option<String>,
    /// Start and end of the time that is measured, s; infinite where the file sets no limit.
    pub window: [f64; 2],
    /// Position or threshold the measure needs, SI.
    pub at: Option<f64>,
    /// Expected value, if it is one number.
    pub expect: Option<f64>,
    /// Kind and source of the expected value.
    pub expect_kind: ReferenceKind,
    /// Where the expected value comes from.
    pub expect_source: String,
    /// On which side of the expected value a measured one agrees with it.
    pub expect_side: Side,
    /// Half width of the uncertainty of the expected value, in its unit.
    pub uncertainty: Option<f64>,
    /// Discretisation error of the value, in the unit of the measure.
    pub discretisation: Option<f64>,
    /// Factor from the measured to the reported unit.
    pub scale: f64,
    /// Reference band that gives the bounds: `folder/name`.
    pub band: Option<String>,
    /// Variant the check is about, or a pattern of variants; absent: each.
    pub variant: Option<String>,
    /// Variant it is compared with.
    pub against: Option<String>,
    /// How far below and above its reference value a measurement may lie, if the bounds are relative to it.
    pub around_reference: Option<[f64; 2]>,
    /// What to make of the values on all meshes; absent: a value for each.
    pub meshes: Option<Estimate>,
    /// Order of theory in h, for `meshes`.
    pub order: Option<f64>,
    /// Bounds within which the value is accepted.
    pub accept: Accept,
    /// Why the value is shown beside its reference and not judged.
    pub shown: Option<String>,
    /// Documented limit, in which a value may lie that does not agree with its reference.
    pub limit: Option<Limit>,
    /// Numbers that a formula gives for every run, by key; until then they are not a number above.
    pub formulas: Vec<(&'static str, Formula)>,
}

impl Check {
    /// Bounds that count from the reference value, if any do.
    ///
    /// # Errors
    /// If there is no value to count from.
    pub fn bounds_around(&self, reference: Option<&Reference>) -> Result<Option<[f64; 2]>, String> {
        let Some([below, above]) = self.around_reference else { return Ok(None) };
        let value = reference.and_then(|reference| reference.value);
        let value = value.ok_or("below and above need a reference value")?;
        Ok(Some([value - fault!("bounds-both-above", below => -below), value + above]))
    }

    /// With the numbers that `value` gives for its formulas.
    ///
    /// # Errors
    /// Whatever `value` gives, with the key.
    pub fn with_numbers(
        &self,
        value: &dyn Fn(&Formula) -> Result<f64, String>,
    ) -> Result<Self, (&'static str, String)> {
        let mut check = self.clone();
        for (key, formula) in &self.formulas {
            let value = value(formula).map_err(|message| (*key, message))?;
            match *key {
                "from" => check.window[0] = value,
                "to" => check.window[1] = value,
                "at" => check.at = Some(value),
                "expect" => check.expect = Some(value),
                "discretisation" => check.discretisation = Some(value),
                "scale" => check.scale = value,
                other => unreachable!("{other} takes no formula"),
            }
        }
        Ok(check)
    }

    /// Whether it is about a variant: it names none, this one, or a pattern such as `p=[234]` that matches
    /// it.
    pub fn is_about(&self, variant: &str) -> bool {
        let matches = |wanted: &str| glob::Pattern::new(wanted).is_ok_and(|pattern| pattern.matches(variant));
        self.variant.as_deref().is_none_or(|wanted| wanted == variant || matches(wanted))
    }
}

/// Keys changed together.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// Name, part of record ids.
    pub name: String,
    /// Key path in the scene and value.
    pub set: Vec<(String, Node)>,
    /// Energies of the run times this are those of the whole body; absent: that of the case.
    pub energy_factor: Option<f64>,
}

/// A verification case, as its file states it: a claim, what is run, and how it is checked.
#[derive(Debug, Clone)]
pub struct Case {
    /// Suite of the case: the name of the folder that holds its file.
    pub suite: String,
    /// Name: the file without ending.
    pub name: String,
    /// File that it was read from.
    pub path: PathBuf,
    /// The sentence the case can refute.
    pub claim: String,
    /// Tier in which it runs, quick or full.
    pub tier: Tier,
    /// Estimated wall time on two cores, s.
    pub seconds: f64,
    /// Study that runs it.
    pub study: String,
    /// Name of the case in legends and titles; empty if the file gives none.
    pub label: String,
    /// Energies of the run times this are those of the whole body: 2 for a half model.
    pub energy_factor: f64,
    /// What differs from the cited source.
    pub deviations: Vec<String>,
    /// Models in use, such as `momentum`, `phase field` or `contact`; found from the scene if the file gives
    /// none.
    pub models: Vec<String>,
    /// Numbers by name, for formulas.
    pub values: Vec<(String, Amount)>,
    /// Changed copies of the scene.
    pub variants: Vec<Variant>,
    /// What a convergence study solves.
    pub convergence: Option<convergence::ConvergenceSetup>,
    /// Geometries of the `rings-sweep` study.
    pub rings: Option<Vec<Geometry>>,
    /// Checks of what its runs gave.
    pub checks: Vec<Check>,
    /// Charts of its runs.
    pub charts: Vec<Chart>,
    /// The file with its base and every check written out, for places of errors.
    pub document: Document,
}

/// The JSON schema of a case file, for editors; its scene may be any table.
pub fn json_schema() -> serde_json::Value {
    schemars::schema_for!(read::CaseTable).to_value()
}

impl Case {
    /// Id of the case: `suite/name`.
    pub fn id(&self) -> String {
        format!("{}/{}", self.suite, self.name)
    }

    /// The `[scene]` table.
    pub fn scene_node(&self) -> Option<&Node> {
        self.document.root.get("scene")
    }

    /// Reads `cases/<suite>/<case>.toml`; `overrides` are `scene` keys as in `--set`.
    ///
    /// # Errors
    /// Everything wrong with the file outside its scene.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self, SceneFileError> {
        Self::from_document(path, Document::load(path)?, overrides)
    }

    /// Reads a case from `text`; `path` says its suite and name.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(path: &Path, text: &str, overrides: &[String]) -> Result<Self, SceneFileError> {
        Self::from_document(path, Document::parse(&path.display().to_string(), text)?, overrides)
    }

    fn from_document(path: &Path, mut document: Document, overrides: &[String]) -> Result<Self, SceneFileError> {
        let in_scene: Vec<String> = overrides.iter().map(|o| format!("scene.{o}")).collect();
        repeat::add_base(&mut document, path)?;
        document.apply(&in_scene)?;
        repeat::write_lists(&mut document, path)?;
        let problems = Problems::default();
        let case = read::case(&Item::new(&document.root, "", &problems), path, &document);
        let found = problems.into_inner();
        match case {
            Some(case) if found.is_empty() => Ok(case),
            _ => Err(document.error(&found)),
        }
    }

    /// Fingerprint of all it says: its file, the base and the sets of checks that it names, overrides, and
    /// the files of numbers that its scene names.
    pub fn fingerprint(&self) -> String {
        fingerprint([self.document.text(), &self.document.root.canonical(), &self.numbers()])
    }

    /// Fingerprint of what the case simulates: everything but its claim, checks, label and estimated time.
    pub fn inputs(&self) -> String {
        let others = ["claim", "check", "label", "seconds", "tier", "deviations"];
        let entries = self.document.root.as_table().into_iter().flatten();
        let simulated = entries.filter(|(key, _)| !others.contains(&key.as_str()));
        let said = simulated.map(|(key, node)| format!("{key} = {}", node.canonical()));
        fingerprint(said.chain(Some(self.numbers()).filter(|numbers| !numbers.is_empty())))
    }

    /// Texts of the files of numbers that the scene names; one that cannot be read has none.
    fn numbers(&self) -> String {
        let mut files = Vec::new();
        self.document.root.texts_of("file", &mut files);
        let text = |file: &&str| std::fs::read_to_string(self.document.folder().join(file)).ok();
        files.iter().filter_map(text).collect::<Vec<_>>().join("\0")
    }

    /// An error at a key of the file.
    pub fn error(&self, key: &str, message: &str, remedy: &str) -> SceneFileError {
        let location = self.document.root.locate(key);
        let problem = Problem { key: key.into(), location, message: message.into(), remedy: remedy.into() };
        self.document.error(&[problem])
    }
}
