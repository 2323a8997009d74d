//! How a case file is read.

use std::path::Path;

use super::{Case, Check, Tier, Variant, convergence, rings};
use crate::measure::grid_convergence::Estimate;
use crate::record::{Accept, ReferenceKind};
use crate::scene_file::document::{Document, Node, Value};
use crate::scene_file::fields::{Fields, Item};
use crate::scene_file::units::{self, Dimension};

const KEYS: [&str; 13] = [
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
    "rings",
    "check",
];

pub(super) fn case(item: &Item<'_>, path: &Path, document: &Document) -> Option<Case> {
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
    let rings = fields.maybe("rings", rings::read);
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
        rings: rings?,
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
    if scene.get("contact").is_some() {
        models.push("contact".to_string());
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
