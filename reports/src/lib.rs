//! Figures and reports of the fisura verification harness, as pure functions of its records.
//!
//! [`render`] takes a results folder (`results.json`, `series/*.csv`) and writes beside it what people and
//! machines read. Nothing here runs a simulation, reads a clock or judges a value: the same results give the
//! same bytes. Results may come from anywhere: what is opened, linked, printed and drawn of them is bounded,
//! see [`fisura_verification::output::foreign`].
//!
//! | file | for | module |
//! |---|---|---|
//! | `figures/*.svg` | papers and pages | [`figure`], [`chart`], [`field`] |
//! | `report.html` | a reader with a browser | [`html`] |
//! | `summary.md` | the step summary of a CI run | [`markdown`] |
//! | `junit.xml` | the test view of a CI service | [`junit`] |
//! | `metrics.json` | trend charts over commits | [`metrics`] |
//! | `metrics/` | dashboards, in the form of each | [`dashboards`] |
//!
//! [`compare`] holds two such sets side by side, [`annotations`] marks failed checks in the view of a CI
//! service.
//!
//! [`animation`] draws moving pictures, [`docs`] writes the generated parts of README and book.
//!
//! [`paper`] finds the figures of the source paper, [`bundle`] writes a figure with its numbers, caption and
//! provenance.
//!
//! [`judge`] shows verdicts on results of other codes, and the errors of all of them.
//!
//! [`vtk`] writes the files that ParaView opens.
//!
//! [`text`] prints the verdict on a terminal, [`run_report`] draws the pictures of a single run,
//! [`mod@bench`] the benchmarks. Below them lie [`series`] (the numbers behind figures and what can be wrong
//! with them), [`axis`] (ranges and ticks), [`colour`] (the map of fields), [`number`] (digits as they are
//! printed), [`rates`] (orders of convergence among records), [`view`] (verdicts in words, records in groups)
//! and [`template`] (documents from templates).

pub mod animation;
pub mod annotations;
pub mod axis;
pub mod bench;
pub mod bundle;
pub mod chart;
pub mod colour;
pub mod compare;
pub mod dashboards;
pub mod docs;
pub mod error;
pub mod field;
pub mod figure;
pub mod html;
pub mod judge;
pub mod junit;
pub mod markdown;
pub mod metrics;
pub mod number;
pub mod paper;
pub mod rates;
pub mod run_report;
pub mod series;
pub mod template;
pub mod text;
pub mod view;
pub mod vtk;

mod canvas;
mod frame;
mod guides;
mod legend;
mod regions;
mod style;
mod svg;
mod thin;
mod trace;

use std::path::{Path, PathBuf};

use fisura_verification::output::OutputFolder;
use fisura_verification::output::foreign;
use fisura_verification::record::{Figure, ResultSet, SCHEMA};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

pub use error::ReportError;
pub use series::{FigureError, SeriesSet};

use html::Drawings;

/// Most records and figures of a result set.
const MOST: [usize; 2] = [50_000, 5_000];
/// Most rows that the curves and pictures of one report are drawn from.
const MOST_ROWS: usize = 50_000_000;

/// What [`render`] wrote.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendered {
    /// The results that were read.
    pub results: ResultSet,
    /// Files written, relative to their folder, in the order in which they were written.
    pub files: Vec<PathBuf>,
}

