//! Loads that move with the body. Tractions act on surface points s: `f_I = factor(time) Σ_s f_s N_I(x_s)`,
//! where the force f_s of a pressure turns and stretches with the boundary.
//!
//! The volume loads of a [`Forcing`] act on the material points, for verification. A load is given per
//! reference volume as a function of reference position and time, and integrated at the moved point: its
//! force with the shape functions there, its stress with their gradients there. Work is the mean of the
//! powers of old and new load on the motion of the step. With finite kinematics the gradient of that motion
//! is taken at either end.

use std::sync::Arc;

use rayon::prelude::*;

use super::grid::NodalFields;
use super::windows::{cut, scatter};
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::forcing::{Forcing, VolumeLoad};
use crate::dynamics::loads::KickFactor;
use crate::dynamics::surface::{SurfacePoint, surface_points};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::vectors::{cofactor, dot};
use crate::material::hencky::{Gradient, gradient_at_end};
use crate::particles::follower::Follower;
use crate::particles::points::{Cell, Cells, OutsidePatch, Point};
use crate::scene::{Body, Load, Traction};
use crate::splines::patch::Patch;

/// A traction and the surface points that carry it.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceLoad {
    points: Vec<MovingSurfacePoint>,
    /// Whether it is a pressure.
    follows: bool,
    /// Factor over time by which the full strength is multiplied.
    pub factor: KickFactor,
    /// Power at full strength during the last motion, of the forces before and after it, W/m.
    powers: [f64; 2],
}

#[derive(Debug, Clone, Copy)]
struct MovingSurfacePoint {
    place: Follower,
    /// Length at t = 0, m.
    length: f64,
    /// At full strength, N/m.
    force: [f64; 2],
}

impl SurfaceLoad {
    /// The surface points of a traction at t = 0.
    pub(super) fn new(patch: &Patch, body: &Body, traction: &Traction) -> Self {
        let carried = |point: SurfacePoint| {
            let SurfacePoint { position, length, normal, .. } = point;
            let force = traction.load.traction(position, normal).map(|t| length * t);
            MovingSurfacePoint { place: Follower::new(position), length, force }
        };
        Self {
            points: surface_points(patch, body, &traction.edge).into_iter().map(carried).collect(),
            follows: matches!(traction.load, Load::Pressure(_)),
            factor: KickFactor::new(traction.time.clone()),
            powers: [0.0; 2],
        }
    }

    /// A place where its force is not finite, m.
    pub(crate) fn undefined(&self) -> Option<[f64; 2]> {
        let is_undefined = |point: &&MovingSurfacePoint| !point.force.iter().all(|f| f.is_finite());
        self.points.iter().find(is_undefined).map(|point| point.place.position)
    }

    /// Power during the last motion of `dt` seconds, of the forces before and after it at `time`, W/m.
    pub(crate) fn powers(&self, time: f64, dt: f64) -> [f64; 2] {
        [self.factor.at(time - dt) * self.powers[0], self.factor.at(time) * self.powers[1]]
    }

    /// Chooses the span of every surface point anew.
    ///
    /// # Errors
    /// A surface point with no material within one span of it.
    pub(crate) fn attach(&mut self, patch: &Patch, nodes: &NodalFields, density: f64) -> Result<(), OutsidePatch> {
        self.points.iter_mut().try_for_each(|point| point.place.attach(patch, &nodes.inverse_mass, density))
    }

    /// Position (m) of every control point that answers to the load, and its share of the length of the edge,
    /// m: once for each surface point.
    pub(crate) fn shares<'a>(
        &'a self,
        patch: &'a Patch,
        nodes: &'a NodalFields,
    ) -> impl Iterator<Item = ([f64; 2], f64)> + 'a {
        self.points.iter().flat_map(move |point| {
            let mut shares = Vec::new();
            point.place.for_each_function(patch, nodes.grid, |at, n| {
                if nodes.inverse_mass[at] > 0.0 {
                    shares.push((nodes.position(at), point.length * n));
                }
            });
            shares
        })
    }

    /// Adds the nodal forces at a time, N/m.
    pub(crate) fn add_forces(&self, patch: &Patch, grid: ControlGrid, time: f64, force: &mut [Vec<f64>; 2]) {
        let factor = self.factor.at(time);
        for point in &self.points {
            point.place.for_each_function(patch, grid, |at, n| {
                (0..2).for_each(|c| force[c][at] += factor * point.force[c] * n);
            });
        }
    }

    /// Moves the points with the grid over `dt` seconds and records the powers.
    pub(crate) fn move_points(&mut self, patch: &Patch, grid: ControlGrid, velocity: &[Vec<f64>; 2], dt: f64) {
        self.powers = [0.0; 2];
        for MovingSurfacePoint { place, force, .. } in &mut self.points {
            let mut v = [0.0; 2];
            place.for_each_function(patch, grid, |at, n| v = [0, 1].map(|c| v[c] + n * velocity[c][at]));
            let gradient = place.follow(patch, grid, velocity, dt);
            self.powers[0] += dot(*force, v);
            if fault!("pressure-on-the-edge-of-t-0", self.follows => false) {
                let turned = cofactor(gradient, *force);
                *force = [0, 1].map(|c| force[c] + dt * turned[c]);
            }
            self.powers[1] += dot(*force, v);
        }
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { points, follows, factor: _, powers } = self;
        points.iter_mut().try_for_each(|point| archive.value(&mut point.place.position))?;
        if *follows {
            points.iter_mut().try_for_each(|point| archive.value(&mut point.force))?;
        }
        archive.value(powers)
    }
}

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
