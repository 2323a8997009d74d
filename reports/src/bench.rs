//! The report of `cargo xtask bench`: figures, tables and readings of a folder with `bench.json`.
//!
//! [`render`] writes `samples.csv` (every sample), `figures/timing/*.svg`, `summary.md` (with links to the
//! figures) and `bench.html` (figures inline). Everything is a pure function of `bench.json`:
//! [`work_precision`], [`plate`](mod@plate), [`plate_match`], [`stages`], [`contact`], [`motion`], [`scale`]
//! and [`conditions`] make the exhibits, [`ratios`] holds the targets, [`bars`] draws bars, [`page`] puts it
//! together.

pub mod bars;
pub mod conditions;
pub mod contact;
pub mod motion;
pub mod page;
pub mod pareto;
pub mod plate;
pub mod plate_match;
pub mod ratios;
pub mod scale;
pub mod scoreboard;
pub mod stages;
pub mod work_precision;

use std::path::{Path, PathBuf};

use fisura_verification::bench::record::{BenchRecord, BenchSet, SCHEMA, Spread};
use fisura_verification::output::OutputFolder;
use fisura_verification::record::{Axis, Curve, Figure, FigureBody, Floor};

use crate::error::ReportError;
use crate::figure::render_figure;
use crate::number::plain;
use crate::series::{FigureError, SeriesSet};
use crate::{failed, read_json, write};

/// Most records of a set.
const MOST_RECORDS: usize = 10_000;

/// A figure with what it says.
#[derive(Debug, Clone)]
pub struct Plot {
    /// File name without ending, below `timing/`.
    pub id: String,
    /// Title above the figure.
    pub title: String,
    /// Text below the figure: what was run, and how.
    pub caption: String,
    /// A sentence computed from the numbers.
    pub reading: String,
    /// The drawing, or why there is none.
    pub svg: Result<String, FigureError>,
}

/// A table with what it says.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Title above the table.
    pub title: String,
    /// Names of the columns.
    pub head: Vec<String>,
    /// Rows of the table, with a cell for each column.
    pub rows: Vec<Vec<String>>,
    /// What to know about it.
    pub note: String,
}

/// Something in a section.
#[derive(Debug, Clone)]
pub enum Exhibit {
    /// A figure with its caption and reading.
    Plot(Plot),
    /// A table with its title and note.
    Grid(Grid),
}

impl Exhibit {
    /// A table from its title, the names of its columns, its rows and its note.
    fn grid(
        title: &str,
        head: &[impl ToString],
        rows: impl IntoIterator<Item = Vec<String>>,
        note: impl Into<String>,
    ) -> Self {
        let head = head.iter().map(ToString::to_string).collect();
        Self::Grid(Grid { title: title.into(), head, rows: rows.into_iter().collect(), note: note.into() })
    }

    /// A chart of curves on two logarithmic axes.
    fn log_log(
        words: [&str; 3],
        axes: [&str; 2],
        curves: Vec<Curve>,
        floors: Vec<Floor>,
        (set, reading): (&SeriesSet, String),
    ) -> Self {
        let [x, y] = axes.map(Axis::logarithmic);
        let body = FigureBody::Chart { x, y, curves, regions: Vec::new(), slopes: Vec::new(), floors };
        let figure = Figure::new("bench", words, body);
        let svg = render_figure(&figure, set);
        let Figure { id, title, caption, .. } = figure;
        Self::Plot(Plot { id, title, caption, reading, svg })
    }
}

/// Least and largest value in words.
fn range(spread: Spread) -> String {
    format!("{} to {}", plain(spread.min, 3), plain(spread.max, 3))
}

/// A part of the report.
#[derive(Debug, Clone)]
pub struct Section {
    /// Title of this part of the report.
    pub title: String,
    /// What it shows, in order.
    pub exhibits: Vec<Exhibit>,
}

/// The records of a set, found by id or family. What is drawn, read off or compared goes by [`Self::get`] and
/// [`Self::below`], which leave out records whose answers do not hold; [`page::all_records`] lists those.
#[derive(Debug, Clone, Copy)]
pub struct Records<'a>(pub &'a [BenchRecord]);

