//! `report.html`: one page with everything, that needs no script and no other file. Figures beyond 5 MB are
//! links to their files.

mod embed;
mod size;

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use fisura_verification::output::foreign::is_plain;
use fisura_verification::record::{Figure, FigureBody, Record, Reference, ReferenceKind, ResultSet};
use minijinja::value::Serde;
use minijinja::{Value, context};

use crate::judge::stored_boards;
use crate::number::{duration, grouped, plain, pretty};
use crate::rates::{Rate, rates};
use crate::series::names;
use crate::svg::slug;
use crate::template::{self, row, verdict};
use crate::view::{self, Counts};

use embed::embedded;
use size::{left_out, reduced};

const TEMPLATE: &str = include_str!("../templates/report.html");
const STYLE: &str = include_str!("../templates/report.css");

/// Drawn figures by their id; a figure that could not be drawn has its error instead.
pub type Drawings = BTreeMap<String, Result<String, String>>;

/// The page stays below this many bytes, so that it opens anywhere and can be sent.
const MOST_BYTES: usize = 5_000_000;

/// Renders the page; figures that would make it too large are named instead of drawn, and where that is not
/// enough records and figures are left out, those that hold first.
///
/// # Errors
/// Only if the template cannot be filled, which has no cause in the results.
pub fn render_html(set: &ResultSet, drawings: &Drawings) -> Result<String, minijinja::Error> {
    render_below(MOST_BYTES, set, drawings)
}

fn render_below(bytes: usize, set: &ResultSet, drawings: &Drawings) -> Result<String, minijinja::Error> {
    let (drawings, looks) = &embedded(drawings);
    let fill = |shown: &ResultSet, left_out: &BTreeSet<&str>| fill(set, shown, (drawings, looks), left_out);
    let page = fill(set, &BTreeSet::new())?;
    if page.len() < bytes {
        return Ok(page);
    }
    let mut page = fill(set, &left_out(set, drawings, page.len() + 1 - bytes))?;
    let mut shown = Cow::Borrowed(set);
    while page.len() >= bytes && shown.records.len() + shown.figures.len() > 0 {
        let part = 0.8 * bytes as f64 / page.len() as f64;
        shown = Cow::Owned(reduced(&shown, part));
        page = fill(&shown, &left_out(&shown, drawings, usize::MAX))?;
    }
    Ok(page)
}

/// The page of the records and figures of `shown`, with the verdict on all of `set`.
fn fill(
    set: &ResultSet,
    shown: &ResultSet,
    (drawings, looks): (&Drawings, &str),
    left_out: &BTreeSet<&str>,
) -> Result<String, minijinja::Error> {
    let counts = Counts::of(&set.records);
    let opening = opening(&shown.figures);
    let opens = |figure: &Figure| opening.iter().any(|first| first.id == figure.id);
    let timed = shown.figures.iter().filter(|f| is_timing(f) && !opens(f));
    let [records, figures] = [set.records.len() - shown.records.len(), set.figures.len() - shown.figures.len()];
    let missing =
        if records + figures == 0 { String::new() } else { format!("{records} records and {figures} figures") };
    let pictures = |figure: &Figure| picture(figure, drawings, left_out);
    let page = context! {
        style => format!("{STYLE}{looks}"),
        verdict => verdict(counts.verdict()),
        sentence => counts.sentence(),
        counts => counts.list(),
        remarks => counts.remarks(),
        missing,
        environment => Serde(view::environment(set)),
        broken => view::broken(shown).into_iter().map(|r| row(r, &r.id, pretty)).collect::<Value>(),
        limited => view::limited(shown).into_iter().map(|r| row(r, &r.id, pretty)).collect::<Value>(),
        opening => opening.iter().map(|figure| pictures(figure)).collect::<Value>(),
        suites => suites(shown, &opens, &pictures),
        timing => timed.map(pictures).collect::<Value>(),
        boards => Serde(if shown.records.iter().any(|r| r.suite == "plate") { stored_boards() } else { Vec::new() }),
        sources => sources(&shown.records),
        deviations => deviations(shown),
    };
    template::fill("report.html", TEMPLATE, page)
}

