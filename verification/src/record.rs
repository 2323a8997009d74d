//! The data model of results: schema `fisura.results/1`.
//!
//! `results.json` holds one [`ResultSet`]; the numbers behind its figures stand beside it in `series/*.csv`. Everything
//! a report shows is a pure function of that folder.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Name of the schema written and read.
pub const SCHEMA: &str = "fisura.results/1";

/// Everything one invocation found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResultSet {
    /// [`SCHEMA`].
    pub schema: String,
    /// Where and when it was run.
    pub environment: Environment,
    /// One record per check, in the order of the plan.
    pub records: Vec<Record>,
    /// Figures, in the order of the report.
    pub figures: Vec<Figure>,
}

/// Where and when; exempt from byte-for-byte comparison.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Environment {
    /// Commit of the work tree, or empty.
    pub commit: String,
    /// Whether the work tree had uncommitted changes.
    pub dirty: bool,
    /// Compiler version.
    pub rustc: String,
    /// Processor.
    pub cpu: String,
    /// Threads used.
    pub threads: usize,
    /// Start, UTC, ISO 8601.
    pub started: String,
}

/// Verdict of one check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Within its bounds.
    Pass,
    /// Outside its bounds.
    Fail,
    /// The run broke down.
    Error,
    /// No bounds: a figure to read.
    Info,
}

/// Kind of reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceKind {
    /// A closed form.
    Exact,
    /// A theorem or an asymptotic rate.
    Theory,
    /// Published numbers.
    Literature,
    /// Another code.
    IndependentCode,
    /// Finer runs of this code.
    SelfConvergence,
    /// An earlier result of this code.
    Regression,
}

/// What a value is held against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Value, if it is one number.
    pub value: Option<f64>,
    /// Kind.
    pub kind: ReferenceKind,
    /// Where it comes from.
    pub source: String,
}

/// Bounds and why they are what they are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Accept {
    /// Smallest value that passes.
    pub min: Option<f64>,
    /// Largest value that passes.
    pub max: Option<f64>,
    /// Reason.
    pub why: String,
}

/// Measured time; exempt from byte-for-byte comparison.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Wall time of the runs behind the record, s.
    pub wall_s: f64,
    /// Material points times steps.
    pub particle_steps: u64,
    /// Wall time per particle-step, ns.
    pub ns_per_particle_step: f64,
}

/// One check and what it found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// `suite/case[/variant]/quantity`.
    pub id: String,
    /// Suite.
    pub suite: String,
    /// Case.
    pub case: String,
    /// `quick` or `full`.
    pub tier: String,
    /// The sentence the check can refute.
    pub claim: String,
    /// Parameters of the run.
    pub parameters: BTreeMap<String, serde_json::Value>,
    /// What was modelled.
    pub models: Vec<String>,
    /// What differs from the cited source.
    pub deviations: Vec<String>,
    /// The quantity, in words.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Its value; absent when the run broke down or the event did not occur.
    pub value: Option<f64>,
    /// What it is held against.
    pub reference: Option<Reference>,
    /// Bounds.
    pub accept: Accept,
    /// Verdict.
    pub status: Status,
    /// How, where and when, for errors and remarks.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub message: Option<String>,
    /// Series with the numbers behind it, relative to the results folder.
    pub series: Option<String>,
    /// Measured time.
    pub timing: Timing,
}

impl Record {
    /// The verdict that `value` deserves under `accept`: a missing or non-finite value fails unless there are no bounds.
    pub fn judge(value: Option<f64>, accept: &Accept) -> Status {
        if accept.min.is_none() && accept.max.is_none() {
            return Status::Info;
        }
        let holds = value.is_some_and(|v| {
            v.is_finite() && accept.min.is_none_or(|min| v >= min) && accept.max.is_none_or(|max| v <= max)
        });
        if holds { Status::Pass } else { Status::Fail }
    }
}

/// Scale of an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Linear.
    #[default]
    Linear,
    /// Logarithmic, base 10.
    Log,
}

/// An axis of a figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Label with unit, as printed: `time (µs)`.
    pub label: String,
    /// Scale.
    #[serde(default)]
    pub scale: Scale,
    /// Range, if it is not to be fitted to the curves.
    #[serde(default)]
    pub range: Option<[f64; 2]>,
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Legend.
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
    /// Style.
    pub style: CurveStyle,
    /// Half width of the uncertainty band: absolute, in drawn units.
    #[serde(default)]
    pub uncertainty_absolute: f64,
    /// Half width of the uncertainty band: relative to the ordinate; the larger of the two is drawn.
    #[serde(default)]
    pub uncertainty_relative: f64,
}

/// A marked place in a chart: a band in which an event should fall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// Label.
    pub label: String,
    /// Range in drawn abscissa units, if the region is bounded in x.
    pub x: Option<[f64; 2]>,
    /// Range in drawn ordinate units, if the region is bounded in y.
    pub y: Option<[f64; 2]>,
}

/// A triangle beside a curve that shows an order: its hypotenuse runs from `(x[0], y0)` with the slope of theory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// A level below which values mean nothing, such as that of round-off; markers at or below it are drawn hollow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Floor {
    /// Ordinate in drawn units.
    pub y: f64,
    /// Label.
    pub label: String,
}

/// What a figure shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum FigureBody {
    /// Curves over common axes.
    Chart {
        /// Abscissa.
        x: Axis,
        /// Ordinate.
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
    /// A field on a regular raster: the series has columns `x_m, y_m, value`, one row per pixel centre, x fastest.
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

/// One figure of the report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// File name without ending: `plate-elastic-energy`. Below `timing/` if it shows measured time.
    pub id: String,
    /// Suite it belongs to.
    pub suite: String,
    /// Title.
    pub title: String,
    /// Caption: resolution, points, steps, dt.
    pub caption: String,
    /// Every deviation from the cited source.
    pub deviations: Vec<String>,
    /// Content.
    pub body: FigureBody,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_outside_its_bounds_or_missing_fails() {
        let accept = Accept { min: Some(1.0), max: Some(2.0), why: String::new() };
        assert_eq!(Record::judge(Some(1.5), &accept), Status::Pass);
        for bad in [Some(0.9), Some(2.1), Some(f64::NAN), None] {
            assert_eq!(Record::judge(bad, &accept), Status::Fail, "{bad:?}");
        }
        assert_eq!(Record::judge(None, &Accept::default()), Status::Info);
    }
}
