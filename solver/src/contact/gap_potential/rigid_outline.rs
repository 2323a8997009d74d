//! The boundary of a rigid body in contact by the potential of the gap.

use super::arc::{Arc, Outline};
use crate::contact::rigid::{RigidMotion, RigidPose};

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
