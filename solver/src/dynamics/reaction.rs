//! Reactions to prescribed motion, and their work.
//!
//! Between two whole steps a prescribed component moves with one velocity w: the change of a prescribed
//! displacement over the step, or a prescribed velocity in the middle of it.
//!
//! ```text
//! R = M a − f_ext + f_int,   work of a step = dt w · (R_n + R_n+1)/2
//! ```

use serde::{Deserialize, Serialize};

use crate::dynamics::energy::ConditionSample;
use crate::linear_algebra::vectors::dot;

/// What a condition does to the body.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::dynamics) struct Reaction {
    /// Force on the body at the present whole step, and at the one before, N/m.
    pub(in crate::dynamics) force: [[f64; 2]; 2],
    /// Velocity in the step to come, and in the last one, m/s.
    pub(in crate::dynamics) velocity: [[f64; 2]; 2],
    /// Work so far, J/m.
    pub(in crate::dynamics) work: f64,
}

impl Reaction {
    /// Goes on to another whole step, at which there is no force yet.
    pub(in crate::dynamics) fn begin(&mut self) {
        self.force = [[0.0; 2], self.force[0]];
    }

    /// Goes on to another step, with a velocity, m/s.
    pub(in crate::dynamics) fn drive(&mut self, velocity: [f64; 2]) {
        self.velocity = [velocity, self.velocity[0]];
    }

    /// Books the work (J/m) of an impulse (N s/m) with the velocity of the step to come.
    pub(in crate::dynamics) fn push(&mut self, impulse: [f64; 2]) -> f64 {
        let added = dot(impulse, self.velocity[0]);
        self.work += added;
        added
    }

    /// Books the work over the last step of `dt` seconds, J/m.
    pub(in crate::dynamics) fn book(&mut self, dt: f64) -> f64 {
        let ([now, before], [_, last]) = (self.force, self.velocity);
        let power = [0, 1].map(|d| 0.5 * (before[d] + now[d]) * last[d]);
        let added = dt * (power[0] + power[1]);
        self.work += added;
        added
    }

    /// What it is now, for a thickness of a metre.
    pub(in crate::dynamics) fn sample(&self, name: &str, components: [bool; 2]) -> ConditionSample {
        ConditionSample::new(name, components, self.force[0], self.work)
    }
}
