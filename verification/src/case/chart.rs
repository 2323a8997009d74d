//! The `[[chart]]` tables of a case file: what is drawn of its runs.

use schemars::JsonSchema;
use serde::Deserialize;

use super::value::{Column, Words};

/// A chart of columns of the histories of all runs.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "ChartTable", description = "As it stands in the file.")]
pub struct Chart {
    /// Last part of the id of the figure: `id = "energies"`.
    pub id: Words,
    /// What is shown.
    pub title: Words,
    /// A sentence below the figure.
    #[serde(default)]
    pub caption: String,
    /// Formula of columns along the abscissa.
    #[serde(default = "time")]
    pub x: Column,
    /// Labels of both axes: `axes = ["time (s)", "energy (J)"]`.
    pub axes: [Words; 2],
    /// What is drawn: `curves = [{ label = "", column = "kinetic_j" }]`.
    pub curves: Vec<ChartCurve>,
}

/// A curve of every run.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "CurveTable", description = "")]
pub struct ChartCurve {
    /// Name beside that of the run.
    #[serde(default)]
    pub label: String,
    /// Formula of columns: `column = "kinetic_j"`.
    pub column: Column,
    /// Whether it is a closed form and no result.
    #[serde(default)]
    pub exact: bool,
}

fn time() -> Column {
    Column("time_s".into())
}
