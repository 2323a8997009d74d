//! Axes: ranges fitted to data, ticks at round numbers, labels without floating-point dust.
//!
//! An [`AxisScale`] works in *axis coordinates*: the value itself on a linear axis, its decimal logarithm on
//! a logarithmic one. Both run linearly along the page.

use fisura_verification::extremes::{larger, smaller};
use std::ops::Range;

use fisura_verification::record::{Axis, Scale};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use crate::number::{power_of_ten, pretty};

/// Values beyond are not drawn, and ranges do not go beyond: spans would not be numbers.
const LARGEST: [f64; 2] = [1e290, 1e300];
/// Least span of a range, absolute and relative to its larger end: below, ticks and pixels have no digits
/// left.
const LEAST_SPAN: [f64; 2] = [1e-300, 1e-12];
/// Decades up to which minor ticks have grid lines; beyond, they would be a grey wash.
const FINE_GRID: f64 = 3.0;

/// A fitted axis that plotters can draw.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisScale {
    scale: Scale,
    /// First axis coordinate.
    pub low: f64,
    /// Last axis coordinate.
    pub high: f64,
    /// Labelled ticks: axis coordinate and text.
    pub ticks: Vec<(f64, String)>,
    /// Ticks without label of a logarithmic axis.
    pub minor: Vec<f64>,
    /// Power of ten by which all labels are to be multiplied, to be printed beside the axis.
    pub factor: Option<i32>,
}

impl AxisScale {
    /// An axis for `values` (drawn units). `padding` is the fraction of the range left free at both ends;
    /// about `target` ticks are labelled. The axis' own range wins where it is given and usable.
    pub fn fit(axis: &Axis, values: impl IntoIterator<Item = f64>, padding: f64, target: usize) -> Self {
        let coordinates = values.into_iter().map(|v| coordinate(axis.scale, v)).filter(|u| u.is_finite());
        let fitted = coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), u| (smaller(a, u), larger(b, u)));
        let fitted = if fitted.0 <= fitted.1 { fitted } else { (0.0, 1.0) };
        let given = axis.range.map(|[a, b]| (coordinate(axis.scale, a), coordinate(axis.scale, b)));
        let (low, high) = match given {
            Some((a, b)) if is_range(a, b) => (a, b),
            _ => pad(fitted, padding, axis.scale),
        };
        Self::with_range(axis.scale, low, high, target)
    }

    /// An axis over given axis coordinates.
    pub fn with_range(scale: Scale, low: f64, high: f64, target: usize) -> Self {
        let (ticks, minor, factor) = match scale {
            Scale::Log => log_ticks(low, high, target).unwrap_or_else(|| {
                let (values, _) = linear_values(10f64.powf(low), 10f64.powf(high), target);
                (values.iter().map(|v| (v.log10(), pretty(*v, 6))).collect(), Vec::new(), None)
            }),
            Scale::Linear => linear_ticks(low, high, target),
        };
        Self { scale, low, high, ticks, minor, factor }
    }

    /// Axis coordinate of a value; not-a-number where a logarithmic axis has no place for it.
    pub fn coordinate(&self, value: f64) -> f64 {
        coordinate(self.scale, value)
    }

    /// Whether zero lies inside a linear range.
    pub fn crosses_zero(&self) -> bool {
        self.scale == Scale::Linear && self.low < 0.0 && self.high > 0.0
    }
}

impl Ranged for AxisScale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let fraction = (value - self.low) / (self.high - self.low);
        // what lies far outside is clipped or left out anyway, and must not overflow
        (limit.0 as f64 + fraction.clamp(-1.0, 2.0) * (limit.1 - limit.0) as f64).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let fine = self.high - self.low <= FINE_GRID && hint.weight().allow_light_points();
        let minor: &[f64] = if fine { &self.minor } else { &[] };
        self.ticks.iter().map(|t| t.0).chain(minor.iter().copied()).collect()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for AxisScale {
    fn format_ext(&self, value: &f64) -> String {
        self.ticks.iter().find(|t| t.0 == *value).map_or_else(String::new, |t| t.1.clone())
    }
}

