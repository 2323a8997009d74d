//! What conditions do to a body in a step, on the control points of sides and on edges that move, and what
//! the step adds to its energy ledger and to the losses of its transfers.

use super::field::DiscreteField;
use super::grid::{EndOfStep, ImposedEnergy};
use super::held_sides::constraints;
use crate::dynamics::failure::Failure;
use crate::linear_algebra::vectors::dot;

impl DiscreteField {
    /// Lets the sides hold the control points that their material reaches now.
    pub(super) fn hold_sides(&mut self) {
        self.nodes.hold(constraints(&self.whole, &self.patch, self.origin, &self.sides));
    }

    /// Imposes the prescribed velocities.
    pub(super) fn apply_boundary(&mut self) -> ImposedEnergy {
        let fixed = self.nodes.stop();
        let Self { nodes, edges, .. } = self;
        edges.as_mut().map_or(fixed, |edges| edges.impose(nodes).plus(fixed))
    }

    /// Accelerations of the forces and of the conditions.
    pub(super) fn accelerate(&mut self) {
        self.nodes.accelerate();
        if let Some(mut edges) = self.edges.take() {
            let kick = self.kick_length(edges.step);
            edges.accelerate(&mut self.nodes.acceleration, kick);
            self.edges = Some(edges);
        }
    }

    /// Accelerations at t = 0 by the loads of the first kick, which lead to what is prescribed for a step of
    /// `dt` seconds.
    ///
    /// # Errors
    /// A load or a condition that has lost its material.
    pub(super) fn prepare(&mut self, dt: f64) -> Result<(), Failure> {
        self.loads.iter_mut().for_each(|load| load.factor.prepare(dt));
        self.gravity.factor.prepare(dt);
        if self.at_start && (self.gravity.varies() || !self.loads.is_empty()) {
            self.rebuild_grid()?;
        }
        if let Some(edges) = self.edges.as_mut().filter(|_| self.at_start) {
            edges.go_on([self.time, dt]);
            self.accelerate();
        }
        Ok(())
    }

    /// Lets the edges answer to accelerations that were added for a step of `dt` seconds.
    pub(super) fn hold_pushed(&mut self, dt: f64) {
        let Some(mut edges) = self.edges.take() else { return };
        let kick = self.kick_length(dt);
        self.ledger.external_work += edges.hold_pushed(&mut self.nodes.acceleration, kick);
        self.edges = Some(edges);
    }

    /// To be asked once the velocities for the points are known.
    pub(super) fn end_of_step(&self) -> EndOfStep {
        let nodes = &self.nodes;
        EndOfStep {
            kinetic: nodes.kinetic_energy(&nodes.velocity),
            momentum: nodes.momentum(&nodes.velocity),
            not_followed: nodes.power(false),
        }
    }

    /// Books the works and losses of the step that ends now.
    pub(super) fn book(&mut self, dt: f64, end_of_step: &EndOfStep, imposed: ImposedEnergy) {
        let weights = [self.time - dt, self.time].map(|time| dot(self.gravity.at(time), end_of_step.momentum));
        let powers = self.loads.iter().map(|load| load.powers(self.time, dt));
        let [before, now] = powers.fold(weights, |[a, b], [before, now]| [a + before, b + now]);
        let [forced_before, forced_now] = self.forcing.as_ref().map_or([0.0; 2], |forcing| forcing.powers);
        let driven = self.edges.as_mut().map_or(0.0, |edges| edges.work(dt));
        let on_points = now + forced_now - self.stress_work / dt;
        self.losses.kinetic += end_of_step.kinetic - self.nodes.kinetic_energy(&self.nodes.arrived);
        self.losses.power += 0.5 * dt * (end_of_step.not_followed + on_points - self.nodes.power(true));
        self.losses.imposed += fault!("loss-forgotten", imposed.loss => 0.0);
        self.ledger.external_work += imposed.work + 0.5 * dt * (before + now);
        self.ledger.external_work += driven + 0.5 * dt * (forced_before + forced_now);
        self.ledger.transfer_loss = self.losses.sum();
    }

    /// Books the change of the stagger `dt²/8 aᵀ M a` where a step of `dt` seconds follows one of another
    /// length; `half_square` is `1/2 aᵀ M a`.
    pub(super) fn book_change_of_step(&mut self, dt: f64, half_square: impl FnOnce(&Self) -> f64) {
        if !self.at_start && dt != self.last_step {
            let squares = self.last_step * self.last_step - dt * dt;
            self.losses.step -= 0.25 * squares * half_square(self);
        }
    }
}
