//! Stiffness of the undamaged body in the total frame, and the critical step it implies.

use std::collections::BTreeSet;

use super::TotalFrame;
use crate::dynamics::critical_step::{StiffnessOperator, highest_frequency};
use crate::linear_algebra::control_grid::VectorField;
use crate::scene::Kinematics;
use crate::transfer::elastic_forces::elastic_forces;
use crate::transfer::sweep::StripForces;

impl TotalFrame {
    /// Critical time step of the body, undamaged or broken, s; infinite if nothing can move.
    pub fn critical_step(&self) -> f64 {
        let frequency = highest_frequency(&mut self.stiffness_operator());
        let stiffening = self.fracture.as_ref().map_or(1.0, |fracture| fracture.model.stiffening(&self.moduli));
        fault!("critical-step-too-long", 2.0 => 2.2) / frequency / stiffening.sqrt()
    }

    /// Control point and component of every degree of freedom that can move.
    pub(crate) fn free_components(&self) -> Vec<(usize, usize)> {
        let held: BTreeSet<_> = self.constraints.iter().map(|(at, c, _)| (at, c)).collect();
        let moving = |&(at, c): &(usize, usize)| self.mass.moves(at) && !held.contains(&(at, c));
        self.grid.indices().flat_map(|at| [(at, 0), (at, 1)]).filter(moving).collect()
    }

    /// Internal forces (N/m) of the undamaged body under a displacement (m), linear in it.
    pub(crate) fn elastic_forces(&self, displacement: &VectorField, strips: &mut StripForces, out: &mut VectorField) {
        elastic_forces(&self.lattice, self.moduli, Kinematics::Small, displacement, strips, out);
        self.lattice.fold(out);
    }

    /// Stiffness of the undamaged body on its free degrees of freedom.
    pub fn stiffness_operator(&self) -> LatticeStiffness<'_> {
        let zeros = || [self.grid.zeros(), self.grid.zeros()];
        LatticeStiffness {
            frame: self,
            free: self.free_components(),
            field: zeros(),
            image: zeros(),
            strips: self.strip_forces.clone(),
        }
    }
}

/// Stiffness of the undamaged body on its free degrees of freedom, per unit thickness.
#[derive(Debug)]
pub struct LatticeStiffness<'a> {
    frame: &'a TotalFrame,
    /// Control points and components that move.
    pub free: Vec<(usize, usize)>,
    pub(super) field: VectorField,
    image: VectorField,
    strips: StripForces,
}

impl LatticeStiffness<'_> {
    /// Writes a motion of the free degrees of freedom into [`Self::field`].
    pub(super) fn unpack(&mut self, x: &[f64]) {
        for (&(at, component), x) in self.free.iter().zip(x) {
            self.field[component][at] = *x;
        }
        self.frame.lattice.spread(&mut self.field);
    }

    /// Adds what springs along a boundary that may meet others answer to the motion in [`Self::field`].
    pub(super) fn add_springs(&self, forces: &mut VectorField) {
        if let Some(boundary) = &self.frame.boundary {
            boundary.add_springs(&self.field, forces);
        }
    }

    /// Forces on the free degrees of freedom, without what conditions on edges carry: what they would leave
    /// to round-off grows from iteration to iteration (Gould, Hribar and Nocedal 2001).
    pub(super) fn pack_forces(&self, forces: &mut VectorField, out: &mut [f64]) {
        if let Some(edges) = &self.frame.edges {
            edges.multipliers.project_forces(forces);
        }
        self.pack(forces, out);
    }

    fn pack(&self, field: &VectorField, out: &mut [f64]) {
        for (&(at, component), out) in self.free.iter().zip(out) {
            *out = field[component][at];
        }
    }
}

impl StiffnessOperator for LatticeStiffness<'_> {
    fn size(&self) -> usize {
        self.free.len()
    }

    fn stiffness(&mut self, x: &[f64], out: &mut [f64]) {
        self.unpack(x);
        let mut image = std::mem::take(&mut self.image);
        self.frame.elastic_forces(&self.field, &mut self.strips, &mut image);
        self.add_springs(&mut image);
        self.pack_forces(&mut image, out);
        self.image = image;
    }

    fn divide_by_mass(&mut self, x: &[f64], out: &mut [f64]) {
        self.unpack(x);
        let mut quotient = self.field.clone();
        self.frame.mass.divide(&mut quotient);
        if let Some(edges) = &self.frame.edges {
            edges.multipliers.project(&mut quotient);
        }
        self.pack(&quotient, out);
    }
}
