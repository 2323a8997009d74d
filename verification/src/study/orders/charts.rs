//! Figures of a convergence study: error against h, unknowns and measured cost on two logarithmic axes.

use super::{Convergence, Curve, Norm, Refined, above_floor, has_times, words};
use crate::extremes::{larger, smaller};
use crate::record::{self, Axis, CurveStyle, Figure, FigureBody, Floor, SlopeTriangle};

/// Column of the unknowns.
pub(super) const UNKNOWNS: &str = "unknowns";
/// Column of the measured time.
pub(super) const SECONDS: &str = "seconds";
/// The floor is drawn if some error comes within this factor of it.
const NEAR: f64 = 100.0;
/// Length of a triangle over that of the interval it stands at.
const LENGTH: f64 = 0.5;
/// Distance of a triangle from its curve, as a fraction of the decades of the chart.
const GAP: f64 = 0.03;

/// What the error is drawn against.
#[derive(Clone, Copy, PartialEq)]
enum Against {
    Size,
    Unknowns,
    Cost,
}

/// A point `(log x, log error)`.
type Point = (f64, f64);

pub(super) fn figures(study: &Convergence) -> Vec<Figure> {
    let mut figures = Vec::new();
    for index in 0..study.norms.len() {
        let drawn: Vec<&Curve> = study.curves.iter().filter(|curve| curve.errors(index).iter().any(positive)).collect();
        if drawn.is_empty() {
            continue;
        }
        figures.push(figure(study, index, Against::Size, &drawn));
        if index > 0 {
            continue; // one norm is enough to compare degrees at equal unknowns and at equal cost
        }
        if matches!(study.refined, Refined::Mesh { .. }) {
            figures.push(figure(study, index, Against::Unknowns, &drawn));
        }
        let timed: Vec<&Curve> = drawn.into_iter().filter(|curve| has_times(curve)).collect();
        if !timed.is_empty() {
            figures.push(figure(study, index, Against::Cost, &timed));
        }
    }
    figures
}

fn figure(study: &Convergence, index: usize, against: Against, curves: &[&Curve]) -> Figure {
    let norm = &study.norms[index];
    let name = format!("{}-{}", study.stem, words(&norm.quantity, "-"));
    let [size, axis, _] = study.refined.words();
    let (id, title, x, column) = match against {
        Against::Size => (name, study.title.clone(), axis, size),
        Against::Unknowns => (format!("{name}-unknowns"), per(study, "unknown"), "unknowns", UNKNOWNS),
        Against::Cost => (format!("timing/{name}"), per(study, "second"), "measured wall time (s)", SECONDS),
    };
    let unit = if norm.unit == "1" { String::new() } else { format!(" ({})", norm.unit) };
    let slopes = if against == Against::Cost { Vec::new() } else { triangles(study, index, against, curves) };
    let body = FigureBody::Chart {
        x: Axis::logarithmic(x),
        y: Axis::logarithmic(&format!("{}{unit}", norm.quantity)),
        curves: curves.iter().map(|curve| drawn(study, curve, norm, against, column)).collect(),
        regions: Vec::new(),
        slopes,
        floors: floor(norm, index, curves).into_iter().collect(),
    };
    Figure { deviations: study.deviations.clone(), ..Figure::new(&study.suite, [&id, &title, &study.caption], body) }
}

fn per(study: &Convergence, what: &str) -> String {
    format!("{}: error per {what}", study.title)
}

fn drawn(study: &Convergence, curve: &Curve, norm: &Norm, against: Against, x: &str) -> record::Curve {
    let stem = if against == Against::Cost { study.timing_stem(curve) } else { study.series_stem(curve) };
    let (label, series) = (curve.name.replace('=', " = "), format!("series/{stem}.csv"));
    let line = record::Curve::line(&label, &series, [x, &norm.column()]);
    record::Curve { style: CurveStyle::Markers, ..line }
}

fn positive(level: &(f64, f64)) -> bool {
    level.1.is_finite() && level.1 > 0.0
}

fn floor(norm: &Norm, index: usize, curves: &[&Curve]) -> Option<Floor> {
    let near = |curve: &&Curve| curve.errors(index).iter().any(|level| positive(level) && level.1 < NEAR * norm.floor);
    curves.iter().any(near).then(|| Floor { y: norm.floor, label: "round-off".into() })
}

