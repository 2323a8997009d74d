//! Charts of studies, and those that a case asks for.

use super::scene::{FinishedScene, series_stem};
use crate::case::{Case, Chart};
use crate::output::history::Table;
use crate::record::{Axis, Curve, CurveStyle, Figure, FigureBody};

/// Most rows of a series that is drawn and not judged.
const MOST_ROWS: usize = 400;

/// A curve of two columns of a series.
pub(super) fn curve(label: &str, stem: &str, columns: [&str; 2], style: CurveStyle) -> Curve {
    Curve { style, ..Curve::line(label, &format!("series/{stem}.csv"), columns) }
}

/// A chart of all scenes of a case.
pub(super) fn chart(
    case: &Case,
    name: &str,
    title: &str,
    caption: &str,
    axes: [&str; 2],
    curves: Vec<Curve>,
) -> Figure {
    let (id, title) = (series_stem(case, name), format!("{title}, {}", case.label));
    let body = FigureBody::chart(axes.map(Axis::linear), curves, Vec::new());
    Figure::new(&case.suite, [&id, &title, caption], body)
}

/// The charts that a case asks for, of the runs that have a history, and their series.
pub fn of_case(case: &Case, finished: &[FinishedScene]) -> (Vec<Figure>, Vec<(String, Table)>) {
    let (mut figures, mut series) = (Vec::new(), Vec::new());
    for wanted in &case.charts {
        let mut curves = Vec::new();
        for run in finished {
            let name = &run.case_scene.name;
            let own = if name.is_empty() { wanted.id.0.clone() } else { format!("{name}-{}", wanted.id.0) };
            let stem = series_stem(case, &own);
            let Ok(table) = rows(wanted, run) else { continue }; // it broke down before it started
            for (drawn, column) in wanted.curves.iter().zip(&table.names[1..]) {
                let style = if drawn.exact { CurveStyle::Reference } else { CurveStyle::Line };
                let label = [name.as_str(), &drawn.label].into_iter().filter(|part| !part.is_empty());
                let label = label.collect::<Vec<_>>().join(": ");
                curves.push(curve(&label, &stem, [&table.names[0], column], style));
            }
            series.push((stem, table));
        }
        let [x, y] = wanted.axes.each_ref().map(|label| label.0.as_str());
        figures.push(chart(case, &wanted.id.0, &wanted.title.0, &wanted.caption, [x, y], curves));
    }
    (figures, series)
}

/// What a chart draws of a run: the abscissa, and every curve.
fn rows(wanted: &Chart, run: &FinishedScene) -> Result<Table, String> {
    let run = run.as_run();
    let formulas = std::iter::once(&wanted.x).chain(wanted.curves.iter().map(|curve| &curve.column));
    let columns = formulas.map(|formula| run.column(&formula.0)).collect::<Result<Vec<_>, _>>()?;
    let names: Vec<String> = (0..columns.len()).map(|i| if i == 0 { "x".into() } else { format!("y{i}") }).collect();
    let every = columns[0].len().div_ceil(MOST_ROWS).max(1);
    let thinned = columns.into_iter().map(|column| column.into_iter().step_by(every).collect());
    Ok(Table { names, columns: thinned.collect() })
}