/// What a reader came for, as far as it is there: energies of the plate, its crack at the end, speed against
/// error, an order of convergence. Each stands here and not again in its suite.
fn opening(figures: &[Figure]) -> Vec<&Figure> {
    let is_field = |figure: &Figure| matches!(figure.body, FigureBody::Field { .. });
    let first = |wanted: &dyn Fn(&Figure) -> bool| figures.iter().find(|figure| wanted(figure));
    let converges =
        |f: &Figure, words: &str| f.suite == "convergence" && f.id.contains(words) && !f.id.ends_with("-unknowns");
    let wave = "standing-wave-square-displacement-error";
    let pictures = [
        first(&|f| f.id == "plate-elastic-energy"),
        figures.iter().rfind(|f| f.id.starts_with("plate-phase-") && is_field(f)),
        first(&|f| is_timing(f) && f.id.contains(wave)).or_else(|| first(&is_timing)),
        first(&|f| !is_timing(f) && converges(f, wave)).or_else(|| first(&|f| !is_timing(f) && converges(f, "error"))),
    ];
    pictures.into_iter().flatten().collect()
}

/// Figures that show measured time; the page has a section of its own for them.
fn is_timing(figure: &Figure) -> bool {
    figure.id.starts_with("timing/")
}

fn suites(set: &ResultSet, opens: &dyn Fn(&Figure) -> bool, picture: &dyn Fn(&Figure) -> Value) -> Value {
    let mut figures: HashMap<&str, Vec<&Figure>> = HashMap::new();
    for figure in set.figures.iter().filter(|f| !is_timing(f) && !opens(f)) {
        figures.entry(&figure.suite).or_default().push(figure);
    }
    let all = view::by_suite(set).into_iter();
    all.map(|(name, records)| suite(name, &records, &figures.remove(name).unwrap_or_default(), picture)).collect()
}

fn suite(name: &str, records: &[&Record], figures: &[&Figure], picture: &dyn Fn(&Figure) -> Value) -> Value {
    let counts = Counts::of(records.iter().copied());
    let cases = records.chunk_by(|a, b| a.case == b.case);
    context! {
        anchor => format!("suite-{}", slug(name)),
        name,
        counts => counts.list(),
        verdict => verdict(counts.verdict()),
        orders => orders(records),
        cases => cases.map(case).collect::<Value>(),
        figures => figures.iter().map(|figure| picture(figure)).collect::<Value>(),
    }
}

/// The rates of a suite, by case.
fn orders(records: &[&Record]) -> Value {
    let order = |rate: &Rate| {
        context! {
            anchor => format!("check-{}", slug(&rate.record.id)),
            verdict => verdict(rate.record.status),
            cells => rate.cells(pretty).to_vec(),
        }
    };
    let of_case = |rates: &[Rate]| {
        let first = rates[0].record;
        let id = format!("{}/{}", first.suite, first.case);
        context! { id, claim => &first.claim, rows => rates.iter().map(order).collect::<Value>() }
    };
    rates(records).chunk_by(|a, b| a.record.case == b.record.case).map(of_case).collect()
}

fn case(records: &[&Record]) -> Value {
    let first = records[0];
    let counts = Counts::of(records.iter().copied());
    let id = format!("{}/{}", first.suite, first.case);
    let mut series: Vec<String> = records.iter().filter_map(|r| r.series.clone()).collect();
    series.dedup();
    let run = |record| view::run_id(record).strip_prefix(id.as_str()).unwrap_or_default().trim_start_matches('/');
    let holding = match counts.judged() {
        0 => format!("{} shown", counts.info),
        judged if counts.known_limit == 0 => format!("{} of {judged}", counts.pass),
        judged => format!("{} of {judged}, known limits {}", counts.pass, counts.known_limit),
    };
    context! {
        anchor => format!("case-{}", slug(&id)),
        verdict => verdict(counts.verdict()),
        claim => &first.claim,
        holding,
        tier => &first.tier,
        models => first.models.join(", "),
        parameters => parameters(records),
        deviations => view::deviations(records).into_iter().collect::<Value>(),
        series => series.iter().map(|name| link(name)).collect::<Value>(),
        time => time(records),
        open => counts.fail + counts.error > 0,
        rows => records.iter().map(|r| row(r, run(r), pretty)).collect::<Value>(),
        id => &id,
    }
}

/// The parameters of every run of a case.
fn parameters(records: &[&Record]) -> Value {
    let runs = view::runs(records.iter().copied()).into_iter();
    let texts = runs.map(|(run, records)| (run, view::parameters(records[0]))).filter(|(_, text)| !text.is_empty());
    texts.map(|(run, text)| context! { run, text }).collect()
}

