//! Sums over the points for a fit of what they carry: matrix and right-hand sides.
//!
//! ```text
//! A_ij = Σ m_p N_i N_j,      b_i = Σ m_p N_i u_p
//! ```

use crate::dynamics::updated_frame::windows::{Window, scatter};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::lane::{Vectorised, dispatch, each};
use crate::linear_algebra::stencil::Stencil;
use crate::particles::points::{Cell, Cells, Point};
use crate::splines::patch::Patch;
use crate::splines::spline::MAX_FUNCTIONS;

/// Points on a patch, with their density (kg/m³).
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointFit<'a> {
    /// Background patch.
    pub patch: &'a Patch,
    /// Order of the points.
    pub cells: &'a Cells,
    /// The points.
    pub points: &'a [Point],
    /// Density, kg/m³.
    pub density: f64,
}

impl PointFit<'_> {
    /// Matrix, and right-hand side of the displacements less `mean` (m).
    pub(crate) fn assemble(&self, matrix: &mut Stencil, load: &mut VectorField, mean: [f64; 2]) {
        let (grid, row_length) = (matrix.grid, matrix.row_length());
        let (fields, strides) = cleared(matrix, load);
        scatter(&self.cells.strips, fields, strides, |strip, window| {
            let cells = &self.cells.cells[strip.cells.clone()];
            dispatch(AssemblePointFit { fit: self, cells, window, grid, row_length, mean });
        });
    }

    #[inline(always)]
    fn strip<const K: usize, const F: usize>(
        &self,
        cells: &[Cell],
        window: &mut Window<'_, 3>,
        grid: ControlGrid,
        row_length: usize,
        mean: [f64; 2],
    ) {
        for cell in cells {
            let mut local = [[0.0; F]; F];
            let mut load = [[0.0; 2]; F];
            for point in &self.points[cell.points.clone()] {
                let n = self.functions::<K, F>(cell, point.position);
                let mass = self.density * point.volume;
                let carried = each!(c in [0, 1] => mass * (point.displacement[c] - mean[c]));
                for i in 0..F {
                    let weighted = mass * n[i];
                    for j in 0..F {
                        local[i][j] += weighted * n[j];
                    }
                    load[i] = each!(c in [0, 1] => load[i][c] + carried[c] * n[i]);
                }
            }
            let [matrix, x, y] = &mut window.fields;
            add_cell::<K, F>(matrix, cell.first, window.first_row, grid, row_length, &local);
            for i in 0..F {
                let at = grid.index(cell.first[0] + i % K, cell.first[1] + i / K - window.first_row);
                x[at] += load[i][0];
                y[at] += load[i][1];
            }
        }
    }

    #[inline(always)]
    fn functions<const K: usize, const F: usize>(&self, cell: &Cell, position: [f64; 2]) -> [f64; F] {
        let sx = self.patch.spaces[0].shape_functions(cell.span[0], position[0]).value;
        let sy = self.patch.spaces[1].shape_functions(cell.span[1], position[1]).value;
        let mut n = [0.0; F];
        for i in 0..F {
            n[i] = sx[i % K] * sy[i / K];
        }
        n
    }

    /// `b_i = Σ m_p N_i u_p` of a vector per point.
    pub(crate) fn load(&self, value: impl Fn(&Point) -> [f64; 2] + Sync, load: &mut VectorField) {
        let grid = self.patch.control_grid();
        let [kx, ky] = self.patch.spaces.each_ref().map(|space| space.degree() + 1);
        load.iter_mut().for_each(|load| load.fill(0.0));
        scatter(&self.cells.strips, load.each_mut().map(|l| &mut l[..]), [grid.stride; 2], |strip, mut window| {
            for cell in &self.cells.cells[strip.cells.clone()] {
                let mut sums = [[0.0; 2]; MAX_FUNCTIONS];
                for point in &self.points[cell.points.clone()] {
                    let sx = self.patch.spaces[0].shape_functions(cell.span[0], point.position[0]).value;
                    let sy = self.patch.spaces[1].shape_functions(cell.span[1], point.position[1]).value;
                    let carried = value(point).map(|v| self.density * point.volume * v);
                    for i in 0..kx * ky {
                        let n = sx[i % kx] * sy[i / kx];
                        sums[i] = each!(c in [0, 1] => sums[i][c] + carried[c] * n);
                    }
                }
                window.add(grid, cell, &sums, kx, ky);
            }
        });
    }

    /// Values of a field at the points, in their order.
    pub(crate) fn at_points(&self, field: &VectorField, out: &mut Vec<[f64; 2]>) {
        let grid = self.patch.control_grid();
        let [kx, ky] = self.patch.spaces.each_ref().map(|space| space.degree() + 1);
        out.clear();
        for cell in &self.cells.cells {
            for point in &self.points[cell.points.clone()] {
                let sx = self.patch.spaces[0].shape_functions(cell.span[0], point.position[0]).value;
                let sy = self.patch.spaces[1].shape_functions(cell.span[1], point.position[1]).value;
                let mut sum = [0.0; 2];
                for l in 0..ky {
                    let at = grid.index(cell.first[0], cell.first[1] + l);
                    for k in 0..kx {
                        sum = each!(c in [0, 1] => sum[c] + sx[k] * sy[l] * field[c][at + k]);
                    }
                }
                out.push(sum);
            }
        }
    }
}

/// Matrix and right-hand side of the points of a strip.
struct AssemblePointFit<'a, 'b> {
    fit: &'a PointFit<'a>,
    cells: &'a [Cell],
    window: Window<'b, 3>,
    grid: ControlGrid,
    row_length: usize,
    mean: [f64; 2],
}

impl Vectorised for AssemblePointFit<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(mut self) {
        let Self { fit, cells, window, grid, row_length, mean } = &mut self;
        match fit.patch.spaces[0].degree() {
            1 => fit.strip::<2, 4>(cells, window, *grid, *row_length, *mean),
            2 => fit.strip::<3, 9>(cells, window, *grid, *row_length, *mean),
            3 => fit.strip::<4, 16>(cells, window, *grid, *row_length, *mean),
            _ => fit.strip::<5, 25>(cells, window, *grid, *row_length, *mean),
        }
    }
}

/// Coefficients of a matrix and a field, all zero, and their lengths per row of control points.
pub(crate) fn cleared<'a>(matrix: &'a mut Stencil, field: &'a mut VectorField) -> ([&'a mut [f64]; 3], [usize; 3]) {
    let strides = [matrix.row_length(), matrix.grid.stride, matrix.grid.stride];
    let [x, y] = field;
    let mut fields = [matrix.coefficients_mut(), x.as_mut_slice(), y.as_mut_slice()];
    fields.iter_mut().for_each(|values| values.fill(0.0));
    (fields, strides)
}

/// Adds the symmetric matrix of a cell of K × K functions to that of a
/// [`MassSystem`](super::system::MassSystem).
#[inline(always)]
pub(crate) fn add_cell<const K: usize, const F: usize>(
    matrix: &mut [f64],
    first: [usize; 2],
    first_row: usize,
    grid: ControlGrid,
    row_length: usize,
    local: &[[f64; F]; F],
) {
    for i in 0..F {
        let row = (first[1] + i / K - first_row) * row_length;
        let column = grid.index(first[0] + i % K, 0);
        for j in i..F {
            let offset = Stencil::offset_index([K; 2], (j % K) as isize - (i % K) as isize, j / K - i / K);
            matrix[row + offset * grid.stride + column] += local[i][j];
        }
    }
}
