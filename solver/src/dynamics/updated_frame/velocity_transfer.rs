//! The velocities that the grid gives the points: the transfers PIC, FLIP, APIC, TPIC and XPIC.
//!
//! Let w be the velocity that arrived on the grid, `v = w + dt a` the one after the step (conditions on the
//! sides imposed), S the interpolation to the points and `S⁺ S` the way there and back ([`Smoothing`]). A
//! point gets `v_p ← k v_p + S Δv`, k being the kept fraction and Δv the increment, and moves and strains
//! with v:
//!
//! ```text
//!          k     Δv
//! PIC      0     v
//! FLIP     1     v − w
//! APIC     0     v, and C from v (see `affine`)
//! TPIC     0     v, and C from v
//! XPIC(m)  0     [Σ_{j<m} (I − S⁺ S)^j] w + (v − w)
//! ```
//!
//! XPIC(1) is PIC, and XPIC(m) tends to a FLIP without velocities the grid cannot see (Hammerquist and Nairn
//! 2017).
//!
//! # The critical step
//!
//! For points at rest, a mode of the grid with frequency ω that `S⁺ S` (with the affine part, for APIC and
//! TPIC) multiplies by s obeys, with Ω = ω dt,
//!
//! ```text
//! FLIP      u ← u + dt (w − dt ω² u),   w ← w − s dt ω² u          stable up to Ω² = 4/(2 − s)
//! others    u ← u + dt (w − dt ω² u),   w ← q w − s dt ω² u        stable up to Ω² = 2 (1 + q)/(1 + q − s)
//! ```
//!
//! with q = s for PIC, APIC and TPIC and q = 1 − (1 − s)^m ≥ s for XPIC(m). 0 ≤ s ≤ 1 is a theorem, but for
//! TPIC, where it was measured (all eigenvalues of bodies at random offsets: real, 0 to 1). So Ω ≤ √2 is
//! stable for all.
//!
//! # The way to the points and back
//!
//! `S⁺ S` on a nodal field has `S⁺ = M⁻¹ Sᵀ m`, the mass-weighted mean that P2G takes. Its eigenvalues lie
//! between 0 and 1: it keeps what the points see and filters the rest. The lumped mass makes it a filter for
//! all fields but the constant; that is the loss of PIC, and what XPIC corrects.

use super::grid::NodalFields;
use super::transfer::walks;
use super::windows::{Reach, Window, scatter, side_by_side};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::lane::{Vectorised, dispatch, each};
use crate::particles::points::{Cell, Cells, Point};
use crate::scene::Transfer;
use crate::splines::patch::Patch;

/// Fraction of `1/ω_max` up to which a step is stable (see the module).
pub(crate) fn stable_fraction() -> f64 {
    fault!("step-of-the-total-frame", std::f64::consts::SQRT_2 => 2.0)
}

/// Velocities from the grid to the points.
#[derive(Debug, Clone)]
pub(crate) struct VelocityTransfer {
    /// What the points add to the kept part of their velocity, m/s.
    pub increment: VectorField,
    /// Part of its own velocity that a point keeps.
    pub kept_fraction: f64,
    pub transfer: Transfer,
    /// Velocity of the grid and [`Self::increment`], side by side.
    fields: Vec<[f64; 4]>,
}

impl VelocityTransfer {
    /// A transfer before the first step: points keep their velocity, and the increment is zero.
    pub(crate) fn new(grid: ControlGrid, transfer: Transfer) -> Self {
        Self { increment: [grid.zeros(), grid.zeros()], kept_fraction: 1.0, transfer, fields: Vec::new() }
    }

    /// From the velocities on the grid before and after the step.
    pub(crate) fn update(&mut self, nodes: &NodalFields, smoothing: &Smoothing) {
        let Self { increment, kept_fraction, transfer, .. } = self;
        let of_flip = fault!("transfer-keeps-less", 1.0 => 0.999);
        *kept_fraction = if *transfer == Transfer::Flip { of_flip } else { 0.0 };
        for (to, from) in increment.iter_mut().zip(&nodes.velocity) {
            to.copy_from_slice(from);
        }
        match *transfer {
            Transfer::Pic | Transfer::Apic | Transfer::Tpic => (),
            Transfer::Flip => add(increment, -1.0, &nodes.arrived),
            Transfer::Xpic(order) => {
                let (mut rest, mut smooth) = (nodes.arrived.clone(), nodes.arrived.clone());
                for _ in fault!("xpic-a-power-short", 1 => 2)..order {
                    smoothing.apply(&rest, &mut smooth);
                    add(&mut rest, -1.0, &smooth);
                    add(increment, 1.0, &rest);
                }
            }
        }
    }

    /// The points keep their velocities.
    pub(crate) fn keep(&mut self) {
        self.increment.iter_mut().for_each(|component| component.fill(0.0));
        self.kept_fraction = 1.0;
    }

    /// What the points read: the velocity with which they move, m/s, and the increment.
    pub(crate) fn fields(&mut self, motion: &VectorField) -> &[[f64; 4]] {
        let ([ux, uy], [tx, ty]) = (motion, &self.increment);
        side_by_side([ux, uy, tx, ty], &mut self.fields);
        &self.fields
    }
}

/// `to += factor from`.
fn add(to: &mut VectorField, factor: f64, from: &VectorField) {
    for (to, from) in to.iter_mut().flatten().zip(from.iter().flatten()) {
        *to += factor * from;
    }
}

/// Points on a grid, and the lumped mass they give it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Smoothing<'a> {
    /// Part of the background patch that the nodal fields of the body cover.
    pub patch: &'a Patch,
    /// Order of the points.
    pub cells: &'a Cells,
    /// All points of the body, sorted by span.
    pub points: &'a [Point],
    /// Density of the undeformed material, kg/m³.
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

walks!([] GridToGrid<'_> => ());

impl GridToGrid<'_> {
    #[inline(always)]
    fn walk<const FMA: bool>(mut self, kx: usize, ky: usize) {
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