/// Whether a range from `low` to `high`, in axis coordinates, can be divided into ticks and pixels.
pub fn is_range(low: f64, high: f64) -> bool {
    let least = LEAST_SPAN[0].max(LEAST_SPAN[1] * low.abs().max(high.abs()));
    low.abs().max(high.abs()) <= LARGEST[1] && high - low >= least
}

fn coordinate(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear if value.abs() > LARGEST[0] => f64::NAN,
        Scale::Linear => value,
        Scale::Log if value > 0.0 => value.log10(),
        Scale::Log => f64::NAN,
    }
}

/// Widens a fitted range; starts a linear axis at zero where the data come near it.
fn pad((low, high): (f64, f64), padding: f64, scale: Scale) -> (f64, f64) {
    let span = high - low;
    if !is_range(low, high) {
        let half = if scale == Scale::Log { 0.5 } else { 0.05 * low.abs().max(high.abs()) };
        return if low.abs() < LEAST_SPAN[0] && scale == Scale::Linear {
            (-1.0, 1.0)
        } else {
            (low - half, high + half)
        };
    }
    let margin = padding * span;
    let near_zero = scale == Scale::Linear && padding > 0.0 && low >= 0.0 && low < 0.3 * high;
    let bottom = if near_zero { 0.0 } else { low - margin };
    (bottom, high + margin)
}

type Ticks = (Vec<(f64, String)>, Vec<f64>, Option<i32>);

/// Multiples of 1, 2, 2.5 or 5 times a power of ten within the range, and the decimals they need.
fn linear_values(low: f64, high: f64, target: usize) -> (Vec<f64>, f64) {
    let rough = (high - low) / target.max(1) as f64;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0].iter().map(|m| m * power).find(|s| *s >= rough * 0.999).unwrap_or(10.0 * power);
    if !(step.is_normal() && is_range(low, high)) {
        return (Vec::new(), 1.0);
    }
    let slack = 1e-9 * (high - low);
    let first = ((low - slack) / step).ceil() as i64;
    let last = ((high + slack) / step).floor() as i64;
    ((first..=last).map(|i| i as f64 * step).collect(), step)
}

fn linear_ticks(low: f64, high: f64, target: usize) -> Ticks {
    let (values, step) = linear_values(low, high, target);
    let magnitude = low.abs().max(high.abs()).log10().floor() as i32;
    let factor = (!(-3..5).contains(&magnitude)).then_some(magnitude.div_euclid(3) * 3);
    let unit = 10f64.powi(factor.unwrap_or(0));
    let relative = step / unit;
    let decimals = (0..12).find(|d| is_whole(relative * 10f64.powi(*d))).unwrap_or(12) as usize;
    let label = |v: f64| format!("{:.decimals$}", if v == 0.0 { 0.0 } else { v / unit }).replace('-', "−");
    (values.iter().map(|v| (*v, label(*v))).collect(), Vec::new(), factor)
}

fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() < 1e-6 * value.abs().max(1e-300)
}

