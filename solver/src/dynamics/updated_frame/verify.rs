//! What verification sets and a scene cannot say: velocity fields, volume loads, prescribed motions.

use std::sync::Arc;

use super::UpdatedFrame;
use super::field::DiscreteField;
use super::volume_forcing::PointForcing;
use crate::dynamics::failure::Failure;
use crate::dynamics::forcing::Forcing;

impl UpdatedFrame {
    /// Gives the points an initial velocity (m/s) as a function of the reference position (m), before the
    /// first step.
    ///
    /// # Panics
    /// After a step.
    pub fn set_initial_velocity(&mut self, velocity: impl Fn([f64; 2]) -> [f64; 2]) {
        assert!(self.fields.iter().all(|field| field.at_start), "a step has been taken");
        self.fields.iter_mut().for_each(|field| field.set_velocity(&velocity));
    }

    /// Applies the volume loads of a forcing (`volume` alone) from the present time on, before the first
    /// step.
    ///
    /// # Panics
    /// After a step.
    pub fn apply_forcing(&mut self, forcing: Arc<dyn Forcing>) {
        assert!(self.fields.iter().all(|field| field.at_start), "a step has been taken");
        self.fields.iter_mut().for_each(|field| field.apply_forcing(Arc::clone(&forcing)));
    }

    /// Moves the points for `dt` seconds with a velocity (m/s) prescribed at the Greville points of all
    /// control points, which makes an affine motion exact. Forces play no part, velocities stay, and the
    /// ledger books nothing.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn prescribe_motion(&mut self, velocity: impl Fn([f64; 2]) -> [f64; 2], dt: f64) -> Result<(), Failure> {
        self.fields.iter_mut().try_for_each(|field| field.prescribe_motion(&velocity, dt))
    }
}

impl DiscreteField {
    fn set_velocity(&mut self, velocity: impl Fn([f64; 2]) -> [f64; 2]) {
        for point in &mut self.points {
            point.velocity = velocity(point.reference());
        }
        self.take_affine_velocities(velocity);
        self.points_to_grid();
        self.respond();
    }

    fn apply_forcing(&mut self, forcing: Arc<dyn Forcing>) {
        self.forcing = Some(PointForcing::new(forcing, self.deformation.is_some(), &self.points, self.time));
        self.points_to_grid();
        self.respond();
    }

    fn prescribe_motion(&mut self, velocity: impl Fn([f64; 2]) -> [f64; 2], dt: f64) -> Result<(), Failure> {
        self.time += dt;
        self.nodes.velocity = self.nodes.at_greville_points(velocity);
        self.velocity_transfer.keep();
        if self.grid_to_points(dt)? {
            self.sort()?;
        }
        self.crack_and_stress()?;
        self.rebuild_grid()?;
        Ok(())
    }
}
