//! Phases of the step and solvers, as bars.

use fisura_verification::bench::record::BenchRecord;

use super::bars::BarChart;
use super::{Exhibit, Records, range};
use crate::number::{plain, pretty};

/// Degrees that are drawn side by side.
const DEGREES: [usize; 2] = [2, 3];

/// Bars of the phases, of the whole steps, and of the plate.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let whole = |record: &BenchRecord| record.id.contains("step");
    let [steps, phases] = [true, false].map(|of_steps| {
        let all = records.below("stages/p2/").into_iter().filter(|r| whole(r) == of_steps);
        all.map(|r| r.id.trim_start_matches("stages/p2/").to_string()).collect::<Vec<_>>()
    });
    if steps.is_empty() {
        return Vec::new();
    }
    let of_step = |names: &[String], id: &str, title: &str, reading: String| {
        bars(records, names, ["stages/p", id, title, "time per particle-step (ns)"], 1.0, reading)
    };
    let mut exhibits = vec![
        of_step(&phases, "timing/stages", "Phases of the step", reading_of_phases(records)),
        of_step(&steps, "timing/steps", "Whole steps", reading_of_steps(records)),
    ];
    exhibits.extend(shares(records));
    exhibits
}

/// A bar for each phase, p = 2 and 3 side by side; in words the ids of the records up to the degree, id and
/// title of the figure and its axis.
fn bars(records: Records, names: &[String], words: [&str; 4], scale: f64, reading: String) -> Exhibit {
    let [prefix, id, title, axis] = words;
    let of = |degree: usize, name: &str| records.get(&format!("{prefix}{degree}/{name}"));
    let row = |name: &String| {
        let label = of(DEGREES[0], name).map_or(name.clone(), |r| r.label.clone());
        (label, DEGREES.map(|p| of(p, name).map(|r| r.ns_per_unit.scaled(scale))).to_vec())
    };
    let chart = BarChart {
        id: id.into(),
        title: title.into(),
        axis: axis.into(),
        series: DEGREES.map(|p| format!("p = {p}")).to_vec(),
        rows: names.iter().map(row).collect(),
    };
    let drawn: Vec<&BenchRecord> = names.iter().flat_map(|name| DEGREES.map(|p| of(p, name))).flatten().collect();
    let caption = conditions(&drawn);
    chart.exhibit(caption, reading)
}

/// What the records have in common, or each value of it.
fn conditions(drawn: &[&BenchRecord]) -> String {
    let all = |values: Vec<f64>| {
        let mut values = values;
        values.sort_by(f64::total_cmp);
        values.dedup();
        values.iter().map(|v| v.to_string()).collect::<Vec<_>>().join(" or ")
    };
    let numbers = |name: &str| all(drawn.iter().filter_map(|record| record.number(name)).collect());
    let what = match (numbers("cells"), numbers("unknowns")) {
        (n, unknowns) if n.is_empty() => format!("{unknowns} unknowns"),
        (n, _) => {
            let points = numbers("points_per_direction");
            format!("block of {n} × {n} spans with {points} × {points} points")
        }
    };
    let rounds = all(drawn.iter().map(|record| record.samples.len() as f64).collect());
    format!("{what}, one thread, processor time; bars: median of {rounds} rounds, whiskers: minimum and maximum")
}

fn median(records: Records, id: &str) -> Option<f64> {
    Some(records.get(id)?.ns_per_unit.median)
}

fn reading_of_phases(records: Records) -> String {
    let sentence = |p: usize| -> Option<String> {
        let of = |phase: &str| median(records, &format!("stages/p{p}/{phase}"));
        let sweeps = of("history-sweep")? + of("stress-sweep")?;
        let split = sweeps - of("history-sweep-no-split")? - of("stress-sweep-no-split")?;
        Some(format!(
            "p = {p}: the history and stress sweeps take {} ns per particle-step, {} times the elastic sweep. The spectral split is {} % \
             of them. Assembly of the whole matrix takes {} times as long as both.",
            pretty(sweeps, 3),
            pretty(sweeps / of("elastic-sweep")?, 2),
            pretty(100.0 * split / sweeps, 2),
            pretty(of("assembly")? / sweeps, 2)
        ))
    };
    DEGREES.into_iter().filter_map(sentence).collect::<Vec<_>>().join(" ")
}

