//! Figures: curves over axes, and fields on a raster.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Scale of an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Equal differences are equally long.
    #[default]
    Linear,
    /// Logarithmic, base 10.
    Log,
}

/// An axis of a figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Axis {
    /// Label with unit, as printed: `time (µs)`.
    pub label: String,
    /// Scale of the axis.
    #[serde(default)]
    pub scale: Scale,
    /// Range, if it is not to be fitted to the curves.
    #[serde(default)]
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis fitted to the curves.
    pub fn linear(label: &str) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// The same with a logarithmic scale.
    pub fn logarithmic(label: &str) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label) }
    }
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CurveStyle {
    /// Result of this code: solid line.
    Line,
    /// Result with a marker at each row.
    Markers,
    /// Reference curve: dashed line, with its uncertainty as a band.
    Reference,
    /// Reference points, with their uncertainty as bars.
    Points,
}

/// One curve: two columns of a series file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Curve {
    /// Its text in the legend.
    pub label: String,
    /// Series, relative to the results folder.
    pub series: String,
    /// Column of the abscissa.
    pub x: String,
    /// Column of the ordinate.
    pub y: String,
    /// Factor applied to the abscissa before drawing (units of the axis).
    pub x_scale: f64,
    /// Factor applied to the ordinate before drawing.
    pub y_scale: f64,
    /// How the curve is drawn.
    pub style: CurveStyle,
    /// Half width of the uncertainty band: absolute, in drawn units.
    #[serde(default)]
    pub uncertainty_absolute: f64,
    /// Half width of the uncertainty band: relative to the ordinate; the larger of the two is drawn.
    #[serde(default)]
    pub uncertainty_relative: f64,
}

impl Curve {
    /// Two columns of a series in its own units: a solid line.
    pub fn line(label: &str, series: &str, [x, y]: [&str; 2]) -> Self {
        Self {
            label: label.into(),
            series: series.into(),
            x: x.into(),
            y: y.into(),
            x_scale: 1.0,
            y_scale: 1.0,
            style: CurveStyle::Line,
            uncertainty_absolute: 0.0,
            uncertainty_relative: 0.0,
        }
    }

    /// A column of a history times a factor against the time in µs.
    pub fn history(label: &str, series: &str, column: &str, factor: f64) -> Self {
        Self { x_scale: 1e6, y_scale: factor, ..Self::line(label, series, ["time_s", column]) }
    }

    /// An energy of a history, named by its column, times a factor against the time in µs.
    pub fn energy(series: &str, column: &str, factor: f64) -> Self {
        Self::history(&column.trim_end_matches("_j").replace('_', " "), series, column, factor)
    }
}

/// A marked place in a chart: a band in which an event should fall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Region {
    /// Text beside the region.
    pub label: String,
    /// Range in drawn abscissa units, if the region is bounded in x.
    pub x: Option<[f64; 2]>,
    /// Range in drawn ordinate units, if the region is bounded in y.
    pub y: Option<[f64; 2]>,
}

/// A triangle beside a curve that shows an order: its hypotenuse runs from `(x[0], y0)` with the slope of
/// theory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SlopeTriangle {
    /// Abscissae of its ends, in drawn units.
    pub x: [f64; 2],
    /// Ordinate of the hypotenuse at `x[0]`, in drawn units.
    pub y0: f64,
    /// Slope along the axes as drawn: on two logarithmic axes the exponent of `y ~ x^slope`.
    pub slope: f64,
    /// Text beside the upright leg: `3`, `3/2`.
    pub label: String,
}

/// A level below which values mean nothing, such as that of round-off; markers at or below it are drawn
/// hollow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Floor {
    /// Ordinate in drawn units.
    pub y: f64,
    /// Text beside the level.
    pub label: String,
}

/// What a figure shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum FigureBody {
    /// Curves over common axes.
    Chart {
        /// Axis of the abscissae.
        x: Axis,
        /// Axis of the ordinates.
        y: Axis,
        /// Curves, in drawing order.
        curves: Vec<Curve>,
        /// Marked regions.
        regions: Vec<Region>,
        /// Orders of theory, beside the curves that should show them.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        slopes: Vec<SlopeTriangle>,
        /// Levels below which values mean nothing.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        floors: Vec<Floor>,
    },
    /// A field on a regular raster: the series has columns `x_m, y_m, value`, one row per pixel centre, x
    /// fastest.
    Field {
        /// Series, relative to the results folder.
        series: String,
        /// Pixels per direction.
        pixels: [usize; 2],
        /// Label of the colour bar.
        label: String,
        /// Range of the colour bar.
        range: [f64; 2],
    },
}

impl FigureBody {
    /// Curves and marked regions over two axes.
    pub fn chart([x, y]: [Axis; 2], curves: Vec<Curve>, regions: Vec<Region>) -> Self {
        Self::Chart { x, y, curves, regions, slopes: Vec::new(), floors: Vec::new() }
    }

    /// Curves and marked regions over the time in µs.
    pub fn over_time(label: &str, curves: Vec<Curve>, regions: Vec<Region>) -> Self {
        Self::chart([Axis::linear("time (µs)"), Axis::linear(label)], curves, regions)
    }

    /// A picture of the phase field, of as many `pixels`.
    pub fn phase_field(series: String, pixels: [usize; 2]) -> Self {
        Self::Field { series, pixels, label: "phase field c".into(), range: [0.0, 1.0] }
    }
}

/// One figure of the report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Figure {
    /// File name without ending: `plate-elastic-energy`. Below `timing/` if it shows measured time.
    pub id: String,
    /// Suite it belongs to.
    pub suite: String,
    /// Title above the figure.
    pub title: String,
    /// Caption: resolution, points, steps, dt.
    pub caption: String,
    /// Every deviation from the cited source.
    pub deviations: Vec<String>,
    /// What is drawn.
    pub body: FigureBody,
}

impl Figure {
    /// A figure that deviates from no source: suite, then id, title and caption.
    pub fn new(suite: &str, words: [&str; 3], body: FigureBody) -> Self {
        let [id, title, caption] = words.map(String::from);
        Self { id, suite: suite.into(), title, caption, deviations: Vec::new(), body }
    }
}
