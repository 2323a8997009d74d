//! Figures of runs of scenes, each with every reference curve of its quantity.
//!
//! Reference curves are looked up by quantity at the time of drawing, so a curve added to the reference data
//! appears without a change of code.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::measure::fitted_speed;
use crate::output::history::Table;
use crate::record::{Axis, Curve, Figure, FigureBody, Region};
use crate::reference::{Library, ReferenceCurve};
use crate::study::scene::{PictureInfo, RunInfo};

/// A chart of one quantity against time, over all runs of a suite.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Quantity {
    id: String,
    title: String,
    label: String,
    /// Column of the history or of the derived series.
    column: String,
    #[serde(default)]
    derived: bool,
    /// Factor from SI to the unit of the axis; 1 if absent.
    #[serde(default = "one")]
    scale: f64,
    /// Reference curves with this quantity are drawn.
    reference: String,
    /// Bands of the events to mark.
    #[serde(default)]
    bands: Vec<String>,
}

#[derive(Debug, Deserialize)]
struct Charts {
    /// Terms of the ledger, drawn as far as a run has them.
    ledger: Vec<String>,
    chart: Vec<Quantity>,
}

/// Charts of the plate under impact.
static PLATE: LazyLock<Charts> = LazyLock::new(|| {
    toml::from_str(include_str!("../../templates/plate-charts.toml"))
        .expect("plate-charts.toml lists charts; every run of the plate reads it")
});

fn one() -> f64 {
    1.0
}

/// Charts and pictures of all runs, and the tables they need beyond those of the runs. Variants of one case,
/// such as the meshes of a study, have charts of their own.
pub fn of_runs(runs: &[RunInfo], library: &Library) -> (Vec<Figure>, Vec<(String, Table)>) {
    let (mut figures, mut tables) = (Vec::new(), Vec::new());
    let of_plate = runs.iter().filter(|r| r.suite == "plate");
    let (plates, variants): (Vec<&RunInfo>, Vec<&RunInfo>) = of_plate.partition(|r| r.variant.is_empty());
    if !plates.is_empty() {
        for quantity in &PLATE.chart {
            figures.push(chart(quantity, "plate", &plates, library, &mut tables));
        }
    }
    for runs in variants.chunk_by(|a, b| a.case == b.case) {
        for quantity in &PLATE.chart {
            let case = &runs[0].case;
            let figure = chart(quantity, &format!("plate-{case}"), runs, library, &mut tables);
            figures.push(Figure { title: format!("{}: {}", figure.title, case.replace('-', " ")), ..figure });
        }
    }
    let mut suites: Vec<&str> = runs.iter().map(|r| r.suite.as_str()).collect();
    suites.dedup();
    for suite in suites {
        figures.push(closure_chart(suite, runs));
    }
    for run in &plates {
        figures.push(ledger(run));
        figures.extend(pictures(run));
    }
    (figures, tables)
}

/// Draws the reference curves of the fracture energy of two rings into its figures; the tables they need.
pub fn add_references(figures: &mut [Figure], library: &Library) -> Vec<(String, Table)> {
    let mut tables = Vec::new();
    for figure in figures.iter_mut().filter(|f| f.suite == "rings" && f.id.ends_with("fracture-energy")) {
        let FigureBody::Chart { curves, .. } = &mut figure.body else { continue };
        for reference in library.curves("rings/fracture-energy") {
            let (curve, table) = reference.series(1e6, 1.0);
            tables.push((stem(&curve), table));
            curves.push(curve);
        }
    }
    tables
}

/// File name without ending of the series of a curve.
fn stem(curve: &Curve) -> String {
    curve.series.trim_start_matches("series/").trim_end_matches(".csv").to_string()
}

