//! Volume loads of a [`Forcing`] on the moving points, for verification.
//!
//! A load is given per reference volume as a function of reference position and time, and integrated at the
//! moved point: its force with the shape functions there, its stress with their gradients there. Work is the
//! mean of the powers of old and new load on the motion of the step. With finite kinematics the gradient of
//! that motion is taken at either end.

use std::sync::Arc;

use rayon::prelude::*;

use super::windows::{cut, scatter};
use crate::dynamics::forcing::{Forcing, VolumeLoad};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::material::hencky::{Gradient, gradient_at_end};
use crate::particles::points::{Cell, Cells, Point};
use crate::splines::patch::Patch;

/// A forcing, and what it needs per point.
#[derive(Debug, Clone)]
pub(crate) struct PointForcing {
    forcing: Arc<dyn Forcing>,
    finite: bool,
    /// Load on each point now, in the order of the points.
    loads: Vec<VolumeLoad>,
    /// Velocity and its gradient in the motion of the step.
    motion: Vec<([f64; 2], Gradient)>,
    /// Powers of the old and of the new load on that motion, W/m.
    pub powers: [f64; 2],
}

impl PointForcing {
    /// Loads at a time, s.
    pub(crate) fn new(forcing: Arc<dyn Forcing>, finite: bool, points: &[Point], time: f64) -> Self {
        let loads = points.iter().map(|p| forcing.volume(p.reference(), time)).collect();
        Self { forcing, finite, loads, motion: vec![Default::default(); points.len()], powers: [0.0; 2] }
    }

    /// Records the motion the points are about to make, and the power of the present loads on it.
    pub(crate) fn before_motion(&mut self, patch: &Patch, cells: &Cells, points: &[Point], velocity: &VectorField) {
        let (loads, grid) = (&self.loads, patch.control_grid());
        let motion = cut(&mut self.motion, cells.strips.iter().map(|s| s.points.clone())).into_par_iter();
        let powers: Vec<f64> = motion
            .zip(&cells.strips)
            .map(|(motion, strip)| {
                let mut power = 0.0;
                for (cell, at) in in_cells(cells, strip.cells.clone()) {
                    let point = &points[at];
                    let moved = &mut motion[at - strip.points.start];
                    *moved = Default::default();
                    let (v, gradient) = moved;
                    for_each_function(patch, grid, cell, point, |node, n, slope| {
                        for i in 0..2 {
                            v[i] += n * velocity[i][node];
                            gradient[i] = [0, 1].map(|j| gradient[i][j] + slope[j] * velocity[i][node]);
                        }
                    });
                    power += point.volume * power_density(&loads[at], moved);
                }
                power
            })
            .collect();
        self.powers[0] = powers.iter().sum();
    }

    /// Loads at the new time (s), and their power on the motion of `dt` seconds that was made.
    pub(crate) fn after_motion(&mut self, points: &[Point], time: f64, dt: f64) {
        self.powers[1] = 0.0;
        for ((load, (v, gradient)), point) in self.loads.iter_mut().zip(&self.motion).zip(points) {
            *load = self.forcing.volume(point.reference(), time);
            let at_end = if self.finite {
                gradient_at_end(&gradient.map(|row| row.map(|g| dt * g))).map(|row| row.map(|g| g / dt))
            } else {
                *gradient
            };
            self.powers[1] += point.volume * power_density(load, &(*v, at_end));
        }
    }

    /// Follows a new order of the points.
    pub(crate) fn reorder(&mut self, cells: &Cells) {
        cells.reorder(&mut self.loads);
    }

    /// Adds the nodal forces, N/m.
    pub(crate) fn add_forces(&self, patch: &Patch, cells: &Cells, points: &[Point], force: &mut VectorField) {
        let grid = patch.control_grid();
        scatter(&cells.strips, force.each_mut().map(|f| &mut f[..]), [grid.stride; 2], |strip, window| {
            let above = window.first_row * grid.stride;
            for (cell, at) in in_cells(cells, strip.cells.clone()) {
                let (point, load) = (&points[at], &self.loads[at]);
                for_each_function(patch, grid, cell, point, |node, n, slope| {
                    for i in 0..2 {
                        let stress = load.stress[i][0] * slope[0] + load.stress[i][1] * slope[1];
                        window.fields[i][node - above] += point.volume * (n * load.force[i] + stress);
                    }
                });
            }
        });
    }
}

/// Power per unit volume on a velocity and its gradient.
fn power_density(load: &VolumeLoad, (v, gradient): &([f64; 2], Gradient)) -> f64 {
    (0..2).map(|i| load.force[i] * v[i] + (0..2).map(|j| load.stress[i][j] * gradient[i][j]).sum::<f64>()).sum()
}

/// Cell and index of the points of some cells.
fn in_cells(cells: &Cells, some: std::ops::Range<usize>) -> impl Iterator<Item = (&Cell, usize)> {
    cells.cells[some].iter().flat_map(|cell| cell.points.clone().map(move |at| (cell, at)))
}

/// Calls `f` with control point and means of value and gradient of every shape function over the domain of a
/// point.
fn for_each_function(
    patch: &Patch,
    grid: ControlGrid,
    cell: &Cell,
    point: &Point,
    mut f: impl FnMut(usize, f64, [f64; 2]),
) {
    let order = [0, 1].map(|d| patch.spaces[d].degree() + 1);
    let [sx, sy] = point.mean_functions::<false>(patch, cell, order);
    for l in (0..=order[1]).filter(|&l| sy.value[l] != 0.0) {
        for k in (0..=order[0]).filter(|&k| sx.value[k] != 0.0) {
            let slope = [sx.derivative[k] * sy.value[l], sx.value[k] * sy.derivative[l]];
            let at = grid.index(cell.first[0] + sx.start + k - 1, cell.first[1] + sy.start + l - 1);
            f(at, sx.value[k] * sy.value[l], slope);
        }
    }
}
