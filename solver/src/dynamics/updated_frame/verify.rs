//! What verification sets and a scene cannot say: velocity fields, volume loads, prescribed motions.

use std::sync::Arc;

use super::UpdatedFrame;
use super::loads::PointForcing;
use crate::dynamics::failure::Failure;
use crate::dynamics::forcing::Forcing;

impl UpdatedFrame {
    /// Gives the points an initial velocity (m/s) as a function of the reference position (m), before the
    /// first step.
    ///
    /// # Panics
    /// After a step.
    pub fn set_initial_velocity(&mut self, velocity: impl Fn([f64; 2]) -> [f64; 2]) {
        for field in &mut self.fields {
            assert!(field.at_start, "a step has been taken");
            field.points.iter_mut().for_each(|point| point.velocity = velocity(point.reference()));
            field.take_affine_velocities(&velocity);
            field.points_to_grid();
            field.respond();
        }
    }

    /// Applies the volume loads of a forcing (`volume` alone) from the present time on, before the first
    /// step.
    ///
    /// # Panics
    /// After a step.
    pub fn apply_forcing(&mut self, forcing: Arc<dyn Forcing>) {
        for field in &mut self.fields {
            assert!(field.at_start, "a step has been taken");
            let (forcing, finite) = (Arc::clone(&forcing), field.deformation.is_some());
            field.forcing = Some(PointForcing::new(forcing, finite, &field.points, field.time));
            field.points_to_grid();
            field.respond();
        }
    }

    /// Moves the points for `dt` seconds with a velocity (m/s) prescribed at the Greville points of all
    /// control points, which makes an affine motion exact. Forces play no part, velocities stay, and the
    /// ledger books nothing.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn prescribe_motion(&mut self, velocity: impl Fn([f64; 2]) -> [f64; 2], dt: f64) -> Result<(), Failure> {
        for field in &mut self.fields {
            field.time += dt;
            field.nodes.velocity = field.nodes.at_greville_points(&velocity);
            field.velocity_transfer.keep();
            if field.grid_to_points(dt)? {
                field.sort()?;
            }
            field.crack_and_stress()?;
            field.rebuild_grid()?;
        }
        Ok(())
    }
}
