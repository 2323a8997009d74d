//! The plate: error against cost, with the finite elements beside it, measured in the same run or stored.

use fisura_verification::bench::record::{BenchRecord, BenchSet, CostPoint, Spread};

use super::pareto::cost_of;
use super::ratios::{Found, Target};
use super::work_precision::{Chart, Cost, Line, error, lines};
use super::{Exhibit, Grid, Records};
use crate::number::{DIGITS, plain, pretty};

/// Ids of the finite elements that ran here.
const ELEMENTS: &str = "plate/elements/";
/// Errors of the kinetic energy that both reach, and how many times less time fisura should take.
const ERRORS: [f64; 2] = [0.02, 0.007];
const LESS_TIME: f64 = 5.0;
const AXIS: &str = "processor time of all threads (s)";

/// Diagram and table of the plate, and its tolerances.
pub fn exhibits(set: &BenchSet) -> Vec<Exhibit> {
    let records = Records(&set.records);
    let ours = lines(records.below("plate/p"));
    let Some(first) = ours.first().and_then(|line| line.records.first()) else { return Vec::new() };
    let elements = lines(records.below(ELEMENTS));
    let here = !elements.is_empty();
    let fem = if here { measured(&elements) } else { set.fem.clone() };
    let uncertainty = first.error.as_ref().map_or(0.0, |e| e.uncertainty);
    let particles: Vec<String> =
        ours.iter().flat_map(|l| &l.records).map(|r| format!("{}", r.number("particles").unwrap_or(0.0))).collect();
    let caption = format!(
        "Half plate to 80 µs, whole runs on {} threads; kinetic energy from 5 to 80 µs against {}; {} points",
        first.threads,
        first.error.as_ref().map_or("", |e| e.reference.as_str()),
        particles.join(", ")
    );
    let reading = reading(&ours, &fem, here, set.fem_unbuilt.as_deref());
    let rows = table(&ours, &elements, if here { &[] } else { &fem });
    let drawn: Vec<Line> = ours.into_iter().chain(elements).collect();
    let chart = Chart {
        id: "timing/plate-error-against-time".to_string(),
        title: "The plate: error against processor time".to_string(),
        lines: &drawn,
        front: None,
        fem: if here { &[] } else { &fem },
        cost: Cost::Time,
        axis: AXIS,
        uncertainty,
    };
    let mut exhibits = vec![chart.plot(&caption, reading), Exhibit::Grid(rows)];
    exhibits.extend(tolerances(records));
    exhibits
}

/// The finite elements that ran here on one thread.
fn measured(elements: &[Line]) -> Vec<CostPoint> {
    let of_one_thread = elements.iter().flat_map(|line| &line.records).filter(|record| record.threads == 1);
    let point = |record: &&BenchRecord| CostPoint {
        label: record.label.clone(),
        cpu_s: record.cpu_s.median,
        error: error(record),
        conditions: "this machine, in this run".into(),
    };
    of_one_thread.map(point).collect()
}

/// Every whole run, the cheapest first.
fn table(ours: &[Line], elements: &[Line], stored: &[CostPoint]) -> Grid {
    let row = |record: &&BenchRecord| {
        let cells = vec![
            record.label.clone(),
            record.number("h_over_l0").map_or("–".into(), |h| plain(h, 3)),
            record.threads.to_string(),
            plain(record.cpu_s.median, 3),
            plain(record.wall_s.median, 3),
            format!("{} %", plain(100.0 * error(record), 3)),
        ];
        (record.cpu_s.median, cells)
    };
    let mut rows: Vec<(f64, Vec<String>)> =
        ours.iter().chain(elements).flat_map(|line| &line.records).map(row).collect();
    rows.extend(stored.iter().map(|point| {
        let label = format!("{}, stored: {}", point.label, point.conditions);
        let error = format!("{} %", plain(100.0 * point.error, 3));
        (point.cpu_s, vec![label, "–".into(), "1".into(), plain(point.cpu_s, 3), "–".into(), error])
    }));
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let head = ["run", "h/l0", "threads", "processor s", "wall s", "error of the kinetic energy"];
    Grid {
        title: "The plate: what each error took".into(),
        head: head.map(String::from).to_vec(),
        rows: rows.into_iter().map(|(_, cells)| cells).collect(),
        note: "Medians of the rounds; the least processor time first.".into(),
    }
}

