//! The `[[chart]]` tables of a case file: what is drawn of its runs.

use super::check::read_column;
use crate::scene::fields::Item;

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

/// One of the tables.
pub(super) fn read(item: &Item<'_>) -> Option<Chart> {
    let fields = item.fields(&["id", "title", "caption", "x", "axes", "curves"])?;
    let id = fields.need("id", "id = \"energies\"", Item::words);
    let title = fields.need("title", "title = \"what is shown\"", Item::words);
    let caption = fields.or("caption", String::new(), Item::text);
    let x = fields.or("x", "time_s".to_string(), read_column);
    let axes = fields.need("axes", "axes = [\"time (s)\", \"energy (J)\"]", |item| {
        let axes = item.each(Item::words)?;
        axes.try_into().ok().or_else(|| item.fail("there are two axes", "give the label of x and that of y"))
    });
    let curves = fields.need("curves", "curves = [{ label = \"\", column = \"kinetic_j\" }]", |item| {
        item.tables()?.iter().map(read_curve).collect()
    });
    Some(Chart { id: id?, title: title?, caption: caption?, x: x?, axes: axes?, curves: curves? })
}

fn read_curve(item: &Item<'_>) -> Option<ChartCurve> {
    let fields = item.fields(&["label", "column", "exact"])?;
    let label = fields.or("label", String::new(), Item::text);
    let column = fields.need("column", "column = \"kinetic_j\"", read_column);
    let exact = fields.or("exact", false, Item::flag);
    Some(ChartCurve { label: label?, column: column?, exact: exact? })
}
