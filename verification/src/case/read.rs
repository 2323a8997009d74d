//! How a case file is read.

use std::path::Path;

use super::formula::Amount;
use super::{Case, Tier, Variant, chart, check, convergence, rings};
use crate::scene::document::{Document, Node, Value};
use crate::scene::fields::Item;
use crate::scene::units::Dimension;

const KEYS: [&str; 15] = [
    "claim",
    "tier",
    "seconds",
    "study",
    "label",
    "energy_factor",
    "deviations",
    "models",
    "scene",
    "values",
    "variant",
    "convergence",
    "rings",
    "check",
    "chart",
];

pub(super) fn case(item: &Item<'_>, path: &Path, document: &Document) -> Option<Case> {
    let fields = item.fields(&KEYS)?;
    let words = |item: &Item<'_>| item.each(|entry| entry.text());
    let claim = fields.need("claim", "claim = \"one sentence that a check can refute\"", Item::words);
    let tier = fields.or("tier", Tier::Quick, |i| i.choice(&[("quick", Tier::Quick), ("full", Tier::Full)]));
    let seconds = fields.need("seconds", "seconds = 10, the estimated wall time", |i| i.positive(Dimension::NONE));
    let study = fields.or("study", "scene".to_string(), Item::text);
    let label = fields.or("label", String::new(), Item::text);
    let energy_factor = fields.or("energy_factor", 1.0, |i| i.positive(Dimension::NONE));
    let deviations = fields.or("deviations", Vec::new(), words);
    let models = fields.or("models", default_models(document), words);
    let values = fields.or("values", Vec::new(), read_values);
    let variants = fields.or("variant", Vec::new(), |i| i.tables()?.iter().map(read_variant).collect());
    let convergence = fields.maybe("convergence", convergence::read);
    let rings = fields.maybe("rings", rings::read);
    let checks = fields.need("check", "at least one [[check]]", check::read);
    let charts = fields.or("chart", Vec::new(), |i| i.tables()?.iter().map(chart::read).collect());
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
        values: values?,
        variants: variants?,
        convergence: convergence?,
        rings: rings?,
        checks: checks?,
        charts: charts?,
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
fn read_values(item: &Item<'_>) -> Option<Vec<(String, Amount)>> {
    let Value::Table(table) = &item.node.value else { return item.fail("expected a table", "write [values]") };
    let plain = |name: &str| {
        name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    let names: Vec<&str> = table.keys().map(String::as_str).collect();
    let fields = item.fields(&names)?;
    let read = |name: &&str| {
        if !plain(name) {
            return item.fail(format!("{name:?} is no name in a formula"), "use letters, digits and underscores");
        }
        Some((name.to_string(), fields.need(name, "a number", Amount::read)?))
    };
    names.iter().map(read).collect()
}

fn read_variant(item: &Item<'_>) -> Option<Variant> {
    let fields = item.fields(&["name", "set", "energy_factor"])?;
    let name = fields.need("name", "name = \"…\"", Item::words);
    let set = fields.need("set", "set = { \"mesh.degree\" = 3 }", |i| match &i.node.value {
        Value::Table(table) => Some(table.iter().map(|(key, node)| (key.clone(), node.clone())).collect()),
        _ => i.fail("expected a table", "write set = { \"mesh.degree\" = 3 }"),
    });
    let energy_factor = fields.maybe("energy_factor", |i| i.positive(Dimension::NONE));
    Some(Variant { name: name?, set: set?, energy_factor: energy_factor? })
}
