//! Where two boundaries are near each other, square by square.

use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::vectors::{dot, unit};
use crate::splines::patch::Patch;

/// Distance of two encounters along the boundaries, and across them, below which they are one, in squares.
const APART: f64 = 0.6;
/// Difference of gaps, in spans, by which the larger one counts least; and how much that is. Within it a
/// curve is flat to a few tenths of a span.
const DEPTH: f64 = 0.01;
const LEAST: f64 = 0.01;
/// Overlap, in spans, by which a segment counts twice: a wedge meets more than its tip.
const OVERLAP: f64 = 0.1;

/// Squares around the crossings of knot lines, as large as a span: a plane of symmetry along a knot line cuts
/// none.
#[derive(Debug, Clone)]
pub(super) struct Squares([Vec<f64>; 2]);

impl Squares {
    pub(super) fn new(patch: &Patch) -> Self {
        Self([0, 1].map(|d| {
            let spans = patch.spaces[d].spans();
            spans.iter().map(|span| span.left).chain(spans.last().map(|span| span.right)).collect()
        }))
    }

    /// Column and row of the square of a position, m.
    pub(super) fn of(&self, position: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|d| {
            let (knots, x) = (&self.0[d], position[d]);
            let next = knots.partition_point(|knot| *knot <= x).clamp(1, knots.len() - 1);
            if x - knots[next - 1] < knots[next] - x { next - 1 } else { next }
        })
    }

    /// Width and height of a square, m.
    fn size(&self, square: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|d| {
            let beside = self.0[d][square[d].saturating_sub(1)..].windows(2).take(2);
            beside.map(|knots| knots[1] - knots[0]).fold(f64::INFINITY, smaller)
        })
    }
}

/// What a segment sees of another boundary.
#[derive(Clone, Copy)]
pub(super) struct Sight {
    pub position: [f64; 2],
    pub gap: f64,
    pub normal: [f64; 2],
    /// Length of the segment, m.
    pub length: f64,
}

/// What the segments of two bodies see of each other whose middle of the gap lies in a square.
pub(super) struct Encounter {
    pub bodies: [usize; 2],
    pub square: [usize; 2],
    pub seen: Vec<Sight>,
    /// Length of a span, m.
    pub span: f64,
    /// Whether the boundaries are not rigid.
    pub soft: bool,
}

impl Encounter {
    /// Mean over the segments, with weights: a curve touches a line at one place, not in all of a square. The
    /// weights of boundaries that are not rigid are their forces: so these work at the mean as they do at the
    /// segments.
    fn mean<const N: usize>(&self, value: impl Fn(&Sight) -> [f64; N]) -> [f64; N] {
        let nearest = self.seen.iter().map(|sight| sight.gap).fold(f64::INFINITY, smaller);
        let least = larger(nearest, 0.0);
        let (mut sum, mut count) = ([0.0; N], 0.0);
        for sight in &self.seen {
            let (open, overlap) = (larger(sight.gap, 0.0) - least, larger(-sight.gap, 0.0));
            let depth = fault!("all-segments-of-a-square-count", DEPTH => f64::INFINITY) * self.span;
            let weight = if self.soft && nearest < 0.0 {
                sight.length * overlap
            } else {
                larger(1.0 - open / depth, LEAST) + overlap / (OVERLAP * self.span)
            };
            let value = value(sight);
            count += weight;
            (0..N).for_each(|n| sum[n] += weight * value[n]);
        }
        sum.map(|sum| sum / count)
    }

    pub(super) fn position(&self) -> [f64; 2] {
        self.mean(|sight| sight.position)
    }

    pub(super) fn gap(&self) -> f64 {
        self.mean(|sight| [sight.gap])[0]
    }

    /// Depth of the boundaries in each other, integrated along half of their length, m².
    pub(super) fn overlap(&self) -> f64 {
        let half = fault!("overlap-counted-twice", 0.5 => 1.0);
        self.seen.iter().map(|sight| half * sight.length * larger(-sight.gap, 0.0)).sum()
    }

    /// Mean normal, unless the normals cancel each other.
    pub(super) fn direction(&self) -> Option<[f64; 2]> {
        unit(self.mean(|sight| sight.normal), 1.0)
    }

    /// Whether both are parts of what one square should see: along the border of two rows of squares,
    /// boundaries are in either to round-off.
    fn is_part_of(&self, other: &Self, squares: &Squares) -> bool {
        let apart = |d: usize| self.square[d].abs_diff(other.square[d]);
        let (Some(normal), Some(others)) = (self.direction(), other.direction()) else { return false };
        if larger(apart(0) as f64, apart(1) as f64) > 1.0 || dot(normal, others) < 0.5 {
            return false;
        }
        let ([width, height], [x, y]) = (squares.size(self.square), self.position());
        let Some(along) = unit([-normal[1] / width, normal[0] / height], 1.0 / width + 1.0 / height) else {
            return false;
        };
        let [to_x, to_y] = other.position();
        let between = [(to_x - x) / width, (to_y - y) / height];
        let across = [-along[1], along[0]];
        dot(between, along).abs() < APART && dot(between, across).abs() < APART
    }

    /// Encounters of which none is a part of another.
    pub(super) fn merged(found: impl Iterator<Item = Self>, squares: &Squares) -> Vec<Self> {
        let mut merged = Vec::<Self>::new();
        for part in found {
            match merged.iter_mut().find(|whole| part.is_part_of(whole, squares)) {
                None => merged.push(part),
                Some(whole) => whole.seen.extend(part.seen),
            }
        }
        merged
    }
}
