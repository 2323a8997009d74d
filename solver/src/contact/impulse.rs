//! Impulses of contact, and their energy. The equations are those of [`contact`](super); one constraint is
//! made to hold in `Acting::projected`.

mod direct;

use std::collections::HashMap;

use thiserror::Error;

use super::constraint::{BodyView, ContactConstraint, Impulse};
use super::{ContactLedger, ContactSolver};
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::vectors::dot;

/// Iterations over the constraints until their equations are solved directly, and most of them: a few tens
/// converge them but where constraints are many for their control points.
const ITERATIONS: usize = 500;
const MOST_ITERATIONS: usize = 10 * ITERATIONS;
/// Change of an impulse, relative to the largest, below which the iterations end.
const CONVERGED: f64 = 1e-12;
/// Round-off of the velocity at a constraint, relative to those it is summed from; impulses that change it by
/// less have converged.
const ROUND_OFF: f64 = 1e-14;
/// Change of an impulse, relative to the largest, above which impulses are not used: momentum is kept by any,
/// so this is the error of the velocities at the constraints. Functions of even degree hardly tell
/// neighbouring constraints on knots apart, so that impulses may change for long that leave these velocities
/// as they are.
const ACCEPTED: f64 = 1e-6;

/// Time of a kick and of the step it leads into, s: from the middle of the step before to the middle of the
/// coming one, which may have another length. The first kick is half a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kick {
    /// Length of the kick.
    pub length: f64,
    /// Length of the coming step.
    pub step: f64,
}

impl Kick {
    /// Part of the kick that belongs to the coming step.
    fn leaving(self) -> f64 {
        0.5 * self.step / self.length
    }
}

/// Acceleration of a control point by contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Push {
    /// Number of the body.
    pub body: usize,
    /// Index in its nodal fields.
    pub at: usize,
    /// Acceleration, m/s².
    pub acceleration: [f64; 2],
}

/// Impulses that did not converge.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("the impulses of contact did not converge in {iterations} iterations: they still change by {residual:.3e}")]
pub struct Unconverged {
    /// Where the impulse changed most in the last iteration, m.
    pub place: [f64; 2],
    /// Iterations after which it was given up.
    pub iterations: usize,
    /// That change, relative to the largest impulse.
    pub residual: f64,
}

/// A force of contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce {
    /// Numbers of the bodies a and b; rigid ones are counted after the others.
    pub bodies: [usize; 2],
    /// Place where the force acts, m.
    pub position: [f64; 2],
    /// Force on b, per unit thickness, N/m.
    pub force: [f64; 2],
}

/// A control point of a body in contact.
#[derive(Debug, Clone, Copy)]
struct Node {
    body: usize,
    at: usize,
    /// Inverse masses of the components, m/kg; zero where they cannot answer.
    mobility: [f64; 2],
    /// Velocity before the kick, after it without contact, and after it, m/s.
    before: [f64; 2],
    free: [f64; 2],
    after: [f64; 2],
}

/// The constraints of a kick, with the control points they act on.
struct Problem<'a> {
    nodes: Vec<Node>,
    constraints: Vec<Acting<'a>>,
    unconverged: Option<Unconverged>,
}

/// What an iteration over the constraints changed.
#[derive(Default)]
struct Iteration {
    /// Largest normal impulse, and largest change of an impulse, kg/s per unit thickness.
    largest: f64,
    change: f64,
    /// Place of the constraint whose impulse changed most, m.
    place: [f64; 2],
}

/// A constraint that acts.
struct Acting<'a> {
    constraint: &'a ContactConstraint,
    /// Node and weight, negative for body a.
    weights: Vec<(usize, f64)>,
    /// Velocity of body b if it is rigid, else zero, m/s.
    rigid: [f64; 2],
    /// Change of an impulse that is round-off of the velocities, kg/s.
    round_off: f64,
    /// How the relative velocity answers an impulse along normal and tangent, m/kg.
    answers: [f64; 2],
    impulse: Impulse,
}

