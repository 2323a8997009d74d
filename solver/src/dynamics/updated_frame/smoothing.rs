//! The way to the points and back: `S⁺ S` on a nodal field, with `S` the interpolation to the points and
//! `S⁺ = M⁻¹ Sᵀ m` the mass-weighted mean that P2G takes.
//!
//! Its eigenvalues lie between 0 and 1: it keeps what the points see and filters the rest. The lumped mass
//! makes it a filter for all fields but the constant; that is the loss of PIC, and what XPIC corrects.

use super::transfer::walk;
use super::windows::{Reach, Window, scatter, side_by_side};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::lane::{Vectorised, dispatch, each};
use crate::particles::points::{Cell, Cells, Point};
use crate::splines::patch::Patch;

/// Points on a grid, and the lumped mass they give it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Smoothing<'a> {
    /// Background patch.
    pub patch: &'a Patch,
    /// Order of the points.
    pub cells: &'a Cells,
    /// The points.
    pub points: &'a [Point],
    /// Density, kg/m³.
    pub density: f64,
    /// Lumped mass of the control points, kg/m.
    pub mass: &'a [f64],
}

impl Smoothing<'_> {
    /// `out = S⁺ S field`; zero where there is no mass.
    pub(crate) fn apply(&self, field: &VectorField, out: &mut VectorField) {
        let Self { patch, cells, points, density, mass } = *self;
        let grid = patch.control_grid();
        let (mut values, mut sums) = (Vec::new(), vec![[0.0; 2]; grid.len()]);
        side_by_side(field.each_ref().map(|component| &component[..]), &mut values);
        let field = &values[..];
        scatter(&cells.strips, [&mut sums[..]], [grid.stride], |strip, window| {
            let cells = &cells.cells[strip.cells.clone()];
            dispatch(GridToGrid { patch, grid, density, cells, points, field, window });
        });
        for (at, (sums, mass)) in sums.iter().zip(mass).enumerate() {
            for c in 0..2 {
                out[c][at] = sums[c] / if *mass == 0.0 { f64::INFINITY } else { *mass };
            }
        }
    }
}

struct GridToGrid<'a> {
    patch: &'a Patch,
    grid: ControlGrid,
    density: f64,
    cells: &'a [Cell],
    points: &'a [Point],
    field: &'a [[f64; 2]],
    window: Window<'a, [f64; 2], 1>,
}

impl Vectorised for GridToGrid<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        walk!(self, FMA)
    }
}

impl GridToGrid<'_> {
    #[inline(always)]
    fn walk(mut self, kx: usize, ky: usize) {
        let Window { first_row, fields: [sums] } = &mut self.window;
        for cell in self.cells {
            for point in &self.points[cell.points.clone()] {
                let functions = point.mean_functions::<false>(self.patch, cell, [kx, ky]);
                let [sx, sy] = &functions;
                let mut value = [0.0; 2];
                let reach = Reach::new(self.grid, cell, &functions, [kx, ky], 0);
                for l in 0..reach.rows {
                    for (k, field) in self.field[reach.row(l)].iter().enumerate() {
                        let n = sx.value[k] * sy.value[l];
                        value = each!(c in [0, 1] => value[c] + n * field[c]);
                    }
                }
                let momentum = value.map(|v| self.density * point.volume * v);
                let reach = Reach::new(self.grid, cell, &functions, [kx, ky], *first_row);
                for l in 0..reach.rows {
                    for (k, sum) in sums[reach.row(l)].iter_mut().enumerate() {
                        let n = sx.value[k] * sy.value[l];
                        *sum = each!(c in [0, 1] => sum[c] + n * momentum[c]);
                    }
                }
            }
        }
    }
}
