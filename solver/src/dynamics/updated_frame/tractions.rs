//! Tractions on surface points s that move with the body: `f_I = factor(time) Σ_s f_s N_I(x_s)`, where the
//! force f_s of a pressure turns and stretches with the boundary.

use super::grid::NodalFields;
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::loads::KickFactor;
use crate::dynamics::surface::{SurfacePoint, surface_points};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::vectors::{cofactor, dot};
use crate::particles::follower::Follower;
use crate::particles::points::OutsidePatch;
use crate::scene::{Body, Load, Traction};
use crate::splines::patch::Patch;

/// A traction and the surface points that carry it.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceLoad {
    points: Vec<MovingSurfacePoint>,
    /// Whether it is a pressure.
    follows: bool,
    /// Its factor.
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
