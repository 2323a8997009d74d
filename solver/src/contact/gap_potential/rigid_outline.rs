//! The boundary of a rigid body in contact by the potential of the gap.

use super::arc::{Arc, Outline};
use crate::contact::rigid::RigidMotion;

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

    /// Where it is at a time, s.
    pub(crate) fn at(&self, time: f64) -> Outline {
        let Self { arcs, motion } = self;
        let moved = |arc: &Arc| arc.moved(|x| motion.place(x, time), |arm| motion.turn(arm, time));
        let arcs = if motion.rests() { arcs.clone() } else { arcs.iter().map(moved).collect() };
        Outline::new(arcs, f64::INFINITY)
    }

    /// Velocity at a position, m/s, at a time, s.
    pub(crate) fn velocity_at(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        self.motion.velocity_at(position, time)
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.arcs.len() * size_of::<Arc>()
    }
}
