//! How a case file is read.

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Map, Value};

use super::chart::Chart;
use super::check::{self, CheckTable};
use super::convergence::{self, ConvergenceTable};
use super::formula::Amount;
use super::rings::{self, RingsTable};
use super::value::{AnyAmount, Positive, Words};
use super::{Case, Tier, Variant};
use crate::scene::document::{Document, Node};
use crate::scene::fields::Item;
use crate::scene::typed;

/// A case file as it stands.
#[derive(Deserialize, JsonSchema)]
#[schemars(title = "case of fisura")]
#[serde(deny_unknown_fields)]
pub(super) struct CaseTable {
    /// One sentence that a check can refute.
    claim: Words,
    /// The part in `bases.toml` that several cases have in common; what the case states replaces or adds to
    /// it.
    #[schemars(with = "Option<String>")]
    #[expect(dead_code, reason = "it is added before")]
    base: Option<IgnoredAny>,
    /// How much a run may cost.
    #[serde(default)]
    tier: Tier,
    /// Estimated wall time on two cores, s: `seconds = 10`; 3 if absent.
    seconds: Option<Positive>,
    /// The study that runs the case; `scene` runs its scene and measures the results. If absent, that of the
    /// table `[convergence]` if there is one, otherwise `scene`.
    study: Option<String>,
    /// Label in figures.
    #[serde(default)]
    label: String,
    /// Energies of the run times this are those of the whole body: 2 for a half model.
    energy_factor: Option<Positive>,
    /// What differs from the cited source: a list, or a table of the entries that differ from the base.
    #[serde(default)]
    #[schemars(with = "Value")]
    deviations: Vec<String>,
    /// What is modelled, if it does not follow from the scene.
    models: Option<Vec<String>>,
    /// A scene as in a scene file; a list in place of a value is an axis of the study, and a string that
    /// begins with `=` a formula of other keys: `end_time = "= 2*{mesh.size.0}"`.
    #[schemars(with = "Option<Map<String, Value>>")]
    #[expect(dead_code, reason = "it is read as a scene file")]
    scene: Option<IgnoredAny>,
    /// Numbers by name, for formulas of checks and charts: `speed = "= sqrt({material.bar.young_modulus})"`.
    #[serde(default)]
    values: BTreeMap<String, AnyAmount>,
    /// Changed copies of the scene.
    #[serde(default)]
    variant: Vec<VariantTable>,
    /// What a convergence study solves.
    convergence: Option<ConvergenceTable>,
    /// Geometries of the study `rings-sweep`.
    rings: Option<RingsTable>,
    /// What is measured, and the bounds within which the claim holds: at least one `[[check]]`.
    #[schemars(length(min = 1))]
    check: Vec<CheckTable>,
    /// What is drawn of the runs.
    #[serde(default)]
    chart: Vec<Chart>,
}

/// A changed copy of the scene, or one for each entry of a list, which are written out before it is read.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct VariantTable {
    /// Name, part of the ids of its records.
    #[schemars(with = "Option<Words>")]
    name: Words,
    /// Keys of the scene and their values: `set = { "mesh.degree" = 3 }`.
    #[schemars(with = "Option<Map<String, Value>>")]
    #[expect(dead_code, reason = "its values are read with their places")]
    set: BTreeMap<String, IgnoredAny>,
    /// Energies of this run times this are those of the whole body, if not those of the case.
    energy_factor: Option<Positive>,
    /// A variant for each entry: `each = [{ name = "p=3", set = { "mesh.degree" = 3 } }]`; lists in the list
    /// are combined, with names put together.
    #[schemars(with = "Option<Vec<Map<String, Value>>>")]
    #[expect(dead_code, reason = "it is written out before")]
    each: Option<IgnoredAny>,
}

pub(super) fn case(item: &Item<'_>, path: &Path, document: &Document) -> Option<Case> {
    let table: CaseTable = typed::read(item)?;
    let below = |key: &str| item.at(key).expect("what was read is there");
    if table.check.is_empty() {
        return below("check").fail("there is no check", "add at least one [[check]]");
    }
    let checks =
        table.check.into_iter().enumerate().map(|(i, table)| check::check(table, &below(&format!("check.{i}"))));
    let checks: Vec<Option<_>> = checks.collect();
    let set = |i: usize| item.node.at(&format!("variant.{i}.set")).and_then(Node::as_table).cloned();
    let variants = table.variant.into_iter().enumerate().map(|(i, variant)| Variant {
        name: variant.name.0,
        set: set(i).into_iter().flatten().collect(),
        energy_factor: variant.energy_factor.map(|factor| factor.0),
    });
    let values = values(table.values, item);
    let convergence = table.convergence.map(|table| convergence::setup(table, &below("convergence")));
    let rings = table.rings.map(|table| rings::geometries(&table, &below("rings")));
    let stem = |p: Option<&std::ffi::OsStr>| p.map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    Some(Case {
        suite: stem(path.parent().and_then(Path::file_name)),
        name: stem(path.file_stem()),
        path: path.to_path_buf(),
        claim: table.claim.0,
        tier: table.tier,
        seconds: table.seconds.map_or(3.0, |seconds| seconds.0),
        study: table.study.unwrap_or(if convergence.is_some() { "convergence" } else { "scene" }.into()),
        label: table.label,
        energy_factor: table.energy_factor.map_or(1.0, |factor| factor.0),
        deviations: table.deviations,
        models: table.models.unwrap_or_else(|| default_models(document)),
        values: values?,
        variants: variants.collect(),
        convergence: convergence.map_or(Some(None), |read| read.map(Some))?,
        rings: rings.map_or(Some(None), |read| read.map(Some))?,
        checks: checks.into_iter().collect::<Option<_>>()?,
        charts: table.chart,
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
    if scene.get("contact").is_some() {
        models.push("contact".to_string());
    }
    models
}

/// `[values]`: names of letters, digits and underscores, each a number or a formula.
fn values(table: BTreeMap<String, AnyAmount>, item: &Item<'_>) -> Option<Vec<(String, Amount)>> {
    let plain = |name: &str| {
        name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    match table.keys().find(|name| !plain(name)) {
        Some(name) => {
            let message = format!("{name:?} is not a valid name in a formula");
            item.at("values")?.fail(message, "use letters, digits and underscores")
        }
        None => Some(table.into_iter().map(|(name, amount)| (name, amount.0)).collect()),
    }
}