/// One triangle per order of theory, under a curve that should show it, where it meets no other curve.
fn triangles(study: &Convergence, index: usize, against: Against, curves: &[&Curve]) -> Vec<SlopeTriangle> {
    let lines: Vec<Vec<Point>> = curves.iter().map(|curve| points(curve, index, against, 0.0)).collect();
    let ordinates = || lines.iter().flatten().map(|p| p.1);
    let gap = GAP * (ordinates().fold(f64::MIN, larger) - ordinates().fold(f64::MAX, smaller));
    let mut slopes: Vec<f64> = curves.iter().filter_map(|curve| slope(study, curve.orders[index]?, against)).collect();
    slopes.sort_by(f64::total_cmp);
    slopes.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let place = |slope: f64| {
        let shows = |curve: &Curve| {
            let own = curve.orders[index].and_then(|order| self::slope(study, order, against));
            own.is_some_and(|own| (own - slope).abs() < 1e-9)
        };
        let candidates = curves.iter().enumerate().filter(|(_, curve)| shows(curve)).flat_map(|(of, curve)| {
            let usable = points(curve, index, against, study.norms[index].floor);
            let places: Vec<Place> = usable.windows(2).map(|pair| Place::below(pair, slope, gap)).collect();
            places.into_iter().rev().map(move |place| (of, place))
        });
        let clearances = candidates.map(|(of, place)| (place.clearance(of, &lines), place));
        let clear = |best: Option<(f64, Place)>, next: (f64, Place)| match best {
            Some(best) if best.0 >= gap.min(next.0) => Some(best),
            _ => Some(next),
        };
        clearances.fold(None, clear).map(|(_, place)| place.triangle(slope))
    };
    slopes.into_iter().filter_map(place).collect()
}

/// Levels above the floor, from coarse to fine.
fn points(curve: &Curve, index: usize, against: Against, floor: f64) -> Vec<Point> {
    let errors = curve.errors(index);
    let usable = above_floor(&errors, floor).len();
    let levels = curve.sorted().into_iter().take(usable);
    let abscissa = |level: &super::Level| match against {
        Against::Size => level.h,
        Against::Unknowns => level.unknowns as f64,
        Against::Cost => level.seconds,
    };
    levels.map(|level| (abscissa(level).log10(), level.errors[index].log10())).filter(|p| p.1.is_finite()).collect()
}

/// The slope at which an order appears.
fn slope(study: &Convergence, order: f64, against: Against) -> Option<f64> {
    match (against, study.refined) {
        (Against::Size, _) => Some(order),
        (Against::Unknowns, Refined::Mesh { dimensions }) => Some(-order / dimensions as f64),
        _ => None,
    }
}

/// Where a triangle may stand: its ends and the hypotenuse there.
struct Place {
    x: [f64; 2],
    y: [f64; 2],
}

impl Place {
    /// Under the interval between two levels, `gap` below the line.
    fn below(pair: &[Point], slope: f64, gap: f64) -> Self {
        let (left, right) = if pair[0].0 < pair[1].0 { (pair[0], pair[1]) } else { (pair[1], pair[0]) };
        let middle = 0.5 * (left.0 + right.0);
        let half = 0.5 * LENGTH * (right.0 - left.0);
        let x = [middle - half, middle + half];
        let own = (right.1 - left.1) / (right.0 - left.0);
        let line = |x: f64| left.1 + own * (x - left.0);
        let drop = line(x[0]).min(line(x[1]) - slope * (x[1] - x[0])) - gap;
        Self { x, y: [drop, drop + slope * (x[1] - x[0])] }
    }

    /// Distance, in decades, from the other lines: positive where none of them meets the triangle.
    fn clearance(&self, own: usize, lines: &[Vec<Point>]) -> f64 {
        let low = self.y[0].min(self.y[1]);
        let hypotenuse = |s: f64| self.y[0] + s * (self.y[1] - self.y[0]);
        let others = lines.iter().enumerate().filter(|(index, _)| *index != own).map(|(_, line)| line);
        let distance = |line: &Vec<Point>, s: f64| {
            let y = at(line, self.x[0] + s * (self.x[1] - self.x[0]))?;
            Some((low - y).max(y - hypotenuse(s)))
        };
        let distances = others.flat_map(|line| [0.0, 0.5, 1.0].map(|s| distance(line, s))).flatten();
        distances.fold(f64::INFINITY, smaller)
    }

    fn triangle(self, slope: f64) -> SlopeTriangle {
        SlopeTriangle { x: self.x.map(power), y0: power(self.y[0]), slope, label: fraction(slope.abs()) }
    }
}

/// Ordinate of a polyline at `x`.
fn at(line: &[Point], x: f64) -> Option<f64> {
    line.windows(2).find_map(|pair| {
        let s = (x - pair[0].0) / (pair[1].0 - pair[0].0);
        (0.0..=1.0).contains(&s).then(|| pair[0].1 + s * (pair[1].1 - pair[0].1))
    })
}

fn power(exponent: f64) -> f64 {
    10f64.powf(exponent)
}

/// `3`, `3/2`, or decimals.
fn fraction(value: f64) -> String {
    let whole = |n: f64| (value * n - (value * n).round()).abs() < 1e-9;
    match [1.0, 2.0, 3.0].into_iter().find(|n| whole(*n)) {
        Some(1.0) => format!("{value:.0}"),
        Some(n) => format!("{:.0}/{n:.0}", value * n),
        None => format!("{value:.2}"),
    }
}
