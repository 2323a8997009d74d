//! The plate: error against cost for fisura and the finite elements that ran beside it.

use fisura_verification::bench::plate_error::{QUANTITIES, Quantity};
use fisura_verification::bench::record::{AnswerError, BenchRecord, BenchSet};

use super::work_precision::{Chart, Cost, Line, error, lines};
use super::{Exhibit, Records, plate_match};
use crate::number::{plain, pretty};

/// Ids of runs: equal spans and the tolerance of the suite, graded spans, the finite elements.
pub(super) const EQUAL: &str = "plate/equal/";
pub(super) const GRADED: &str = "plate/graded/";
pub(super) const ELEMENTS: &str = "plate/elements/";
const AXIS: &str = "processor time (s)";

/// Diagrams and tables of the plate, and its tolerances.
pub fn exhibits(set: &BenchSet) -> Vec<Exhibit> {
    let records = Records(&set.records);
    let (graded, equal) = ([GRADED, ELEMENTS].map(|id| records.below(id)).concat(), records.below(EQUAL));
    let mut exhibits = Vec::new();
    if !graded.is_empty() {
        let reading = plate_match::reading(records, set.fem_unbuilt.as_deref());
        let title = "The plate: error against processor time";
        exhibits.push(chart("timing/plate-error-against-time", title, &lines(graded.iter().copied()), reading));
        exhibits.push(plate_match::table(records, set.fem_unbuilt.as_deref()));
        exhibits.push(table(&[graded.as_slice(), &equal].concat()));
    }
    if !equal.is_empty() {
        let lines = lines(equal.iter().copied());
        let title = "The plate: degrees on equal spans, tolerance of the suite";
        exhibits.push(chart("timing/plate-degrees", title, &lines, finest(&lines)));
    }
    exhibits.extend(tolerances(records));
    exhibits
}

fn chart(id: &str, title: &str, lines: &[Line], reading: String) -> Exhibit {
    let first = lines.iter().flat_map(|line| &line.records).find_map(|record| record.error.as_ref());
    let caption = format!(
        "Half plate to 80 µs, whole runs on one thread; kinetic energy from 5 to 80 µs against {}",
        first.map_or("", |e| e.reference.as_str())
    );
    let uncertainty = first.map_or(0.0, |e| e.uncertainty);
    Chart { uncertainty, ..Chart::of_time(id, title, lines, AXIS) }.plot(&caption, reading)
}

fn finest(lines: &[Line]) -> String {
    let sentence = |line: &Line| {
        let last = line.records.last()?;
        let (value, seconds) = (pretty(100.0 * error(last), 2), plain(last.cpu_s.median, 3));
        Some(format!("{}, h = {} l0: {value} %, {seconds} s.", line.label, plain(last.number("h_over_l0")?, 3)))
    };
    lines.iter().filter_map(sentence).collect::<Vec<_>>().join(" ")
}

/// The error of a record in a quantity.
pub(super) fn error_in<'a>(record: &'a BenchRecord, quantity: &Quantity) -> Option<&'a AnswerError> {
    record.errors().find(|error| error.quantity.starts_with(quantity.name))
}

/// An error or uncertainty and its unit for people.
pub(super) fn shown(value: f64, unit: &str) -> String {
    if unit.is_empty() { format!("{} %", plain(100.0 * value, 2)) } else { format!("{} {unit}", plain(value, 2)) }
}

/// Every whole run with all its errors, the cheapest first.
fn table(records: &[&BenchRecord]) -> Exhibit {
    let mut records = records.to_vec();
    records.sort_by(|a, b| a.cpu_s.median.total_cmp(&b.cpu_s.median));
    let row = |record: &&BenchRecord| {
        let of = |quantity: &Quantity| {
            error_in(record, quantity).map_or("–".to_string(), |error| shown(error.value, &error.unit))
        };
        let h = record.number("h_over_l0").map_or("–".into(), |h| plain(h, 3));
        let mut cells = vec![record.label.clone(), h, plain(record.cpu_s.median, 3)];
        cells.extend(QUANTITIES.iter().map(of));
        cells
    };
    let name = |quantity: &Quantity| {
        let error = records.iter().find_map(|record| error_in(record, quantity));
        error.map_or(quantity.name.to_string(), |e| format!("{} (U {})", quantity.name, shown(e.uncertainty, &e.unit)))
    };
    let mut head = ["run", "h/l0", "processor s"].map(String::from).to_vec();
    head.extend(QUANTITIES.iter().map(name));
    let note = "Relative rms from 5 µs to 80 µs; for the increment of the fracture energy since t = 0, from 30 µs; for the crack tip, rms in \
                mm. U: uncertainty of the reference in the same norm; an error below U is not significant. Times: medians of the rounds.";
    Exhibit::grid("The plate: time and errors of each run", &head, records.iter().map(row), note)
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
    let title = "The plate: tolerance of the phase field against processor time";
    Some(Chart::of_time("timing/plate-tolerance-against-time", title, &lines, AXIS).plot(&caption, reading))
}
