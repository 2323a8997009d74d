//! Rigid bodies: they move as prescribed, whatever they meet.

use super::surface::Surface;
use crate::scene::{Body, Mesh};

/// A rigid body.
#[derive(Debug, Clone)]
pub(crate) struct RigidBody {
    surface: Surface,
    /// Vertices of the surface and centre at t = 0, m.
    reference: Vec<[f64; 2]>,
    center: [f64; 2],
    velocity: [f64; 2],
    spin: f64,
    time: f64,
}

impl RigidBody {
    /// `body` at t = 0.
    pub(crate) fn new(mesh: &Mesh, body: &Body) -> Self {
        let surface = Surface::new(mesh, body);
        let (center, velocity, spin) = (surface.centroid(), body.velocity, body.angular_velocity);
        Self { reference: surface.positions().to_vec(), surface, center, velocity, spin, time: 0.0 }
    }

    /// Moves to the place it has at a time, s, and expects a step of `dt` seconds.
    pub(crate) fn move_to(&mut self, time: f64, dt: f64) {
        self.time = time;
        if self.velocity == [0.0; 2] && self.spin == 0.0 {
            return;
        }
        let (sin, cos) = (self.spin * time).sin_cos();
        let (center, reference, now) = (self.center, &self.reference, self.present_center());
        self.surface.place(|vertex| {
            let arm = [0, 1].map(|d| reference[vertex][d] - center[d]);
            [now[0] + cos * arm[0] - sin * arm[1], now[1] + sin * arm[0] + cos * arm[1]]
        });
        let mut surface = std::mem::take(&mut self.surface);
        surface.expect_displacements(|position| self.velocity_at(position).map(|v| dt * v));
        self.surface = surface;
    }

    /// Velocity at a position, m/s.
    pub(crate) fn velocity_at(&self, position: [f64; 2]) -> [f64; 2] {
        let center = self.present_center();
        let arm = [0, 1].map(|d| position[d] - center[d]);
        let moving = [self.velocity[0] - self.spin * arm[1], self.velocity[1] + self.spin * arm[0]];
        fault!("rigid-body-at-rest", moving => [0.0; 2])
    }

    /// Its boundary now.
    pub(crate) fn surface(&self) -> &Surface {
        &self.surface
    }

    fn present_center(&self) -> [f64; 2] {
        [0, 1].map(|d| self.center[d] + self.time * self.velocity[d])
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.surface.bytes() + self.reference.len() * size_of::<[f64; 2]>()
    }
}
