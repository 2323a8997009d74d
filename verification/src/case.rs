//! Case files: a claim, a scene, what is measured, and the bounds within which the claim holds.
//!
//! A case is one TOML file `cases/<suite>/<case>.toml`. Its `[scene]` table has the form of a scene file, and may have a
//! list where a scene has one value: a study axis. `[[variant]]` tables change several keys together.

pub mod convergence;

use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::measure::grid_convergence::Estimate;
use crate::record::{Accept, ReferenceKind};
use crate::scene_file::document::{Document, Node, Value};
use crate::scene_file::fields::{Fields, Item, Problems};
use crate::scene_file::units::{self, Dimension};
use crate::scene_file::{Problem, SceneFileError};

/// How much a run may cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tier {
    /// Minutes in all; what CI runs.
    Quick,
    /// Paper resolution.
    Full,
}

impl std::fmt::Display for Tier {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Quick => "quick",
            Self::Full => "full",
        })
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
    /// Quantity in words.
    pub quantity: String,
    /// Unit of the value.
    pub unit: String,
    /// Name of the measure; absent where the study itself measures `quantity`.
    pub measure: Option<String>,
    /// Column of the history.
    pub column: Option<String>,
    /// Reference curve or value: `folder/quantity`.
    pub reference: Option<String>,
    /// Window in time, s.
    pub window: [f64; 2],
    /// Position or threshold the measure needs, SI.
    pub at: Option<f64>,
    /// Expected value, if it is one number.
    pub expect: Option<f64>,
    /// Kind and source of the expected value.
    pub expect_kind: ReferenceKind,
    /// Where the expected value comes from.
    pub expect_source: String,
    /// Factor from the measured to the reported unit.
    pub scale: f64,
    /// Reference band that gives the bounds: `folder/name`.
    pub band: Option<String>,
    /// Variant the check is about; absent: each.
    pub variant: Option<String>,
    /// Variant it is compared with.
    pub against: Option<String>,
    /// How far below and above its reference value a measurement may lie, if the bounds are relative to it.
    pub around_reference: Option<[f64; 2]>,
    /// What to make of the values on all meshes; absent: a value for each.
    pub meshes: Option<Estimate>,
    /// Order of theory in h, for `meshes`.
    pub order: Option<f64>,
    /// Bounds.
    pub accept: Accept,
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

/// A case of a suite.
#[derive(Debug, Clone)]
pub struct Case {
    /// Suite: the folder.
    pub suite: String,
    /// Name: the file without ending.
    pub name: String,
    /// File.
    pub path: PathBuf,
    /// The sentence the case can refute.
    pub claim: String,
    /// Tier.
    pub tier: Tier,
    /// Estimated wall time on two cores, s.
    pub seconds: f64,
    /// Study that runs it.
    pub study: String,
    /// Label in figures.
    pub label: String,
    /// Energies of the run times this are those of the whole body: 2 for a half model.
    pub energy_factor: f64,
    /// What differs from the cited source.
    pub deviations: Vec<String>,
    /// What is modelled.
    pub models: Vec<String>,
    /// Changed copies of the scene.
    pub variants: Vec<Variant>,
    /// What a convergence study solves.
    pub convergence: Option<convergence::ConvergenceSetup>,
    /// Checks.
    pub checks: Vec<Check>,
    /// The file, for places of errors.
    pub document: Document,
}

impl Case {
    /// `suite/name`.
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
        let mut document = Document::load(path)?;
        let in_scene: Vec<String> = overrides.iter().map(|o| format!("scene.{o}")).collect();
        document.apply(&in_scene)?;
        let problems = Problems::default();
        let case = read_case(&Item::new(&document.root, "", &problems), path, &document);
        let found = problems.into_inner();
        match case {
            Some(case) if found.is_empty() => Ok(case),
            _ => Err(document.error(&found)),
        }
    }

    /// An error at a key of the file.
    pub fn error(&self, key: &str, message: &str, remedy: &str) -> SceneFileError {
        let location = self.document.root.locate(key);
        let problem = Problem { key: key.into(), location, message: message.into(), remedy: remedy.into() };
        self.document.error(&[problem])
    }
}

const KEYS: [&str; 12] = [
    "claim",
    "tier",
    "seconds",
    "study",
    "label",
    "energy_factor",
    "deviations",
    "models",
    "scene",
    "variant",
    "convergence",
    "check",
];

fn read_case(item: &Item<'_>, path: &Path, document: &Document) -> Option<Case> {
    let fields = item.fields(&KEYS)?;
    let words = |item: &Item<'_>| item.each(|entry| entry.text());
    let claim = fields.need("claim", "claim = \"one sentence that a check can refute\"", Item::text);
    let tier = fields.or("tier", Tier::Quick, |i| i.choice(&[("quick", Tier::Quick), ("full", Tier::Full)]));
    let seconds = fields.need("seconds", "seconds = 10, the estimated wall time", |i| i.quantity(Dimension::NONE));
    let study = fields.or("study", "scene".to_string(), Item::text);
    let label = fields.or("label", String::new(), Item::text);
    let energy_factor = fields.or("energy_factor", 1.0, |i| i.quantity(Dimension::NONE));
    let deviations = fields.or("deviations", Vec::new(), words);
    let models = fields.or("models", default_models(document), words);
    let variants = fields.or("variant", Vec::new(), |i| i.tables()?.iter().map(read_variant).collect());
    let convergence = fields.maybe("convergence", convergence::read);
    let checks = fields.need("check", "at least one [[check]]", |i| i.tables()?.iter().map(read_check).collect());
    let stem = |p: Option<&std::ffi::OsStr>| p.map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    Some(Case {
        suite: stem(path.parent().and_then(Path::file_name)),
        name: stem(path.file_stem()),
        path: path.to_path_buf(),
        claim: claim?,
        tier: tier?,
        seconds: seconds?,
        study: study?,
        label: label?,
        energy_factor: energy_factor?,
        deviations: deviations?,
        models: models?,
        variants: variants?,
        convergence: convergence?,
        checks: checks?,
        document: document.clone(),
    })
}

