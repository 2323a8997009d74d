//! Prescribed motion in the total frame, and the reactions to it.
//!
//! Between two whole steps a prescribed component moves with one velocity w: the change of a prescribed
//! displacement over the step, or a prescribed velocity in the middle of it. Its acceleration is that of
//! velocity Verlet:
//!
//! ```text
//! a_n = (w_n+1/2 − w_n−1/2)/dt,   at t = 0: a_0 = 2 (w_1/2 − v_0)/dt
//! R = M a − f_ext + f_int,   work of a step = dt w · (R_n + R_n+1)/2
//! ```

use serde::{Deserialize, Serialize};

use crate::checkpoint::{Archive, StateError};
use crate::dynamics::constraints::Constraints;
use crate::dynamics::energy::ConditionSample;
use crate::dynamics::mass::MassMatrix;
use crate::linear_algebra::control_grid::VectorField;
use crate::scene::Boundary;

/// What a condition does to the body.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Reaction {
    /// Force on the body at the present whole step, and at the one before, N/m.
    force: [[f64; 2]; 2],
    /// Velocity in the step to come, and in the last one, m/s.
    velocity: [[f64; 2]; 2],
    /// Work so far, J/m.
    work: f64,
}

/// A reaction for every condition; empty if none of them moves or has a name.
#[derive(Debug, Clone)]
pub(super) struct Reactions(Vec<Reaction>);

impl Reactions {
    pub(super) fn new(constraints: &Constraints) -> Self {
        let conditions = constraints.conditions();
        let wanted = conditions.iter().any(|c| c.name.is_some() || !c.is_at_rest());
        Self(vec![Reaction::default(); if wanted { conditions.len() } else { 0 }])
    }

    /// Takes the forces `f_ext − f_int` (N/m) at the prescribed components.
    pub(super) fn begin(&mut self, constraints: &Constraints, net: &VectorField) {
        if self.0.is_empty() {
            return;
        }
        for reaction in &mut self.0 {
            reaction.force = [[0.0; 2], reaction.force[0]];
        }
        for (at, component, number) in constraints.iter() {
            self.0[number].force[0][component] -= net[component][at];
        }
    }

    /// Sets the accelerations (m/s²) of the prescribed components at `time` for a step of `dt` seconds, and
    /// adds the inertia to their reactions.
    pub(super) fn prescribe(
        &mut self,
        constraints: &Constraints,
        [time, dt]: [f64; 2],
        mass: &MassMatrix,
        velocity: &VectorField,
        acceleration: &mut VectorField,
    ) {
        if self.0.is_empty() {
            return constraints.remove(acceleration);
        }
        for (reaction, condition) in self.0.iter_mut().zip(constraints.conditions()) {
            let next = condition.mean_velocity(time, dt);
            reaction.velocity = [fault!("driven-side-lags", next => next.map(|v| 0.5 * v)), reaction.velocity[0]];
        }
        let part = if time == 0.0 { 0.5 } else { 1.0 }; // of a step, since the velocity at hand
        for (at, component, number) in constraints.iter() {
            let change = self.0[number].velocity[0][component] - velocity[component][at];
            acceleration[component][at] = if dt > 0.0 { change / (part * dt) } else { 0.0 };
        }
        let inertia = [0, 1].map(|component| mass.product(&acceleration[component]));
        for (at, component, number) in constraints.iter() {
            self.0[number].force[0][component] += fault!("reaction-without-inertia", inertia[component](at) => 0.0);
        }
    }

    /// Work (J/m) of the prescribed motion over the last step of `dt` seconds.
    pub(super) fn work(&mut self, dt: f64) -> f64 {
        let mut sum = 0.0;
        for Reaction { force: [now, before], velocity: [_, last], work } in &mut self.0 {
            let power = [0, 1].map(|d| 0.5 * (before[d] + now[d]) * last[d]);
            let added = dt * (power[0] + power[1]);
            *work += added;
            sum += added;
        }
        sum
    }

    /// Reaction and work of every condition with a name, for a thickness of a metre.
    pub(super) fn samples(&self, constraints: &Constraints) -> Vec<ConditionSample> {
        let sample = |(reaction, condition): (&Reaction, &Boundary)| {
            let name = condition.name.as_deref()?;
            Some(ConditionSample::new(name, condition.fix, reaction.force[0], reaction.work))
        };
        self.0.iter().zip(constraints.conditions()).filter_map(sample).collect()
    }

    /// Stores or takes up all of them.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        self.0.iter_mut().try_for_each(|reaction| archive.value(reaction))
    }
}
