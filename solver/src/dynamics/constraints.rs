//! Conditions on the sides of the mesh: prescribed components of the motion of control points.
//!
//! End knots are repeated, so the control points of a side alone decide the field on it. A part of a side
//! takes those whose functions have at least half of their integral along the side on the part. The control
//! point of a corner belongs to both sides: it has what either prescribes. Where both prescribe a component
//! they have to agree, which [`crate::validate::validate`] demands, so the order of the sides does not count.
//!
//! # Reactions
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
use crate::scene::Boundary;

/// Control points with a prescribed component.
#[derive(Debug, Clone, Default)]
pub struct Constraints {
    /// Per component: control point, and number of its condition, in increasing order.
    fixed: [Vec<(usize, usize)>; 2],
    pub(crate) conditions: Vec<Boundary>,
    /// Two conditions on one side that prescribe a component of the same control point differently.
    pub(crate) contradiction: Option<[usize; 2]>,
}

impl Constraints {
    /// The conditions on a mesh, each on its `points`.
    pub(crate) fn new(conditions: &[Boundary], points: impl Fn(&Boundary) -> Vec<usize>) -> Self {
        let mut constraints = Self { conditions: conditions.to_vec(), ..Self::default() };
        for component in 0..2 {
            let fixed = &mut constraints.fixed[component];
            for (number, condition) in conditions.iter().enumerate() {
                if condition.fix[fault!("side-holds-the-other-component", component => 1 - component)] {
                    fixed.extend(points(condition).into_iter().map(|at| (at, number)));
                }
            }
            fixed.sort_unstable();
            let differ = |[i, j]: &[usize; 2]| {
                let pair = [*i, *j].map(|number| &conditions[number]);
                pair[0].side == pair[1].side
                    && pair[0].prescribed.course(component) != pair[1].prescribed.course(component)
            };
            let mut shared = fixed.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| [pair[0].1, pair[1].1]);
            constraints.contradiction = constraints.contradiction.or_else(|| shared.find(differ));
            fixed.dedup_by_key(|&mut (at, _)| at);
        }
        constraints
    }

    /// The same conditions on some of the control points alone.
    pub(crate) fn among(&self, takes: impl Fn(usize) -> bool) -> Self {
        let mut some = self.clone();
        some.fixed.iter_mut().for_each(|fixed| fixed.retain(|(at, _)| takes(*at)));
        some
    }

    /// Prescribed components: control point, component, number of the condition.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let component = |c: usize| self.fixed[c].iter().map(move |&(at, number)| (at, c, number));
        component(0).chain(component(1))
    }

    /// Control points at which a component is prescribed, in increasing order.
    pub fn held(&self, component: usize) -> Vec<usize> {
        self.fixed[component].iter().map(|&(at, _)| at).collect()
    }

    /// Sets the prescribed displacements (m) and velocities (m/s) at t = 0.
    pub(crate) fn start(&self, displacement: &mut [Vec<f64>; 2], velocity: &mut [Vec<f64>; 2]) {
        let starts: Vec<_> = self.conditions.iter().map(|condition| condition.prescribed.start()).collect();
        for (at, component, number) in self.iter() {
            let [place, speed] = starts[number].map(|value| value[component]);
            velocity[component][at] = speed;
            if self.conditions[number].prescribed.is_displacement() {
                displacement[component][at] = place;
            }
        }
    }

    /// Removes the components from a field (accelerations, directions).
    pub fn remove(&self, field: &mut [Vec<f64>; 2]) {
        for (at, component, _) in self.iter() {
            field[component][at] = fault!("held-side-let-go", 0.0 => field[component][at]);
        }
    }
}

/// What a condition does to the body.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Reaction {
    /// Force on the body at the present whole step, and at the one before, N/m.
    pub(super) force: [[f64; 2]; 2],
    /// Velocity in the step to come, and in the last one, m/s.
    pub(super) velocity: [[f64; 2]; 2],
    /// Work of the condition on the body so far, J/m.
    pub(super) work: f64,
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

    /// Books the work (J/m) of an impulse (N s/m) with the velocity of the step to come.
    pub(super) fn push(&mut self, impulse: [f64; 2]) -> f64 {
        let added = dot(impulse, self.velocity[0]);
        self.work += added;
        added
    }

    /// Books the work over the last step of `dt` seconds, J/m.
    pub(super) fn book(&mut self, dt: f64) -> f64 {
        let ([now, before], [_, last]) = (self.force, self.velocity);
        let power = [0, 1].map(|d| 0.5 * (before[d] + now[d]) * last[d]);
        let added = dt * (power[0] + power[1]);
        self.work += added;
        added
    }

    /// What it is now, for a thickness of a metre, if its condition has a name.
    pub(super) fn sample(&self, name: &Option<String>, components: [bool; 2]) -> Option<ConditionSample> {
        Some(ConditionSample::new(name.as_ref()?, components, self.force[0], self.work))
    }
}
