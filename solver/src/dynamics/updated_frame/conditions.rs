//! What conditions do to a body in a step: on the control points of sides, and on edges that move.

use super::field::DiscreteField;
use super::grid::ImposedEnergy;
use super::held_sides::constraints;
use crate::dynamics::failure::Failure;

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
        if self.at_start && !self.loads.is_empty() {
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
}
