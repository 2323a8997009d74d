//! Conditions in the updated frame on material that moves: edges of bodies, and what lies at t = 0 on a side
//! of the mesh that is driven, that has a course in time, or of which only a part is held.
//!
//! Points of an edge move with the body. At every whole step the multipliers along it
//! ([`edge_moments`](crate::dynamics::edge_moments)) act on the present grid: first the velocity that arrived
//! is made that of the last step, as on the sides of the mesh, then the accelerations lead to that of the
//! next one:
//!
//! ```text
//! v ← v − M⁻¹ Bᵀ S⁻¹ (B v − B w_n−1/2),     a ← a − M⁻¹ Bᵀ S⁻¹ (B a − B (w_n+1/2 − w_n−1/2)/dt)
//! ```
//!
//! The first is an impact. It does the work `−λ·B w` and costs `½ λ·(B v − B w)`.

use super::grid::{ImposedEnergy, NodalFields};
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::constraints::Reaction;
use crate::dynamics::edge_moments::{
    EdgeMultipliers, Moment, Multipliers, along_mesh, is_whole_side, moments_of, multiplier_space,
};
use crate::dynamics::energy::ConditionSample;
use crate::dynamics::failure::Failure;
use crate::dynamics::surface::{SurfacePoint, smooth_parts};
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::vectors::dot;
use crate::particles::follower::Follower;
use crate::scene::{Body, EdgeCondition};
use crate::splines::patch::Patch;
use crate::splines::spline::SplineSpace;

/// Part of the compliance of a multiplier that is added to it, so that moments which nearly follow from
/// others do no harm.
const SOFTNESS: f64 = 1e-13;

/// Conditions on the edges of a body in the updated frame.
#[derive(Debug, Clone)]
pub(super) struct HeldEdges {
    edges: Vec<HeldEdge>,
    /// On the present grid; `None` if nothing there can yield.
    multipliers: Option<Multipliers>,
    /// Length of the steps, s; zero before the first one.
    pub step: f64,
}

/// A condition, and the points of its edge.
#[derive(Debug, Clone)]
struct HeldEdge {
    condition: EdgeCondition,
    /// Whether it is a whole side of the body, with no other edge near.
    is_whole_side: bool,
    space: SplineSpace,
    points: Vec<(Follower, SurfacePoint)>,
    reaction: Reaction,
    /// Work of the impact at the present whole step, J/m.
    struck: f64,
}

impl HeldEdges {
    /// Some conditions on a body, where its material lies on their edges; absent if it lies on none.
    pub(super) fn new(
        patch: &Patch,
        body: &Body,
        conditions: impl Iterator<Item = EdgeCondition>,
    ) -> Option<Box<Self>> {
        let conditions: Vec<_> = conditions.collect();
        let edge = |(number, condition): (usize, &EdgeCondition)| {
            let parts = smooth_parts(patch, body, &condition.edge);
            let on_material = parts.iter().flatten().filter(|point| body.shape.contains(point.inner));
            let points: Vec<_> = on_material.map(|point| (Follower::new(point.position), *point)).collect();
            let reaction = Reaction { velocity: [condition.prescribed.start()[1]; 2], ..Reaction::default() };
            (!points.is_empty()).then(|| HeldEdge {
                is_whole_side: is_whole_side(patch, body, &conditions, number),
                space: multiplier_space(patch, &parts),
                condition: condition.clone(),
                points,
                reaction,
                struck: 0.0,
            })
        };
        let edges: Vec<_> = conditions.iter().enumerate().filter_map(edge).collect();
        (!edges.is_empty()).then(|| Box::new(Self { edges, multipliers: None, step: 0.0 }))
    }

    /// Keeps some of the points, by their positions (m); the work so far stays with who `keeps_work`.
    pub(super) fn keep(&mut self, keeps_work: bool, keeps: impl Fn([f64; 2]) -> bool) {
        for edge in &mut self.edges {
            edge.points.retain(|(place, _)| keeps(place.position));
            if !keeps_work {
                edge.reaction.work = 0.0;
            }
        }
    }

