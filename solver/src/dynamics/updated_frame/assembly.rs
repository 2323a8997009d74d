//! The phase-field system from points at their present positions (E 19–24):
//!
//! ```text
//! K_IJ = Σ_p V_p [ (4 l0 (1 − k) H_p/Gc + 1) N_I N_J + 4 l0² grad N_I · grad N_J ],   load_I = Σ_p V_p N_I
//! ```

use std::ops::Range;

use super::fictitious::FictitiousMaterial;
use super::transfer::walk;
use super::windows::{Window, scatter};
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::lane::{Vectorised, add_product, dispatch};
use crate::linear_algebra::stencil::Stencil;
use crate::material::degradation::FractureModel;
use crate::particles::points::{Cell, Cells, FracturePoint, Point};
use crate::splines::patch::Patch;
use crate::splines::spline::MAX_FUNCTIONS;

/// Control points around those whose functions see a point that take part in the system: the fictitious
/// material continues the field to where points may come next. Without them the ledger of a crack that flies
/// through the mesh is half as much again open; with more of them nothing changes.
const HALO: usize = 1;

/// Assembles matrix and right-hand side anew.
pub(crate) fn assemble(
    (matrix, load): (&mut Stencil, &mut Vec<f64>),
    patch: &Patch,
    cells: &Cells,
    points: &[Point],
    fracture: &[FracturePoint],
    model: &FractureModel,
    fictitious: &FictitiousMaterial,
) {
    let (grid, row_length) = (matrix.grid, matrix.row_length());
    fictitious.begin(matrix, load);
    matrix.restrict(with_material(patch, cells));
    let fields = [matrix.coefficients_mut(), load.as_mut_slice()];
    scatter(&cells.strips, fields, [row_length, grid.stride], |strip, window| {
        let cells = &cells.cells[strip.cells.clone()];
        let stride = grid.stride;
        let lead = grid.index(0, 0);
        dispatch(AssemblePoints { patch, row_length, stride, lead, cells, points, fracture, model, window });
    });
}

/// The control points whose functions see a point, and those around them: others keep their values.
fn with_material(patch: &Patch, cells: &Cells) -> ActiveColumns {
    let grid = patch.control_grid();
    let order = [0, 1].map(|d| patch.spaces[d].degree() + 1);
    let mut marks = vec![false; grid.len()];
    for cell in &cells.cells {
        let first = cell.first.map(|first| first.saturating_sub(HALO));
        let end = [0, 1].map(|d| cell.first[d] + order[d] + HALO);
        for row in first[1]..end[1].min(grid.rows) {
            marks[grid.index(first[0], row)..grid.index(end[0].min(grid.columns), row)].fill(true);
        }
    }
    ActiveColumns::marked(grid, &marks)
}

struct AssemblePoints<'a> {
    patch: &'a Patch,
    row_length: usize,
    stride: usize,
    /// Room before the first control point of a row.
    lead: usize,
    cells: &'a [Cell],
    points: &'a [Point],
    fracture: &'a [FracturePoint],
    model: &'a FractureModel,
    window: Window<'a, 2>,
}

impl Vectorised for AssemblePoints<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        walk!(self, FMA, walk::<FMA>)
    }
}

/// Matrix of one cell.
type CellMatrix = [[f64; MAX_FUNCTIONS]; MAX_FUNCTIONS];

/// Points whose products are summed together, before the sums go back to memory.
const TOGETHER: usize = 4;

/// The matrix of some points is a sum of products `w v vᵀ`, three of each point.
struct Products {
    weights: [f64; 3 * TOGETHER],
    vectors: [[f64; MAX_FUNCTIONS]; 3 * TOGETHER],
}

impl AssemblePoints<'_> {
    #[inline(always)]
    fn walk<const FMA: bool>(mut self, kx: usize, ky: usize) {
        for cell in self.cells {
            let mut local: CellMatrix = [[0.0; MAX_FUNCTIONS]; MAX_FUNCTIONS];
            let mut load = [0.0; MAX_FUNCTIONS];
            for first in cell.points.clone().step_by(TOGETHER) {
                let some = first..(first + TOGETHER).min(cell.points.end);
                let products = self.products(cell, some, &mut load, kx, ky);
                products.add_to::<FMA>(&mut local, kx * ky);
            }
            self.add_cell(cell, &local, &load, kx, ky);
        }
    }

    /// The products of at most [`TOGETHER`] points, and their share of the load.
    #[inline(always)]
    fn products(
        &self,
        cell: &Cell,
        some: Range<usize>,
        load: &mut [f64; MAX_FUNCTIONS],
        kx: usize,
        ky: usize,
    ) -> Products {
        let [x, y] = &self.patch.spaces;
        let mut products = Products { weights: [0.0; 3 * TOGETHER], vectors: [[0.0; MAX_FUNCTIONS]; 3 * TOGETHER] };
        for (number, at) in some.enumerate() {
            let point = &self.points[at];
            let sx = x.shape_functions(cell.span[0], point.position[0]);
            let sy = y.shape_functions(cell.span[1], point.position[1]);
            let reaction = point.volume * (self.model.reaction_per_energy() * self.fracture[at].history + 1.0);
            let diffusion = point.volume * self.model.diffusion();
            products.weights[3 * number..][..3].copy_from_slice(&[reaction, diffusion, diffusion]);
            for l in 0..ky {
                for k in 0..kx {
                    let n = sx.value[k] * sy.value[l];
                    products.vectors[3 * number][l * kx + k] = n;
                    products.vectors[3 * number + 1][l * kx + k] = sx.derivative[k] * sy.value[l];
                    products.vectors[3 * number + 2][l * kx + k] = sx.value[k] * sy.derivative[l];
                    load[l * kx + k] += point.volume * n;
                }
            }
        }
        products
    }

    /// The couplings of each function with itself and those after it, into the half stencil.
    #[inline(always)]
    fn add_cell(&mut self, cell: &Cell, local: &CellMatrix, load: &[f64; MAX_FUNCTIONS], kx: usize, ky: usize) {
        let degree = [kx - 1, ky - 1];
        let [matrix, loads] = &mut self.window.fields;
        for i in 0..kx * ky {
            let (k, l) = (i % kx, i / kx);
            let row = cell.first[1] + l - self.window.first_row;
            let column = self.lead + cell.first[0] + k;
            loads[row * self.stride + column] += load[i];
            for j in i..kx * ky {
                let offset = Stencil::offset_index(degree, (j % kx) as isize - k as isize, j / kx - l);
                matrix[row * self.row_length + offset * self.stride + column] += local[i][j];
            }
        }
    }
}

impl Products {
    /// Adds them to a matrix of so many functions, two rows at a time: their sums stay in registers.
    #[inline(always)]
    fn add_to<const FMA: bool>(&self, matrix: &mut CellMatrix, functions: usize) {
        let mut row = 0;
        while row + 1 < functions {
            let [mut upper, mut lower] = [matrix[row], matrix[row + 1]];
            for (weight, vector) in self.weights.iter().zip(&self.vectors) {
                let (above, below) = (weight * vector[row], weight * vector[row + 1]);
                for j in 0..functions {
                    upper[j] = add_product::<FMA, _>(upper[j], above, vector[j]);
                    lower[j] = add_product::<FMA, _>(lower[j], below, vector[j]);
                }
            }
            (matrix[row], matrix[row + 1]) = (upper, lower);
            row += 2;
        }
        if row < functions {
            for (weight, vector) in self.weights.iter().zip(&self.vectors) {
                matrix[row][row] = add_product::<FMA, _>(matrix[row][row], weight * vector[row], vector[row]);
            }
        }
    }
}
