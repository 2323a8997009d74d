//! Curves on their way to the page: read, scaled, broken at gaps, clipped to the frame, dashed.

use fisura_verification::extremes::{larger, smaller};
use fisura_verification::record::{Curve, CurveStyle, Scale};

use crate::axis::AxisScale;
use crate::series::{FigureError, SeriesSet};
use crate::style::Look;
use crate::thin::by_column;

/// A point in drawn units or in axis coordinates.
pub type Point = (f64, f64);

/// One curve in drawn units.
#[derive(Debug, Clone)]
pub struct Trace {
    /// Its text in the legend.
    pub label: String,
    /// What kind of curve it is.
    pub style: CurveStyle,
    /// Colour, dashes, marker.
    pub look: Look,
    /// Rows; not-a-number where the curve breaks.
    pub points: Vec<Point>,
    /// Half width of the uncertainty at each row; empty if there is none.
    pub half_widths: Vec<f64>,
    /// Least and largest abscissa at each row; empty if the series has no columns `<x>_min` and `<x>_max`.
    pub spread: Vec<[f64; 2]>,
}

impl Trace {
    /// Reads a curve for a figure. A curve with no row that can be drawn on axes of these scales is an error.
    pub fn read(
        figure: &str,
        curve: &Curve,
        look: Look,
        scales: [Scale; 2],
        set: &SeriesSet,
    ) -> Result<Self, FigureError> {
        let x = set.column(figure, &curve.series, &curve.x)?;
        let y = set.column(figure, &curve.series, &curve.y)?;
        let points: Vec<Point> = x.iter().zip(y).map(|(x, y)| (x * curve.x_scale, y * curve.y_scale)).collect();
        let fits = |value: f64, scale| value.is_finite() && (scale == Scale::Linear || value > 0.0);
        if !points.iter().any(|(x, y)| fits(*x, scales[0]) && fits(*y, scales[1])) {
            let Curve { label, series, x, y, .. } = curve;
            let message =
                format!("nothing to draw for {label:?}: columns {x} and {y} of series {series} have no drawable row");
            return Err(FigureError::new(figure, message));
        }
        let (absolute, relative) = (curve.uncertainty_absolute.abs(), curve.uncertainty_relative.abs());
        let uncertain = absolute.max(relative) > 0.0;
        let half_widths =
            if uncertain { points.iter().map(|p| absolute.max(relative * p.1.abs())).collect() } else { Vec::new() };
        let table = set.table(figure, &curve.series)?;
        let [low, high] = ["min", "max"].map(|end| table.column(&format!("{}_{end}", curve.x)).unwrap_or_default());
        let spread = low.iter().zip(high).map(|(low, high)| [low * curve.x_scale, high * curve.x_scale]).collect();
        Ok(Self { label: curve.label.clone(), style: curve.style, look, points, half_widths, spread })
    }

    /// All ordinates that should be seen, uncertainty included, except where it would make a positive value
    /// negative.
    pub fn ordinates(&self) -> impl Iterator<Item = f64> + '_ {
        let lowest = |y: f64, h: f64| if y < 0.0 { y - h } else { (y - h).max(0.0) };
        let band = self.points.iter().zip(&self.half_widths).flat_map(move |(p, h)| [lowest(p.1, *h), p.1 + h]);
        self.points.iter().map(|p| p.1).chain(band)
    }

    /// The points in axis coordinates, not-a-number kept.
    pub fn coordinates(&self, x: &AxisScale, y: &AxisScale) -> Vec<Point> {
        self.points.iter().map(|p| (x.coordinate(p.0), y.coordinate(p.1))).collect()
    }

    /// The outline of the uncertainty band in axis coordinates, one closed polygon per unbroken stretch,
    /// within the frame of nominal `width`.
    pub fn band(&self, x: &AxisScale, y: &AxisScale, width: f64) -> Vec<Vec<Point>> {
        let edge = |sign: f64| -> Vec<Point> {
            let rows = self.points.iter().zip(&self.half_widths);
            rows.map(|(p, h)| {
                let u = y.coordinate(p.1 + sign * h);
                // a lower edge at or below zero lies below every logarithmic axis
                let below = sign < 0.0 && u.is_nan() && y.coordinate(p.1).is_finite();
                (x.coordinate(p.0), if below { y.low } else { u })
            })
            .collect()
        };
        let (lower, upper) = (edge(-1.0), edge(1.0));
        let stretches = stretches(&upper.iter().zip(&lower).map(|(a, b)| (a.0, a.1 + b.1)).collect::<Vec<_>>());
        let polygons = stretches.into_iter().map(|range| {
            let [upper, lower] = [&upper, &lower].map(|edge| by_column(within(&edge[range.clone()], x, y), x, width));
            upper.into_iter().chain(lower.into_iter().rev()).collect()
        });
        polygons.filter(|outline: &Vec<Point>| outline.len() > 2).collect()
    }
}