    /// Chooses the span of every point anew, and takes the multipliers of the present grid.
    ///
    /// # Errors
    /// A point with no material within one span of it, or conditions that are not independent.
    pub(super) fn attach(&mut self, patch: &Patch, nodes: &NodalFields, density: f64) -> Result<(), Failure> {
        let mut places = self.edges.iter_mut().flat_map(|edge| &mut edge.points);
        places.try_for_each(|(place, _)| place.attach(patch, &nodes.inverse_mass, density))?;
        self.multipliers = self.on_grid(patch, nodes)?;
        Ok(())
    }

    /// Moves the points with the grid over `dt` seconds.
    pub(super) fn move_points(&mut self, patch: &Patch, nodes: &NodalFields, dt: f64) {
        for (place, _) in self.edges.iter_mut().flat_map(|edge| &mut edge.points) {
            place.follow(patch, nodes.grid, &nodes.velocity, dt);
        }
    }

    /// Goes on to a whole step at `time`, to be followed by a step of `dt` seconds.
    pub(super) fn go_on(&mut self, [time, dt]: [f64; 2]) {
        self.step = dt;
        for HeldEdge { condition, reaction, .. } in &mut self.edges {
            reaction.begin();
            reaction.drive(condition.prescribed.mean_velocity(time, dt));
        }
    }

    /// Imposes on the velocities of the grid what the last step prescribed.
    pub(super) fn impose(&mut self, nodes: &mut NodalFields) -> ImposedEnergy {
        self.edges.iter_mut().for_each(|edge| edge.struck = 0.0);
        let Self { edges, multipliers: Some(multipliers), .. } = self else { return ImposedEnergy::default() };
        let last = |moment: &Moment| moment.translated(edges[moment.condition].reaction.velocity[1]);
        let impulses = multipliers.of_excess(|moment| moment.of(&nodes.velocity) - last(moment));
        let mut energy = ImposedEnergy::default();
        let mut sums = vec![[0.0; 2]; edges.len()];
        for (moment, impulse) in multipliers.moments.iter().zip(&impulses) {
            let arrived_too_fast = moment.of(&nodes.velocity) - last(moment);
            energy.loss += fault!("held-edge-impact-free", 0.5 => 0.0) * impulse * arrived_too_fast;
            (0..2).for_each(|d| sums[moment.condition][d] -= impulse * moment.total[d]);
        }
        multipliers.yield_to(&impulses, &mut nodes.velocity);
        for (edge, sum) in edges.iter_mut().zip(sums) {
            edge.struck = dot(sum, edge.reaction.velocity[1]);
            energy.work += edge.struck;
        }
        energy
    }

    /// Makes accelerations (m/s²) those that lead to the velocities of the step to come, of which `kick` is
    /// the length as velocities see it, s. The forces of the conditions on the body, N/m.
    pub(super) fn hold(&self, acceleration: &mut VectorField, kick: f64) -> Vec<[f64; 2]> {
        let mut forces = vec![[0.0; 2]; self.edges.len()];
        let Some(multipliers) = &self.multipliers else { return forces };
        let change = |moment: &Moment| {
            let reaction = &self.edges[moment.condition].reaction;
            let [next, last] = reaction.velocity;
            let begun = fault!("held-edge-without-course", kick > 0.0 => false);
            moment.translated([0, 1].map(|d| if begun { (next[d] - last[d]) / kick } else { 0.0 }))
        };
        let values = multipliers.of_excess(|moment| moment.of(acceleration) - change(moment));
        multipliers.yield_to(&values, acceleration);
        for (moment, value) in multipliers.moments.iter().zip(values) {
            (0..2).for_each(|d| forces[moment.condition][d] -= value * moment.total[d]);
        }
        forces
    }

    /// Does so for the forces at the present whole step, which the reactions are.
    pub(super) fn accelerate(&mut self, acceleration: &mut VectorField, kick: f64) {
        let forces = self.hold(acceleration, kick);
        for (edge, force) in self.edges.iter_mut().zip(forces) {
            edge.reaction.force[0] = force;
        }
    }

