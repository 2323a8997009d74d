//! The numbers behind the figures, and what can be wrong with them.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use fisura_verification::output::foreign;
use fisura_verification::output::history::Table;
use fisura_verification::record::{Figure, FigureBody};
use thiserror::Error;

/// A figure that cannot be drawn.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("figure {figure}: {message}")]
pub struct FigureError {
    /// Id of the figure that cannot be drawn.
    pub figure: String,
    /// Why, with the series and its column.
    pub message: String,
}

impl FigureError {
    pub(crate) fn new(figure: &str, message: impl Into<String>) -> Self {
        Self { figure: figure.to_string(), message: message.into() }
    }

    /// The rows of a field do not form the raster that the figure declares.
    pub(crate) fn raster(figure: &str, series: &str, message: &str) -> Self {
        Self::new(figure, format!("series {series} is not a raster: {message}"))
    }
}

/// Most bytes of all series of one report.
pub(crate) const MOST_BYTES: u64 = 512 << 20;

/// Series tables by their name relative to the results folder.
#[derive(Debug, Clone, Default)]
pub struct SeriesSet {
    tables: BTreeMap<String, Result<Table, String>>,
}

impl SeriesSet {
    /// Adds a table under a name such as `series/plate.csv`.
    pub fn insert(&mut self, name: impl Into<String>, table: Table) {
        self.tables.insert(name.into(), Ok(table));
    }

    /// Reads every series that the figures name. A file that cannot be read is remembered with its error,
    /// which comes up when a figure asks for it.
    pub fn load<'a>(folder: &Path, figures: impl IntoIterator<Item = &'a Figure>) -> Self {
        let mut set = Self::default();
        let mut left = MOST_BYTES;
        for name in figures.into_iter().flat_map(names) {
            set.tables.entry(name).or_insert_with_key(|name| read(folder, name, &mut left));
        }
        set
    }

    /// Rows from which a figure is drawn, those of each curve for itself.
    pub(crate) fn rows(&self, figure: &Figure) -> usize {
        let rows = |series: &String| self.tables.get(series).and_then(|t| t.as_ref().ok()).map_or(0, Table::rows);
        match &figure.body {
            FigureBody::Chart { curves, .. } => curves.iter().map(|curve| rows(&curve.series)).sum(),
            FigureBody::Field { series, .. } => rows(series),
        }
    }

    /// The table of that name, for a figure.
    pub fn table(&self, figure: &str, series: &str) -> Result<&Table, FigureError> {
        let fail = |why: &str| FigureError::new(figure, format!("series {series} cannot be read: {why}"));
        match self.tables.get(series) {
            Some(Ok(table)) => Ok(table),
            Some(Err(message)) => Err(fail(message)),
            None => Err(fail("it was not loaded")),
        }
    }

    /// A column of a table, for a figure.
    pub fn column(&self, figure: &str, series: &str, column: &str) -> Result<&[f64], FigureError> {
        let table = self.table(figure, series)?;
        table.column(column).ok_or_else(|| {
            let present = table.names.join(", ");
            FigureError::new(figure, format!("series {series} has no column {column:?}; it has {present}"))
        })
    }
}

/// Reads one series; `left` is what all of them may still have, bytes.
pub(crate) fn read(folder: &Path, name: &str, left: &mut u64) -> Result<Table, String> {
    let bytes = foreign::read(folder, name, foreign::SERIES_BYTES).map_err(|e| e.to_string())?;
    *left = left.checked_sub(bytes.len() as u64).ok_or("the series of one report have more than 512 MiB")?;
    Table::parse(name, bytes.as_slice()).map_err(|e| foreign::line(&e.message).into_owned())
}

/// Names of the series behind a figure, each once, in the order of its curves.
pub fn names(figure: &Figure) -> Vec<String> {
    match &figure.body {
        FigureBody::Chart { curves, .. } => {
            let mut seen = HashSet::new();
            let first = curves.iter().filter(|curve| seen.insert(curve.series.as_str()));
            first.map(|curve| curve.series.clone()).collect()
        }
        FigureBody::Field { series, .. } => vec![series.clone()],
    }
}
