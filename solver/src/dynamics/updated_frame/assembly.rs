//! The phase-field system from points at their present positions (E 19–24):
//!
//! ```text
//! K_IJ = Σ_p V_p [ (4 l0 (1 − k) H_p/Gc + 1) N_I N_J + 4 l0² grad N_I · grad N_J ],   load_I = Σ_p V_p N_I
//! ```

use super::fictitious::FictitiousMaterial;
use super::transfer::walk;
use super::windows::{Window, scatter};
use crate::linear_algebra::lane::{Vectorised, dispatch};
use crate::linear_algebra::stencil::Stencil;
use crate::material::degradation::FractureModel;
use crate::particles::points::{Cell, Cells, FracturePoint, Point};
use crate::splines::patch::Patch;
use crate::splines::spline::MAX_FUNCTIONS;

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
    let fields = [matrix.coefficients_mut(), load.as_mut_slice()];
    scatter(&cells.strips, fields, [row_length, grid.stride], |strip, window| {
        let cells = &cells.cells[strip.cells.clone()];
        let stride = grid.stride;
        let lead = grid.index(0, 0);
        dispatch(AssemblePoints { patch, row_length, stride, lead, cells, points, fracture, model, window });
    });
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
        walk!(self, FMA)
    }
}

/// Matrix of one cell.
type CellMatrix = [[f64; MAX_FUNCTIONS]; MAX_FUNCTIONS];

impl AssemblePoints<'_> {
    #[inline(always)]
    fn walk(mut self, kx: usize, ky: usize) {
        for cell in self.cells {
            let mut local: CellMatrix = [[0.0; MAX_FUNCTIONS]; MAX_FUNCTIONS];
            let mut load = [0.0; MAX_FUNCTIONS];
            for at in cell.points.clone() {
                self.add_point(cell, at, &mut local, &mut load, kx, ky);
            }
            self.add_cell(cell, &local, &load, kx, ky);
        }
    }

    #[inline(always)]
    fn add_point(
        &self,
        cell: &Cell,
        at: usize,
        local: &mut CellMatrix,
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
        let (mut n, mut dx, mut dy) = ([0.0; MAX_FUNCTIONS], [0.0; MAX_FUNCTIONS], [0.0; MAX_FUNCTIONS]);
        for l in 0..ky {
            for k in 0..kx {
                n[l * kx + k] = sx.value[k] * sy.value[l];
                dx[l * kx + k] = sx.derivative[k] * sy.value[l];
                dy[l * kx + k] = sx.value[k] * sy.derivative[l];
            }
        }
        let functions = kx * ky;
        for i in 0..functions {
            load[i] += point.volume * n[i];
            let (rn, rx, ry) = (reaction * n[i], diffusion * dx[i], diffusion * dy[i]);
            for j in 0..functions {
                local[i][j] += rn * n[j] + rx * dx[j] + ry * dy[j];
            }
        }
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
