//! Measures on the history of a run: what a check of a scene study can ask for.
//!
//! Energies are those of the whole body: a half model's are doubled first (`energy_factor` of the case).

pub mod grid_convergence;
mod series;
mod table;
mod tip;

use std::collections::BTreeMap;

use fisura::fault;
use fisura::output::picture::Picture;
use fisura::scene::Scene;

use crate::case::Check;
use crate::case::formula::{Formula, Name, Reduction};
use crate::extremes;
use crate::output::history::Table;
use crate::record::{Discretisation, Reference};
use crate::reference::Library;

use table::Question;
pub use table::{LooksAt, MEASURES, Measure, find};
pub use tip::{chord, fitted_speed, grown};

/// A finished run of a scene, as measures see it.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// Name of the variant.
    pub name: &'a str,
    /// Scene that was run.
    pub scene: &'a Scene,
    /// History of the run: a column for each quantity, a row for each sample.
    pub history: &'a Table,
    /// Pictures at the frames of the scene, in the order of time.
    pub frames: &'a [Picture],
    /// Factor from its energies to those of the whole body.
    pub energy_factor: f64,
    /// Values of the case.
    pub values: &'a BTreeMap<String, f64>,
}

/// What a measure found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measured {
    /// Value in the unit of the check; absent if what it asks for did not happen.
    pub value: Option<f64>,
    /// What it is held against, if the measure knows.
    pub reference: Option<Reference>,
    /// Why there is no value, if the measure knows.
    pub message: Option<String>,
    /// Discretisation error of the value.
    pub discretisation: Option<Discretisation>,
}

impl Measured {
    fn of(value: Option<f64>) -> Self {
        Self { value, ..Self::default() }
    }
}

/// What a name in a formula stands for.
enum Named<'a> {
    Number(f64),
    /// A column, times a factor.
    Column(&'a [f64], f64),
}

impl Named<'_> {
    fn at(&self, row: usize) -> f64 {
        match self {
            Self::Number(value) => *value,
            Self::Column(values, factor) => factor * values[row],
        }
    }
}

impl Run<'_> {
    /// Times of the rows of the history, s.
    pub fn times(&self) -> Result<&[f64], String> {
        self.history.column("time_s").ok_or_else(|| "the history has no column time_s".to_string())
    }

    /// A formula of columns, row by row; energies are those of the whole body.
    pub fn column(&self, formula: &str) -> Result<Vec<f64>, String> {
        let formula: Formula = formula.parse()?;
        let found = formula.names().map(|name| self.named(name)).collect::<Result<Vec<_>, _>>()?;
        let mut row = vec![0.0; found.len()];
        let rows = (0..self.history.rows()).map(|index| {
            row.iter_mut().zip(&found).for_each(|(value, named)| *value = named.at(index));
            formula.value(&row)
        });
        Ok(rows.collect())
    }

    /// A formula of values, and of what is found from columns.
    pub fn number(&self, formula: &Formula) -> Result<f64, String> {
        formula.number(&mut |name| match self.named(name)? {
            Named::Number(value) => Ok(value),
            Named::Column(..) => Err(format!("{name:?} is a column where a number is needed")),
        })
    }

    fn named(&self, name: Name<'_>) -> Result<Named<'_>, String> {
        match name {
            Name::Of(reduction, columns) => {
                let values = self.column(columns)?;
                let found = match reduction {
                    Reduction::Initial => values.first().copied(),
                    Reduction::Final => values.last().copied(),
                    Reduction::Largest => Some(extremes::largest(values.iter().map(|v| v.abs()))),
                };
                found.map(Named::Number).ok_or_else(|| "an empty history".to_string())
            }
            Name::Key(key) => Err(format!("name the scene's {{{key}}} in [values]")),
            Name::Plain(name) => {
                if let Some(column) = self.history.column(name) {
                    let half = name.ends_with("_j");
                    let factor = if half { fault!("half-model-not-doubled", self.energy_factor => 1.0) } else { 1.0 };
                    return Ok(Named::Column(column, factor));
                }
                let columns = || self.history.names.join(", ");
                let missing = || format!("the history has no column {name:?}; it has {}", columns());
                self.values.get(name).copied().map(Named::Number).ok_or_else(missing)
            }
        }
    }

    /// Increment of a column since t = 0.
    fn increment(&self, name: &str) -> Result<Vec<f64>, String> {
        let values = self.column(name)?;
        let start = values.first().copied().unwrap_or(0.0);
        Ok(values.iter().map(|v| v - start).collect())
    }

    /// Rows within the window of a check.
    fn window(&self, check: &Check) -> Result<std::ops::Range<usize>, String> {
        let times = self.times()?;
        let slack = 1e-9 * times.last().copied().unwrap_or(0.0);
        let start = times.partition_point(|&t| t < check.window[0] - slack);
        let end = times.partition_point(|&t| t <= check.window[1] + slack);
        if start < end { Ok(start..end) } else { Err("no sample lies between from and to".to_string()) }
    }
}

/// Measures what `check` asks of `run`; `runs` are all variants of the case.
///
/// # Errors
/// If the measure or something it needs does not exist.
pub fn measure(check: &Check, run: &Run, runs: &[Run], library: &Library) -> Result<Measured, String> {
    let numbers = check.with_numbers(&|formula| run.number(formula));
    let check = &numbers.map_err(|(key, message)| format!("{key}: {message}"))?;
    let measure = find(check.measure.as_deref())?;
    let measured = (measure.find)(&Question { check, run, runs, library })?;
    let value = measured.value.filter(|v| v.is_finite()).map(|v| v * check.scale);
    let reference = match measure.compares_curves() {
        true => measured.reference,
        false => held_against(check, check.scale, library)?.or(measured.reference),
    };
    let stated = check.discretisation.map(|error| Discretisation {
        value: (error * check.scale).abs(),
        from: "the order and the constant that the check states".to_string(),
    });
    Ok(Measured { value, reference, discretisation: stated.or(measured.discretisation), ..measured })
}

/// What the value of a check is held against, times `factor`: its expected value, or what the library has
/// under `reference`.
fn held_against(check: &Check, factor: f64, library: &Library) -> Result<Option<Reference>, String> {
    let Some(path) = check.reference.as_deref().filter(|_| check.expect.is_none()) else {
        return Ok(expected(check, factor));
    };
    library.reference(path, check.at, factor).map(Some)
}

/// The expected value of a check as a reference, times `factor`.
pub fn expected(check: &Check, factor: f64) -> Option<Reference> {
    let uncertainty = check.uncertainty.map(|u| u * factor.abs());
    let of = |value| Reference::new(Some(value * factor), check.expect_kind, &check.expect_source);
    check.expect.map(|value| Reference { uncertainty, side: check.expect_side, ..of(value) })
}

fn column(check: &Check) -> Result<&str, String> {
    check.column.as_deref().ok_or_else(|| "this measure needs column = \"…\"".to_string())
}

fn position(check: &Check) -> Result<f64, String> {
    check.at.ok_or_else(|| "this measure needs at = …".to_string())
}
