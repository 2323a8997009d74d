//! The background mesh of a scene.

use super::condition::Side;
use super::shape::Shape;
use crate::linear_algebra::extremes::{larger, smaller};

/// Distance of a shape from a knot that counts as none, of the size of the shape.
const NEAR: f64 = 1e-12;
/// The same from a side of the mesh, of the size of the mesh.
const ON_SIDE: f64 = 1e-9;

/// Background NURBS patch: a B-spline patch over an axis-aligned rectangle, or any other with its geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Polynomial degree per direction, 1 to 4.
    pub degree: [usize; 2],
    /// Open knot vector per direction: first and last knot repeated `degree + 1` times. In metres over a
    /// rectangle, in any unit with a geometry.
    pub knots: [Vec<f64>; 2],
    /// Control points and weights; absent over a rectangle, whose knots are its coordinates.
    pub geometry: Option<Geometry>,
    /// How often spans near a crack are halved; zero without refinement.
    pub halvings: usize,
}

/// Geometry of a general patch, row by row, first direction fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Positions x and y of the control points, m.
    pub control_points: Vec<[f64; 2]>,
    /// Weights, all positive.
    pub weights: Vec<f64>,
}

impl Mesh {
    /// Open uniform knots: `cells[d]` equal spans of a rectangle with lower left corner `origin` (m) and
    /// `size` (m).
    pub fn uniform(degree: [usize; 2], origin: [f64; 2], size: [f64; 2], cells: [usize; 2]) -> Self {
        let knots = [0, 1].map(|d| {
            let interior = (0..=cells[d]).map(|i| origin[d] + size[d] * (i as f64 / cells[d] as f64));
            let mut knots = vec![origin[d]; degree[d]];
            knots.extend(interior);
            knots.extend(std::iter::repeat_n(origin[d] + size[d], degree[d]));
            knots
        });
        Self::of_knots(degree, knots)
    }

    /// A mesh over a rectangle with these knots, m.
    pub fn of_knots(degree: [usize; 2], knots: [Vec<f64>; 2]) -> Self {
        Self { degree, knots, geometry: None, halvings: 0 }
    }

    /// Joins the two spans next to a side of a mesh over a rectangle, all along it; `false` if there is only
    /// one. There the functions of degree 2 and more have the highest frequencies: the critical step is that
    /// of the spans at the sides, and grows with their length.
    pub fn lengthen_end(&mut self, side: Side) -> bool {
        let (d, upper) = side.axis();
        let inner = self.degree[d] + 1..self.knots[d].len().saturating_sub(self.degree[d] + 1);
        let knots = self.knots[d].get(inner).unwrap_or_default();
        let next = if upper { knots.last() } else { knots.first() };
        let Some(next) = next.copied() else { return false };
        self.knots[d].retain(|knot| *knot != next);
        true
    }

    /// The mesh whose spans are half as long.
    pub(crate) fn halved(&self) -> Self {
        let knots = self.knots.each_ref().map(|knots| {
            let middle = |pair: &[f64]| (pair[1] > pair[0]).then_some(0.5 * (pair[0] + pair[1]));
            let pairs = knots.windows(2).flat_map(|pair| std::iter::once(pair[0]).chain(middle(pair)));
            pairs.chain(knots.last().copied()).collect()
        });
        Self { knots, ..self.clone() }
    }

    /// The mesh whose spans are all as short as those near a crack.
    pub(crate) fn finest(&self) -> Self {
        let finest = (0..self.halvings).fold(self.clone(), |mesh, _| mesh.halved());
        Self { halvings: 0, ..finest }
    }

    /// Lower left corner of the patch, or of the box around its control points, m.
    pub fn origin(&self) -> [f64; 2] {
        [0, 1].map(|d| match &self.geometry {
            None => self.knots[d].first().copied().unwrap_or(0.0),
            Some(geometry) => geometry.control_points.iter().map(|p| p[d]).fold(f64::INFINITY, smaller),
        })
    }

    /// Upper right corner of the patch, or of the box around its control points, m.
    pub fn end(&self) -> [f64; 2] {
        [0, 1].map(|d| match &self.geometry {
            None => self.knots[d].last().copied().unwrap_or(0.0),
            Some(geometry) => geometry.control_points.iter().map(|p| p[d]).fold(f64::NEG_INFINITY, larger),
        })
    }

    /// The box around the part of a shape that lies in the box around the patch: lower left and upper right
    /// corner, m.
    pub fn extent(&self, shape: &Shape) -> ([f64; 2], [f64; 2]) {
        let (low, high) = shape.bounding_box();
        let (origin, end) = (self.origin(), self.end());
        ([0, 1].map(|d| low[d].max(origin[d])), [0, 1].map(|d| high[d].min(end[d])))
    }

    /// The spans of a mesh over a rectangle that a shape reaches into, as a mesh of their own: the same
    /// polynomials on each of them.
    pub(crate) fn around(&self, shape: &Shape) -> Self {
        let (low, high) = self.extent(shape);
        let knots = [0, 1].map(|d| {
            let (degree, knots) = (self.degree[d], &self.knots[d]);
            let near = NEAR * (high[d] - low[d]);
            let first = knots.partition_point(|knot| *knot <= low[d] + near).max(degree + 1) - 1;
            let last = knots.partition_point(|knot| *knot < high[d] - near).min(knots.len() - degree - 1);
            let inner = knots[..last].iter().skip(first + 1).copied();
            let ends = |knot: f64| std::iter::repeat_n(knot, degree + 1);
            ends(knots[first]).chain(inner).chain(ends(knots[last])).collect()
        });
        Self::of_knots(self.degree, knots)
    }

    /// Whether a shape reaches a side of the box around the mesh.
    pub(crate) fn is_reached(&self, side: Side, shape: &Shape) -> bool {
        let (d, upper) = side.axis();
        let (origin, end, (min, max)) = (self.origin()[d], self.end()[d], self.extent(shape));
        let tolerance = ON_SIDE * (end - origin);
        if upper { max[d] >= end - tolerance } else { min[d] <= origin + tolerance }
    }
}