/// Measured time of a case in words: the sum over its runs, each measurement once.
fn time(records: &[&Record]) -> String {
    let timings = view::own_times(records);
    let wall: f64 = timings.iter().map(|t| t.wall_s).sum();
    let steps = timings.iter().fold(0u64, |sum, t| sum.saturating_add(t.particle_steps));
    if wall <= 0.0 {
        return String::new();
    }
    let per_step = || format!(", {} particle-steps at {} ns", grouped(steps), plain(1e9 * wall / steps as f64, 3));
    format!("{} of wall time{}", duration(wall), if steps > 0 { per_step() } else { String::new() })
}

fn picture(figure: &Figure, drawings: &Drawings, left_out: &BTreeSet<&str>) -> Value {
    let left_out = left_out.contains(figure.id.as_str());
    let (svg, error) = match drawings.get(&figure.id) {
        _ if left_out => ("", ""),
        Some(Ok(svg)) => (svg.as_str(), ""),
        Some(Err(error)) => ("", error.as_str()),
        None => ("", "it was not drawn"),
    };
    context! {
        anchor => format!("figure-{}", slug(&figure.id)),
        kind => if matches!(figure.body, FigureBody::Field { .. }) { "field" } else { "chart" },
        title => &figure.title,
        caption => &figure.caption,
        deviations => &figure.deviations,
        svg,
        left_out,
        error,
        file => link(&crate::figure::file_name(&figure.id).unwrap_or_default()),
        series => names(figure).iter().map(|name| link(name)).collect::<Value>(),
    }
}

/// A file of the folder as a link; without an address if its name is not plain, since that could lead
/// anywhere.
fn link(name: &str) -> Value {
    let encoded = |c: char| match c {
        '%' => "%25".into(),
        '#' => "%23".into(),
        '?' => "%3F".into(),
        ' ' => "%20".into(),
        c => c.to_string(),
    };
    let address: String = if is_plain(name) { name.chars().map(encoded).collect() } else { String::new() };
    context! { address, text => name.strip_prefix("series/").unwrap_or(name) }
}

/// What the records cite beyond closed forms and theory, each source once with the number of its checks.
fn sources(records: &[Record]) -> Value {
    let is_other = |r: &&Reference| matches!(r.kind, ReferenceKind::Literature | ReferenceKind::IndependentCode);
    let cited = records.iter().filter_map(|r| r.reference.as_ref()).filter(is_other);
    let source = |(text, checks): (&str, Vec<&Reference>)| {
        context! { text, kind => view::kind(checks[0]), checks => checks.len() }
    };
    view::by_key(cited.map(|reference| (reference.source.as_str(), reference))).into_iter().map(source).collect()
}

/// Every deviation from a cited source, with the cases that deviate.
fn deviations(set: &ResultSet) -> Value {
    let mut seen = HashSet::new();
    let said = set.records.iter().flat_map(|r| r.deviations.iter().map(move |text| (r, text)));
    let said = said.filter(|(record, text)| seen.insert((*text, &record.suite, &record.case)));
    let by_text = view::by_key(said.map(|(record, text)| {
        let case = format!("{}/{}", record.suite, record.case);
        (text.as_str(), (format!("case-{}", slug(&case)), case))
    }));
    by_text.into_iter().map(|(text, cases)| context! { text, cases => Serde(cases) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::results;

    #[test]
    fn a_page_that_would_be_too_large_names_figures_instead_of_drawing_them() {
        let set = results();
        let drawing = |f: &Figure| (f.id.clone(), Ok(format!("<svg>{}</svg>", "x".repeat(20_000))));
        let drawings: Drawings = set.figures.iter().map(drawing).collect();
        let whole = render_below(usize::MAX, &set, &drawings).unwrap();
        let below = render_below(whole.len() - 1_000, &set, &drawings).unwrap();
        assert!(below.len() < whole.len() - 1_000, "{} of {}", below.len(), whole.len());
        assert_eq!(below.matches("<svg>").count() + 1, whole.matches("<svg>").count());
        assert_eq!(below.matches("class=\"card left-out\"").count(), 1);
        assert!(!whole.contains("class=\"card left-out\""));
        assert_eq!(render_below(whole.len() + 1, &set, &drawings).unwrap(), whole);
    }
}
