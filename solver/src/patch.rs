//! The background patch: a tensor product of two spline spaces, and the layout of control-point fields.
//!
//! Fields on the control points are rows of `stride` numbers, x fastest. Each row begins and ends with room for reading
//! [`LANES`] neighbours past the control points; the room stays zero.

use crate::lane::LANES;
use crate::scene::{Mesh, Side};
use crate::spline::{MAX_DEGREE, SplineSpace};

/// Room before the first control point of a row.
const LEAD: usize = LANES;

/// Tensor-product B-spline patch over an axis-aligned rectangle.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Spline spaces in x and y, on knots in metres.
    pub spaces: [SplineSpace; 2],
}

impl Patch {
    /// The patch of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        Self { spaces: [0, 1].map(|d| SplineSpace::new(mesh.degree[d], &mesh.knots[d])) }
    }

    /// Layout of fields on its control points.
    pub fn control_grid(&self) -> ControlGrid {
        let [columns, rows] = [0, 1].map(|d| self.spaces[d].dimension());
        ControlGrid { columns, rows, stride: (LEAD + columns + MAX_DEGREE + LANES).next_multiple_of(LANES) }
    }

    /// Largest span lengths that meet the rectangle from `low` to `high`, m.
    pub fn largest_spans(&self, low: [f64; 2], high: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| {
            self.spaces[d]
                .spans()
                .iter()
                .filter(|span| span.right > low[d] && span.left < high[d])
                .map(|span| span.length())
                .fold(0.0, f64::max)
        })
    }
}

/// A scalar field and its gradient at a position.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PointValue {
    /// Value.
    pub value: f64,
    /// Gradient, 1/m.
    pub gradient: [f64; 2],
}

impl Patch {
    /// A field of control values at a position (m); `None` outside the patch.
    pub fn evaluate(&self, field: &[f64], position: [f64; 2]) -> Option<PointValue> {
        let grid = self.control_grid();
        let [x, y] = &self.spaces;
        let (i, j) = (x.find_span(position[0])?, y.find_span(position[1])?);
        let (sx, sy) = (x.shape_functions(i, position[0]), y.shape_functions(j, position[1]));
        let first = grid.index(x.spans()[i].first, y.spans()[j].first);
        let mut result = PointValue::default();
        for l in 0..=y.degree() {
            for k in 0..=x.degree() {
                let control = field[first + l * grid.stride + k];
                result.value += sx.value[k] * sy.value[l] * control;
                result.gradient[0] += sx.derivative[k] * sy.value[l] * control;
                result.gradient[1] += sx.value[k] * sy.derivative[l] * control;
            }
        }
        Some(result)
    }
}

/// Layout of the control points of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControlGrid {
    /// Control points in x.
    pub columns: usize,
    /// Control points in y.
    pub rows: usize,
    /// Distance between rows in a field.
    pub stride: usize,
}

impl ControlGrid {
    /// Length of a field.
    pub fn len(&self) -> usize {
        self.rows * self.stride
    }

    /// Whether there are no control points.
    pub fn is_empty(&self) -> bool {
        self.rows == 0 || self.columns == 0
    }

    /// A field of zeros.
    pub fn zeros(&self) -> Vec<f64> {
        vec![0.0; self.len()]
    }

    /// Index of a control point.
    pub fn index(&self, column: usize, row: usize) -> usize {
        row * self.stride + LEAD + column
    }

    /// Indices of all control points, row by row.
    pub fn indices(&self) -> impl Iterator<Item = usize> + use<> {
        let grid = *self;
        (0..grid.rows).flat_map(move |row| (0..grid.columns).map(move |column| grid.index(column, row)))
    }

    /// Row of an index.
    pub fn row_of(&self, index: usize) -> usize {
        index / self.stride
    }

    /// Column of the index of a control point.
    pub fn column_of(&self, index: usize) -> usize {
        index % self.stride - LEAD
    }

    /// Indices of the control points on a side, in increasing order.
    pub fn side(&self, side: Side) -> Vec<usize> {
        match side {
            Side::Left => (0..self.rows).map(|row| self.index(0, row)).collect(),
            Side::Right => (0..self.rows).map(|row| self.index(self.columns - 1, row)).collect(),
            Side::Bottom => (0..self.columns).map(|column| self.index(column, 0)).collect(),
            Side::Top => (0..self.columns).map(|column| self.index(column, self.rows - 1)).collect(),
        }
    }
}
