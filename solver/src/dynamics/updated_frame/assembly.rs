//! The phase-field system from points at their present positions (E 19–24):
//!
//! ```text
//! K_IJ = Σ_p V_p [ (4 l0 (1 − k) H_p/Gc + 1) N_I N_J + 4 l0² grad N_I · grad N_J ],   load_I = Σ_p V_p N_I
//! ```

use super::fictitious::FictitiousMaterial;
use super::transfer::walks;
use super::windows::{Window, scatter};
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::lane::{LANES, Lane, Vectorised, dispatch};
use crate::linear_algebra::stencil::Stencil;
use crate::material::degradation::FractureModel;
use crate::particles::points::{Cell, Cells, FracturePoint, Point};
use crate::splines::patch::Patch;
use crate::splines::spline::{MAX_FUNCTIONS, MAX_ORDER};

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
    window: Window<'a, f64, 2>,
}

walks!([] AssemblePoints<'_> => ());

/// Most pairs of functions of a direction, each with itself and those after it, and their batches.
const PAIRS: usize = MAX_ORDER * (MAX_ORDER + 1) / 2;
const BATCHES: usize = PAIRS.div_ceil(LANES);

/// Points whose products are summed together, before the sums go back to memory.
const TOGETHER: usize = 4;

/// Matrix of one cell: for each pair of functions in y, those in x. An entry is the same for both orders of
/// a pair.
type CellMatrix = [[Lane; BATCHES]; PAIRS];

/// What a point adds to the matrix of its cell, `a X X + b X' X'` for every pair.
#[derive(Clone, Copy)]
struct PointProducts {
    /// `X X` and `X' X'` of the functions in x.
    values: [Lane; BATCHES],
    slopes: [Lane; BATCHES],
    /// a and b for each pair in y.
    factors: [[f64; 2]; PAIRS],
}

impl PointProducts {
    const NONE: Self =
        Self { values: [Lane::ZERO; BATCHES], slopes: [Lane::ZERO; BATCHES], factors: [[0.0; 2]; PAIRS] };
}

impl AssemblePoints<'_> {
    #[inline(always)]
    fn walk<const FMA: bool>(mut self, kx: usize, ky: usize) {
        for cell in self.cells {
            let mut local: CellMatrix = [[Lane::ZERO; BATCHES]; PAIRS];
            let mut load = [0.0; MAX_FUNCTIONS];
            for first in cell.points.clone().step_by(TOGETHER) {
                let mut products = [PointProducts::NONE; TOGETHER];
                for (products, at) in products.iter_mut().zip(first..cell.points.end) {
                    self.multiply(cell, at, products, &mut load, kx, ky);
                }
                add_products::<FMA>(&mut local, &products, kx, ky);
            }
            self.add_cell(cell, &local, &load, kx, ky);
        }
    }

    /// The products of a point, and its share of the load.
    #[inline(always)]
    fn multiply(
        &self,
        cell: &Cell,
        at: usize,
        products: &mut PointProducts,
        load: &mut [f64; MAX_FUNCTIONS],
        kx: usize,
        ky: usize,
    ) {
        let [x, y] = &self.patch.spaces;
        let point = &self.points[at];
        let sx = x.shape_functions(cell.span[0], point.position[0]);
        let sy = y.shape_functions(cell.span[1], point.position[1]);
        let reaction = point.volume * (self.model.reaction_per_energy() * self.fracture[at].history + 1.0);
        let diffusion = point.volume * self.model.diffusion();
        let mut pair = 0;
        for k in 0..kx {
            for j in k..kx {
                products.values[pair / LANES][pair % LANES] = sx.value[k] * sx.value[j];
                products.slopes[pair / LANES][pair % LANES] = sx.derivative[k] * sx.derivative[j];
                pair += 1;
            }
        }
        let mut pair = 0;
        for l in 0..ky {
            for m in l..ky {
                let (value, slope) = (sy.value[l] * sy.value[m], sy.derivative[l] * sy.derivative[m]);
                products.factors[pair] = [reaction * value + diffusion * slope, diffusion * value];
                pair += 1;
            }
            for k in 0..kx {
                load[l * kx + k] += point.volume * sx.value[k] * sy.value[l];
            }
        }
    }

    /// The couplings of each function with itself and those after it, into the half stencil.
    #[inline(always)]
    fn add_cell(&mut self, cell: &Cell, local: &CellMatrix, load: &[f64; MAX_FUNCTIONS], kx: usize, ky: usize) {
        let degree = [kx - 1, ky - 1];
        let [matrix, loads] = &mut self.window.fields;
        let first_row = cell.first[1] - self.window.first_row;
        let first_column = self.lead + cell.first[0];
        let mut rows = local.iter();
        for l in 0..ky {
            let row = (first_row + l) * self.stride + first_column;
            for k in 0..kx {
                loads[row + k] += load[l * kx + k];
            }
            for (m, sums) in (l..ky).zip(&mut rows) {
                let mut add = |k: usize, j: usize, value: f64| {
                    let offset = Stencil::offset_index(degree, j as isize - k as isize, m - l);
                    matrix[(first_row + l) * self.row_length + offset * self.stride + first_column + k] += value;
                };
                let mut pair = 0;
                for k in 0..kx {
                    for j in k..kx {
                        let value = sums[pair / LANES][pair % LANES];
                        add(k, j, value);
                        if j > k && m > l {
                            add(j, k, value);
                        }
                        pair += 1;
                    }
                }
            }
        }
    }
}

/// Adds the products of some points to the matrix of their cell.
#[inline(always)]
fn add_products<const FMA: bool>(local: &mut CellMatrix, products: &[PointProducts; TOGETHER], kx: usize, ky: usize) {
    for pair in 0..ky * (ky + 1) / 2 {
        for batch in 0..(kx * (kx + 1) / 2).div_ceil(LANES) {
            let mut sum = local[pair][batch];
            for point in products {
                let [a, b] = point.factors[pair];
                sum = sum.add_scaled::<FMA>(point.values[batch], a).add_scaled::<FMA>(point.slopes[batch], b);
            }
            local[pair][batch] = sum;
        }
    }
}
