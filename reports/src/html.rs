//! `report.html`: one page with everything, that needs no script and no other file.

mod page;

use std::collections::BTreeMap;

use fisura_verification::record::{Figure, FigureBody, Record, ReferenceKind, ResultSet};
use minijinja::Environment;
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;

use crate::number::{DIGITS, duration, grouped, plain, pretty};
use crate::rates::{Rate, rates};
use crate::series::names;
use crate::svg::slug;
use crate::view::{self, Counts};

use page::{Case, Deviations, Order, Orders, Page, Parameters, Picture, ReferenceCell, Row, Source, Suite, Verdict};

const TEMPLATE: &str = include_str!("../templates/report.html");
const STYLE: &str = include_str!("../templates/report.css");

/// Drawn figures by their id; a figure that could not be drawn has its error instead.
pub type Drawings = BTreeMap<String, Result<String, String>>;

/// Renders the page.
///
/// # Errors
/// Only if the template cannot be filled, which has no cause in the results.
pub fn render_html(set: &ResultSet, drawings: &Drawings) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    environment.add_template("report.html", TEMPLATE)?;
    let counts = Counts::of(&set.records);
    let timed = set.figures.iter().filter(|f| is_timing(f));
    let page = Page {
        style: STYLE,
        verdict: Verdict::of(counts.verdict()),
        sentence: counts.sentence(),
        counts: counts.list(),
        environment: view::environment(set),
        broken: view::broken(set).into_iter().map(|r| row(r, &r.id)).collect(),
        suites: view::suites(set).into_iter().map(|name| suite(set, name, drawings)).collect(),
        timing: timed.map(|f| picture(f, drawings)).collect(),
        sources: sources(&set.records),
        deviations: deviations(set),
    };
    environment.get_template("report.html")?.render(Serde(page))
}

/// Figures that show measured time; the page has a section of its own for them.
fn is_timing(figure: &Figure) -> bool {
    figure.id.starts_with("timing/")
}

fn suite(set: &ResultSet, name: &str, drawings: &Drawings) -> Suite {
    let records: Vec<&Record> = set.records.iter().filter(|r| r.suite == name).collect();
    let counts = Counts::of(records.iter().copied());
    let figures = set.figures.iter().filter(|f| f.suite == name && !is_timing(f));
    let cases = records.chunk_by(|a, b| a.case == b.case);
    Suite {
        anchor: format!("suite-{}", slug(name)),
        name: name.to_string(),
        counts: counts.list(),
        verdict: Verdict::of(counts.verdict()),
        orders: orders(&records),
        cases: cases.map(case).collect(),
        figures: figures.map(|f| picture(f, drawings)).collect(),
    }
}

/// The rates of a suite, by case.
fn orders(records: &[&Record]) -> Vec<Orders> {
    let order = |rate: &Rate| Order {
        anchor: format!("check-{}", slug(&rate.record.id)),
        verdict: Verdict::of(rate.record.status),
        cells: rate.cells(pretty),
    };
    let of_case = |rates: &[Rate]| {
        let first = rates[0].record;
        let id = format!("{}/{}", first.suite, first.case);
        Orders { id, claim: first.claim.clone(), rows: rates.iter().map(order).collect() }
    };
    rates(records).chunk_by(|a, b| a.record.case == b.record.case).map(of_case).collect()
}

fn case(records: &[&Record]) -> Case {
    let first = records[0];
    let counts = Counts::of(records.iter().copied());
    let id = format!("{}/{}", first.suite, first.case);
    let mut series: Vec<String> = records.iter().filter_map(|r| r.series.clone()).collect();
    series.dedup();
    let run = |record| view::run_id(record).strip_prefix(id.as_str()).unwrap_or_default().trim_start_matches('/');
    let holding = match counts.judged() {
        0 => format!("{} shown", counts.info),
        judged => format!("{} of {judged}", counts.pass),
    };
    Case {
        anchor: format!("case-{}", slug(&id)),
        verdict: Verdict::of(counts.verdict()),
        claim: first.claim.clone(),
        holding,
        tier: first.tier.clone(),
        models: first.models.join(", "),
        parameters: parameters(records),
        deviations: view::deviations(records).into_iter().map(String::from).collect(),
        series,
        time: time(records),
        open: counts.fail + counts.error > 0,
        rows: records.iter().map(|r| row(r, run(r))).collect(),
        id,
    }
}

