//! Where two boundaries are near each other, square by square.

use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::vectors::{dot, unit};
use crate::splines::patch::Patch;

/// Distance of two encounters along the boundaries, and across them, below which they are one, in squares.
const APART: f64 = 0.6;

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

/// What the segments of two bodies see of each other whose middle of the gap lies in a square: sums.
pub(super) struct Encounter {
    pub bodies: [usize; 2],
    pub square: [usize; 2],
    pub count: f64,
    pub position: [f64; 2],
    pub gap: f64,
    pub normal: [f64; 2],
}

impl Encounter {
    pub(super) fn new(bodies: [usize; 2], square: [usize; 2]) -> Self {
        Self { bodies, square, count: 0.0, position: [0.0; 2], gap: 0.0, normal: [0.0; 2] }
    }

    pub(super) fn position(&self) -> [f64; 2] {
        self.position.map(|sum| sum / self.count)
    }

    /// Mean normal, unless the normals cancel each other.
    pub(super) fn direction(&self) -> Option<[f64; 2]> {
        unit(self.normal, self.count)
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
                Some(whole) => {
                    whole.count += part.count;
                    whole.gap += part.gap;
                    for d in 0..2 {
                        whole.position[d] += part.position[d];
                        whole.normal[d] += part.normal[d];
                    }
                }
            }
        }
        merged
    }
}
