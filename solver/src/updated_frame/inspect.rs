//! The points of the bodies in the updated frame, one by one, for looking at a run that broke down.

use super::UpdatedFrame;
use crate::inspection::{PointFracture, PointState};

impl UpdatedFrame {
    /// Calls `f` with the state of every point.
    pub(crate) fn for_each_point_state(&self, f: &mut dyn FnMut(PointState)) {
        for (body, field) in self.fields().iter().enumerate() {
            for (point, carried) in field.points().iter().enumerate() {
                let cracked = field.fracture.as_ref().map(|fracture| fracture.points[point]);
                let fracture = cracked.map(|c| PointFracture { history: c.history, phase: c.phase });
                let (position, strain, stress) = (carried.position, carried.strain, carried.stress);
                f(PointState { body, point, position, strain, stress, fracture });
            }
        }
    }
}