impl ContactSolver {
    /// Accelerations that contact adds in the coming kick, and the ledger at the present whole step: with the
    /// half of that kick that belongs to the step before.
    pub(crate) fn coming(&self, bodies: &[BodyView], kick: Kick) -> (Vec<Push>, ContactLedger) {
        let problem = self.solve(bodies, kick);
        (problem.pushes(kick.length), self.ledger.plus(problem.arriving(kick)))
    }

    /// Forces in the coming kick.
    pub(crate) fn forces(&self, bodies: &[BodyView], kick: Kick) -> Vec<ContactForce> {
        let force = |acting: &Acting| {
            let ContactConstraint { bodies, position, .. } = *acting.constraint;
            let force = acting.vector_of(acting.impulse).map(|impulse| impulse / kick.length);
            (acting.impulse.normal > 0.0).then_some(ContactForce { bodies, position, force })
        };
        self.solve(bodies, kick).constraints.iter().filter_map(force).collect()
    }

    /// Whether the impulses of the coming kick converge.
    ///
    /// # Errors
    /// If they do not.
    pub(crate) fn converges(&self, bodies: &[BodyView], kick: Kick) -> Result<(), Unconverged> {
        self.solve(bodies, kick).unconverged.map_or(Ok(()), Err)
    }

    /// The accelerations, and books the energies of the kick.
    ///
    /// # Errors
    /// If the impulses do not converge; nothing is booked.
    pub(crate) fn act(&mut self, bodies: &[BodyView], kick: Kick) -> Result<Vec<Push>, Unconverged> {
        let problem = self.solve(bodies, kick);
        if let Some(unconverged) = problem.unconverged {
            return Err(unconverged);
        }
        let ledger = self.ledger.plus(problem.arriving(kick)).plus(problem.leaving(kick));
        let pushing = problem.constraints.iter().filter(|acting| acting.impulse.normal > 0.0);
        let last =
            pushing.map(|a| ((a.constraint.bodies, a.constraint.square), a.impulse.times(1.0 / kick.length))).collect();
        let pushes = problem.pushes(kick.length);
        (self.ledger, self.last) = (ledger, last);
        Ok(pushes)
    }

    /// Impulses of the coming kick.
    fn solve(&self, bodies: &[BodyView], kick: Kick) -> Problem<'_> {
        let mut problem = self.problem(bodies, kick);
        problem.converge(self.friction, kick.step);
        problem
    }

    /// The constraints with the impulses of the step before.
    fn problem(&self, bodies: &[BodyView], kick: Kick) -> Problem<'_> {
        let mut nodes = Vec::new();
        let mut numbers = HashMap::new();
        let mut number = |body: usize, at: usize| {
            *numbers.entry((body, at)).or_insert_with(|| {
                let view = &bodies[body];
                let before = [0, 1].map(|c| view.velocity[c][at]);
                let free = [0, 1].map(|c| before[c] + kick.length * view.acceleration[c][at]);
                nodes.push(Node { body, at, mobility: view.mobility(at), before, free, after: free });
                nodes.len() - 1
            })
        };
        let mut constraints = Vec::with_capacity(self.constraints.len());
        for constraint in &self.constraints {
            let [a, b] = constraint.bodies;
            let on_a = constraint.on_a.weights().iter();
            let mut weights: Vec<_> =
                on_a.map(|&(at, w)| (number(a, at), fault!("impulse-one-sided", -w => -0.9 * w))).collect();
            let rigid = match &constraint.on_b {
                Some(on_b) => {
                    weights.extend(on_b.weights().iter().map(|&(at, w)| (number(b, at), w)));
                    [0.0; 2]
                }
                None => self.rigid[b - bodies.len()].pose.velocity_at(constraint.position),
            };
            let last = self.last.get(&(constraint.bodies, constraint.square)).copied().unwrap_or_default();
            let normal = constraint.pressing.unwrap_or(last.normal);
            let impulse = Impulse { normal, ..last }.times(kick.length);
            constraints.push(Acting { constraint, weights, rigid, round_off: 0.0, answers: [0.0; 2], impulse });
        }
        for acting in &mut constraints {
            acting.find_answers(&nodes);
            acting.give(&mut nodes, acting.impulse);
        }
        Problem { nodes, constraints, unconverged: None }
    }
}

