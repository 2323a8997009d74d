//! Positions on the boundary of a body that move with it.
//!
//! Such a position may stand in a span that no material point has reached. It is evaluated with the
//! polynomials of the nearest span with material, continued beyond its end: they still sum to one and
//! reproduce positions. A load takes the nearest span whose control points all answer to a force, so no force
//! and no torque is lost.

use super::points::{Cells, OutsidePatch};
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::surface::SurfacePoint;
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::vectors::dot;
use crate::scene::Body;
use crate::splines::nearest_span::nearest_span;
use crate::splines::patch::Patch;
use crate::splines::spline::ShapeFunctions;

/// A position that moves with a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Follower {
    /// Position, m.
    pub position: [f64; 2],
    /// Span whose polynomials are used.
    span: [usize; 2],
}

impl Follower {
    /// A position at t = 0, m, to be attached.
    pub(crate) fn new(position: [f64; 2]) -> Self {
        Self { position, span: [0, 0] }
    }

    /// A position (m) with the polynomials of the span it is in or nearest to; `None` if there is no material
    /// within one span of it.
    pub(crate) fn nearest(position: [f64; 2], patch: &Patch, cells: &Cells) -> Option<Self> {
        let span = nearest_span(&patch.spaces, position, |span| cells.is_occupied(span))?;
        Some(Self { position, span })
    }

    /// Chooses the span anew: the nearest whose control points all answer to a force.
    ///
    /// # Errors
    /// If there is none within one span of it.
    pub(crate) fn attach(&mut self, patch: &Patch, inverse_mass: &[f64]) -> Result<(), OutsidePatch> {
        let answers = |span| patch.all_functions(span, |at| inverse_mass[at] > 0.0);
        self.span = nearest_span(&patch.spaces, self.position, answers).ok_or(OutsidePatch(self.position))?;
        Ok(())
    }

    /// Moves with a velocity field (m/s) for `dt` seconds.
    pub(crate) fn follow(&mut self, patch: &Patch, grid: ControlGrid, velocity: &VectorField, dt: f64) {
        let mut v = [0.0; 2];
        self.for_each_function(patch, grid, |at, n| v = [0, 1].map(|c| v[c] + n * velocity[c][at]));
        self.position = [0, 1].map(|c| self.position[c] + dt * v[c]);
    }

    /// Calls `f` with control point and value of every shape function at the position.
    pub(crate) fn for_each_function(&self, patch: &Patch, grid: ControlGrid, mut f: impl FnMut(usize, f64)) {
        let [(column, x), (row, y)] = self.shape_functions(patch);
        for l in 0..=patch.spaces[1].degree() {
            for k in 0..=patch.spaces[0].degree() {
                f(grid.index(column + k, row + l), x.value[k] * y.value[l]);
            }
        }
    }

    /// Calls `f` with control point, value and gradient (1/m) of every shape function at the position.
    fn for_each_gradient(&self, patch: &Patch, grid: ControlGrid, mut f: impl FnMut(usize, f64, [f64; 2])) {
        let [(column, x), (row, y)] = self.shape_functions(patch);
        for l in 0..=patch.spaces[1].degree() {
            for k in 0..=patch.spaces[0].degree() {
                let slope = [x.derivative[k] * y.value[l], x.value[k] * y.derivative[l]];
                f(grid.index(column + k, row + l), x.value[k] * y.value[l], slope);
            }
        }
    }

    /// Shape functions in x at the position with the control column of the first, and those in y with the
    /// control row.
    #[inline]
    pub(crate) fn shape_functions(&self, patch: &Patch) -> [(usize, ShapeFunctions); 2] {
        let along = |d: usize| {
            let (space, span) = (&patch.spaces[d], self.span[d]);
            (space.spans()[span].first, space.shape_functions(span, self.position[d]))
        };
        [along(0), along(1)]
    }
}

/// A place on an edge of a body that the material next to it carries: a place as deep in the body as the points
/// next to the edge are, which moves as they do, and the arm from it to the edge, which deforms with it. So the
/// edge stays where the points are, though no point marks it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EdgePlace {
    root: Follower,
    arm: [f64; 2],
}

impl EdgePlace {
    /// A place on the edge of a body at t = 0, m, to be attached.
    pub(crate) fn new(patch: &Patch, body: &Body, point: &SurfacePoint) -> Self {
        let spacing = |d: usize| {
            let space = &patch.spaces[d];
            let length = space.find_span(point.inner[d]).map_or(0.0, |span| space.spans()[span].length());
            length * point.normal[d].abs() / body.particles_per_cell[d] as f64
        };
        let arm = point.normal.map(|n| 0.5 * (spacing(0) + spacing(1)) * n);
        Self { root: Follower::new([0, 1].map(|d| point.position[d] - arm[d])), arm }
    }

    /// Where it is, m.
    pub(crate) fn position(&self) -> [f64; 2] {
        [0, 1].map(|d| self.root.position[d] + self.arm[d])
    }

    /// Chooses the span anew.
    ///
    /// # Errors
    /// If there is no material within one span of it.
    pub(crate) fn attach(&mut self, patch: &Patch, inverse_mass: &[f64]) -> Result<(), OutsidePatch> {
        self.root.attach(patch, inverse_mass)
    }

    /// Calls `f` with control point and value of every shape function at the edge, by the polynomials of the
    /// material next to it.
    pub(crate) fn for_each_function(&self, patch: &Patch, grid: ControlGrid, f: impl FnMut(usize, f64)) {
        Follower { position: self.position(), ..self.root }.for_each_function(patch, grid, f);
    }

    /// Calls `f` with control point and linear continuation of every shape function from the root to the edge:
    /// of a velocity field it gives the velocity with which the edge [moves](Self::follow).
    pub(crate) fn for_each_continued(&self, patch: &Patch, grid: ControlGrid, mut f: impl FnMut(usize, f64)) {
        self.root.for_each_gradient(patch, grid, |at, n, [x, y]| f(at, n + self.arm[0] * x + self.arm[1] * y));
    }

    /// Moves with a velocity field (m/s) for `dt` seconds.
    pub(crate) fn follow(&mut self, patch: &Patch, grid: ControlGrid, velocity: &VectorField, dt: f64) {
        let mut gradient = [[0.0; 2]; 2];
        self.root.for_each_gradient(patch, grid, |at, _, slope| {
            (0..2).for_each(|c| (0..2).for_each(|d| gradient[c][d] += velocity[c][at] * slope[d]));
        });
        self.root.follow(patch, grid, velocity, dt);
        let stretched = [0, 1].map(|c| self.arm[c] + dt * dot(gradient[c], self.arm));
        self.arm = fault!("edge-on-a-rigid-arm", stretched => self.arm);
    }

    /// Stores or takes up where it is.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        archive.value(&mut self.root.position)?;
        archive.value(&mut self.arm)
    }
}
