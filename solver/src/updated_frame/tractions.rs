//! Tractions on surface points that move with the body.
//!
//! A surface point lies on the boundary, so it may stand in a span that no material point has reached. It is evaluated
//! with the polynomials of the nearest span that has points, continued beyond its end: they still sum to one and
//! reproduce positions, so no force and no torque is lost, and every control point that gets a force has mass.

use super::points::{Cells, OutsidePatch};
use crate::loads::surface_points;
use crate::patch::{ControlGrid, Patch};
use crate::scene::{Body, Traction};
use crate::spline::{ShapeFunctions, SplineSpace};

/// A traction and the surface points that carry it.
#[derive(Debug, Clone)]
pub struct SurfaceLoad {
    points: Vec<MovingSurfacePoint>,
    stress: [f64; 2],
    ramp: Option<f64>,
    /// Power of the full traction on the points during the last motion, W/m.
    power: f64,
}

#[derive(Debug, Clone, Copy)]
struct MovingSurfacePoint {
    position: [f64; 2],
    length: f64,
    /// Span whose polynomials are used.
    span: [usize; 2],
}

impl SurfaceLoad {
    /// The surface points of a traction at t = 0.
    pub fn new(patch: &Patch, body: &Body, traction: &Traction) -> Self {
        let points = surface_points(patch, body, &traction.edge).into_iter();
        let points =
            points.map(|p| MovingSurfacePoint { position: p.position, length: p.length, span: [0, 0] }).collect();
        Self { points, stress: traction.stress, ramp: traction.ramp, power: 0.0 }
    }

    /// Factor at a time (s): rises linearly over the ramp.
    pub fn factor(&self, time: f64) -> f64 {
        self.ramp.map_or(1.0, |ramp| (time / ramp).clamp(0.0, 1.0))
    }

    /// Power of the full traction on the points during the last motion, W/m.
    pub fn power(&self) -> f64 {
        self.power
    }

    /// Chooses the span of every surface point anew.
    ///
    /// # Errors
    /// A surface point with no material within one span of it.
    pub fn attach(&mut self, patch: &Patch, cells: &Cells) -> Result<(), OutsidePatch> {
        for point in &mut self.points {
            point.span = nearest_occupied_span(patch, cells, point.position).ok_or(OutsidePatch(point.position))?;
        }
        Ok(())
    }

    /// Adds the nodal forces at a time, N/m.
    pub fn add_forces(&self, patch: &Patch, grid: ControlGrid, time: f64, force: &mut [Vec<f64>; 2]) {
        let factor = self.factor(time);
        for point in &self.points {
            for_each_function(patch, grid, point, |at, n| {
                for component in 0..2 {
                    force[component][at] += factor * point.length * self.stress[component] * n;
                }
            });
        }
    }

    /// Moves the points with the grid over `dt` seconds and records the power.
    pub fn move_points(&mut self, patch: &Patch, grid: ControlGrid, velocity: &[Vec<f64>; 2], dt: f64) {
        self.power = 0.0;
        for point in &mut self.points {
            let mut v = [0.0; 2];
            for_each_function(patch, grid, point, |at, n| v = [0, 1].map(|c| v[c] + n * velocity[c][at]));
            self.power += point.length * (self.stress[0] * v[0] + self.stress[1] * v[1]);
            point.position = [0, 1].map(|c| point.position[c] + dt * v[c]);
        }
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        self.points.len() * size_of::<MovingSurfacePoint>()
    }
}

/// Calls `f` with control point and value of every shape function at a surface point.
fn for_each_function(patch: &Patch, grid: ControlGrid, point: &MovingSurfacePoint, mut f: impl FnMut(usize, f64)) {
    let shapes: [ShapeFunctions; 2] = [0, 1].map(|d| patch.spaces[d].shape_functions(point.span[d], point.position[d]));
    let first = [0, 1].map(|d| patch.spaces[d].spans()[point.span[d]].first);
    for l in 0..=patch.spaces[1].degree() {
        for k in 0..=patch.spaces[0].degree() {
            f(grid.index(first[0] + k, first[1] + l), shapes[0].value[k] * shapes[1].value[l]);
        }
    }
}

/// The span with points that is nearest to a position, among its own and its eight neighbours.
fn nearest_occupied_span(patch: &Patch, cells: &Cells, position: [f64; 2]) -> Option<[usize; 2]> {
    let home = [0, 1].map(|d| clamped_span(&patch.spaces[d], position[d]));
    let near = |d: usize| home[d].saturating_sub(1)..(home[d] + 2).min(patch.spaces[d].spans().len());
    let distance = |span: &[usize; 2]| {
        let beyond = |d: usize| {
            let s = &patch.spaces[d].spans()[span[d]];
            (s.left - position[d]).max(position[d] - s.right).max(0.0)
        };
        beyond(0).hypot(beyond(1))
    };
    let spans = std::iter::once(home).chain(near(1).flat_map(|j| near(0).map(move |i| [i, j])));
    spans.filter(|span| cells.is_occupied(*span)).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The span of `x`, or the end span nearest to it.
fn clamped_span(space: &SplineSpace, x: f64) -> usize {
    let last = space.spans().len() - 1;
    space.find_span(x).unwrap_or(if x > space.spans()[last].right { last } else { 0 })
}