fn reading_of_steps(records: Records) -> String {
    let sentence = |p: usize| -> Option<String> {
        let of = |phase: &str| median(records, &format!("stages/p{p}/{phase}"));
        let kernel = of("minimal-step")?;
        Some(format!(
            "p = {p}: an elastic step of moving points takes {} times the {} ns of the minimal kernel. An elastic step of the total frame, \
             in which points do not move, takes {} ns.",
            pretty(of("elastic-step-updated")? / kernel, 2),
            pretty(kernel, 3),
            pretty(of("elastic-step")?, 3)
        ))
    };
    DEGREES.into_iter().filter_map(sentence).collect::<Vec<_>>().join(" ")
}

/// The part of the phase field in a step of the plate.
fn shares(records: Records) -> Option<Exhibit> {
    let (step, field) = (records.get("plate/share/step")?, records.get("plate/share/phase-field")?);
    let row = |name: &str, median: f64, range: String| vec![name.to_string(), plain(median, 3), range];
    let [of_step, of_field] = [step, field].map(|record| record.ns_per_unit.median);
    let rows = [
        row("the whole step", of_step, range(step.ns_per_unit)),
        row("phase field: assembly and solve", of_field, range(field.ns_per_unit)),
        row("remainder: difference of the medians", of_step - of_field, "–".into()),
    ];
    let note = format!(
        "{} points, one thread, {} steps; the phase field is {} % of the median step. {}.",
        step.number("particles").unwrap_or(0.0),
        step.samples.len(),
        plain(100.0 * of_field / of_step, 3),
        step.answer
    );
    let head = ["part", "ns per particle-step", "steps"];
    Some(Exhibit::grid("A step of the plate during crack growth", &head, rows, note))
}

/// Bars of the solvers, for a length scale of one span and of two.
pub fn solves(records: Records) -> Vec<Exhibit> {
    [1, 2].into_iter().filter_map(|spans| solves_of(records, spans)).collect()
}

fn solves_of(records: Records, spans: usize) -> Option<Exhibit> {
    let prefix = format!("solves/p2/l{spans}/");
    let names: Vec<String> =
        records.below(&prefix).iter().map(|r| format!("l{spans}/{}", r.id.trim_start_matches(&prefix))).collect();
    names.first()?;
    let sentence = |p: usize| -> Option<String> {
        let of = |name: &str| records.get(&format!("solves/p{p}/l{spans}/{name}"));
        let (incomplete, jacobi, direct) = (of("incomplete-cholesky")?, of("jacobi")?, of("cholesky")?);
        let time = |record: &BenchRecord| record.ns_per_unit.median;
        Some(format!(
            "p = {p}: incomplete Cholesky needs {} iterations, and Jacobi needs {}. With its factorisation, incomplete Cholesky is {} \
             times as fast as Jacobi. The direct solver takes {} times as long as incomplete Cholesky.",
            incomplete.number("iterations")?,
            jacobi.number("iterations")?,
            pretty(time(jacobi) / time(incomplete), 2),
            pretty(time(direct) / time(incomplete), 2)
        ))
    };
    let reading = DEGREES.into_iter().filter_map(sentence).collect::<Vec<_>>().join(" ");
    let axis = "time of a solve from c = 1, factorisation included (ms)";
    let length = if spans == 1 { "h = l0" } else { "h = l0/2" };
    let (id, title) = (format!("timing/solves-l{spans}"), format!("Phase field of a cold crack, {length}"));
    Some(bars(records, &names, ["solves/p", &id, &title, axis], 1e-6, reading))
}