impl Iteration {
    fn has_converged(&self, tolerance: f64) -> bool {
        self.change <= tolerance * self.largest
    }
}

impl Problem<'_> {
    /// Finds impulses with which every constraint has converged, or says that it did not.
    fn converge(&mut self, friction: f64, step: f64) {
        let mut last = self.iterations(friction, step);
        let (mut iterations, mut enough, mut helps) = (ITERATIONS, CONVERGED, true);
        while !last.has_converged(enough) && iterations < MOST_ITERATIONS {
            helps = helps && self.solve_directly(friction, step);
            last = self.iterations(friction, step);
            (iterations, enough) = (iterations + ITERATIONS, ACCEPTED);
        }
        if !last.has_converged(ACCEPTED) {
            let residual = last.change / last.largest;
            self.unconverged = Some(Unconverged { place: last.place, iterations, residual });
        }
    }

    /// Iterations over the constraints until they converge or are too many; the last one.
    fn iterations(&mut self, friction: f64, step: f64) -> Iteration {
        let mut last = self.iteration(friction, step);
        let mut iterations = 1;
        while iterations < ITERATIONS && !last.has_converged(CONVERGED) {
            last = self.iteration(friction, step);
            iterations += 1;
        }
        last
    }

    /// Settles one constraint after the other, with all others as they are.
    fn iteration(&mut self, friction: f64, step: f64) -> Iteration {
        let Self { nodes, constraints, .. } = self;
        let mut iteration = Iteration::default();
        for acting in constraints {
            let old = acting.impulse;
            let new = acting.projected(nodes, friction, step);
            let delta = Impulse { normal: new.normal - old.normal, tangent: new.tangent - old.tangent };
            acting.give(nodes, delta);
            acting.impulse = new;
            iteration.largest = larger(iteration.largest, new.normal);
            for change in [delta.normal.abs(), delta.tangent.abs()] {
                // what is no number stays: such impulses never converge
                if (change > iteration.change && change > acting.round_off) || change.is_nan() {
                    (iteration.change, iteration.place) = (change, acting.constraint.position);
                }
            }
        }
        iteration
    }

    fn pushes(&self, length: f64) -> Vec<Push> {
        let push = |node: &Node| {
            let acceleration = [0, 1].map(|c| (node.after[c] - node.free[c]) / length);
            Push { body: node.body, at: node.at, acceleration }
        };
        self.nodes.iter().map(push).filter(|push| push.acceleration != [0.0; 2]).collect()
    }

    /// Energies of the part of the kick that belongs to the step before, with the velocities before it;
    /// there is no such part at the start.
    fn arriving(&self, kick: Kick) -> ContactLedger {
        let part = 1.0 - kick.leaving();
        self.energy(fault!("longer-steps-forget-the-last", part => if part < 0.5 { 0.0 } else { part }), |node| {
            node.before
        })
    }

    /// Energies of the part of the kick that belongs to the coming step, with the velocities after it.
    fn leaving(&self, kick: Kick) -> ContactLedger {
        self.energy(kick.leaving(), |node| node.after)
    }

    /// Energies of a part of the impulses with given velocities.
    fn energy(&self, part: f64, velocity: impl Fn(&Node) -> [f64; 2] + Copy) -> ContactLedger {
        let counted = fault!("contact-loss-doubled", part => 2.0 * part);
        let energies = self.constraints.iter().map(|acting| acting.energy(&self.nodes, velocity));
        energies.fold(ContactLedger::default(), |sum, energy| sum.plus(energy.times(counted)))
    }
}