impl<'a> Records<'a> {
    /// The record of that id, whether or not its answer holds.
    pub fn find(self, id: &str) -> Option<&'a BenchRecord> {
        self.0.iter().find(|record| record.id == id)
    }

    /// The record of that id, if its answer holds.
    pub fn get(self, id: &str) -> Option<&'a BenchRecord> {
        self.find(id).filter(|record| record.verified)
    }

    /// All records whose id begins so and whose answers hold.
    pub fn below(self, prefix: &str) -> Vec<&'a BenchRecord> {
        self.0.iter().filter(|record| record.verified && record.id.starts_with(prefix)).collect()
    }
}

/// All sections that have something to show.
pub fn sections(set: &BenchSet) -> Vec<Section> {
    let records = Records(&set.records);
    let one = |exhibit: Option<Exhibit>| Vec::from_iter(exhibit);
    let parts = [
        ("Targets", one(ratios::exhibit(records))),
        ("Work and precision", work_precision::exhibits(records)),
        ("The plate", plate::exhibits(set)),
        ("Other benchmarks", scoreboard::exhibits(records)),
        ("Time of a step by phase", stages::exhibits(records)),
        ("Solving for the phase field", stages::solves(records)),
        ("Threads", one(conditions::threads(records))),
        ("Ceilings", one(conditions::ceilings(records))),
        ("Collisions", contact::exhibits(records)),
        ("Points that cross spans", one(motion::exhibit(records))),
        ("Scaling from ten thousand to sixteen million points", scale::exhibits(records)),
        ("Cost of declared models", one(conditions::scenes(records))),
        ("Another checkout", one(conditions::baseline(records))),
        ("Other codes", conditions::peers(set)),
        ("All records", vec![page::all_records(set)]),
    ];
    let named = parts.into_iter().filter(|(_, exhibits)| !exhibits.is_empty());
    named.map(|(title, exhibits)| Section { title: title.into(), exhibits }).collect()
}

/// Whether a folder holds benchmarks.
pub fn is_bench(folder: &Path) -> bool {
    folder.join("bench.json").is_file()
}

/// Reads `bench.json` of a folder.
///
/// # Errors
/// The file is missing, malformed or of another schema.
pub fn read(folder: &Path) -> Result<BenchSet, ReportError> {
    let set: BenchSet = read_json(folder, "bench.json", SCHEMA)?;
    if set.records.len() > MOST_RECORDS {
        let message = format!("{} records; at most {MOST_RECORDS} are read", set.records.len());
        return Err(ReportError::file(folder.join("bench.json"), message));
    }
    Ok(set)
}

/// Writes `bench.json`.
///
/// # Errors
/// If it cannot be written.
pub fn store(out: &OutputFolder, set: &BenchSet) -> Result<PathBuf, ReportError> {
    out.write_json("bench.json", set)?;
    Ok("bench.json".into())
}

/// Renders the benchmarks in `folder` to `out`, which may be the same; names the files written, relative to
/// that.
///
/// # Errors
/// `bench.json` cannot be read, or a file cannot be written. Figures that cannot be drawn give
/// [`ReportError::Figures`], after everything else was written.
pub fn render(folder: &Path, out: &OutputFolder) -> Result<Vec<PathBuf>, ReportError> {
    let set = read(folder)?;
    let sections = sections(&set);
    let old = out.files().into_iter().filter(|name| name.starts_with("figures/timing/"));
    old.into_iter().try_for_each(|name| out.remove(&name))?;
    let mut files = vec![write(out, "samples.csv", &page::samples(&set))?];
    let mut broken = Vec::new();
    for exhibit in sections.iter().flat_map(|section| &section.exhibits) {
        let Exhibit::Plot(plot) = exhibit else { continue };
        match &plot.svg {
            Ok(svg) => files.push(write(out, &page::file(plot), svg)?),
            Err(error) => broken.push(error.clone()),
        }
    }
    files.push(write(out, "summary.md", &page::markdown(&set, &sections))?);
    let html = page::html(&set, &sections).map_err(|e| failed("bench.html", e))?;
    files.push(write(out, "bench.html", &html)?);
    if broken.is_empty() { Ok(files) } else { Err(ReportError::Figures(broken)) }
}