/// The parameters of every run of a case.
fn parameters(records: &[&Record]) -> Vec<Parameters> {
    let runs = view::runs(records.iter().copied()).into_iter();
    let of_run =
        |(run, records): (&str, Vec<&Record>)| Parameters { run: run.to_string(), text: view::parameters(records[0]) };
    runs.map(of_run).filter(|p| !p.text.is_empty()).collect()
}

/// Measured time of a case in words: the sum over its runs, each measurement once.
fn time(records: &[&Record]) -> String {
    let mut timings = Vec::new();
    for (_, run) in view::runs(records.iter().copied()) {
        let timing = view::timing(&run);
        if !timings.contains(&timing) {
            timings.push(timing);
        }
    }
    let wall: f64 = timings.iter().map(|t| t.wall_s).sum();
    let steps: u64 = timings.iter().map(|t| t.particle_steps).sum();
    if wall <= 0.0 {
        return String::new();
    }
    let per_step = || format!(", {} particle-steps at {} ns", grouped(steps), plain(1e9 * wall / steps as f64, 3));
    format!("{} of wall time{}", duration(wall), if steps > 0 { per_step() } else { String::new() })
}

fn row(record: &Record, name: &str) -> Row {
    let reference = record.reference.as_ref().map(|r| ReferenceCell {
        value: r.value.map(|v| view::with_unit(&pretty(v, DIGITS), &record.unit)).unwrap_or_default(),
        kind: view::kind(r),
        source: r.source.clone(),
    });
    Row {
        anchor: format!("check-{}", slug(&record.id)),
        name: name.to_string(),
        verdict: Verdict::of(record.status),
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
        kind: if matches!(figure.body, FigureBody::Field { .. }) { "field" } else { "chart" },
        title: figure.title.clone(),
        caption: figure.caption.clone(),
        deviations: figure.deviations.clone(),
        svg,
        error,
        file: crate::figure::file_name(&figure.id).unwrap_or_default(),
        series: names(figure),
    }
}

/// What the records cite beyond closed forms and theory, each source once with the number of its checks.
fn sources(records: &[Record]) -> Vec<Source> {
    let mut sources: Vec<Source> = Vec::new();
    let cited = records.iter().filter_map(|r| r.reference.as_ref());
    for reference in cited.filter(|r| matches!(r.kind, ReferenceKind::Literature | ReferenceKind::IndependentCode)) {
        match sources.iter_mut().find(|s| s.text == reference.source) {
            Some(source) => source.checks += 1,
            None => sources.push(Source { text: reference.source.clone(), kind: view::kind(reference), checks: 1 }),
        }
    }
    sources
}

/// Every deviation from a cited source, with the cases that deviate.
fn deviations(set: &ResultSet) -> Vec<Deviations> {
    let mut all: Vec<Deviations> = Vec::new();
    for record in &set.records {
        let case = format!("{}/{}", record.suite, record.case);
        for text in &record.deviations {
            match all.iter_mut().find(|d| d.text == *text) {
                Some(known) if known.cases.iter().any(|(_, id)| *id == case) => {}
                Some(known) => known.cases.push((format!("case-{}", slug(&case)), case.clone())),
                None => {
                    let cases = vec![(format!("case-{}", slug(&case)), case.clone())];
                    all.push(Deviations { text: text.clone(), cases });
                }
            }
        }
    }
    all
}
