//! Figures and reports of the fisura verification harness, as pure functions of its records.
//!
//! [`render`] takes a results folder (`results.json`, `series/*.csv`) and writes beside it what people and machines
//! read. Nothing here runs a simulation, reads a clock or judges a value: the same results give the same bytes.
//!
//! | file | for | module |
//! |---|---|---|
//! | `figures/*.svg` | papers and pages | [`figure`], [`chart`], [`field`] |
//! | `report.html` | a reader with a browser | [`html`] |
//! | `summary.md` | the step summary of a CI run | [`markdown`] |
//! | `junit.xml` | the test view of a CI service | [`junit`] |
//! | `metrics.json` | trend charts over commits | [`metrics`] |
//!
//! [`compare`] holds two such sets side by side, [`annotations`] marks failed checks in the view of a CI service.
//!
//! [`paper`] finds the figures of the source paper, [`bundle`] writes a figure with its numbers, caption and provenance.
//!
//! [`vtk`] writes the files that ParaView opens.
//!
//! [`text`] prints the verdict on a terminal, [`run_report`] draws the pictures of a single run, [`mod@bench`] the benchmarks. Below them lie
//! [`series`] (the numbers behind figures and what can be wrong with them), [`axis`] (ranges and ticks), [`colour`]
//! (the map of fields), [`number`] (digits as they are printed), [`rates`] (orders of convergence among records) and
//! [`view`] (verdicts in words, records in groups).

pub mod annotations;
pub mod axis;
pub mod bench;
pub mod bundle;
pub mod chart;
pub mod colour;
pub mod compare;
pub mod error;
pub mod field;
pub mod figure;
pub mod html;
pub mod junit;
pub mod markdown;
pub mod metrics;
pub mod number;
pub mod paper;
pub mod rates;
pub mod run_report;
pub mod series;
pub mod text;
pub mod view;
pub mod vtk;

mod compact;
mod frame;
mod guides;
mod legend;
mod regions;
mod style;
mod svg;
mod trace;

use std::fs;
use std::path::{Path, PathBuf};

use fisura_verification::output;
use fisura_verification::record::{ResultSet, SCHEMA};
use serde::de::DeserializeOwned;

pub use error::ReportError;
pub use series::{FigureError, SeriesSet};

use html::Drawings;

/// What [`render`] wrote.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendered {
    /// The results that were read.
    pub results: ResultSet,
    /// Files written, relative to the folder, in the order in which they were written.
    pub files: Vec<PathBuf>,
}

/// Renders the results in `folder`: figures, `report.html`, `summary.md`, `junit.xml`, `metrics.json`, each written
/// under a temporary name first.
///
/// # Errors
/// `results.json` is missing, malformed or of another schema, or a file cannot be written. Figures that cannot be drawn
/// give [`ReportError::Figures`] with all of them, after everything else was written; the page says so in their place.
pub fn render(folder: &Path) -> Result<Rendered, ReportError> {
    let results = read_results(folder)?;
    let series = SeriesSet::load(folder, &results.figures);
    let mut files = Vec::new();
    let mut drawings = Drawings::new();
    let mut broken = Vec::new();
    for figure in &results.figures {
        let drawn = figure::file_name(&figure.id).and_then(|name| Ok((name, figure::render_figure(figure, &series)?)));
        let drawing = match drawn {
            Ok((name, svg)) => {
                files.push(write(folder, &name, &svg)?);
                Ok(svg)
            }
            Err(error) => {
                let words = error.to_string();
                broken.push(error);
                Err(words)
            }
        };
        drawings.insert(figure.id.clone(), drawing);
    }
    let page = html::render_html(&results, &drawings).map_err(|e| failed("report.html", e))?;
    files.push(write(folder, "report.html", &page)?);
    files.push(write(folder, "summary.md", &markdown::render_markdown(&results))?);
    let junit = junit::render_junit(&results).map_err(|e| failed("junit.xml", e))?;
    files.push(write(folder, "junit.xml", &junit)?);
    let metrics = metrics::render_metrics(&results).map_err(|e| failed("metrics.json", e))?;
    files.push(write(folder, "metrics.json", &metrics)?);
    if broken.is_empty() { Ok(Rendered { results, files }) } else { Err(ReportError::Figures(broken)) }
}

/// Reads `results.json` of a folder.
///
/// # Errors
/// The file is missing, malformed or of another schema.
pub fn read_results(folder: &Path) -> Result<ResultSet, ReportError> {
    read_json(folder.join("results.json"), SCHEMA)
}

/// Reads a JSON document that names its schema.
fn read_json<T: DeserializeOwned>(path: PathBuf, schema: &'static str) -> Result<T, ReportError> {
    let text = fs::read_to_string(&path).map_err(|source| ReportError::File { path: path.clone(), source })?;
    let malformed = |e: serde_json::Error| ReportError::Results { path: path.clone(), message: e.to_string() };
    let value: serde_json::Value = serde_json::from_str(&text).map_err(malformed)?;
    let found = value.get("schema").and_then(|s| s.as_str()).unwrap_or_default().to_string();
    if found != schema {
        return Err(ReportError::Schema { path, found, expected: schema });
    }
    // read from the text again, so that the error has line and column
    serde_json::from_str(&text).map_err(malformed)
}

fn failed(file: &'static str, error: impl std::fmt::Display) -> ReportError {
    ReportError::Render { file, message: error.to_string() }
}

/// Writes a file of the folder.
fn write(folder: &Path, name: &str, content: &str) -> Result<PathBuf, ReportError> {
    let path = folder.join(name);
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(|source| ReportError::File { path: parent.into(), source })?;
    }
    output::write(&path, content)?;
    Ok(PathBuf::from(name))
}

#[cfg(test)]
#[path = "../tests/fixture/mod.rs"]
mod example;
