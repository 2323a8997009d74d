//! A figure that stands on its own: `NAME.svg`, the numbers in `NAME-*.csv`, `NAME.caption.txt` and
//! `NAME.json` with its definition and provenance. [`redraw`] makes the same bytes from the last and the
//! numbers.
//!
//! Charts keep the columns that they draw. A picture is a matrix: the header has the abscissae of the pixels,
//! the first column their ordinates, and values are rounded to a thousandth of the colour bar.

use std::collections::BTreeMap;
use std::path::Path;

use fisura_verification::output::fingerprint::fingerprint;
use fisura_verification::output::history::{Table, format_number};
use fisura_verification::output::{OutputError, OutputFolder};
use fisura_verification::record::{Environment, Figure, FigureBody};
use serde::{Deserialize, Serialize};

use crate::error::ReportError;
use crate::field::Raster;
use crate::figure::render_figure;
use crate::read_json;
use crate::series::{self, SeriesSet, names};

/// Name of the schema written and read.
pub const BUNDLE_SCHEMA: &str = "fisura.figure/1";
/// Steps into which the colour bar of a picture is divided when values are rounded.
const STEPS: f64 = 1000.0;

/// Where a figure comes from, and what it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bundle {
    /// Name and version of the format, [`BUNDLE_SCHEMA`].
    pub schema: String,
    /// Where and when its numbers were computed.
    pub environment: Environment,
    /// Fingerprints of what its cases simulate, by their ids.
    pub inputs: BTreeMap<String, String>,
    /// Fingerprints of its CSV files, by their names.
    pub data: BTreeMap<String, String>,
    /// The figure; its series are files beside this one.
    pub figure: Figure,
}

/// Writes a figure of results in `from` as `folder/name.*`; names the files.
///
/// # Errors
/// A series that cannot be read or drawn, or a file that cannot be written.
pub fn write(
    (from, figure): (&Path, &Figure),
    (folder, name): (&OutputFolder, &str),
    environment: &Environment,
    inputs: BTreeMap<String, String>,
) -> Result<Vec<String>, ReportError> {
    let set = SeriesSet::load(from, [figure]);
    let (figure, tables) = own_series(figure, name, &set)?;
    let mut data = BTreeMap::new();
    let mut files = Vec::new();
    let mut store = |file: String, bytes: &[u8]| {
        folder.write(&file, bytes)?;
        files.push(file);
        Ok::<(), ReportError>(())
    };
    for (file, table) in &tables {
        let bytes = table.to_csv().map_err(|error| OutputError::unwritable(Path::new(file), error))?;
        data.insert(file.clone(), fingerprint([&bytes]));
        store(file.clone(), &bytes)?;
    }
    let svg = draw(&figure, tables).map_err(|e| ReportError::Figures(vec![e]))?;
    store(format!("{name}.svg"), svg.as_bytes())?;
    store(format!("{name}.caption.txt"), caption(&figure).as_bytes())?;
    let bundle = Bundle { schema: BUNDLE_SCHEMA.to_string(), environment: environment.clone(), inputs, data, figure };
    // Plain data, which JSON can hold.
    let json = serde_json::to_string_pretty(&bundle).unwrap_or_default() + "\n";
    store(format!("{name}.json"), json.as_bytes())?;
    Ok(files)
}

/// Reads `folder/name.json`.
///
/// # Errors
/// The file is missing, malformed or of another schema.
pub fn read(folder: &Path, name: &str) -> Result<Bundle, ReportError> {
    read_json(folder, &format!("{name}.json"), BUNDLE_SCHEMA)
}

/// Draws a figure again from the files beside its definition.
///
/// # Errors
/// A file that cannot be read, or a figure that cannot be drawn.
pub fn redraw(folder: &Path, bundle: &Bundle) -> Result<String, ReportError> {
    let mut left = series::MOST_BYTES;
    let table = |file: &String| {
        series::read(folder, file, &mut left)
            .map(|table| (file.clone(), table))
            .map_err(|message| ReportError::file(folder.join(file), message))
    };
    let tables = bundle.data.keys().map(table).collect::<Result<_, _>>()?;
    draw(&bundle.figure, tables).map_err(|e| ReportError::Figures(vec![e]))
}

