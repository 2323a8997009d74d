//! Where the material points of a body will be, before anything is made of them.

use std::ops::Range;

use super::geometry::{Position, complexity};
use super::ground::Ground;
use crate::linear_algebra::extremes::largest;
use crate::particles::lattice::{AxisPoint, fills_lattice, point_axes};
use crate::scene::Body;
use crate::scene::shape::distance_to_segment;
use crate::splines::nurbs::{MapPoint, NurbsPatch};

/// Most tests of a point against a corner or circle, over all looks at a body: a tenth of a second.
const MOST_LOOKS: usize = 10_000_000;
/// Most points that are mapped by a geometry: a quarter of a second.
const MOST_MAPPED: usize = 1_000_000;
/// Most points along a segment that are put in order: a tenth of a second.
const MOST_NEAR: usize = 400_000;

/// The points of a body: pairs of its positions along both directions of the mesh that lie in its shape.
pub(super) struct Points<'a> {
    body: &'a Body,
    axes: [Vec<AxisPoint>; 2],
    /// Images of all pairs on a patch with a geometry, first direction fastest.
    mapped: Option<Vec<MapPoint>>,
    fills: bool,
    /// Points that may be looked at.
    most: usize,
}

/// A point near a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    /// Where along the segment it is nearest, m.
    pub along: f64,
    /// Distance from the segment, m.
    pub distance: f64,
    /// Length of a span there along the segment, m.
    pub span: f64,
    /// Length of a span there across the segment, m.
    pub across: f64,
    /// What it stands for, m².
    pub area: f64,
}

impl<'a> Points<'a> {
    /// The points of a body with a sound shape and layout on a sound mesh; `None` if there are too many to be
    /// mapped.
    pub(crate) fn new(body: &'a Body, ground: &Ground<'_>) -> Option<Self> {
        let (spaces, patch) = (ground.spaces.as_ref()?, ground.patch.as_ref());
        let axes = point_axes(body, spaces, patch.is_some());
        let fills = fills_lattice(patch.is_some(), &body.shape);
        let needed = !fills || !body.cracks.is_empty();
        if patch.is_some() && needed && axes[0].len().saturating_mul(axes[1].len()) > MOST_MAPPED {
            return None;
        }
        let mapped = patch.filter(|_| needed).map(|patch| images(patch, &axes));
        let of_a_look = if fills { 1 } else { complexity(&body.shape).max(1) };
        let most = MOST_LOOKS / ((1 + body.cracks.len()) * of_a_look);
        Some(Self { body, axes, mapped, fills, most })
    }

    /// Whether there are points at all.
    pub(crate) fn exist(&self) -> bool {
        let pairs = self.axes.iter().all(|axis| !axis.is_empty());
        pairs && (self.fills || self.any(|_| true))
    }

    /// Whether some point is `wanted`, or none was found among as many as may be looked at.
    pub(crate) fn any(&self, wanted: impl Fn(Position) -> bool) -> bool {
        let [columns, rows] = self.axes.each_ref().map(Vec::len);
        let mut pairs = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j])).map(|pair| self.position(pair));
        let found = pairs.by_ref().take(self.most).any(|x| wanted(x) && self.is_inside(x));
        found || pairs.next().is_some()
    }

    /// The points within a span of a segment, and within `reach` (m), in their order along it; `None` if
    /// there are too many.
    pub(crate) fn near(&self, [from, to]: [Position; 2], reach: f64) -> Option<Vec<Near>> {
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        let candidates = self.candidates(from, along, reach);
        if candidates.iter().map(|(columns, _)| columns.len()).sum::<usize>() > self.most {
            return None;
        }
        let mut near = Vec::new();
        for pair in candidates.into_iter().flat_map(|(columns, j)| columns.map(move |i| [i, j])) {
            let position = self.position(pair);
            let spans = [0, 1].map(|d| self.along(pair, d, |axis| axis.span));
            let [[ax, ay], [bx, by]] = spans;
            let diagonal = (ax * ax + ay * ay + bx * bx + by * by).sqrt();
            let distance = distance_to_segment(position, from, to);
            if distance <= diagonal.max(reach) && self.is_inside(position) {
                if near.len() == MOST_NEAR {
                    return None;
                }
                let project = |v: Position| (v[0] * along[0] + v[1] * along[1]) / length;
                let foot = project([position[0] - from[0], position[1] - from[1]]);
                let span = spans.into_iter().map(|span| project(span).abs()).sum();
                let across = spans.into_iter().map(|[x, y]| project([y, -x]).abs()).sum();
                let [[ax, ay], [bx, by]] = [0, 1].map(|d| self.along(pair, d, |axis| axis.weight));
                let area = (ax * by - ay * bx).abs();
                near.push(Near { along: foot.clamp(0.0, length), distance, span, across, area });
            }
        }
        near.sort_by(|a, b| a.along.total_cmp(&b.along));
        Some(near)
    }

    /// Columns and row of the pairs that may lie within a span, or `reach` (m), of a segment: over a
    /// rectangle those under it, row by row.
    fn candidates(&self, from: Position, along: Position, reach: f64) -> Vec<(Range<usize>, usize)> {
        let [xs, ys] = &self.axes;
        if self.mapped.is_some() {
            return (0..ys.len()).map(|j| (0..xs.len(), j)).collect();
        }
        let [x, y] = self.axes.each_ref().map(|axis| largest(axis.iter().map(|point| point.span)));
        let reach = x.hypot(y).max(reach);
        let within = |axis: &[AxisPoint], low: f64, high: f64| {
            let before = |end: f64| axis.partition_point(|point| point.position <= end);
            axis.partition_point(|point| point.position < low - reach)..before(high + reach)
        };
        let in_row = |j: usize| {
            // the ends of the part of the segment that is no further up or down
            let at = |y: f64| if along[1] == 0.0 { 0.0 } else { ((y - from[1]) / along[1]).clamp(0.0, 1.0) };
            let ends =
                if along[1] == 0.0 { [0.0, 1.0] } else { [ys[j].position - reach, ys[j].position + reach].map(at) };
            let [a, b] = ends.map(|t| from[0] + t * along[0]);
            (within(xs, a.min(b), a.max(b)), j)
        };
        let to = from[1] + along[1];
        within(ys, from[1].min(to), from[1].max(to)).map(in_row).collect()
    }

    fn is_inside(&self, position: Position) -> bool {
        self.fills || self.body.shape.contains(position)
    }

    fn position(&self, [i, j]: [usize; 2]) -> Position {
        match &self.mapped {
            None => [self.axes[0][i].position, self.axes[1][j].position],
            Some(images) => images[j * self.axes[0].len() + i].position,
        }
    }

    /// A length along direction `d` at a point as a vector, m.
    fn along(&self, pair: [usize; 2], d: usize, length: impl Fn(&AxisPoint) -> f64) -> Position {
        let length = length(&self.axes[d][pair[d]]);
        match &self.mapped {
            None => [0, 1].map(|i| if i == d { length } else { 0.0 }),
            Some(images) => images[pair[1] * self.axes[0].len() + pair[0]].jacobian.map(|row| length * row[d]),
        }
    }
}

/// Images of all pairs of parameters.
fn images(patch: &NurbsPatch, [xs, ys]: &[Vec<AxisPoint>; 2]) -> Vec<MapPoint> {
    let image = |parameters: Position| {
        let span = patch.find_span(parameters).expect("points lie in spans");
        patch.map(&patch.shape_functions(span, parameters))
    };
    ys.iter().flat_map(|y| xs.iter().map(|x| image([x.position, y.position]))).collect()
}
