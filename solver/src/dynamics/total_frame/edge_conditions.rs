//! Conditions on edges of the body that are not sides of the mesh: multipliers along them
//! ([`edge_moments`](crate::dynamics::edge_moments)).

use std::collections::BTreeMap;

use super::prescribed::Reactions;
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::constraints::{Constraints, Reaction};
use crate::dynamics::edge_moments::{
    EdgeMultipliers, Moment, Multipliers, along_mesh, is_whole_side, moments_of, multiplier_space,
};
use crate::dynamics::energy::ConditionSample;
use crate::dynamics::failure::Failure;
use crate::dynamics::loads::material_at;
use crate::dynamics::mass::MassMatrix;
use crate::dynamics::surface::{SurfacePoint, smooth_parts};
use crate::linear_algebra::control_grid::VectorField;
use crate::particles::lattice::Lattice;
use crate::scene::{Body, EdgeCondition};
use crate::splines::patch::Patch;

/// Least part of the compliance of a multiplier that the others do not have.
const INDEPENDENT: f64 = 1e-9;
/// Part of a rigid motion that a condition may see by round-off.
const ROUND_OFF: f64 = 1e-9;

/// Conditions on the edges of a body.
#[derive(Debug, Clone)]
pub(super) struct EdgeConditions {
    conditions: Vec<EdgeCondition>,
    pub multipliers: Multipliers,
    /// Shares where a side of the mesh prescribes: moment, number of that condition, component, share (m).
    held: Vec<(usize, usize, usize, f64)>,
    reactions: Vec<Reaction>,
}

impl EdgeConditions {
    /// Those of a body, if it has any.
    ///
    /// # Errors
    /// If there is no material at an edge, or what two conditions prescribe is not independent.
    pub(super) fn new(
        patch: &Patch,
        lattice: &Lattice,
        body: &Body,
        mass: &MassMatrix,
        constraints: &Constraints,
    ) -> Result<Option<Box<Self>>, Failure> {
        let conditions = body.conditions.clone();
        let prescribed: BTreeMap<_, _> = constraints.iter().map(|(at, c, number)| ((at, c), number)).collect();
        let mut moments = Vec::new();
        for (number, condition) in conditions.iter().enumerate() {
            let parts = smooth_parts(patch, body, &condition.edge);
            let lost = |place| Failure::LostCondition { body: 0, condition: number, place };
            let of_material = |point: &SurfacePoint| {
                let functions = material_at(patch, lattice, point, |at| mass.moves(at));
                functions.map(|functions| (*point, functions.values)).ok_or_else(|| lost(point.position))
            };
            let points = parts.iter().flatten().map(of_material).collect::<Result<Vec<_>, _>>()?;
            let space = multiplier_space(patch, &parts);
            let components = condition.components();
            let is_fixed = |at, c: usize| components[c] && prescribed.contains_key(&(at, c));
            let of_mesh = is_whole_side(patch, body, &conditions, number)
                .then(|| along_mesh(patch, lattice.grid, &points, is_fixed))
                .flatten();
            let multipliers = of_mesh.unwrap_or(EdgeMultipliers::OfParts(&space));
            moments.extend(moments_of(number, condition.hold, multipliers, points.into_iter()).map_err(lost)?);
        }
        if moments.is_empty() {
            return Ok(None);
        }
        let (mut inverse, mut held) = (Vec::new(), Vec::new());
        for (row, moment) in moments.iter().enumerate() {
            let of = |&(at, component, share): &(usize, usize, f64)| match prescribed.get(&(at, component)) {
                Some(&number) => {
                    held.push((row, number, component, share));
                    0.0
                }
                None => 1.0 / mass.row_sums[at],
            };
            let inverses: Vec<f64> = moment.shares.iter().map(of).collect();
            if !moment.yields(&inverses, |at| 1.0 / mass.row_sums[at]) {
                return Err(Failure::HeldTwice { body: 0, condition: moment.condition });
            }
            inverse.push(inverses);
        }
        let last = conditions.len() - 1;
        let reactions = vec![Reaction::default(); conditions.len()];
        let multipliers =
            Multipliers::new(moments, inverse, 0.0).ok_or(Failure::HeldTwice { body: 0, condition: last })?;
        if let Some(moment) = multipliers.dependent(INDEPENDENT) {
            return Err(Failure::HeldTwice { body: 0, condition: moment.condition });
        }
        Ok(Some(Box::new(Self { conditions, multipliers, held, reactions })))
    }

