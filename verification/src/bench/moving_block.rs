//! The block in the updated frame, and the phases of its step one by one: P2G, grid, G2P.

use fisura::Simulation;
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::dynamics::updated_frame::field::DiscreteField;
use fisura::dynamics::updated_frame::strain::SmallStrain;
use fisura::dynamics::updated_frame::transfer::{GridToPoints, PointsToGrid, StripMotion};
use fisura::dynamics::updated_frame::windows::{cut, scatter, side_by_side};
use fisura::linear_algebra::lane::dispatch;
use fisura::scene::Scene;
use rayon::prelude::*;

use super::block::{DENSITY, moving_scene};
use super::{BenchError, minimal::Minimal};
use crate::extremes::{larger, largest};

/// An elastic block in the updated frame after a few steps.
pub struct MovingBlock(DiscreteField);

/// A velocity that strains: m/s at a position in m.
fn velocity([x, y]: [f64; 2]) -> [f64; 2] {
    [(900.0 * x + 300.0 * y).sin(), (500.0 * x - 1100.0 * y).cos()]
}

impl MovingBlock {
    /// The block after `steps` steps.
    ///
    /// # Errors
    /// If a step cannot be taken.
    pub fn new(degree: usize, points: usize, cells: usize, steps: usize) -> Result<Self, BenchError> {
        let (mut frame, _) = moved(&moving_scene(degree, points, cells, degree), steps)?;
        Ok(Self(frame.fields.swap_remove(0)))
    }

    /// Number of material points.
    pub fn count(&self) -> usize {
        self.0.points.len()
    }

    /// Means of the shape functions over the domains of all points; their sum, which is the number of points.
    pub fn basis(&self) -> f64 {
        let DiscreteField { patch, points, cells, .. } = &self.0;
        let order = patch.spaces.each_ref().map(|space| space.degree() + 1);
        let mut sum = 0.0;
        for cell in &cells.cells {
            for point in &points[cell.points.clone()] {
                let [sx, sy] = point.mean_functions::<false>(patch, cell, order);
                sum += sx.value.iter().sum::<f64>() * sy.value.iter().sum::<f64>();
            }
        }
        sum
    }

    /// Mass, momentum and forces of the points on the grid.
    pub fn points_to_grid(&mut self) {
        let DiscreteField { patch, points, cells, nodes, .. } = &mut self.0;
        let (patch, points, cells) = (&*patch, &points[..], &*cells);
        let grid = nodes.grid;
        nodes.sums.fill([0.0; 5]);
        scatter(&cells.strips, [&mut nodes.sums[..]], [grid.stride], |strip, window| {
            let cells = &cells.cells[strip.cells.clone()];
            dispatch(PointsToGrid { patch, grid, density: DENSITY, cells, points, affine: None, window });
        });
    }

    /// Velocities and accelerations of the control points, and a kick of `dt` seconds. What
    /// [`Self::points_to_grid`] left is used up.
    pub fn grid(&mut self, dt: f64) {
        self.0.nodes.divide_by_mass();
        self.0.nodes.stop();
        self.0.nodes.accelerate();
        self.0.nodes.kick(dt);
    }

    /// Velocity, position, strain and stress of the points after a step of `dt` seconds; zero leaves them
    /// where they are.
    pub fn grid_to_points(&mut self, dt: f64) -> StripMotion {
        let DiscreteField { patch, points, cells, nodes, moduli, .. } = &mut self.0;
        let patch = &*patch;
        let ([ux, uy], [ax, ay], mut fields) = (&nodes.velocity, &nodes.acceleration, Vec::new());
        side_by_side([ux, uy, ax, ay], &mut fields);
        let strips = cut(points, cells.strips.iter().map(|s| s.points.clone())).into_par_iter().zip(&cells.strips);
        let motions: Vec<StripMotion> = strips
            .map(|(points, strip)| {
                dispatch(GridToPoints {
                    patch,
                    grid: nodes.grid,
                    dt,
                    fields: &fields,
                    kept_fraction: 1.0,
                    affine: None,
                    kinematics: SmallStrain,
                    elastic: Some(*moduli),
                    cells: &cells.cells[strip.cells.clone()],
                    points,
                    fracture: &mut [],
                })
            })
            .collect();
        motions.into_iter().fold(StripMotion::default(), |sum, part| StripMotion {
            left_span: sum.left_span || part.left_span,
            fastest: larger(sum.fastest, part.fastest),
            elastic_energy: sum.elastic_energy + part.elastic_energy,
            stress_work: sum.stress_work + part.stress_work,
        })
    }

    /// Largest difference of the accelerations, recomputed phase by phase, from those of the solver's own
    /// step, over the largest of these.
    pub fn deviation(&self) -> f64 {
        let mut again = Self(self.0.clone());
        again.points_to_grid();
        again.grid(0.0);
        let pairs = |d: usize| again.0.nodes.acceleration[d].iter().zip(&self.0.nodes.acceleration[d]);
        let difference = |d: usize| largest(pairs(d).map(|(a, b)| (a - b).abs()));
        let size = largest(self.0.nodes.acceleration.iter().flatten().map(|a| a.abs()));
        larger(difference(0), difference(1)) / size
    }
}

/// The scene after some steps from [`velocity`], and the length of its steps, s.
fn moved(scene: &Scene, steps: usize) -> Result<(UpdatedFrame, f64), BenchError> {
    let dt = Simulation::new(scene)?.plan().step;
    let broken = |_| BenchError::other("a step of the block cannot be taken");
    let mut frame = UpdatedFrame::new(scene).map_err(broken)?;
    frame.set_initial_velocity(velocity);
    (0..steps).try_for_each(|_| frame.step(dt)).map_err(broken)?;
    Ok((frame, dt))
}

/// The minimal kernel on the points of the same block at t = 0, and the time step of the solver, s.
///
/// # Errors
/// If the scene cannot be started.
pub fn minimal<const P: usize>(points: usize, cells: usize) -> Result<(Minimal<P>, f64), BenchError> {
    let scene = moving_scene(P, points, cells, P);
    let (frame, dt) = moved(&scene, 0)?;
    let field = &frame.fields[0];
    Ok((Minimal::new(&scene.mesh, &field.points, field.moduli, DENSITY), dt))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_phases_put_together_are_the_step_of_the_solver() {
        let mut block = MovingBlock::new(2, 2, 12, 3).unwrap();
        assert!(block.deviation() <= 1e-13, "{:e}", block.deviation());
        assert!((block.basis() / block.count() as f64 - 1.0).abs() <= 1e-13);
        assert!(block.grid_to_points(0.0).elastic_energy > 0.0);
    }
}
