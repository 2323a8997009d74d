//! Error against cost: processor time, particle-steps, memory; with the front of what nothing beats.

use fisura_verification::bench::record::{BenchRecord, Spread};
use fisura_verification::output::history::Table;
use fisura_verification::record::{Curve, CurveStyle, Floor};

use super::pareto::{cost_of, cost_to_reach, front};
use super::{Exhibit, Records};
use crate::number::{plain, pretty};
use crate::series::SeriesSet;
use crate::svg::slug;
use crate::view::by_key;

/// Cost against which errors are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cost {
    Time,
    ParticleSteps,
    Memory,
}

impl Cost {
    const ALL: [Self; 3] = [Self::Time, Self::ParticleSteps, Self::Memory];

    pub(super) fn of(self, record: &BenchRecord) -> Spread {
        let exactly = |value: f64| Spread { median: value, min: value, max: value };
        match self {
            Self::Time => record.cpu_s,
            Self::ParticleSteps => exactly(record.work.amount),
            Self::Memory => exactly(record.memory_bytes as f64 / 1e6),
        }
    }

    /// Name in ids, label of the axis, unit in sentences.
    fn words(self) -> [&'static str; 3] {
        match self {
            Self::Time => ["time", "processor time of the steps (s)", "s"],
            Self::ParticleSteps => ["particle-steps", "particle-steps", "particle-steps"],
            Self::Memory => ["memory", "memory of the model (MB)", "MB"],
        }
    }
}

/// One curve: a label and its points.
pub(super) struct Line<'a> {
    pub label: String,
    pub records: Vec<&'a BenchRecord>,
}

impl Line<'_> {
    /// Cost and error of each verified point.
    pub(super) fn points(&self, cost: Cost) -> Vec<(f64, f64)> {
        self.records.iter().map(|r| (cost.of(r).median, error(r))).collect()
    }
}

pub(super) fn error(record: &BenchRecord) -> f64 {
    record.error.as_ref().map_or(f64::NAN, |error| error.value)
}

/// What the last mesh of every line gave: its error, with so many `spans` ("spans per radius"), and its time.
pub(super) fn on_finest(lines: &[Line], spans: &str) -> String {
    let sentence = |line: &Line| {
        let last = line.records.last()?;
        let (value, count) = (pretty(error(last), 2), last.number("spans")?);
        Some(format!("{}: {value} with {count} {spans}, {} s.", line.label, plain(last.cpu_s.median, 3)))
    };
    lines.iter().filter_map(sentence).collect::<Vec<_>>().join(" ")
}

/// Errors at which two groups of lines are compared.
const ERRORS: [f64; 6] = [0.05, 0.02, 0.01, 0.008, 0.005, 0.003];

/// The line that reaches an error in the least time, s.
pub(super) fn fastest_to(group: &[&Line], error: f64) -> Option<(String, f64)> {
    let cost = |line: &&Line| Some((line.label.clone(), cost_to_reach(&line.points(Cost::Time), error)?));
    group.iter().filter_map(cost).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// What the best lines of two groups take to an error that both reach, and the ratio.
pub(super) fn at_equal_error(groups: [Vec<&Line>; 2]) -> String {
    let sentence = |&error: &f64| {
        let ((first, slow), (second, fast)) = (fastest_to(&groups[0], error)?, fastest_to(&groups[1], error)?);
        let [percent, slow_s, fast_s, ratio] = [100.0 * error, slow, fast, slow / fast].map(|value| plain(value, 2));
        Some(format!("For an error of {percent} %: {first}, {slow_s} s; {second}, {fast_s} s; ratio {ratio}."))
    };
    ERRORS.iter().filter_map(sentence).collect::<Vec<_>>().join(" ")
}

/// Records whose answers hold, by label, in the order in which labels appear.
pub(super) fn lines<'a>(records: impl IntoIterator<Item = &'a BenchRecord>) -> Vec<Line<'a>> {
    let known = records.into_iter().filter(|r| r.verified && error(r).is_finite());
    let by_label = by_key(known.map(|record| (record.label.as_str(), record)));
    by_label.into_iter().map(|(label, records)| Line { label: label.to_string(), records }).collect()
}

/// The diagrams of the manufactured problem: a figure for each group of curves and each cost.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let all = records.below("work-precision/");
    let groups = by_key(all.iter().filter_map(|r| Some((r.parameters.get("group")?.as_str()?, *r))));
    let mut exhibits = Vec::new();
    for cost in Cost::ALL {
        let front = Line { label: "front of all methods".into(), records: frontier(&all, cost) };
        for (group, records) in &groups {
            let lines = lines(records.iter().copied());
            if lines.is_empty() {
                continue;
            }
            let [name, axis, _] = cost.words();
            let id = format!("timing/work-precision-{}-{name}", slug(group));
            let title = format!("Standing wave, {group}: error against {axis}");
            let chart = Chart { id, title, lines: &lines, front: Some(&front), cost, axis, uncertainty: 0.0 };
            let reading = reading(&lines, &front, cost);
            let bars = if cost == Cost::Time { "; bars: minimum and maximum of the rounds" } else { "" };
            exhibits.push(chart.plot(&format!("2-D standing wave on rollers, one thread{bars}"), reading));
        }
    }
    exhibits
}