/// Decades, or 1-2-5 steps where there are few decades; nothing if fewer than two ticks fall into the range.
fn log_ticks(low: f64, high: f64, target: usize) -> Option<Ticks> {
    let slack = 1e-9;
    let inside = |u: f64| u >= low - slack && u <= high + slack;
    let decades: Vec<i32> = (low.floor() as i32..=high.ceil() as i32).collect();
    let plain = low >= -3.0 - slack && high <= 4.0 + slack;
    let places = |mantissas: &'static [i32]| {
        let place = move |d: i32, m: i32| (f64::from(d) + f64::from(m).log10(), m, d);
        let all = decades.iter().flat_map(move |d| mantissas.iter().map(move |m| place(*d, *m)));
        all.filter(|t| inside(t.0)).collect::<Vec<_>>()
    };
    let stride = ((high - low) / target.max(1) as f64).ceil().max(1.0) as i32;
    let choices = [&[1][..], &[1, 2, 5], &[1, 2, 3, 4, 5, 6, 7, 8, 9]];
    let chosen = choices.into_iter().map(places).find(|c| c.len() >= 3.min(target));
    let chosen = chosen.unwrap_or_else(|| places(choices[2]));
    if chosen.len() < 2 {
        return None;
    }
    let text = |m: i32, d: i32| match (plain, m) {
        (true, _) => pretty(format!("{m}e{d}").parse().unwrap_or(f64::NAN), 6),
        (false, 1) => power_of_ten(d),
        (false, m) => format!("{m}×{}", power_of_ten(d)),
    };
    let labelled = chosen.iter().filter(|(_, m, d)| *m != 1 || d.rem_euclid(stride) == 0);
    let ticks = labelled.map(|(u, m, d)| (*u, text(*m, *d))).collect();
    // unlabelled decades where not all are labelled
    let minor = places(choices[if stride == 1 { 2 } else { 0 }]).into_iter().map(|t| t.0).collect();
    Some((ticks, minor, None))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, low: f64, high: f64) -> Vec<String> {
        let axis = AxisScale::with_range(scale, low, high, 6);
        axis.ticks.into_iter().map(|t| t.1).collect()
    }

    #[test]
    fn logarithmic_labels_are_exact_powers() {
        assert_eq!(labels(Scale::Log, -6.2, -1.9), ["10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²"]);
        assert_eq!(labels(Scale::Log, -2.0, 0.1), ["0.01", "0.1", "1"]);
        assert_eq!(labels(Scale::Log, -1.9, -0.8), ["0.02", "0.05", "0.1"]);
        assert_eq!(labels(Scale::Log, -6.02, -5.4), ["10⁻⁶", "2×10⁻⁶", "3×10⁻⁶"]);
        assert_eq!(labels(Scale::Log, -12.0, 0.0), ["10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"]);
    }

    #[test]
    fn minor_ticks_lie_between_decades_or_are_decades() {
        let minor = |low: f64, high: f64| AxisScale::with_range(Scale::Log, low, high, 6).minor.len();
        assert_eq!(minor(-6.0, -2.0), 4 * 9 + 1);
        assert_eq!(minor(-12.0, 0.0), 13, "every decade where every other one is labelled");
    }

    #[test]
    fn linear_labels_are_clean() {
        assert_eq!(labels(Scale::Linear, 0.0, 0.3), ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"]);
        assert_eq!(labels(Scale::Linear, -1.0, 1.0), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(Scale::Linear, 0.0, 80.0), ["0", "20", "40", "60", "80"]);
        let tiny = AxisScale::with_range(Scale::Linear, 0.0, 4e-9, 5);
        assert_eq!(tiny.factor, Some(-9));
        assert_eq!(tiny.ticks[1].1, "1");
    }

    #[test]
    fn ranges_without_digits_are_widened() {
        let denormal = 5e-324;
        let axis = |range| Axis { label: String::new(), scale: Scale::Linear, range };
        for values in [[0.0, denormal], [denormal, denormal], [-1.7e308, 1.7e308], [1e300, 1e300], [1.0, 1.0 + 1e-15]] {
            for fitted in
                [AxisScale::fit(&axis(None), values, 0.05, 5), AxisScale::fit(&axis(Some(values)), [], 0.0, 5)]
            {
                assert!(is_range(fitted.low, fitted.high) && fitted.ticks.len() < 20, "{fitted:?}");
            }
        }
        for values in [vec![], vec![0.0], vec![3.0, 3.0], vec![f64::NAN]] {
            let fitted = AxisScale::fit(&axis(None), values, 0.05, 5);
            assert!(fitted.low < fitted.high && !fitted.ticks.is_empty(), "{fitted:?}");
        }
        assert!(AxisScale::with_range(Scale::Log, -323.3, -323.2, 5).ticks.len() < 20);
        assert!(AxisScale::with_range(Scale::Log, 2.0, 2.01, 5).ticks.len() >= 2);
    }
}
