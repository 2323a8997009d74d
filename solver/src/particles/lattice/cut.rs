//! Quadrature over the part of a span inside a shape, and over the parts on both sides of a slit.
//!
//! A span is divided along one direction wherever an edge of the shape or a slit begins, ends, turns back,
//! meets another one or leaves the span. Between two such places every line across meets the same edges,
//! so Gauss points along and across integrate over the part inside (Saye 2015, *High-order quadrature methods
//! for implicitly defined surfaces and volumes in hyperrectangles*, SIAM Journal on Scientific Computing 37):
//! polynomials up to degree 2 p in x and in y exactly between straight edges, to 1e-10 beside arcs. All
//! weights are positive. A span in which an arc turns much is quartered first.

use std::collections::{BTreeMap, BTreeSet};

use crate::linear_algebra::extremes::{larger, smaller};
use crate::scene::edges::BoundaryEdge;
use crate::scene::{Layout, Shape};
use crate::splines::quadrature::{MAX_POINTS, Rule};
use crate::splines::spline::SplineSpace;

/// Parts of a span smaller than this are none, and all but this are all; edges this near to a knot, of the
/// span, are on it.
const SLIVER: f64 = 1e-10;
/// Half of the diagonal of a box over the radius of an arc in it above which the box is quartered, and the
/// component of its normal across below which it is.
const TURN: f64 = 0.15;
const ALONG: f64 = 0.55;
/// Most times a span is quartered.
const DEPTH: usize = 7;
/// Lines across in a span that is divided into boxes, for each row of points in a whole one: steps of boxes
/// along an oblique edge have forces of their own.
const LINES: usize = 2;

/// Lower left and upper right corner, m.
type Corners = [[f64; 2]; 2];
/// Position of a point, and width and height of the box that it stands for, m.
pub(super) type PointBox = ([f64; 2], [f64; 2]);

/// How the part of a span that the boundary leaves is divided.
#[derive(Debug, Clone)]
pub(super) enum Rules {
    /// By Gauss points on lines across, and by lines: between straight edges, and beside arcs.
    Exact { across: Rule, along: [Rule; 2] },
    /// Into boxes no larger than those of so many points per direction in a whole span; twice as many lines.
    Boxes([usize; 2]),
}

impl Rules {
    /// At least so many points on a line across, and what polynomials up to twice the degree need.
    pub(super) fn exact(spaces: &[SplineSpace; 2], points: usize) -> Self {
        let across = spaces.iter().map(|space| space.degree() + 1).fold(points, usize::max);
        let rule = |count: usize| Rule::new(Layout::Gauss, count.min(MAX_POINTS));
        Self::Exact { across: rule(across), along: [2 * across - 1, 2 * across + 2].map(rule) }
    }
}

/// A shape, and the rules to integrate over its part of a span of this width and height, m.
struct Cutter<'a> {
    shape: &'a Shape,
    rules: &'a Rules,
    span: [f64; 2],
}

/// Edges of a shape by column and row of the spans that they run through.
pub(super) type EdgesInSpans = BTreeMap<[usize; 2], Vec<BoundaryEdge>>;

fn corners(spaces: &[SplineSpace; 2], [i, j]: [usize; 2]) -> Corners {
    let spans = [&spaces[0].spans()[i], &spaces[1].spans()[j]];
    [spans.map(|span| span.left), spans.map(|span| span.right)]
}

/// Edges, or slits, by the spans that they run through.
pub(super) fn edges_in_spans(edges: Vec<BoundaryEdge>, spaces: &[SplineSpace; 2]) -> EdgesInSpans {
    let mut found = EdgesInSpans::new();
    for edge in edges {
        let [low, high] = edge.bounding_box();
        let reached = |d: usize| {
            let spans = spaces[d].spans();
            let first = spans.partition_point(|span| span.right < low[d]);
            first..spans.partition_point(|span| span.left <= high[d]).max(first)
        };
        for span in reached(1).flat_map(|j| reached(0).map(move |i| [i, j])) {
            if crosses(&edge, corners(spaces, span)) {
                found.entry(span).or_default().push(edge.clone());
            }
        }
    }
    found
}