    /// Does so for accelerations that were added; the work of the conditions in the kick, J/m.
    pub(super) fn hold_pushed(&mut self, acceleration: &mut VectorField, kick: f64) -> f64 {
        let forces = self.hold(acceleration, kick);
        let works = self.edges.iter_mut().zip(forces).map(|(edge, force)| edge.reaction.push(force.map(|f| f * kick)));
        works.sum()
    }

    /// Books the works of the last step of `dt` seconds; the work (J/m) of the prescribed motion in it,
    /// without that of impacts.
    pub(super) fn work(&mut self, dt: f64) -> f64 {
        let book = |edge: &mut HeldEdge| {
            edge.reaction.work += edge.struck;
            edge.reaction.book(dt)
        };
        fault!("held-edge-works-twice", 1.0 => 2.0) * self.edges.iter_mut().map(book).sum::<f64>()
    }

    /// Reaction and work of every condition with a name, with forces (N/m) beside the reactions, for a
    /// thickness of a metre.
    pub(super) fn samples(&self, forces: &[[f64; 2]]) -> Vec<ConditionSample> {
        let named = |(HeldEdge { condition, reaction, .. }, force): (&HeldEdge, &[f64; 2])| {
            let mut reaction = *reaction;
            (0..2).for_each(|d| reaction.force[0][d] += force[d]);
            reaction.sample(&condition.name, condition.components())
        };
        self.edges.iter().zip(forces).filter_map(named).collect()
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        archive.value(&mut self.step)?;
        for edge in &mut self.edges {
            archive.value(&mut edge.reaction)?;
            let mut kept: Vec<[f64; 2]> = edge.points.iter().map(|(_, point)| point.position).collect();
            archive.value(&mut kept)?;
            if archive.is_reader() {
                edge.points.retain(|(_, point)| kept.contains(&point.position)); // a fragment has a part of them
            }
            if edge.points.len() != kept.len() {
                return Err(StateError::of_another_scene("a condition holds other places"));
            }
            edge.points.iter_mut().try_for_each(|(place, _)| archive.value(&mut place.position))?;
        }
        Ok(())
    }

    /// The multipliers that can move something on the present grid.
    ///
    /// # Errors
    /// Conditions that are not independent.
    fn on_grid(&self, patch: &Patch, nodes: &NodalFields) -> Result<Option<Multipliers>, Failure> {
        let mut moments = Vec::new();
        for (number, edge) in self.edges.iter().enumerate() {
            let functions = |place: &Follower| {
                let mut values = Vec::new();
                place.for_each_function(patch, nodes.grid, |at, n| values.push((at, n)));
                values
            };
            let lost = |place| Failure::LostCondition { body: 0, condition: number, place };
            let now = |(place, point): &(Follower, SurfacePoint)| {
                (SurfacePoint { position: place.position, ..*point }, functions(place))
            };
            let points: Vec<_> = edge.points.iter().map(now).collect();
            let components = edge.condition.components();
            let is_fixed = |at, c: usize| components[c] && nodes.fixed.contains(&(at, c));
            let of_mesh = edge.is_whole_side.then(|| along_mesh(patch, nodes.grid, &points, is_fixed)).flatten();
            let multipliers = of_mesh.unwrap_or(EdgeMultipliers::OfParts(&edge.space));
            moments.extend(moments_of(number, edge.condition.hold, multipliers, points.into_iter()).map_err(lost)?);
        }
        let inverse = |moment: &Moment| -> Option<Vec<f64>> {
            let free = |(at, component)| if nodes.fixed.contains(&(at, component)) { 0.0 } else { 1.0 };
            let of = |&(at, component, _): &(usize, usize, f64)| free((at, component)) * nodes.inverse_mass[at];
            let inverse: Vec<f64> = moment.shares.iter().map(of).collect();
            moment.yields(&inverse, |at| nodes.inverse_mass[at]).then_some(inverse)
        };
        let yielding = moments.into_iter().filter_map(|moment| inverse(&moment).map(|inverse| (moment, inverse)));
        let (moments, inverse): (Vec<Moment>, Vec<_>) = yielding.unzip();
        let Some(last) = moments.last().map(|moment| moment.condition) else { return Ok(None) };
        Multipliers::new(moments, inverse, SOFTNESS).map(Some).ok_or(Failure::HeldTwice { body: 0, condition: last })
    }
}
