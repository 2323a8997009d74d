//! Any figure as SVG.

use fisura_verification::output::foreign::is_plain;
use fisura_verification::record::{Figure, FigureBody};

use crate::chart::{Marks, render_chart};
use crate::field::{Raster, render_field};
use crate::series::{FigureError, SeriesSet};

/// Draws a figure as SVG; the series it names must be in `set`. The same input gives the same bytes.
///
/// # Errors
/// Names the figure, the series and the column at fault.
pub fn render_figure(figure: &Figure, set: &SeriesSet) -> Result<String, FigureError> {
    file_name(&figure.id)?;
    match &figure.body {
        FigureBody::Chart { x, y, curves, regions, slopes, floors } => {
            render_chart(figure, [x, y], curves, Marks { regions, slopes, floors }, set)
        }
        FigureBody::Field { series, pixels, label, range } => {
            let raster = Raster::read(&figure.id, series, *pixels, set)?;
            render_field(figure, &raster, label, *range)
        }
    }
}

/// File of a figure below the results folder: `figures/<id>.svg`.
pub fn file_name(id: &str) -> Result<String, FigureError> {
    if !is_plain(id) {
        return Err(FigureError::new(id, "an id consists of names joined by single slashes"));
    }
    Ok(format!("figures/{id}.svg"))
}

/// Caption and deviations as one text, for readers who cannot see the picture.
pub(crate) fn words(figure: &Figure) -> String {
    let deviations = figure.deviations.join("; ");
    match (figure.caption.trim(), deviations.as_str()) {
        (caption, "") => caption.to_string(),
        (caption, deviations) => format!("{caption} Differs from the source: {deviations}.").trim().to_string(),
    }
}
