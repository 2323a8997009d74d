//! Tractions on surface points s that move with the body: `f_I = factor(time) Σ_s l_s t N_I(x_s)`.

use super::carried_place::CarriedPlace;
use super::grid::NodalFields;
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::loads::KickFactor;
use crate::dynamics::surface::{SurfacePoint, surface_points};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::particles::points::OutsidePatch;
use crate::scene::{Body, Traction};
use crate::splines::patch::Patch;

/// A traction and the surface points that carry it.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceLoad {
    points: Vec<MovingSurfacePoint>,
    stress: [f64; 2],
    /// Its factor.
    pub factor: KickFactor,
    /// Power of the full traction on the points during the last motion, W/m.
    power: f64,
}

#[derive(Debug, Clone, Copy)]
struct MovingSurfacePoint {
    place: CarriedPlace,
    length: f64,
}

impl SurfaceLoad {
    /// The surface points of a traction at t = 0.
    pub(crate) fn new(patch: &Patch, body: &Body, traction: &Traction) -> Self {
        let points = surface_points(patch, body, &traction.edge).into_iter();
        let place =
            |p: SurfacePoint| MovingSurfacePoint { place: CarriedPlace::new(patch, body, &p), length: p.length };
        let points = points.map(place).collect();
        Self {
            points,
            stress: traction.load.traction([0.0; 2], [0.0; 2]),
            factor: KickFactor::new(traction.time.clone()),
            power: 0.0,
        }
    }

    /// Power of the full traction on the points during the last motion, W/m.
    pub(crate) fn power(&self) -> f64 {
        self.power
    }

    /// Chooses the span of every surface point anew.
    ///
    /// # Errors
    /// A surface point with no material within one span of it.
    pub(crate) fn attach(&mut self, patch: &Patch, nodes: &NodalFields) -> Result<(), OutsidePatch> {
        self.points.iter_mut().try_for_each(|point| point.place.attach(patch, &nodes.inverse_mass))
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
                for component in 0..2 {
                    force[component][at] += factor * point.length * self.stress[component] * n;
                }
            });
        }
    }

    /// Moves the points with the grid over `dt` seconds and records the power.
    pub(crate) fn move_points(&mut self, patch: &Patch, grid: ControlGrid, velocity: &[Vec<f64>; 2], dt: f64) {
        self.power = 0.0;
        for point in &mut self.points {
            let mut v = [0.0; 2];
            point.place.for_each_function(patch, grid, |at, n| v = [0, 1].map(|c| v[c] + n * velocity[c][at]));
            point.place.follow(patch, grid, velocity, dt);
            self.power += point.length * (self.stress[0] * v[0] + self.stress[1] * v[1]);
        }
    }

    /// Stores or takes up the positions of the points and their power.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { points, stress: _, factor: _, power } = self;
        points.iter_mut().try_for_each(|point| point.place.exchange(archive))?;
        archive.value(power)
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.points.len() * size_of::<MovingSurfacePoint>()
    }
}