/// Index ranges of consecutive finite points.
fn stretches(points: &[Point]) -> Vec<std::ops::Range<usize>> {
    let mut ranges: Vec<std::ops::Range<usize>> = Vec::new();
    for (i, p) in points.iter().enumerate() {
        if !(p.0.is_finite() && p.1.is_finite()) {
            continue;
        }
        match ranges.last_mut() {
            Some(range) if range.end == i => range.end = i + 1,
            _ => ranges.push(i..i + 1),
        }
    }
    ranges
}

/// A stretch cut at the sides of the frame and pressed onto its top and bottom.
fn within(points: &[Point], x: &AxisScale, y: &AxisScale) -> Vec<Point> {
    let mut inside = Vec::new();
    for pair in points.windows(2) {
        if let Some((a, b)) = clip(pair[0], pair[1], [x.low, x.high], [f64::NEG_INFINITY, f64::INFINITY]) {
            if inside.last() != Some(&a) {
                inside.push(a);
            }
            inside.push(b);
        }
    }
    inside.into_iter().map(|p| (p.0, p.1.clamp(y.low, y.high))).collect()
}

/// The visible pieces of a curve in axis coordinates: broken where a point is not finite, clipped to the
/// frame.
pub fn pieces(points: &[Point], x: &AxisScale, y: &AxisScale) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    for pair in points.windows(2) {
        if [pair[0].0, pair[0].1, pair[1].0, pair[1].1].iter().any(|v| !v.is_finite()) {
            continue;
        }
        let Some((a, b)) = clip(pair[0], pair[1], [x.low, x.high], [y.low, y.high]) else { continue };
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&a) && a == pair[0] => piece.push(b),
            _ => pieces.push(vec![a, b]),
        }
    }
    pieces
}

/// Whether a point in axis coordinates lies in the frame.
pub fn visible(p: Point, x: &AxisScale, y: &AxisScale) -> bool {
    let slack = |axis: &AxisScale| 1e-9 * (axis.high - axis.low);
    let inside = |u: f64, axis: &AxisScale| u >= axis.low - slack(axis) && u <= axis.high + slack(axis);
    inside(p.0, x) && inside(p.1, y)
}

/// Whether a line runs through a rectangle, both in axis coordinates.
pub fn meets(line: &[Point], x: [f64; 2], y: [f64; 2]) -> bool {
    let finite = |p: &Point| p.0.is_finite() && p.1.is_finite();
    line.windows(2).any(|pair| pair.iter().all(finite) && clip(pair[0], pair[1], x, y).is_some())
}

/// Liang and Barsky: the part of a segment inside a rectangle.
fn clip(a: Point, b: Point, x: [f64; 2], y: [f64; 2]) -> Option<(Point, Point)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for (step, room) in [(-dx, a.0 - x[0]), (dx, x[1] - a.0), (-dy, a.1 - y[0]), (dy, y[1] - a.1)] {
        if step == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if step < 0.0 {
            enter = larger(enter, room / step);
        } else {
            leave = smaller(leave, room / step);
        }
    }
    let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
    let start = if enter == 0.0 { a } else { at(enter) };
    (enter <= leave).then_some((start, if leave == 1.0 { b } else { at(leave) }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> AxisScale {
        AxisScale::with_range(Scale::Linear, 0.0, 1.0, 5)
    }

    #[test]
    fn lines_are_broken_at_missing_values_and_end_at_the_frame() {
        let drawn = |points: &[Point]| pieces(points, &unit(), &unit());
        let gap = [(0.0, 0.1), (0.2, 0.2), (0.4, f64::NAN), (0.6, 0.3), (0.8, 0.4)];
        assert_eq!(drawn(&gap), [gap[..2].to_vec(), gap[3..].to_vec()]);
        let beyond = [(-1.0, 0.5), (0.5, 0.5), (0.5, 3.0), (0.7, 3.0)];
        assert_eq!(drawn(&beyond), [vec![(0.0, 0.5), (0.5, 0.5), (0.5, 1.0)]]);
    }
}