/// One quantity of some runs beside its references; ids begin with `prefix`.
fn chart(
    quantity: &Quantity,
    prefix: &str,
    runs: &[&RunInfo],
    library: &Library,
    tables: &mut Vec<(String, Table)>,
) -> Figure {
    let mut curves = Vec::new();
    for reference in library.curves(&quantity.reference) {
        let (mut curve, mut table) = reference.series(1e6, quantity.scale);
        if quantity.id == "tip-speed" {
            (curve, table) = speed_of(reference, curve);
        }
        tables.push((stem(&curve), table));
        curves.push(curve);
    }
    for run in runs {
        let energy = quantity.column.ends_with("_j");
        let scale = quantity.scale * if energy { run.energy_factor } else { 1.0 };
        let series = if quantity.derived { run.derived() } else { run.series.clone() };
        curves.push(Curve::history(&run.label, &series, &quantity.column, scale));
    }
    let bands = quantity.bands.iter().filter_map(|name| library.band("plate-events", name));
    let regions =
        bands.map(|b| Region { label: b.name.replace('-', " "), x: Some([b.min * 1e6, b.max * 1e6]), y: None });
    let body = FigureBody::over_time(&quantity.label, curves, regions.collect());
    let id = format!("{prefix}-{}", quantity.id);
    Figure { deviations: deviations(runs), ..Figure::new("plate", [&id, &quantity.title, &captions(runs)], body) }
}

/// Speed of a reference tip, fitted as that of the runs; its uncertainty is that of two positions 4 µs apart.
fn speed_of(reference: &ReferenceCurve, position: Curve) -> (Curve, Table) {
    let row = |&time: &f64| [time, fitted_speed(&reference.x, &reference.y, time)];
    let table = Table::of_rows(&["x", "y"], reference.x.iter().map(row));
    let uncertainty_absolute = reference.uncertainty_absolute / 4e-6;
    let series = position.series.replace("tip-x", "tip-speed");
    (Curve { series, y_scale: 1.0, uncertainty_absolute, uncertainty_relative: 0.0, ..position }, table)
}

/// Resolution of every run.
fn captions(runs: &[&RunInfo]) -> String {
    let each = runs.iter().map(|run| format!("{}: {}", run.label, run.resolution));
    format!("{}.", each.collect::<Vec<_>>().join("; "))
}

fn deviations(runs: &[&RunInfo]) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for deviation in runs.iter().flat_map(|run| &run.deviations) {
        if !all.contains(deviation) {
            all.push(deviation.clone());
        }
    }
    all
}

/// Closure of the ledger over the largest energy so far, for every run of a suite.
fn closure_chart(suite: &str, runs: &[RunInfo]) -> Figure {
    let of_suite: Vec<&RunInfo> = runs.iter().filter(|r| r.suite == suite).collect();
    let curves = of_suite.iter().map(|run| {
        let label = if run.variant.is_empty() { run.case.clone() } else { format!("{}: {}", run.case, run.variant) };
        Curve::line(&label, &run.derived(), ["time_over_end", "closure_over_largest"])
    });
    let axes = ["time / end time", "closure / largest energy"].map(Axis::linear);
    let caption = "Sum of all named terms of the ledger, over the largest energy of the run.";
    let id = format!("{suite}-ledger-closure");
    let body = FigureBody::chart(axes, curves.collect(), Vec::new());
    Figure::new(suite, [&id, "Closure of the energy ledger", caption], body)
}

/// Every term of the ledger of one run.
fn ledger(run: &RunInfo) -> Figure {
    let present = PLATE.ledger.iter().filter(|term| run.columns.contains(term));
    let curves = present.map(|term| Curve::energy(&run.series, term, run.energy_factor)).collect();
    let body = FigureBody::over_time("energy (J/m)", curves, Vec::new());
    of_run(run, format!("plate-ledger-{}", run.case), "Energy ledger", "", body)
}

fn of_run(run: &RunInfo, id: String, title: &str, remark: &str, body: FigureBody) -> Figure {
    let words = [&id, &format!("{title}, {}", run.label), &format!("{}.{remark}", run.resolution)];
    Figure { deviations: run.deviations.clone(), ..Figure::new(&run.suite, words.map(String::as_str), body) }
}

/// Phase-field pictures of one run.
fn pictures(run: &RunInfo) -> Vec<Figure> {
    let half = if run.energy_factor == 2.0 { " Upper half of a symmetric plate." } else { "" };
    let figure = |picture: &PictureInfo| {
        let time = picture.time * 1e6;
        let body = FigureBody::phase_field(picture.series.clone(), picture.pixels);
        let id = format!("plate-phase-{}-{time:.0}us", run.case);
        of_run(run, id, &format!("Phase field at {time:.1} µs"), half, body)
    };
    run.pictures.iter().map(figure).collect()
}
