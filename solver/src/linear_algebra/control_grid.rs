//! Layout of fields on the control points: rows of `stride` numbers, x fastest.
//!
//! Each row begins and ends with room for reading [`LANES`] neighbours past the control points; the room
//! stays zero.

use super::lane::LANES;

/// Highest degree of splines: control points that a function reaches to either side.
pub const MAX_DEGREE: usize = 4;
/// Rows of control points whose partial sums are formed together.
pub(crate) const CHUNK_ROWS: usize = 8;
/// Room before the first control point of a row.
const LEAD: usize = LANES;
/// Least room behind the last one: the neighbours that functions of the highest degree reach, and those read
/// with them.
const MARGIN: usize = MAX_DEGREE + LANES;

/// A field of vectors on the control points, by component.
pub type VectorField = [Vec<f64>; 2];

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
    /// Layout of so many control points in x and y.
    pub fn new(columns: usize, rows: usize) -> Self {
        Self { columns, rows, stride: (LEAD + columns + MARGIN).next_multiple_of(LANES) }
    }

    /// Number of values in a field, with the room at both ends of each row.
    pub fn len(&self) -> usize {
        self.rows * self.stride
    }

    /// Whether there are no control points.
    pub fn is_empty(&self) -> bool {
        self.rows == 0 || self.columns == 0
    }

    /// A field of zeros, with the room at both ends of each row.
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

    /// Row of the control point that has this index in a field.
    pub fn row_of(&self, index: usize) -> usize {
        index / self.stride
    }

    /// Column of the index of a control point.
    pub fn column_of(&self, index: usize) -> usize {
        index % self.stride - LEAD
    }
}
