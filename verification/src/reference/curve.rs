//! A reference curve in SI units.

use super::Obtained;
use crate::output::history::Table;
use crate::record::{Curve, CurveStyle, Reference, ReferenceKind};

/// A curve from elsewhere, in SI units, with its uncertainty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReferenceCurve {
    /// Folder below the library's, with the variant if the folder has several: `mandal-2020/at2`.
    pub id: String,
    /// What it describes: `plate/elastic-energy`.
    pub quantity: String,
    /// Its text in legends.
    pub label: String,
    /// Citation of its source.
    pub citation: String,
    /// Kind of reference that a record states when it is held against this curve.
    pub kind: ReferenceKind,
    /// How it was obtained.
    pub obtained: Obtained,
    /// Abscissae, SI, strictly increasing.
    pub x: Vec<f64>,
    /// Ordinates, SI, finite.
    pub y: Vec<f64>,
    /// SI unit of the abscissae.
    pub x_unit: &'static str,
    /// SI unit of the ordinates.
    pub y_unit: &'static str,
    /// Widest distance between two abscissae across which the curve is interpolated and drawn.
    pub max_gap: Option<f64>,
    /// Half width of the uncertainty, SI.
    pub uncertainty_absolute: f64,
    /// Half width of the uncertainty relative to the ordinate; the larger of the two holds.
    pub uncertainty_relative: f64,
    /// Half width of the uncertainty of the abscissae, SI: moves a steep ordinate by its slope.
    pub uncertainty_x: f64,
    /// How the uncertainty was estimated, or that none is known.
    pub uncertainty_note: String,
}

impl ReferenceCurve {
    /// First and last abscissa, SI.
    pub fn range(&self) -> [f64; 2] {
        [self.x[0], self.x[self.x.len() - 1]]
    }

    /// Ordinate at `x` by linear interpolation; `None` outside the range and inside a gap wider than
    /// `max_gap`.
    pub fn at(&self, x: f64) -> Option<f64> {
        let (i, weight) = bracket(&self.x, x)?;
        if weight > 0.0 && weight < 1.0 && self.is_gap(i) {
            return None;
        }
        Some(blend(&self.y, i, weight))
    }

    /// Half width of the uncertainty at an ordinate, SI; 0 where none is known.
    pub fn uncertainty(&self, y: f64) -> f64 {
        self.uncertainty_absolute.max(self.uncertainty_relative * y.abs())
    }

    /// Half width of the uncertainty at row `i`, SI, with what the abscissa adds where the curve is steep; 0
    /// where none is known.
    pub(super) fn uncertainty_at_row(&self, i: usize) -> f64 {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(self.x.len() - 1));
        let slope =
            if after > before { (self.y[after] - self.y[before]) / (self.x[after] - self.x[before]) } else { 0.0 };
        self.uncertainty(self.y[i]).hypot(self.uncertainty_x * slope)
    }

    /// The ordinate at `x` as what a record is held against, times `factor`; `None` as [`Self::at`].
    pub fn reference_at(&self, x: f64, factor: f64) -> Option<Reference> {
        let (i, weight) = bracket(&self.x, x)?;
        let value = self.at(x)?;
        let uncertainty = self.uncertainty_at_row(if weight < 0.5 { i } else { i + 1 }) * factor.abs();
        let known = (uncertainty > 0.0).then_some(uncertainty);
        Some(Reference { uncertainty: known, ..Reference::new(Some(value * factor), self.kind, &self.label) })
    }

    /// Path of the curve's series in a results folder.
    pub fn series_path(&self) -> String {
        format!("series/reference-{}-{}.csv", self.id.replace('/', "-"), self.quantity.replace('/', "-"))
    }

    /// The curve for a figure, and the table (columns `x`, `y`, SI) to be stored at [`Self::series_path`], so
    /// that the results folder stands by itself. The scales take SI to the units of the axes. A row of
    /// not-a-number breaks the line in a gap wider than `max_gap`; a single point is drawn as a point.
    pub fn series(&self, x_scale: f64, y_scale: f64) -> (Curve, Table) {
        let mut table = Table::new(&["x", "y"]);
        for i in 0..self.x.len() {
            table.push(&[self.x[i], self.y[i]]);
            if i + 1 < self.x.len() && self.is_gap(i) {
                table.push(&[0.5 * (self.x[i] + self.x[i + 1]), f64::NAN]);
            }
        }
        let curve = Curve {
            x_scale,
            y_scale,
            style: if self.x.len() > 1 { CurveStyle::Reference } else { CurveStyle::Points },
            uncertainty_absolute: self.uncertainty_absolute * y_scale,
            uncertainty_relative: self.uncertainty_relative,
            ..Curve::line(&self.label, &self.series_path(), ["x", "y"])
        };
        (curve, table)
    }

    /// Whether the interval after row `i` is too wide to be interpolated, round-off of the units aside.
    fn is_gap(&self, i: usize) -> bool {
        self.max_gap.is_some_and(|gap| self.x[i + 1] - self.x[i] > gap * (1.0 + 1e-9))
    }
}

/// Row and weight of the next row for linear interpolation at `x` in increasing abscissae; `None` outside
/// their range.
pub(super) fn bracket(abscissae: &[f64], x: f64) -> Option<(usize, f64)> {
    let (first, last) = (*abscissae.first()?, *abscissae.last()?);
    if !(first..=last).contains(&x) {
        return None;
    }
    if abscissae.len() == 1 {
        return Some((0, 0.0));
    }
    let i = abscissae.partition_point(|a| *a <= x).clamp(1, abscissae.len() - 1) - 1;
    Some((i, (x - abscissae[i]) / (abscissae[i + 1] - abscissae[i])))
}

/// Ordinate between row `i` and the next; a row itself is met exactly and needs no neighbour.
pub(super) fn blend(ordinates: &[f64], i: usize, weight: f64) -> f64 {
    match weight {
        0.0 => ordinates[i],
        1.0 => ordinates[i + 1],
        w => (1.0 - w) * ordinates[i] + w * ordinates[i + 1],
    }
}
