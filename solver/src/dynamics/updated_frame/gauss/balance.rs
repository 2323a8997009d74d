//! Forces and inertia at the Gauss points of the spans inside the body.
//!
//! ```text
//! F = (I − ∇d)⁻¹,      f_i = − ∫ sigma ∇N_i dx = − Σ w det(I − ∇d) tau ∇N_i
//! M_ij = ∫ rho N_i N_j dx = Σ w rho0 det(I − ∇d) N_i N_j
//! ```
//!
//! with Kirchhoff's stress tau of the Hencky strain of F ([`crate::material::hencky`]).

use super::fit::{add_cell, cleared};
use super::map::displacement_gradient;
use super::rule::GaussPoints;
use crate::dynamics::updated_frame::windows::{Window, control_values, scatter};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::lane::{LANES, Lane, Vectorised, dispatch, each};
use crate::linear_algebra::stencil::Stencil;
use crate::material::elasticity::ElasticModuli;
use crate::material::hencky::{Gradient, hencky_strain};
use crate::particles::points::Cell;
use crate::splines::spline::MAX_FUNCTIONS;

/// Forces and inertia of a strip.
struct AssembleSpans<'a, 'b> {
    balance: &'a SpanBalance<'a>,
    cells: &'a [Cell],
    window: Window<'b, 3>,
    grid: ControlGrid,
    row_length: usize,
}

impl Vectorised for AssembleSpans<'_, '_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FMA: bool>(mut self) -> f64 {
        let Self { balance, cells, window, grid, row_length } = &mut self;
        let (grid, row_length) = (*grid, *row_length);
        let mut energy = 0.0;
        for cell in *cells {
            energy += match (balance.gauss.count, balance.gauss.is_cut(cell)) {
                (2, false) => balance.cell::<2, 4, 2, 4>(cell, window, grid, row_length),
                (2, true) => balance.cell::<2, 4, 3, 9>(cell, window, grid, row_length),
                (3, false) => balance.cell::<3, 9, 3, 9>(cell, window, grid, row_length),
                (3, true) => balance.cell::<3, 9, 5, 25>(cell, window, grid, row_length),
                (4, false) => balance.cell::<4, 16, 4, 16>(cell, window, grid, row_length),
                (4, true) => balance.cell::<4, 16, 7, 49>(cell, window, grid, row_length),
                (_, false) => balance.cell::<5, 25, 5, 25>(cell, window, grid, row_length),
                (_, true) => balance.cell::<5, 25, 9, 81>(cell, window, grid, row_length),
            };
        }
        energy
    }
}

/// What the sums need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SpanBalance<'a> {
    /// Gauss points.
    pub gauss: &'a GaussPoints,
    /// Control values of the displacement, m.
    pub displacement: &'a VectorField,
    /// Moduli.
    pub moduli: ElasticModuli,
    /// Density at t = 0, kg/m³.
    pub density: f64,
}