    /// Sets displacements (m) and velocities (m/s) at t = 0, by the least change in the norm of the mass.
    pub(super) fn start(&self, displacement: &mut VectorField, velocity: &mut VectorField) {
        let starts: Vec<_> = self.conditions.iter().map(|condition| condition.prescribed.start()).collect();
        for (derivative, field) in [displacement, velocity].into_iter().enumerate() {
            let skipped =
                |moment: &Moment| derivative == 0 && !self.conditions[moment.condition].prescribed.is_displacement();
            let excess = |moment: &Moment| {
                if skipped(moment) {
                    0.0
                } else {
                    moment.of(field) - moment.translated(starts[moment.condition][derivative])
                }
            };
            let multipliers = self.multipliers.of_excess(excess);
            self.multipliers.yield_to(&multipliers, field);
        }
    }

    /// Makes the accelerations (m/s²) at `time` those of a step of `dt` seconds in which the edges move as
    /// prescribed, from the velocity a `part` of a step before. The reactions go on to this whole step.
    pub(super) fn enforce(
        &mut self,
        [time, dt]: [f64; 2],
        part: f64,
        velocity: &VectorField,
        acceleration: &mut VectorField,
        sides: &mut Reactions,
    ) {
        for (reaction, condition) in self.reactions.iter_mut().zip(&self.conditions) {
            reaction.begin();
            reaction.drive(condition.prescribed.mean_velocity(time, dt));
        }
        let excess = |moment: &Moment| {
            let next = moment.translated(self.reactions[moment.condition].velocity[0]);
            let now = fault!("edge-speed-forgotten", moment.of(velocity) => next);
            let prescribed = if dt > 0.0 { (next - now) / (part * dt) } else { 0.0 };
            moment.of(acceleration) - prescribed
        };
        let multipliers = self.multipliers.of_excess(excess);
        self.multipliers.yield_to(&multipliers, acceleration);
        for (moment, multiplier) in self.multipliers.moments.iter().zip(&multipliers) {
            let force =
                moment.total.map(|total| -fault!("edge-reaction-reversed", multiplier * total => -multiplier * total));
            (0..2).for_each(|d| self.reactions[moment.condition].force[0][d] += force[d]);
        }
        for &(row, number, component, share) in &self.held {
            sides.add(number, component, multipliers[row] * share);
        }
    }

    /// Whether they prescribe a part of a motion: its components at control points.
    pub(super) fn restrain(&self, motion: impl Fn(usize, usize) -> f64) -> bool {
        self.multipliers.moments.iter().any(|moment| {
            let terms = moment.shares.iter().map(|&(at, component, share)| share * motion(at, component));
            let (sum, magnitude) = terms.fold((0.0, 0.0), |(sum, all), term: f64| (sum + term, all + term.abs()));
            f64::abs(sum) > ROUND_OFF * magnitude
        })
    }

    /// Work (J/m) of the prescribed motion over the last step of `dt` seconds.
    pub(super) fn work(&mut self, dt: f64) -> f64 {
        self.reactions.iter_mut().map(|reaction| reaction.book(dt)).sum()
    }

    /// Reaction and work of every condition with a name, for a thickness of a metre.
    pub(super) fn samples(&self) -> impl Iterator<Item = ConditionSample> + '_ {
        let named = self.reactions.iter().zip(&self.conditions);
        named.filter_map(|(reaction, condition)| reaction.sample(&condition.name, condition.components()))
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        self.reactions.iter_mut().try_for_each(|reaction| archive.value(reaction))
    }
}