/// What the tolerance of the phase field does to the energies of the plate.
fn tolerances(records: Records) -> Option<Exhibit> {
    let found = records.below("plate/tolerance/");
    let lines = lines(found.iter().copied());
    let reference = found.first()?.error.as_ref()?;
    let caption = format!(
        "Half plate to 80 µs; {} (kinetic, elastic, fracture) from a run with {}",
        reference.quantity, reference.reference
    );
    let word = |r: &&BenchRecord| {
        let tolerance = r.id.rsplit('/').next().unwrap_or_default();
        format!("{tolerance}: {} % in {} s", pretty(100.0 * error(r), 2), pretty(Cost::Time.of(r).median, 3))
    };
    let reading = format!("Tolerance: {}.", found.iter().map(word).collect::<Vec<_>>().join("; "));
    let title = "The plate: tolerance of the phase field against processor time".to_string();
    let id = "timing/plate-tolerance-against-time".to_string();
    let chart =
        Chart { id, title, lines: &lines, front: None, fem: &[], cost: Cost::Time, axis: AXIS, uncertainty: 0.0 };
    Some(chart.plot(&caption, reading))
}

/// How many times less processor time than the finite elements the plate takes at some errors.
pub fn against_elements(records: Records) -> Vec<Found> {
    let of = |id: &str, threads: Option<usize>| {
        let chosen = records.below(id).into_iter().filter(|r| threads.is_none_or(|threads| r.threads == threads));
        lines(chosen)
    };
    let (ours, elements) = (of("plate/p", None), of(ELEMENTS, Some(1)));
    let factor = |error: f64| {
        let value = best(&elements, error)?.1 / best(&ours, error)?.1;
        let what = format!("finite elements over fisura, plate, error of {} %", plain(100.0 * error, 2));
        Some(Found { what, value: Spread::of([value]), target: Target::AtLeast(LESS_TIME), verified: true })
    };
    ERRORS.into_iter().filter_map(factor).collect()
}

/// The line that buys an error with the least time, and that time, s.
fn best<'a>(lines: &'a [Line], error: f64) -> Option<(&'a str, f64)> {
    let costs = lines.iter().filter_map(|l| Some((l.label.as_str(), cost_of(&l.points(Cost::Time), error)?)));
    costs.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// What our runs take at the errors of the finite elements, or the nearest that can be said.
fn reading(lines: &[Line], fem: &[CostPoint], here: bool, unbuilt: Option<&str>) -> String {
    let sentence = |point: &CostPoint| match best(lines, point.error) {
        Some((label, seconds)) => format!(
            "At the error of {} % that the finite elements bought with {} s, {label} takes {} s: {}.",
            pretty(100.0 * point.error, 2),
            pretty(point.cpu_s, DIGITS),
            pretty(seconds, 3),
            if seconds <= point.cpu_s {
                format!("{} times less", pretty(point.cpu_s / seconds, 2))
            } else {
                format!("{} times more", pretty(seconds / point.cpu_s, 2))
            }
        ),
        None => {
            let all = lines.iter().flat_map(|line| line.points(Cost::Time).into_iter().map(move |p| (line, p)));
            let least = all.min_by(|a, b| a.1.1.total_cmp(&b.1.1));
            let least = least.map_or(String::new(), |(line, (cost, error))| {
                format!(
                    " the smallest error is {} % ({}, {} s).",
                    pretty(100.0 * error, 2),
                    line.label,
                    pretty(cost, 3)
                )
            });
            format!("No curve here crosses the finite elements' error of {} %:{least}", pretty(100.0 * point.error, 2))
        }
    };
    if fem.is_empty() {
        return "There is nothing to compare with.".into();
    }
    let mut sentences: Vec<String> = fem.iter().map(sentence).collect();
    sentences.push(if here {
        "Both ran on this machine in the same rounds; the finite elements on one thread.".into()
    } else {
        "The machines differ (see the legend): read the factors as orders.".into()
    });
    sentences.extend(unbuilt.map(|why| format!("The finite elements could not be built here: {why}.")));
    sentences.join(" ")
}