impl SpanBalance<'_> {
    /// Mass matrix and internal forces (N/m); returns the elastic energy, J/m.
    pub(crate) fn assemble(&self, matrix: &mut Stencil, force: &mut VectorField) -> f64 {
        let (grid, row_length) = (matrix.grid, matrix.row_length());
        let (fields, strides) = cleared(matrix, force);
        let energies = scatter(&self.gauss.strips, fields, strides, |strip, window| {
            let cells = &self.gauss.cells[strip.cells.clone()];
            dispatch(AssembleSpans { balance: self, cells, window, grid, row_length })
        });
        energies.iter().sum()
    }

    /// `K x` of the undamaged material without geometric part, N/m, of a displacement x (m).
    pub(crate) fn stiffness(&self, x: &VectorField, out: &mut VectorField) {
        let grid = self.gauss.grid;
        out.iter_mut().for_each(|out| out.fill(0.0));
        let [ox, oy] = out.each_mut().map(|f| &mut f[..]);
        scatter(&self.gauss.strips, [ox, oy], [grid.stride; 2], |strip, mut window| {
            let cells = &self.gauss.cells[strip.cells.clone()];
            for cell in cells {
                match (self.gauss.count, self.gauss.is_cut(cell)) {
                    (2, false) => self.stiffness_cell::<2, 4, 2, 4>(cell, x, &mut window, grid),
                    (2, true) => self.stiffness_cell::<2, 4, 3, 9>(cell, x, &mut window, grid),
                    (3, false) => self.stiffness_cell::<3, 9, 3, 9>(cell, x, &mut window, grid),
                    (3, true) => self.stiffness_cell::<3, 9, 5, 25>(cell, x, &mut window, grid),
                    (4, false) => self.stiffness_cell::<4, 16, 4, 16>(cell, x, &mut window, grid),
                    (4, true) => self.stiffness_cell::<4, 16, 7, 49>(cell, x, &mut window, grid),
                    (_, false) => self.stiffness_cell::<5, 25, 5, 25>(cell, x, &mut window, grid),
                    (_, true) => self.stiffness_cell::<5, 25, 9, 81>(cell, x, &mut window, grid),
                }
            }
        });
    }

    fn stiffness_cell<const K: usize, const F: usize, const Q: usize, const R: usize>(
        &self,
        cell: &Cell,
        x: &VectorField,
        window: &mut Window<'_, 2>,
        grid: ControlGrid,
    ) {
        let ElasticModuli { lambda, mu, .. } = self.moduli;
        let gradients_of = |field: &VectorField| {
            let local = control_values(field.each_ref().map(|d| &d[..]), grid, cell, K, K);
            let mut gradients = [[[0.0; 2]; 2]; R];
            self.gradients::<K, Q, R>(cell, &local, &mut gradients);
            gradients
        };
        let (motion, strain) = (gradients_of(self.displacement), gradients_of(x));
        let mut stresses = [[0.0; 3]; R];
        for i in 0..R {
            let [[dxx, dxy], [dyx, dyy]] = motion[i];
            let volume = self.gauss.weights[cell.points.start + i] * ((1.0 - dxx) * (1.0 - dyy) - dxy * dyx);
            let [[xx, xy], [yx, yy]] = strain[i];
            let spherical = lambda * (xx + yy);
            let stress = [spherical + 2.0 * mu * xx, spherical + 2.0 * mu * yy, mu * (xy + yx)];
            stresses[i] = stress.map(|s| -volume * s);
        }
        let [ox, oy] = &mut window.fields;
        self.forces::<K, F, Q, R>(cell, &stresses, [ox, oy], window.first_row, grid);
    }

    /// Forces and masses of a span with K shape functions and Q Gauss points per direction, F and R in all;
    /// its elastic energy, J/m.
    #[inline(always)]
    fn cell<const K: usize, const F: usize, const Q: usize, const R: usize>(
        &self,
        cell: &Cell,
        window: &mut Window<'_, 3>,
        grid: ControlGrid,
        row_length: usize,
    ) -> f64 {
        let mut energy = 0.0;
        let local = control_values(self.displacement.each_ref().map(|d| &d[..]), grid, cell, K, K);
        let mut gradients = [[[0.0; 2]; 2]; R];
        self.gradients::<K, Q, R>(cell, &local, &mut gradients);
        let (mut volumes, mut stresses) = ([0.0; R], [[0.0; 3]; R]);
        for (first, some) in gradients.chunks(LANES).enumerate() {
            energy += self.stress(
                some,
                &self.gauss.weights[cell.points.start + first * LANES..][..some.len()],
                &mut volumes[first * LANES..],
                &mut stresses[first * LANES..],
            );
        }
        let [_, x, y] = &mut window.fields;
        self.forces::<K, F, Q, R>(cell, &stresses, [x, y], window.first_row, grid);
        let matrix = self.masses::<K, F, Q, R>(cell, &volumes);
        add_cell::<K, F>(window.fields[0], cell.first, window.first_row, grid, row_length, &matrix);
        energy
    }

    /// `∇d` at the Gauss points of a span.
    #[inline(always)]
    fn gradients<const K: usize, const Q: usize, const R: usize>(
        &self,
        cell: &Cell,
        local: &[[f64; 2]; MAX_FUNCTIONS],
        out: &mut [Gradient; R],
    ) {
        let [tx, ty] = self.gauss.tables(cell);
        for a in 0..Q {
            let (mut rows, mut slopes) = ([[0.0; 2]; K], [[0.0; 2]; K]);
            for l in 0..K {
                for k in 0..K {
                    rows[l] = each!(c in [0, 1] => rows[l][c] + tx[a].value[k] * local[l * K + k][c]);
                    slopes[l] = each!(c in [0, 1] => slopes[l][c] + tx[a].derivative[k] * local[l * K + k][c]);
                }
            }
            for b in 0..Q {
                let sum = &mut out[b * Q + a];
                for l in 0..K {
                    *sum = each!(c in [0, 1] => [
                        sum[c][0] + ty[b].value[l] * slopes[l][c],
                        sum[c][1] + ty[b].derivative[l] * rows[l][c],
                    ]);
                }
            }
        }
    }

    /// Reference volumes (m²) and stresses times those of at most eight points; their elastic energy.
    #[inline(always)]
    fn stress(&self, gradients: &[Gradient], weights: &[f64], volumes: &mut [f64], stresses: &mut [[f64; 3]]) -> f64 {
        let mut strain = [Lane::ZERO; 3];
        for (i, (gradient, weight)) in gradients.iter().zip(weights).enumerate() {
            let [[xx, xy], [yx, yy]] = *gradient;
            let jacobian = (1.0 - xx) * (1.0 - yy) - xy * yx;
            volumes[i] = weight * fault!("spans-miss-the-jacobian", jacobian => 1.0);
            let e = hencky_strain(&displacement_gradient(gradient));
            (0..3).for_each(|c| strain[c][i] = e[c]);
        }
        let stress = self.moduli.stress(strain);
        let energy = self.moduli.energy(strain);
        let mut sum = 0.0;
        for i in 0..gradients.len() {
            stresses[i] = each!(c in [0, 1, 2] => volumes[i] * stress[c][i]);
            sum += volumes[i] * energy[i];
        }
        sum
    }

    /// `f_i −= Σ stress ∇N_i`.
    #[inline(always)]
    fn forces<const K: usize, const F: usize, const Q: usize, const R: usize>(
        &self,
        cell: &Cell,
        stresses: &[[f64; 3]; R],
        [x, y]: [&mut [f64]; 2],
        first_row: usize,
        grid: ControlGrid,
    ) {
        let [tx, ty] = self.gauss.tables(cell);
        let mut forces = [[0.0; 2]; F];
        for a in 0..Q {
            let (mut by_slope, mut by_value) = ([[0.0; 2]; K], [[0.0; 2]; K]);
            for b in 0..Q {
                let [xx, yy, xy] = stresses[b * Q + a];
                for l in 0..K {
                    let (n, d) = (ty[b].value[l], ty[b].derivative[l]);
                    by_slope[l] = [by_slope[l][0] + xx * n, by_slope[l][1] + xy * n];
                    by_value[l] = [by_value[l][0] + xy * d, by_value[l][1] + yy * d];
                }
            }
            for l in 0..K {
                for k in 0..K {
                    let (n, d) = (tx[a].value[k], tx[a].derivative[k]);
                    let f = &mut forces[l * K + k];
                    *f = each!(c in [0, 1] => f[c] + d * by_slope[l][c] + n * by_value[l][c]);
                }
            }
        }
        for l in 0..K {
            let at = grid.index(cell.first[0], cell.first[1] + l - first_row);
            for k in 0..K {
                x[at + k] -= forces[l * K + k][0];
                y[at + k] -= forces[l * K + k][1];
            }
        }
    }

    /// Mass matrix of a span, one direction after the other.
    #[inline(always)]
    fn masses<const K: usize, const F: usize, const Q: usize, const R: usize>(
        &self,
        cell: &Cell,
        volumes: &[f64; R],
    ) -> [[f64; F]; F] {
        let [tx, ty] = self.gauss.tables(cell);
        let mut matrix = [[0.0; F]; F];
        for b in 0..Q {
            let mut along = [[0.0; K]; K];
            for a in 0..Q {
                let mass = self.density * volumes[b * Q + a];
                for k in 0..K {
                    let weighted = mass * tx[a].value[k];
                    for j in 0..K {
                        along[k][j] += weighted * tx[a].value[j];
                    }
                }
            }
            for l in 0..K {
                for m in l..K {
                    let product = ty[b].value[l] * ty[b].value[m];
                    for k in 0..K {
                        for j in 0..K {
                            matrix[l * K + k][m * K + j] += product * along[k][j];
                        }
                    }
                }
            }
        }
        matrix
    }
}
