//! Rigid bodies: they move as prescribed, whatever they meet.

use super::area::ShapeIntegrals;
use super::outline::without_patch;
use super::surface::Surface;
use crate::scene::{Body, Mesh};

/// The motion of a rigid body: steady, about a centre that moves on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidMotion {
    /// At t = 0, m.
    center: [f64; 2],
    velocity: [f64; 2],
    spin: f64,
}

impl RigidMotion {
    /// That of a body, about its centroid.
    pub(crate) fn new(mesh: &Mesh, body: &Body) -> Self {
        let center = ShapeIntegrals::new(&without_patch(&body.shape, mesh)).centroid;
        Self::steady(center, body.velocity, body.angular_velocity)
    }

    /// About a centre at t = 0 (m) that moves on with a velocity (m/s), with a spin (rad/s).
    pub(crate) fn steady(center: [f64; 2], velocity: [f64; 2], spin: f64) -> Self {
        Self { center, velocity, spin }
    }

    /// Whether the body stays where it is.
    pub(crate) fn rests(&self) -> bool {
        self.velocity == [0.0; 2] && self.spin == 0.0
    }

    /// A direction of t = 0 at a time, s.
    pub(crate) fn turn(&self, arm: [f64; 2], time: f64) -> [f64; 2] {
        let (sin, cos) = (self.spin * time).sin_cos();
        [cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]]
    }

    /// A place of t = 0 at a time, s.
    pub(crate) fn place(&self, reference: [f64; 2], time: f64) -> [f64; 2] {
        let now = self.center_at(time);
        let arm = self.turn([0, 1].map(|d| reference[d] - self.center[d]), time);
        [0, 1].map(|d| now[d] + arm[d])
    }

    /// Velocity at a position, m/s, at a time, s.
    pub(crate) fn velocity_at(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        let center = self.center_at(time);
        let arm = [0, 1].map(|d| position[d] - center[d]);
        let moving = [self.velocity[0] - self.spin * arm[1], self.velocity[1] + self.spin * arm[0]];
        fault!("rigid-body-at-rest", moving => [0.0; 2])
    }

    fn center_at(&self, time: f64) -> [f64; 2] {
        [0, 1].map(|d| self.center[d] + time * self.velocity[d])
    }
}

/// A rigid body.
#[derive(Debug, Clone)]
pub(crate) struct RigidBody {
    surface: Surface,
    /// Vertices of the surface at t = 0, m.
    reference: Vec<[f64; 2]>,
    motion: RigidMotion,
    time: f64,
}

impl RigidBody {
    /// `body` at t = 0.
    pub(crate) fn new(mesh: &Mesh, body: &Body) -> Self {
        let surface = Surface::new(mesh, body);
        let motion = RigidMotion::new(mesh, body);
        Self { reference: surface.positions().to_vec(), surface, motion, time: 0.0 }
    }

    /// Moves to the place it has at a time, s, and expects a step of `dt` seconds.
    pub(crate) fn move_to(&mut self, time: f64, dt: f64) {
        self.time = time;
        if self.motion.rests() {
            return;
        }
        let Self { surface, reference, motion, .. } = self;
        surface.place(|vertex| motion.place(reference[vertex], time));
        surface.expect_displacements(|position| motion.velocity_at(position, time).map(|v| dt * v));
    }

    /// Velocity at a position, m/s.
    pub(crate) fn velocity_at(&self, position: [f64; 2]) -> [f64; 2] {
        self.motion.velocity_at(position, self.time)
    }

    /// Its boundary now.
    pub(crate) fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.surface.bytes() + self.reference.len() * size_of::<[f64; 2]>()
    }
}
