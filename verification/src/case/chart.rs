//! The `[[chart]]` tables of a case file: what is drawn of its runs.

use schemars::JsonSchema;
use serde::Deserialize;

use super::value::{Column, Words};

/// A chart of columns of the histories of all runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Last part of its id.
    pub id: String,
    /// Title.
    pub title: String,
    /// Caption.
    pub caption: String,
    /// Formula of the abscissa.
    pub x: String,
    /// Labels of both axes.
    pub axes: [String; 2],
    /// What is drawn against the abscissa.
    pub curves: Vec<ChartCurve>,
}

/// A curve of every run.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartCurve {
    /// Name beside that of the run.
    pub label: String,
    /// Formula of the ordinate.
    pub column: String,
    /// Whether it is a closed form and no result.
    pub exact: bool,
}

/// As it stands in the file.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ChartTable {
    /// Last part of the id of the figure: `id = "energies"`.
    id: Words,
    /// What is shown.
    title: Words,
    /// A sentence below the figure.
    #[serde(default)]
    caption: String,
    /// Formula of columns along the abscissa.
    #[serde(default = "time")]
    x: Column,
    /// Labels of both axes: `axes = ["time (s)", "energy (J)"]`.
    axes: [Words; 2],
    /// What is drawn: `curves = [{ label = "", column = "kinetic_j" }]`.
    curves: Vec<CurveTable>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CurveTable {
    /// Name beside that of the run.
    #[serde(default)]
    label: String,
    /// Formula of columns: `column = "kinetic_j"`.
    column: Column,
    /// Whether it is a closed form and no result.
    #[serde(default)]
    exact: bool,
}

fn time() -> Column {
    Column("time_s".into())
}

impl From<ChartTable> for Chart {
    fn from(table: ChartTable) -> Self {
        let curve = |table: CurveTable| ChartCurve { label: table.label, column: table.column.0, exact: table.exact };
        Self {
            id: table.id.0,
            title: table.title.0,
            caption: table.caption,
            x: table.x.0,
            axes: table.axes.map(|label| label.0),
            curves: table.curves.into_iter().map(curve).collect(),
        }
    }
}
