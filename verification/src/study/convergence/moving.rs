//! One mesh of a convergence study whose points move through it: the updated frame with finite kinematics.
//!
//! Errors are measured at the points, weighted with their volumes, at a whole step: the points carry
//! velocities of half a step before, and reading these without the kick `dt/2 a` would leave an error of
//! first order. The velocity is also measured in the middle of the mesh alone: the lumped way from the points
//! to the grid is of a lower order at its sides.

use std::sync::Arc;
use std::time::Instant;

use fisura::dynamics::failure::Failure;
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::particles::lattice::Lattice;
use fisura::particles::points::Point;
use fisura::scene::{Body, Layout, Scene, Shape};
use fisura::splines::spline::SplineSpace;

use super::problem::{Manufactured, Problem};
use super::scene::scene;
use super::{OnMesh, Variant, other};
use crate::case::convergence::ConvergenceSetup;
use crate::study::orders::Level;
use crate::study::{StudyError, projected_on};

/// Displacements below this at t = 0 are none, m.
const AT_REST: f64 = 1e-12;

/// Names of the errors, in the order of [`Level::errors`], and their order below p + 1.
pub(super) const NORMS: [(&str, usize); 3] =
    [("displacement error at the points", 0), ("velocity error at the points", 0), ("velocity error in the middle", 0)];

/// Part of the mesh, in either direction, that the middle leaves out at each side.
const MARGIN: f64 = 0.2;

/// A problem on one mesh with points that move.
pub(super) struct Moving<'a> {
    setup: &'a ConvergenceSetup,
    problem: &'a Problem,
    frame: UpdatedFrame,
    scene: Scene,
}

impl<'a> Moving<'a> {
    /// The mesh with `cells` spans per direction for the n-th degree.
    pub fn new(
        setup: &'a ConvergenceSetup,
        problem: &'a Problem,
        n: usize,
        cells: usize,
        variant: Variant,
    ) -> Result<Self, StudyError> {
        let scene = scene(setup, problem, n, cells, variant)?;
        let frame = UpdatedFrame::new(&scene).map_err(broken)?;
        Ok(Self { setup, problem, frame, scene })
    }

    /// Displacement, velocity and loads of the exact solution at t = 0.
    fn start(&mut self) -> Result<(), StudyError> {
        let solution = self.problem.solution.clone();
        self.frame.set_initial_velocity(|x| solution.velocity(x, 0.0));
        let moved = |p: &Point| solution.displacement(p.position, 0.0).iter().any(|u| u.abs() > AT_REST);
        if self.frame.fields[0].points.iter().any(moved) {
            displace(&mut self.frame, &self.scene.bodies[0], |x| solution.displacement(x, 0.0))?;
        }
        let (solution, loading) = (self.problem.solution.clone(), self.setup.loading);
        self.frame.apply_forcing(Arc::new(Manufactured { solution, loading, diffusion: 0.0, moved: true }));
        Ok(())
    }

    /// Relative errors of displacement, velocity, and velocity in the middle at the end (s) of steps of `dt`
    /// (s).
    fn errors(&self, end: f64, dt: f64) -> Vec<f64> {
        let solution = &self.problem.solution;
        let acceleration = &self.frame.fields[0].nodes.acceleration;
        let sides = self.frame.patch.spaces.each_ref().map(sides);
        let mut squares = [[0.0; 2]; 3];
        for point in &self.frame.fields[0].points {
            let patch = &self.frame.fields[0].patch;
            let a = acceleration.each_ref().map(|a| patch.evaluate(a, point.position).unwrap_or_default().value);
            let velocity = [0, 1].map(|d: usize| point.velocity[d] + 0.5 * dt * a[d]);
            let reference = point.reference();
            let middle = (0..2).all(|d| is_in_middle(reference[d], sides[d]));
            let velocities = (velocity, solution.velocity(reference, end));
            let terms = [
                (point.volume, (point.displacement, solution.displacement(reference, end))),
                (point.volume, velocities),
                (if middle { point.volume } else { 0.0 }, velocities),
            ];
            for (sums, (weight, (found, exact))) in squares.iter_mut().zip(terms) {
                for d in 0..2 {
                    sums[0] += weight * (found[d] - exact[d]).powi(2);
                    sums[1] += weight * exact[d].powi(2);
                }
            }
        }
        squares.map(|[error, exact]| (error / exact).sqrt()).to_vec()
    }
}

impl OnMesh for Moving<'_> {
    fn best_errors(&self) -> Result<Vec<f64>, StudyError> {
        Ok(Vec::new())
    }

    fn level(mut self: Box<Self>, step: f64) -> Result<Level, StudyError> {
        let start = Instant::now();
        let end = self.setup.end_time.unwrap_or(self.problem.end_time);
        self.start()?;
        let steps = (end / step).ceil().max(1.0);
        let dt = end / steps;
        for _ in 0..steps as usize {
            crate::watch::check()?;
            self.frame.step(dt).map_err(broken)?;
        }
        let errors = self.errors(end, dt);
        let grid = self.frame.patch.control_grid();
        let unknowns = 2 * grid.columns * grid.rows;
        Ok(Level { h: self.span_length(), unknowns, seconds: start.elapsed().as_secs_f64(), errors })
    }

    fn critical_step(&self) -> f64 {
        self.frame.critical_step()
    }

    fn span_length(&self) -> f64 {
        let spans = self.frame.patch.spaces.each_ref().map(|space| {
            let [left, right] = sides(space);
            (right - left) / space.spans().len() as f64
        });
        (spans[0] * spans[1]).sqrt()
    }
}

/// Displaces the points of a body from rest by the projection of a displacement (m), whose error is of order
/// p + 1, within one second, and sets the clock back to zero.
pub(crate) fn displace(
    frame: &mut UpdatedFrame,
    body: &Body,
    displacement: impl Fn([f64; 2]) -> [f64; 2] + Sync,
) -> Result<(), StudyError> {
    let patch = &frame.patch;
    let whole = Body { shape: Shape::Patch, layout: Layout::Gauss, ..body.clone() };
    let lattice = Lattice::new(patch, &whole);
    let control = projected_on(&lattice, |_| Vec::new(), displacement)?;
    let (grid, greville) = (patch.control_grid(), [0, 1].map(|d| patch.spaces[d].greville()));
    let at = |x: [f64; 2]| {
        let [i, j] = [0, 1].map(|d| greville[d].partition_point(|g| *g < x[d]));
        [0, 1].map(|c: usize| control[c][grid.index(i, j)])
    };
    frame.prescribe_motion(at, 1.0).map_err(broken)?;
    frame.prescribe_motion(|_| [0.0; 2], -1.0).map_err(broken)
}

/// Ends of a spline space, m.
fn sides(space: &SplineSpace) -> [f64; 2] {
    let spans = space.spans();
    [spans[0].left, spans[spans.len() - 1].right]
}

fn is_in_middle(x: f64, [left, right]: [f64; 2]) -> bool {
    let part = (x - left) / (right - left);
    (MARGIN..=1.0 - MARGIN).contains(&part)
}

fn broken(failure: Failure) -> StudyError {
    other(failure.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_leaves_out_a_fifth_at_each_side() {
        let sides = sides(&SplineSpace::new(2, &[-1.0, -1.0, -1.0, 0.5, 4.0, 4.0, 4.0]));
        assert_eq!(sides, [-1.0, 4.0]);
        assert_eq!([-0.5, 0.5, 2.5, 3.5].map(|x| is_in_middle(x, sides)), [false, true, true, false]);
    }
}