fn draw(figure: &Figure, tables: Vec<(String, Table)>) -> Result<String, crate::FigureError> {
    let mut set = SeriesSet::default();
    for (file, table) in tables {
        let raster = matches!(figure.body, FigureBody::Field { .. });
        set.insert(file, if raster { from_matrix(&table) } else { table });
    }
    render_figure(figure, &set)
}

/// The figure with series of its own, and these, reduced to what is drawn.
fn own_series(figure: &Figure, name: &str, set: &SeriesSet) -> Result<(Figure, Vec<(String, Table)>), ReportError> {
    let fail = |e| ReportError::Figures(vec![e]);
    let mut own = figure.clone();
    let file = |series: &str| {
        let stem = series.trim_start_matches("series/").trim_start_matches("timing/").trim_end_matches(".csv");
        format!("{name}-{}.csv", stem.replace('/', "-"))
    };
    let mut tables = Vec::new();
    match &mut own.body {
        FigureBody::Field { series, pixels, range, .. } => {
            // The pixels are those of the series.
            Raster::read(&figure.id, series, *pixels, set).map_err(fail)?;
            let table = set.table(&figure.id, series).map_err(fail)?;
            let step = (range[1] - range[0]) / STEPS;
            *series = format!("{name}.csv");
            tables.push((series.clone(), to_matrix(table, pixels[0], step)));
        }
        FigureBody::Chart { curves, .. } => {
            for series in names(figure) {
                let mut table = Table::default();
                let of_series = curves.iter().filter(|c| c.series == series);
                for column in of_series.flat_map(|c| [&c.x, &c.y]) {
                    if !table.names.contains(column) {
                        let values = set.column(&figure.id, &series, column).map_err(fail)?;
                        table.names.push(column.clone());
                        table.columns.push(values.to_vec());
                    }
                }
                tables.push((file(&series), table));
            }
            curves.iter_mut().for_each(|curve| curve.series = file(&curve.series));
        }
    }
    Ok((own, tables))
}

/// Columns `x_m, y_m, value`, x fastest, as a matrix with one row per ordinate.
fn to_matrix(raster: &Table, width: usize, step: f64) -> Table {
    let column = |name: &str| raster.column(name).unwrap_or_default();
    let (x, y, value) = (column("x_m"), column("y_m"), column("value"));
    let abscissae = x.iter().take(width).map(|x| format_number(*x));
    let mut matrix =
        Table { names: std::iter::once("y_m".to_string()).chain(abscissae).collect(), columns: Vec::new() };
    matrix.columns = vec![Vec::new(); matrix.names.len()];
    for (values, ordinates) in value.chunks_exact(width.max(1)).zip(y.chunks_exact(width.max(1))) {
        let rounded = values.iter().map(|v| (v / step).round() / (1.0 / step).round());
        matrix.push(&std::iter::once(ordinates[0]).chain(rounded).collect::<Vec<_>>());
    }
    matrix
}

/// The raster of a matrix.
fn from_matrix(matrix: &Table) -> Table {
    let mut raster = Table::new(&["x_m", "y_m", "value"]);
    let abscissae: Vec<f64> = matrix.names.iter().skip(1).map(|name| name.parse().unwrap_or(f64::NAN)).collect();
    for row in 0..matrix.rows() {
        let ordinate = matrix.columns[0][row];
        for (x, column) in abscissae.iter().zip(&matrix.columns[1..]) {
            raster.push(&[*x, ordinate, column[row]]);
        }
    }
    raster
}

/// Title, caption and every deviation, for below the figure in a paper.
fn caption(figure: &Figure) -> String {
    let mut text = format!("{}. {}\n", figure.title.trim_end_matches('.'), figure.caption);
    for deviation in &figure.deviations {
        text.push_str(&format!("Differs from the source: {deviation}.\n"));
    }
    text
}
