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

impl Reaction {
    /// Goes on to another whole step, at which there is no force yet.
    pub(super) fn begin(&mut self) {
        self.force = [[0.0; 2], self.force[0]];
    }

    /// Goes on to another step, with a velocity, m/s.
    pub(super) fn drive(&mut self, velocity: [f64; 2]) {
        self.velocity = [velocity, self.velocity[0]];
    }

    /// Velocity in the step to come, m/s.
    pub(super) fn next_velocity(&self) -> [f64; 2] {
        self.velocity[0]
    }

    /// Adds a component of a force at the present whole step, N/m.
    pub(super) fn add(&mut self, component: usize, force: f64) {
        self.force[0][component] += force;
    }

    /// Books the work over the last step of `dt` seconds, J/m.
    pub(super) fn book(&mut self, dt: f64) -> f64 {
        let ([now, before], [_, last]) = (self.force, self.velocity);
        let power = [0, 1].map(|d| 0.5 * (before[d] + now[d]) * last[d]);
        let added = dt * (power[0] + power[1]);
        self.work += added;
        added
    }

    /// What it is now, for a thickness of a metre.
    pub(super) fn sample(&self, name: &str, components: [bool; 2]) -> ConditionSample {
        ConditionSample::new(name, components, self.force[0], self.work)
    }
}

/// A reaction for every condition on the sides of the mesh; empty if none of them moves or has a name.
#[derive(Debug, Clone)]
pub(super) struct Reactions(Vec<Reaction>);

impl Reactions {
    pub(super) fn new(constraints: &Constraints) -> Self {
        let conditions = constraints.conditions();
        let wanted = conditions.iter().any(|c| c.name.is_some() || !c.prescribed.is_at_rest());
        Self(vec![Reaction::default(); if wanted { conditions.len() } else { 0 }])
    }

    /// Takes the forces `f_ext − f_int` (N/m) at the prescribed components.
    pub(super) fn begin(&mut self, constraints: &Constraints, net: &VectorField) {
        if self.0.is_empty() {
            return;
        }
        for reaction in &mut self.0 {
            reaction.begin();
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
            let next = condition.prescribed.mean_velocity(time, dt);
            reaction.drive(fault!("driven-side-lags", next => next.map(|v| 0.5 * v)));
        }
        let part = if time == 0.0 { 0.5 } else { 1.0 }; // of a step, since the velocity at hand
        for (at, component, number) in constraints.iter() {
            let change = self.0[number].next_velocity()[component] - velocity[component][at];
            acceleration[component][at] = if dt > 0.0 { change / (part * dt) } else { 0.0 };
        }
        let inertia = [0, 1].map(|component| mass.product(&acceleration[component]));
        for (at, component, number) in constraints.iter() {
            self.0[number].force[0][component] += fault!("reaction-without-inertia", inertia[component](at) => 0.0);
        }
    }

    /// Work (J/m) of the prescribed motion over the last step of `dt` seconds.
    pub(super) fn work(&mut self, dt: f64) -> f64 {
        self.0.iter_mut().map(|reaction| reaction.book(dt)).sum()
    }

    /// Adds a component of a force (N/m) to the reaction to a condition.
    pub(super) fn add(&mut self, number: usize, component: usize, force: f64) {
        if let Some(reaction) = self.0.get_mut(number) {
            reaction.add(component, force);
        }
    }

    /// Reaction and work of every condition with a name, for a thickness of a metre.
    pub(super) fn samples(&self, constraints: &Constraints) -> Vec<ConditionSample> {
        let sample = |(reaction, condition): (&Reaction, &Boundary)| {
            Some(reaction.sample(condition.name.as_deref()?, condition.fix))
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