/// The points of all spans, by column and row, that the boundary of a shape cuts, or a slit.
pub(super) fn cut_spans<'a>(
    shape: &'a Shape,
    [edges, slits]: [&'a EdgesInSpans; 2],
    spaces: &'a [SplineSpace; 2],
    rules: Rules,
) -> impl Iterator<Item = ([usize; 2], Vec<PointBox>)> + 'a {
    let spans: BTreeSet<[usize; 2]> = edges.keys().chain(slits.keys()).copied().collect();
    spans.into_iter().filter_map(move |span| {
        let [low, high] = corners(spaces, span);
        let cutter = Cutter { shape, rules: &rules, span: [0, 1].map(|d| high[d] - low[d]) };
        let mut points = Vec::new();
        let all: Vec<&BoundaryEdge> = edges.get(&span).into_iter().chain(slits.get(&span)).flatten().collect();
        cutter.add([low, high], &all, 0, &mut points);
        let part = points.iter().map(|(_, [width, height])| width * height).sum::<f64>()
            / ((high[0] - low[0]) * (high[1] - low[1]));
        let is_cut = part < 1.0 - SLIVER || slits.contains_key(&span);
        (part > SLIVER && is_cut).then_some((span, points))
    })
}

/// Whether an edge runs through the inside of a box.
fn crosses(edge: &BoundaryEdge, [low, high]: Corners) -> bool {
    let [low, high] = [[low, high], [high, low]].map(|[a, b]| [0, 1].map(|d| a[d] + SLIVER * (b[d] - a[d])));
    match edge {
        BoundaryEdge::Line([a, b]) => {
            let mut part: [f64; 2] = [0.0, 1.0];
            for d in 0..2 {
                let along = b[d] - a[d];
                let ends = [(low[d] - a[d]) / along, (high[d] - a[d]) / along];
                if along == 0.0 {
                    if a[d] <= low[d] || a[d] >= high[d] {
                        return false;
                    }
                } else {
                    part = [larger(part[0], smaller(ends[0], ends[1])), smaller(part[1], larger(ends[0], ends[1]))];
                }
            }
            part[0] < part[1]
        }
        BoundaryEdge::Circle { center, radius, .. } => {
            let nearest = |d: usize| (low[d] - center[d]).max(center[d] - high[d]).max(0.0);
            let furthest = |d: usize| (center[d] - low[d]).max(high[d] - center[d]);
            nearest(0).hypot(nearest(1)) < *radius && furthest(0).hypot(furthest(1)) > *radius
        }
    }
}

