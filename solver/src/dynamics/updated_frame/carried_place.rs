//! Places on an edge of a body that the material next to it carries.

use crate::checkpoint::{Archive, StateError};
use crate::dynamics::surface::SurfacePoint;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::vectors::dot;
use crate::particles::follower::Follower;
use crate::particles::points::{Cells, OutsidePatch, Point};
use crate::scene::Body;
use crate::splines::patch::Patch;

/// The points of a body at t = 0, by the spans of a patch.
pub(super) struct PlacedPoints<'a> {
    pub patch: &'a Patch,
    pub cells: &'a Cells,
    pub points: &'a [Point],
}

impl PlacedPoints<'_> {
    /// Depth under a place on the edge of the points next to it, m: the least of those that lie within the
    /// distance of points to either side, in its span or one beside it.
    fn depth_under(&self, body: &Body, SurfacePoint { position, normal, inner, .. }: &SurfacePoint) -> f64 {
        let Self { patch, cells, points } = self;
        let home = [0, 1].map(|d| patch.spaces[d].find_span(inner[d]).unwrap_or_default());
        let spacing = [0, 1].map(|d| patch.spaces[d].spans()[home[d]].length() / body.particles_per_cell[d] as f64);
        let window = larger(spacing[0], spacing[1]);
        let around = |d: usize| home[d].saturating_sub(1)..(home[d] + 2).min(patch.spaces[d].spans().len());
        let near = around(1).flat_map(|j| around(0).flat_map(move |i| points[cells.points_in([i, j])].iter()));
        let depths = near.filter_map(|point| {
            let from = [0, 1].map(|d| position[d] - point.position[d]);
            let beside = from[0] * normal[1] - from[1] * normal[0];
            (beside.abs() <= window).then(|| dot(from, *normal)).filter(|depth| *depth > 0.0)
        });
        let least = depths.fold(f64::INFINITY, smaller);
        if least.is_finite() { least } else { 0.5 * (spacing[0] * normal[0].abs() + spacing[1] * normal[1].abs()) }
    }
}

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
    pub(super) fn new(body: &Body, point: &SurfacePoint, placed: &PlacedPoints<'_>) -> Self {
        let depth = placed.depth_under(body, point);
        let arm = point.normal.map(|n| depth * n);
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