/// The records that no other beats, from the cheapest to the most accurate.
fn frontier<'a>(records: &[&'a BenchRecord], cost: Cost) -> Vec<&'a BenchRecord> {
    let usable: Vec<&BenchRecord> = records.iter().copied().filter(|r| r.verified).collect();
    let points: Vec<(f64, f64)> = usable.iter().map(|r| (cost.of(r).median, error(r))).collect();
    front(&points).into_iter().map(|i| usable[i]).collect()
}

/// Everything a diagram is drawn from.
pub(super) struct Chart<'a> {
    pub id: String,
    pub title: String,
    pub lines: &'a [Line<'a>],
    pub front: Option<&'a Line<'a>>,
    pub cost: Cost,
    pub axis: &'a str,
    /// Relative uncertainty of the reference.
    pub uncertainty: f64,
}

impl<'a> Chart<'a> {
    /// Errors against processor time, the axis in words; of references without uncertainty.
    pub(super) fn of_time(id: &str, title: &str, lines: &'a [Line<'a>], axis: &'a str) -> Self {
        let [id, title] = [id, title].map(String::from);
        Self { id, title, lines, front: None, cost: Cost::Time, axis, uncertainty: 0.0 }
    }

    pub(super) fn plot(&self, caption: &str, reading: String) -> Exhibit {
        let mut set = SeriesSet::default();
        let mut curves = Vec::new();
        for (number, line) in self.lines.iter().enumerate() {
            curves.push(self.curve(number, line, CurveStyle::Markers, &mut set));
        }
        if let Some(front) = self.front.filter(|front| !front.records.is_empty()) {
            curves.push(self.curve(self.lines.len(), front, CurveStyle::Reference, &mut set));
        }
        let quantity = self.lines.iter().flat_map(|line| &line.records).find_map(|r| r.error.as_ref());
        let quantity = quantity.map_or("error", |error| error.quantity.as_str());
        let floor = Floor { y: self.uncertainty, label: "uncertainty of the reference".into() };
        let floors = if self.uncertainty > 0.0 { vec![floor] } else { vec![] };
        let words = [self.id.as_str(), &self.title, caption];
        Exhibit::log_log(words, [self.axis, quantity], curves, floors, (&set, reading))
    }

    fn curve(&self, number: usize, line: &Line, style: CurveStyle, set: &mut SeriesSet) -> Curve {
        let mut table = Table::new(&["cost", "error", "cost_min", "cost_max"]);
        for record in &line.records {
            let Spread { median, min, max } = self.cost.of(record);
            table.push(&[median, error(record), min, max]);
        }
        if style == CurveStyle::Reference || self.cost != Cost::Time {
            table.names.truncate(2);
            table.columns.truncate(2);
        }
        let series = format!("{}-{number}", self.id);
        set.insert(series.clone(), table);
        Curve { style, ..Curve::line(&line.label, &series, ["cost", "error"]) }
    }
}

/// Decades of error that are read off.
const DECADES: std::ops::RangeInclusive<i32> = 1..=12;

/// Which curve is the cheapest at each decade of error, and what the next one takes; and which touch the
/// front.
fn reading(lines: &[Line], front: &Line, cost: Cost) -> String {
    let mut sentences: Vec<String> = DECADES.filter_map(|k| cheapest(lines, 10f64.powi(-k), cost)).collect();
    if sentences.is_empty() {
        sentences.push("No curve crosses a power of ten of the error.".into());
    }
    let touches = |line: &&Line| line.records.iter().any(|r| front.records.iter().any(|f| f.id == r.id));
    let touching: Vec<&str> = lines.iter().filter(touches).map(|line| line.label.as_str()).collect();
    sentences.push(match touching.as_slice() {
        [] => "None of these curves is on the front of all methods.".into(),
        touching => format!("On the front of all methods: {}.", touching.join("; ")),
    });
    sentences.join(" ")
}

/// The cheapest curve at an error and the next, if a curve reaches it.
fn cheapest(lines: &[Line], error: f64, cost: Cost) -> Option<String> {
    let mut costs: Vec<(&str, f64)> =
        lines.iter().filter_map(|l| Some((l.label.as_str(), cost_of(&l.points(cost), error)?))).collect();
    costs.sort_by(|a, b| a.1.total_cmp(&b.1));
    let first = costs.first()?;
    let beside = match costs.get(1) {
        Some(next) => format!("; next {}, {} times as much", next.0, pretty(next.1 / first.1, 3)),
        None => "; no other curve reaches it".into(),
    };
    let unit = cost.words()[2];
    Some(format!("Error {}: {}, {} {unit}{beside}.", pretty(error, 1), first.0, pretty(first.1, 3)))
}