impl Cutter<'_> {
    /// Adds the points of the part of a box that is inside.
    fn add(&self, corners: Corners, edges: &[&BoundaryEdge], depth: usize, out: &mut Vec<PointBox>) {
        let [low, high] = corners;
        let middle = [0, 1].map(|d| 0.5 * (low[d] + high[d]));
        let edges: Vec<&BoundaryEdge> = edges.iter().copied().filter(|edge| crosses(edge, corners)).collect();
        if edges.is_empty() {
            if self.shape.contains(middle) {
                self.fill(corners, out);
            }
            return;
        }
        let half = 0.5 * (high[0] - low[0]).hypot(high[1] - low[1]);
        let (mut across, mut turns, mut arcs) = ([1.0_f64; 2], 0.0_f64, false);
        for edge in &edges {
            let BoundaryEdge::Circle { center, radius, .. } = edge else { continue };
            let from_center = [middle[0] - center[0], middle[1] - center[1]];
            let distance = from_center[0].hypot(from_center[1]);
            across = [0, 1].map(|d| smaller(across[d], (from_center[d] / distance).abs()));
            (turns, arcs) = (larger(turns, half / radius), true);
        }
        let inner = usize::from(across[1] > across[0]);
        if depth < DEPTH && (turns > TURN || across[inner] < ALONG) {
            for quarter in 0..4 {
                let upper = [quarter % 2 == 1, quarter / 2 == 1];
                let corner = |ends: Corners, d: usize| if upper[d] { ends[1][d] } else { ends[0][d] };
                let quarter = [[0, 1].map(|d| corner([low, middle], d)), [0, 1].map(|d| corner([middle, high], d))];
                self.add(quarter, &edges, depth + 1, out);
            }
            return;
        }
        self.slice(corners, &edges, inner, usize::from(arcs), out);
    }

    /// Places of points on a line along direction `d`, and the lengths that they stand for.
    fn points(&self, [from, to]: [f64; 2], d: usize) -> Vec<(f64, f64)> {
        match self.rules {
            Rules::Exact { across, .. } => across.between(from, to).collect(),
            Rules::Boxes(points) => self.equal([from, to], d, points[d]),
        }
    }

    /// Places of lines in a slab along direction `d`, and the widths that they stand for.
    fn lines(&self, [from, to]: [f64; 2], d: usize, arcs: usize) -> Vec<(f64, f64)> {
        match self.rules {
            Rules::Exact { along, .. } => along[arcs].between(from, to).collect(),
            Rules::Boxes(points) => self.equal([from, to], d, LINES * points[d]),
        }
    }

    /// Middles and lengths of equal parts, of which there are so many in a whole span.
    fn equal(&self, [from, to]: [f64; 2], d: usize, per_span: usize) -> Vec<(f64, f64)> {
        let parts = ((to - from) / self.span[d] * per_span as f64 - 1e-9).ceil().max(1.0);
        let length = (to - from) / parts;
        (0..parts as usize).map(|part| (from + (part as f64 + 0.5) * length, length)).collect()
    }

    /// Points in all of a box.
    fn fill(&self, [low, high]: Corners, out: &mut Vec<PointBox>) {
        let [columns, rows] = [0, 1].map(|d| self.points([low[d], high[d]], d));
        out.extend(rows.iter().flat_map(|&(y, v)| columns.iter().map(move |&(x, w)| ([x, y], [w, v]))));
    }

    /// Points on lines across direction `inner`.
    fn slice(&self, [low, high]: Corners, edges: &[&BoundaryEdge], inner: usize, arcs: usize, out: &mut Vec<PointBox>) {
        let outer = 1 - inner;
        let mut breaks = vec![low[outer], high[outer]];
        for (n, edge) in edges.iter().enumerate() {
            breaks.extend(edge.bounding_box().map(|corner| corner[outer]));
            let sides = fault!("cut-spans-undivided", [low[inner], high[inner]] => [f64::INFINITY; 2]);
            breaks.extend(sides.into_iter().flat_map(|side| edge.crossings(inner, side)));
            breaks.extend(edges[..n].iter().flat_map(|other| edge.meets(other)).map(|place| place[outer]));
        }
        breaks.retain(|x| (low[outer]..=high[outer]).contains(x));
        breaks.sort_by(f64::total_cmp);
        for slab in breaks.windows(2).filter(|slab| slab[1] - slab[0] > 1e-14 * (high[outer] - low[outer])) {
            for (place, weight) in self.lines([slab[0], slab[1]], outer, arcs) {
                let along = |x: f64, y: f64| if inner == 0 { [x, y] } else { [y, x] };
                let on_line = |x: f64| along(x, place);
                let mut ends = vec![low[inner], high[inner]];
                let met = edges.iter().flat_map(|edge| edge.crossings(outer, place));
                ends.extend(met.filter(|x| (low[inner]..=high[inner]).contains(x)));
                ends.sort_by(f64::total_cmp);
                for part in ends.windows(2) {
                    if part[1] > part[0] && self.shape.contains(on_line(0.5 * (part[0] + part[1]))) {
                        let points = self.points([part[0], part[1]], inner).into_iter();
                        out.extend(points.map(|(x, length)| (on_line(x), along(length, weight))));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;
    use crate::splines::patch::Patch;

    fn all(shape: &Shape, spaces: &[SplineSpace; 2]) -> BTreeMap<[usize; 2], Vec<PointBox>> {
        let edges = edges_in_spans(shape.edges(), spaces);
        cut_spans(shape, [&edges, &EdgesInSpans::new()], spaces, Rules::exact(spaces, 1)).collect()
    }

    /// `∫ x^a y^b` over a shape on a mesh: spans inside by their middles.
    fn moment(shape: &Shape, degree: usize, [a, b]: [i32; 2]) -> f64 {
        let patch = Patch::new(&Mesh::uniform([degree; 2], [-1.5, -1.4], [3.0, 2.8], [13, 11]));
        let cut = all(shape, &patch.spaces);
        let rule = Rule::new(Layout::Gauss, degree + 1);
        let mut sum = 0.0;
        for (i, x) in patch.spaces[0].spans().iter().enumerate() {
            for (j, y) in patch.spaces[1].spans().iter().enumerate() {
                let whole = || {
                    let inside = shape.contains([0.5 * (x.left + x.right), 0.5 * (y.left + y.right)]);
                    let points = rule
                        .between(y.left, y.right)
                        .flat_map(|(y, v)| rule.between(x.left, x.right).map(move |(x, w)| ([x, y], [w, v])));
                    points.filter(|_| inside).collect::<Vec<_>>()
                };
                let points = cut.get(&[i, j]).cloned().unwrap_or_else(whole);
                sum += points.iter().map(|([x, y], [w, v])| w * v * x.powi(a) * y.powi(b)).sum::<f64>();
            }
        }
        sum
    }

    fn factorial(n: i32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    #[test]
    fn polynomials_up_to_twice_the_degree_are_integrated_over_polygons_and_arcs() {
        let power = |from: f64, to: f64, n: i32| (to.powi(n + 1) - from.powi(n + 1)) / f64::from(n + 1);
        let rectangle = Shape::Rectangle { min: [-0.71, -0.33], max: [0.64, 1.05] };
        let notched = Shape::Difference {
            of: Box::new(rectangle.clone()),
            minus: vec![Shape::Rectangle { min: [-2.0, 0.31], max: [0.11, 0.33] }],
        };
        let triangle = Shape::Polygon { points: vec![[0.0, 0.0], [1.1, 0.0], [0.0, 0.9]] };
        let disk = Shape::Disk { center: [0.0; 2], radius: 0.93 };
        let ring = Shape::Annulus { center: [0.0; 2], inner_radius: 0.17, outer_radius: 1.1 };
        let on_circle = |[a, b]: [i32; 2], radius: f64| {
            let odd = a % 2 == 1 || b % 2 == 1;
            let double = |n: i32| (1..=n).rev().step_by(2).map(f64::from).product::<f64>();
            let mean = double(a - 1) * double(b - 1) / double(a + b);
            if odd { 0.0 } else { std::f64::consts::TAU * mean * radius.powi(a + b + 2) / f64::from(a + b + 2) }
        };
        for degree in [2, 3, 4] {
            for [a, b] in (0..=2 * degree as i32).flat_map(|a| (0..=2 * degree as i32).map(move |b| [a, b])) {
                let check = |name: &str, shape: &Shape, exact: f64, tolerance: f64| {
                    let found = moment(shape, degree, [a, b]);
                    assert!((found - exact).abs() <= tolerance, "{name}, p = {degree}, {a} {b}: {found} for {exact}");
                };
                let box_of = |x: [f64; 2], y: [f64; 2]| power(x[0], x[1], a) * power(y[0], y[1], b);
                check("rectangle", &rectangle, box_of([-0.71, 0.64], [-0.33, 1.05]), 1e-12);
                let slot = box_of([-0.71, 0.11], [0.31, 0.33]);
                check("notch", &notched, box_of([-0.71, 0.64], [-0.33, 1.05]) - slot, 1e-12);
                let simplex = factorial(a) * factorial(b) / factorial(a + b + 2);
                check("triangle", &triangle, simplex * 1.1_f64.powi(a + 1) * 0.9_f64.powi(b + 1), 1e-12);
                check("disk", &disk, on_circle([a, b], 0.93), 1e-10);
                check("ring", &ring, on_circle([a, b], 1.1) - on_circle([a, b], 0.17), 1e-10);
            }
        }
    }

    #[test]
    fn edges_on_knots_and_shapes_that_overlap_cut_nothing_they_do_not_bound() {
        let spaces = Patch::new(&Mesh::uniform([2; 2], [0.0; 2], [1.0; 2], [10, 10])).spaces;
        let block = Shape::Rectangle { min: [0.1 + 0.2, 0.2], max: [0.7, 0.8] };
        assert!(all(&block, &spaces).is_empty(), "0.1 + 0.2 is on the knot at 0.3");
        let outside = Shape::Disk { center: [0.95, 0.95], radius: 0.14 };
        let trimmed = Shape::Difference { of: Box::new(block), minus: vec![outside] };
        assert!(all(&trimmed, &spaces).is_empty(), "a disk beyond the corner takes nothing away");
        let two = Shape::Difference {
            of: Box::new(Shape::Disk { center: [0.5, 0.5], radius: 0.4 }),
            minus: vec![Shape::Disk { center: [0.7, 0.5], radius: 0.3 }],
        };
        let area: f64 = all(&two, &spaces).values().flatten().map(|(_, [w, v])| w * v).sum();
        let whole = spaces[0].spans().iter().flat_map(|x| spaces[1].spans().iter().map(move |y| [x, y]));
        let cut = all(&two, &spaces);
        let inside = whole.enumerate().filter(|(n, [x, y])| {
            let middle = [0.5 * (x.left + x.right), 0.5 * (y.left + y.right)];
            !cut.contains_key(&[n / 10, n % 10]) && two.contains(middle)
        });
        let (r, s, d): (f64, f64, f64) = (0.4, 0.3, 0.2);
        let angle = |r: f64, s: f64| ((d * d + r * r - s * s) / (2.0 * d * r)).acos();
        let half = |r: f64, angle: f64| r * r * (angle - angle.sin() * angle.cos());
        let lens = half(r, angle(r, s)) + half(s, angle(s, r));
        let exact = std::f64::consts::PI * r * r - lens;
        approx::assert_abs_diff_eq!(area + 0.01 * inside.count() as f64, exact, epsilon = 1e-10);
    }
}
