//! Prescribed motion in the total frame: the control points of conditions on sides, and the reactions to it.
//!
//! Between two whole steps a prescribed component moves with one velocity w: the change of a prescribed
//! displacement over the step, or a prescribed velocity in the middle of it. Its acceleration is that of
//! velocity Verlet:
//!
//! ```text
//! a_n = (w_n+1/2 − w_n−1/2)/dt,   at t = 0: a_0 = 2 (w_1/2 − v_0)/dt
//! R = M a − f_ext + f_int,   work of a step = dt w · (R_n + R_n+1)/2
//! ```

use std::collections::BTreeMap;

use crate::checkpoint::{Archive, StateError};
use crate::dynamics::constraints::{Constraints, Reaction};
use crate::dynamics::energy::ConditionSample;
use crate::dynamics::mass::MassMatrix;
use crate::dynamics::surface::mouths;
use crate::linear_algebra::control_grid::VectorField;
use crate::particles::lattice::Lattice;
use crate::scene::{Body, Boundary, Layout};
use crate::splines::patch::{Patch, control_points_on};
use crate::splines::quadrature::Rule;

/// Part of the integral of a function along a side that has to lie on the part that is held, up to round-off.
const HELD: f64 = 0.5 - 1e-9;

/// Values of functions that vanish on the side, to round-off.
const ROUND_OFF: f64 = 1e-12;

/// A reaction for every condition on the sides of the mesh; empty if none of them moves or has a name.
#[derive(Debug, Clone)]
pub(super) struct Reactions(Vec<Reaction>);

impl Reactions {
    pub(super) fn new(constraints: &Constraints) -> Self {
        let conditions = &constraints.conditions;
        let wanted = conditions.iter().any(|c| c.name.is_some() || !c.prescribed.is_at_rest());
        Self(vec![Reaction::default(); if wanted { conditions.len() } else { 0 }])
    }

    /// Takes the forces `f_ext − f_int` (N/m) at the prescribed components.
    pub(super) fn begin(&mut self, constraints: &Constraints, net: &VectorField) {
        if self.0.is_empty() {
            return;
        }
        self.0.iter_mut().for_each(Reaction::begin);
        for (at, component, number) in constraints.iter() {
            self.0[number].force[0][component] += -net[component][at];
        }
    }

    /// Sets the accelerations (m/s²) of the prescribed components at `time` for a step of `dt` seconds, from
    /// the velocity a `part` of a step before, and adds the inertia to their reactions.
    pub(super) fn prescribe(
        &mut self,
        constraints: &Constraints,
        [time, dt]: [f64; 2],
        part: f64,
        mass: &MassMatrix,
        velocity: &VectorField,
        acceleration: &mut VectorField,
    ) {
        if self.0.is_empty() {
            return constraints.remove(acceleration);
        }
        for (reaction, condition) in self.0.iter_mut().zip(&constraints.conditions) {
            let next = condition.prescribed.mean_velocity(time, dt);
            reaction.drive(fault!("driven-side-lags", next => next.map(|v| 0.5 * v)));
        }
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
        self.0.iter_mut().map(|reaction| reaction.book(dt)).sum()
    }

    /// Adds a component of a force (N/m) to the reaction to a condition.
    pub(super) fn add(&mut self, number: usize, component: usize, force: f64) {
        if let Some(reaction) = self.0.get_mut(number) {
            reaction.force[0][component] += force;
        }
    }

    /// Reaction and work of every condition with a name, for a thickness of a metre.
    pub(super) fn samples(&self, constraints: &Constraints) -> Vec<ConditionSample> {
        let sample = |(reaction, condition): (&Reaction, &Boundary)| reaction.sample(&condition.name, condition.fix);
        self.0.iter().zip(&constraints.conditions).filter_map(sample).collect()
    }

    /// Stores or takes up all of them.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        self.0.iter_mut().try_for_each(|reaction| archive.value(reaction))
    }
}

/// Control points of the side; of a part of it, or where a slit ends on it, those whose functions have at
/// least half of their integral along the side on the part.
pub(super) fn held_points(patch: &Patch, lattice: &Lattice, body: &Body, boundary: &Boundary) -> Vec<usize> {
    if boundary.part.is_none() && lattice.sheets.is_empty() {
        return control_points_on(boundary.side, lattice.grid);
    }
    let along = boundary.side.along();
    let part = boundary.part.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let rule = Rule::new(Layout::Gauss, patch.spaces[along].degree() + 1);
    let mut integrals = BTreeMap::<usize, [f64; 2]>::new(); // on the part, and in all
    let mut cuts: Vec<f64> = mouths(body).into_iter().map(|mouth| mouth[along]).chain(part).collect();
    cuts.sort_by(f64::total_cmp);
    for point in patch.boundary_cut(boundary.side, &rule, &cuts) {
        let on_it = (part[0]..=part[1]).contains(&point.functions.position[along]);
        let inside = fault!("part-of-a-side-is-all-of-it", on_it => true);
        for &(at, value) in point.functions.values.iter().filter(|(_, value)| *value > ROUND_OFF) {
            let at = lattice.control_point(at, point.functions.values[0].0, point.functions.position);
            let [on_part, all] = integrals.entry(at).or_default();
            *all += value * point.length;
            if inside {
                *on_part += value * point.length;
            }
        }
    }
    integrals.into_iter().filter(|(_, [on_part, all])| *on_part >= HELD * all).map(|(at, _)| at).collect()
}
