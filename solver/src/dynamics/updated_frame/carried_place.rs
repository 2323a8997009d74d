//! Places on an edge of a body that the material next to it carries.

use crate::checkpoint::{Archive, StateError};
use crate::dynamics::surface::SurfacePoint;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::vectors::dot;
use crate::particles::follower::Follower;
use crate::particles::points::OutsidePatch;
use crate::scene::Body;
use crate::splines::patch::Patch;

/// A place on an edge: a root as deep in the body as the points next to the edge are, which moves as they do,
/// and the arm from it to the edge, which deforms with it. So the edge stays where the points are, though no
/// point marks it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CarriedPlace {
    root: Follower,
    arm: [f64; 2],
}

impl CarriedPlace {
    /// A place on the edge of a body at t = 0, m, to be attached.
    pub(super) fn new(patch: &Patch, body: &Body, point: &SurfacePoint) -> Self {
        let spacing = |d: usize| {
            let space = &patch.spaces[d];
            let length = space.find_span(point.inner[d]).map_or(0.0, |span| space.spans()[span].length());
            length * point.normal[d].abs() / body.particles_per_cell[d] as f64
        };
        let arm = point.normal.map(|n| 0.5 * (spacing(0) + spacing(1)) * n);
        Self { root: Follower::new([0, 1].map(|d| point.position[d] - arm[d])), arm }
    }

    /// Where it is, m.
    pub(super) fn position(&self) -> [f64; 2] {
        [0, 1].map(|d| self.root.position[d] + self.arm[d])
    }

    /// Chooses the span anew.
    ///
    /// # Errors
    /// If there is no material within one span of it.
    pub(super) fn attach(&mut self, patch: &Patch, inverse_mass: &[f64], density: f64) -> Result<(), OutsidePatch> {
        self.root.attach(patch, inverse_mass, density)
    }

    /// Calls `f` with control point and value of every shape function at the edge, by the polynomials of the
    /// material next to it.
    pub(super) fn for_each_function(&self, patch: &Patch, grid: ControlGrid, f: impl FnMut(usize, f64)) {
        self.root.continued_to(self.position()).for_each_function(patch, grid, f);
    }

    /// Calls `f` with control point and linear continuation of every shape function from the root to the
    /// edge: of a velocity field it gives the velocity with which the edge [moves](Self::follow).
    pub(super) fn for_each_continued(&self, patch: &Patch, grid: ControlGrid, mut f: impl FnMut(usize, f64)) {
        let arm = fault!("edge-behind-its-root", self.arm => self.arm.map(|a| -a));
        self.root.for_each_gradient(patch, grid, |at, n, [x, y]| f(at, n + arm[0] * x + arm[1] * y));
    }

    /// Moves with a velocity field (m/s) for `dt` seconds; the gradient of that at the root, 1/s.
    pub(super) fn follow(
        &mut self,
        patch: &Patch,
        grid: ControlGrid,
        velocity: &VectorField,
        dt: f64,
    ) -> [[f64; 2]; 2] {
        let mut gradient = [[0.0; 2]; 2];
        self.root.for_each_gradient(patch, grid, |at, _, slope| {
            (0..2).for_each(|c| (0..2).for_each(|d| gradient[c][d] += velocity[c][at] * slope[d]));
        });
        self.root.follow(patch, grid, velocity, dt);
        self.arm = [0, 1].map(|c| self.arm[c] + dt * dot(gradient[c], self.arm));
        gradient
    }

    /// Stores or takes up where it is.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        archive.value(&mut self.root.position)?;
        archive.value(&mut self.arm)
    }
}
