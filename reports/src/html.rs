//! `report.html`: one page with everything, that needs no script and no other file.

use std::collections::BTreeMap;

use fisura_verification::record::{Figure, Record, ResultSet, Status};
use minijinja::Environment;
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use serde::Serialize;

use crate::number::{DIGITS, duration, grouped, plain, pretty};
use crate::rates::{Rate, rates};
use crate::series::names;
use crate::svg::slug;
use crate::view::{self, Counts};

const TEMPLATE: &str = include_str!("../templates/report.html");

/// Drawn figures by their id; a figure that could not be drawn has its error instead.
pub type Drawings = BTreeMap<String, Result<String, String>>;

#[derive(Serialize)]
struct Verdict {
    word: &'static str,
    symbol: &'static str,
}

#[derive(Serialize)]
struct Row {
    anchor: String,
    id: String,
    verdict: Verdict,
    claim: String,
    quantity: String,
    value: String,
    reference: Option<ReferenceCell>,
    bounds: String,
    why: String,
    message: String,
}

#[derive(Serialize)]
struct ReferenceCell {
    value: String,
    kind: &'static str,
    source: String,
}

#[derive(Serialize)]
struct Run {
    id: String,
    tier: String,
    models: String,
    parameters: String,
    deviations: Vec<String>,
    series: Vec<String>,
    time: String,
    rows: Vec<Row>,
}

/// Orders of one case.
#[derive(Serialize)]
struct Orders {
    id: String,
    claim: String,
    rows: Vec<Order>,
}

#[derive(Serialize)]
struct Order {
    anchor: String,
    verdict: Verdict,
    cells: [String; 6],
}

#[derive(Serialize)]
struct Picture {
    anchor: String,
    title: String,
    caption: String,
    deviations: Vec<String>,
    svg: String,
    error: String,
    file: String,
    series: Vec<String>,
}

#[derive(Serialize)]
struct Suite {
    anchor: String,
    name: String,
    counts: String,
    verdict: Verdict,
    orders: Vec<Orders>,
    runs: Vec<Run>,
    figures: Vec<Picture>,
}

#[derive(Serialize)]
struct Page {
    verdict: Verdict,
    sentence: String,
    counts: String,
    environment: Vec<(&'static str, String)>,
    broken: Vec<Row>,
    suites: Vec<Suite>,
}

/// Renders the page.
///
/// # Errors
/// Only if the template cannot be filled, which has no cause in the results.
pub fn render_html(set: &ResultSet, drawings: &Drawings) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    environment.add_template("report.html", TEMPLATE)?;
    let counts = Counts::of(&set.records);
    let page = Page {
        verdict: verdict(counts.verdict()),
        sentence: counts.sentence(),
        counts: counts.list(),
        environment: view::environment(set),
        broken: view::broken(set).into_iter().map(row).collect(),
        suites: view::suites(set).into_iter().map(|name| suite(set, name, drawings)).collect(),
    };
    environment.get_template("report.html")?.render(Serde(page))
}

fn verdict(status: Status) -> Verdict {
    Verdict { word: view::word(status), symbol: view::symbol(status) }
}

fn suite(set: &ResultSet, name: &str, drawings: &Drawings) -> Suite {
    let records: Vec<&Record> = set.records.iter().filter(|r| r.suite == name).collect();
    let counts = Counts::of(records.iter().copied());
    let figures = set.figures.iter().filter(|f| f.suite == name);
    Suite {
        anchor: format!("suite-{}", slug(name)),
        name: name.to_string(),
        counts: counts.list(),
        verdict: verdict(counts.verdict()),
        orders: orders(&records),
        runs: view::runs(records).into_iter().map(|(id, records)| run(id, &records)).collect(),
        figures: figures.map(|f| picture(f, drawings)).collect(),
    }
}

/// The rates of a suite, by case.
fn orders(records: &[&Record]) -> Vec<Orders> {
    let order = |rate: &Rate| Order {
        anchor: format!("check-{}", slug(&rate.record.id)),
        verdict: verdict(rate.record.status),
        cells: rate.cells(pretty),
    };
    let of_case = |rates: &[Rate]| {
        let first = rates[0].record;
        let id = format!("{}/{}", first.suite, first.case);
        Orders { id, claim: first.claim.clone(), rows: rates.iter().map(order).collect() }
    };
    rates(records).chunk_by(|a, b| a.record.case == b.record.case).map(of_case).collect()
}

fn run(id: &str, records: &[&Record]) -> Run {
    let first = records[0];
    let mut series: Vec<String> = records.iter().filter_map(|r| r.series.clone()).collect();
    series.dedup();
    Run {
        id: id.to_string(),
        tier: first.tier.clone(),
        models: first.models.join(", "),
        parameters: view::parameters(first),
        deviations: view::deviations(records).into_iter().map(String::from).collect(),
        series,
        time: time(records),
        rows: records.iter().map(|r| row(r)).collect(),
    }
}

/// Measured time in words.
fn time(records: &[&Record]) -> String {
    let timing = view::timing(records);
    if timing.wall_s <= 0.0 {
        return String::new();
    }
    let mut text = format!("{} of wall time", duration(timing.wall_s));
    if timing.particle_steps > 0 {
        let per_step = plain(timing.ns_per_particle_step, 3);
        text.push_str(&format!(", {} particle-steps at {per_step} ns", grouped(timing.particle_steps)));
    }
    text
}

fn row(record: &Record) -> Row {
    let reference = record.reference.as_ref().map(|r| ReferenceCell {
        value: r.value.map(|v| view::with_unit(&pretty(v, DIGITS), &record.unit)).unwrap_or_default(),
        kind: view::kind(r),
        source: r.source.clone(),
    });
    Row {
        anchor: format!("check-{}", slug(&record.id)),
        id: record.id.clone(),
        verdict: verdict(record.status),
        claim: record.claim.clone(),
        quantity: record.quantity.clone(),
        value: view::value(record, pretty),
        reference,
        bounds: view::bounds(&record.accept, pretty),
        why: record.accept.why.clone(),
        message: record.message.clone().unwrap_or_default(),
    }
}

fn picture(figure: &Figure, drawings: &Drawings) -> Picture {
    let (svg, error) = match drawings.get(&figure.id) {
        Some(Ok(svg)) => (svg.clone(), String::new()),
        Some(Err(error)) => (String::new(), error.clone()),
        None => (String::new(), "it was not drawn".to_string()),
    };
    Picture {
        anchor: format!("figure-{}", slug(&figure.id)),
        title: figure.title.clone(),
        caption: figure.caption.clone(),
        deviations: figure.deviations.clone(),
        svg,
        error,
        file: crate::figure::file_name(&figure.id).unwrap_or_default(),
        series: names(figure),
    }
}
