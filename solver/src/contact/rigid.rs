//! Rigid bodies: they move as prescribed, whatever they meet, by impulses or by the potential of the gap.

use super::gap_potential::arc::{Arc, Outline};
use super::outline::{ShapeIntegrals, without_patch};
use super::surface::Surface;
use crate::scene::{Body, Mesh, TimeFactor};

/// The motion of a rigid body about a centre that moves on; velocity and spin share one factor in time.
#[derive(Debug, Clone)]
pub(crate) struct RigidMotion {
    /// Centre of rotation at t = 0, m.
    center: [f64; 2],
    velocity: [f64; 2],
    spin: f64,
    time: TimeFactor,
}

impl RigidMotion {
    /// That of a body, about its centroid.
    pub(crate) fn new(mesh: &Mesh, body: &Body) -> Self {
        let center = ShapeIntegrals::new(&without_patch(&body.shape, mesh)).centroid;
        Self { time: body.time.clone(), ..Self::steady(center, body.velocity, body.angular_velocity) }
    }

    /// About a centre at t = 0 (m) that moves on with a velocity (m/s), with a spin (rad/s).
    pub(crate) fn steady(center: [f64; 2], velocity: [f64; 2], spin: f64) -> Self {
        Self { center, velocity, spin, time: TimeFactor::default() }
    }

    /// Whether the body stays where it is.
    pub(crate) fn rests(&self) -> bool {
        self.velocity == [0.0; 2] && self.spin == 0.0
    }

    /// Where the body is at a time (s), and how it moves then.
    pub(crate) fn at(&self, time: f64) -> RigidPose {
        let factor = self.time.value(time);
        let travelled = fault!("rigid-course-forgotten", self.time.integral(time) => time);
        let center = [0, 1].map(|d| self.center[d] + travelled * self.velocity[d]);
        RigidPose {
            start: self.center,
            center,
            turned: (self.spin * travelled).sin_cos(),
            velocity: self.velocity.map(|v| v * factor),
            spin: self.spin * factor,
        }
    }
}

/// Place and velocity of a rigid body at a time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidPose {
    start: [f64; 2],
    center: [f64; 2],
    /// Sine and cosine of the angle that it has turned by.
    turned: (f64, f64),
    velocity: [f64; 2],
    spin: f64,
}

impl RigidPose {
    /// A direction of t = 0.
    pub(crate) fn turn(&self, arm: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.turned;
        [cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]]
    }

    /// A place of t = 0, m.
    pub(crate) fn place(&self, reference: [f64; 2]) -> [f64; 2] {
        let arm = self.turn([0, 1].map(|d| reference[d] - self.start[d]));
        [0, 1].map(|d| self.center[d] + arm[d])
    }

    /// Velocity at a position (m), m/s.
    pub(crate) fn velocity_at(&self, position: [f64; 2]) -> [f64; 2] {
        let arm = [0, 1].map(|d| position[d] - self.center[d]);
        let moving = [self.velocity[0] - self.spin * arm[1], self.velocity[1] + self.spin * arm[0]];
        fault!("rigid-body-at-rest", moving => [0.0; 2])
    }
}

/// A rigid body that others meet by impulses: its boundary, its motion, and where it is now.
#[derive(Debug, Clone)]
pub(crate) struct RigidBody {
    pub surface: Surface,
    /// Vertices of the surface at t = 0, m.
    reference: Vec<[f64; 2]>,
    motion: RigidMotion,
    pub pose: RigidPose,
}

impl RigidBody {
    /// The rigid body that a scene declares as `body`, at t = 0.
    pub(crate) fn new(mesh: &Mesh, body: &Body) -> Self {
        let surface = Surface::new(mesh, body);
        let motion = RigidMotion::new(mesh, body);
        Self { reference: surface.vertices.clone(), surface, pose: motion.at(0.0), motion }
    }

    /// Moves to the place it has at a time, s, and expects a step of `dt` seconds.
    pub(crate) fn move_to(&mut self, time: f64, dt: f64) {
        if self.motion.rests() {
            return;
        }
        self.pose = self.motion.at(time);
        let Self { surface, reference, pose, .. } = self;
        surface.place(|vertex| pose.place(reference[vertex]));
        surface.displacements = surface.vertices.iter().map(|x| pose.velocity_at(*x).map(|v| dt * v)).collect();
    }
}

/// The boundary of a rigid body at t = 0 and its motion.
#[derive(Debug, Clone)]
pub(crate) struct RigidOutline {
    arcs: Vec<Arc>,
    motion: RigidMotion,
}

impl RigidOutline {
    /// A body with these arcs at t = 0.
    pub(crate) fn new(arcs: Vec<Arc>, motion: RigidMotion) -> Self {
        Self { arcs, motion }
    }

    /// Where it is at a time (s), and how it moves then.
    pub(crate) fn at(&self, time: f64) -> (Outline, RigidPose) {
        let pose = self.motion.at(time);
        let moved = |arc: &Arc| arc.moved(|x| pose.place(x), |arm| pose.turn(arm));
        let arcs = if self.motion.rests() { self.arcs.clone() } else { self.arcs.iter().map(moved).collect() };
        (Outline::new(arcs, f64::INFINITY), pose)
    }
}