/// What a scene models follows from what it declares.
fn default_models(document: &Document) -> Vec<String> {
    let Some(scene) = document.root.get("scene") else { return Vec::new() };
    let materials = scene.get("material").and_then(Node::as_table);
    let fractures = materials.is_some_and(|m| m.values().any(|material| material.get("fracture").is_some()));
    let mut models = vec!["momentum".to_string()];
    if fractures {
        models.push("phase field".to_string());
    }
    models
}

fn read_variant(item: &Item<'_>) -> Option<Variant> {
    let fields = item.fields(&["name", "set", "energy_factor"])?;
    let name = fields.need("name", "name = \"…\"", Item::text);
    let set = fields.need("set", "set = { \"mesh.degree\" = 3 }", |i| match &i.node.value {
        Value::Table(table) => Some(table.iter().map(|(key, node)| (key.clone(), node.clone())).collect()),
        _ => i.fail("expected a table", "write set = { \"mesh.degree\" = 3 }"),
    });
    let energy_factor = fields.maybe("energy_factor", |i| i.quantity(Dimension::NONE));
    Some(Variant { name: name?, set: set?, energy_factor: energy_factor? })
}

const CHECK_KEYS: [&str; 22] = [
    "quantity",
    "unit",
    "measure",
    "column",
    "reference",
    "from",
    "to",
    "at",
    "expect",
    "expect_kind",
    "expect_source",
    "scale",
    "band",
    "variant",
    "against",
    "meshes",
    "order",
    "min",
    "max",
    "below",
    "above",
    "why",
];

fn read_check(item: &Item<'_>) -> Option<Check> {
    let fields = item.fields(&CHECK_KEYS)?;
    let text = |key: &str| fields.maybe(key, Item::text);
    let number = |key: &str| fields.maybe(key, any_quantity);
    let time = |key: &str, default| fields.or(key, default, |i| i.quantity(Dimension::TIME));
    let quantity = fields.need("quantity", "quantity = \"what is measured, in words\"", Item::text);
    let unit = fields.or("unit", "1".to_string(), Item::text);
    let (measure, column, reference) = (text("measure"), text("column"), text("reference"));
    let window = [time("from", f64::NEG_INFINITY), time("to", f64::INFINITY)];
    let (at, expect) = (number("at"), number("expect"));
    let kind = fields.or("expect_kind", ReferenceKind::Exact, reference_kind);
    let expect_source = fields.or("expect_source", String::new(), Item::text);
    let scale = fields.or("scale", 1.0, |i| i.quantity(Dimension::NONE));
    let (band, variant, against) = (text("band"), text("variant"), text("against"));
    let around_reference = read_around(&fields);
    let meshes = fields.maybe("meshes", |i| i.choice(&Estimate::WORDS));
    let order = number("order");
    let accept = read_accept(&fields);
    Some(Check {
        quantity: quantity?,
        unit: unit?,
        measure: measure?,
        column: column?,
        reference: reference?,
        window: [window[0]?, window[1]?],
        at: at?,
        expect: expect?,
        expect_kind: kind?,
        expect_source: expect_source?,
        scale: scale?,
        band: band?,
        variant: variant?,
        against: against?,
        around_reference: around_reference?,
        meshes: meshes?,
        order: order?,
        accept: accept?,
    })
}

/// `below = 0.1, above = 0.5`: bounds around the reference value.
fn read_around(fields: &Fields<'_>) -> Option<Option<[f64; 2]>> {
    let (below, above) = (fields.maybe("below", any_quantity)?, fields.maybe("above", any_quantity)?);
    match (below, above) {
        (None, None) => Some(None),
        (Some(below), Some(above)) => Some(Some([below, above])),
        _ => fields.item().fail("one of below and above is missing", "give both: how far from the reference value"),
    }
}

/// Bounds need a reason.
fn read_accept(fields: &Fields<'_>) -> Option<Accept> {
    let number = |key: &str| fields.maybe(key, any_quantity);
    let (min, max) = (number("min"), number("max"));
    let why = fields.or("why", String::new(), Item::text);
    let (min, max, why) = (min?, max?, why?);
    let bounded = ["min", "max", "below", "above"].iter().any(|key| fields.get(key).is_some());
    if bounded && why.is_empty() {
        return fields.item().fail("bounds without a reason", "add why = \"where the bound comes from\"");
    }
    Some(Accept { min, max, why })
}

fn reference_kind(item: &Item<'_>) -> Option<ReferenceKind> {
    item.choice(&[
        ("exact", ReferenceKind::Exact),
        ("theory", ReferenceKind::Theory),
        ("literature", ReferenceKind::Literature),
        ("independent-code", ReferenceKind::IndependentCode),
        ("self-convergence", ReferenceKind::SelfConvergence),
        ("regression", ReferenceKind::Regression),
    ])
}

/// A number, or a string with any unit, in SI.
fn any_quantity(item: &Item<'_>) -> Option<f64> {
    match item.node.as_str() {
        None => item.quantity(Dimension::NONE),
        Some(text) => match units::parse(text) {
            Ok(quantity) => Some(quantity.value),
            Err(e) => item.fail(e.message, e.remedy),
        },
    }
}