impl Acting<'_> {
    fn tangent(&self) -> [f64; 2] {
        let [x, y] = self.constraint.normal;
        [-y, x]
    }

    fn vector_of(&self, impulse: Impulse) -> [f64; 2] {
        let (n, t) = (self.constraint.normal, self.tangent());
        [0, 1].map(|c| impulse.normal * n[c] + impulse.tangent * t[c])
    }

    fn find_answers(&mut self, nodes: &[Node]) {
        let mut mobility = [0.0; 2];
        for &(node, n) in &self.weights {
            mobility = [0, 1].map(|c| mobility[c] + n * n * nodes[node].mobility[c]);
        }
        let answer = |direction: [f64; 2]| (0..2).map(|c| direction[c] * direction[c] * mobility[c]).sum();
        self.answers = [answer(self.constraint.normal), answer(self.tangent())];
        let size = |v: [f64; 2]| v[0].hypot(v[1]);
        let speed =
            self.weights.iter().fold(size(self.rigid), |sum, &(node, n)| sum + n.abs() * size(nodes[node].free));
        self.round_off = ROUND_OFF * speed / self.answers[0].max(self.answers[1]);
    }

    /// Velocity of b relative to a.
    fn relative(&self, nodes: &[Node], velocity: impl Fn(&Node) -> [f64; 2]) -> [f64; 2] {
        self.weights.iter().fold(self.rigid, |sum, &(node, n)| {
            let v = velocity(&nodes[node]);
            [0, 1].map(|c| sum[c] + n * v[c])
        })
    }

    /// Adds what an impulse does to the velocities of the nodes.
    fn give(&self, nodes: &mut [Node], impulse: Impulse) {
        let vector = self.vector_of(impulse);
        for &(node, n) in &self.weights {
            let node = &mut nodes[node];
            node.after = [0, 1].map(|c| node.after[c] + n * node.mobility[c] * vector[c]);
        }
    }

    /// The impulse that, with all others as they are, keeps the gap from closing and sliding below the
    /// friction.
    fn projected(&self, nodes: &[Node], friction: f64, step: f64) -> Impulse {
        let Impulse { mut normal, mut tangent } = self.impulse;
        let relative = self.relative(nodes, |node| node.after);
        let [along_normal, along_tangent] = self.answers;
        // Where boundaries are not rigid the normal impulse is given.
        if self.constraint.pressing.is_none() && along_normal > 0.0 {
            let allowed = -fault!("open-gap-counts-as-closed", self.constraint.gap.max(0.0) => 0.0) / step;
            let pressed = normal + (allowed - dot(relative, self.constraint.normal)) / along_normal;
            normal = if pressed < fault!("contact-pulls", 0.0 => f64::NEG_INFINITY) { 0.0 } else { pressed };
        }
        if normal.is_nan() {
            return Impulse { normal, tangent: normal };
        }
        let most = fault!("friction-twice", friction * normal => 2.0 * friction * normal);
        if along_tangent > 0.0 {
            let least = fault!("friction-one-way", -most => 0.0);
            tangent = (tangent - dot(relative, self.tangent()) / along_tangent).clamp(least, most);
        }
        Impulse { normal, tangent }
    }

    /// Energies of the impulse with given velocities.
    fn energy(&self, nodes: &[Node], velocity: impl Fn(&Node) -> [f64; 2]) -> ContactLedger {
        let relative = self.relative(nodes, |node| {
            let v = velocity(node);
            [0, 1].map(|c| if node.mobility[c] > 0.0 { v[c] } else { 0.0 })
        });
        let all = self.vector_of(self.impulse);
        let friction = self.vector_of(Impulse { normal: 0.0, ..self.impulse });
        ContactLedger { loss: -dot(all, relative), friction: -dot(friction, relative), work: -dot(all, self.rigid) }
    }
}

impl ContactLedger {
    fn plus(self, other: Self) -> Self {
        Self { loss: self.loss + other.loss, friction: self.friction + other.friction, work: self.work + other.work }
    }

    fn times(self, factor: f64) -> Self {
        Self { loss: factor * self.loss, friction: factor * self.friction, work: factor * self.work }
    }
}

#[cfg(test)]
mod tests;