/// Renders the results in `folder` to `out`, which may be the same: figures, `report.html`, `summary.md`,
/// `junit.xml`, `metrics.json`, `metrics/`.
///
/// # Errors
/// `results.json` is missing, malformed or of another schema, or a file cannot be written. Figures that
/// cannot be drawn give [`ReportError::Figures`] with all of them, after everything else was written; the
/// page says so in their place.
pub fn render(folder: &Path, out: &OutputFolder) -> Result<Rendered, ReportError> {
    let results = read_results(folder)?;
    let series = SeriesSet::load(folder, &results.figures);
    let mut files = Vec::new();
    let mut drawings = Drawings::new();
    let mut broken = Vec::new();
    let mut rows = 0;
    for figure in &results.figures {
        let drawing = match draw(figure, &series, &mut rows) {
            Ok((name, svg)) => {
                files.push(write(out, &name, &svg)?);
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
    files.push(write(out, "report.html", &page)?);
    files.push(write(out, "summary.md", &markdown::render_markdown(&results))?);
    let junit = junit::render_junit(&results).map_err(|e| failed("junit.xml", e))?;
    files.push(write(out, "junit.xml", &junit)?);
    let metrics = metrics::render_metrics(&results).map_err(|e| failed("metrics.json", e))?;
    files.push(write(out, "metrics.json", &metrics)?);
    for (name, content) in dashboards::files(&results) {
        files.push(write(out, &format!("metrics/{name}"), &content)?);
    }
    if broken.is_empty() { Ok(Rendered { results, files }) } else { Err(ReportError::Figures(broken)) }
}

/// Name of the file of a figure and its drawing; `rows` counts what all figures so far have drawn.
fn draw(figure: &Figure, series: &SeriesSet, rows: &mut usize) -> Result<(String, String), FigureError> {
    let name = figure::file_name(&figure.id)?;
    *rows += series.rows(figure);
    if *rows > MOST_ROWS {
        let message = format!("this figure and those before it have more than {MOST_ROWS} rows");
        return Err(FigureError::new(&figure.id, message));
    }
    Ok((name, figure::render_figure(figure, series)?))
}

/// Reads `results.json` of a folder. Its texts are those of the file without characters that steer a
/// terminal, on one line and of bounded length.
///
/// # Errors
/// The file is missing, no regular file, malformed, of another schema, or too large.
pub fn read_results(folder: &Path) -> Result<ResultSet, ReportError> {
    let set: ResultSet = read_json(folder, "results.json", SCHEMA)?;
    let counts = [set.records.len(), set.figures.len()];
    if counts[0] > MOST[0] || counts[1] > MOST[1] {
        let ([records, figures], [most, most_figures]) = (counts, MOST);
        let message = format!("{records} records and {figures} figures; at most {most} and {most_figures} are read");
        return Err(ReportError::file(folder.join("results.json"), message));
    }
    Ok(set)
}

/// The one key that every document has.
#[derive(Deserialize)]
struct Named {
    #[serde(default)]
    schema: String,
}

/// Reads a JSON document that names its schema, with clean texts.
fn read_json<T: DeserializeOwned + Serialize>(
    folder: &Path,
    name: &str,
    schema: &'static str,
) -> Result<T, ReportError> {
    let path = folder.join(name);
    let bytes = foreign::read(folder, name, foreign::DOCUMENT_BYTES);
    let bytes = bytes.map_err(|e| ReportError::file(&path, e))?;
    let malformed = |e: serde_json::Error| ReportError::file(&path, e);
    let found = serde_json::from_slice::<Named>(&bytes).map_err(malformed)?.schema;
    if found != schema {
        let found = foreign::line(&found);
        let message = format!("schema {found:?} is not {schema:?}; render it with the version of fisura that wrote it");
        return Err(ReportError::file(path, message));
    }
    let document: T = serde_json::from_slice(&bytes).map_err(malformed)?;
    let mut value = serde_json::to_value(document).map_err(malformed)?;
    foreign::clean(&mut value);
    serde_json::from_value(value).map_err(malformed)
}

fn failed(file: &'static str, error: impl std::fmt::Display) -> ReportError {
    ReportError::file(file, format!("cannot be rendered: {error}"))
}

/// Writes a file of the folder.
fn write(out: &OutputFolder, name: &str, content: &str) -> Result<PathBuf, ReportError> {
    out.write(name, content)?;
    Ok(PathBuf::from(name))
}

#[cfg(test)]
#[path = "../tests/integration/fixture/mod.rs"]
mod example;
