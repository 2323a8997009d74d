//! Stiffness of fields some of whose control points are one, for the critical step.

use super::super::field::DiscreteField;
use super::super::stiffness::PointStiffness;
use crate::dynamics::critical_step::StiffnessOperator;

/// `K x` on the components that accelerate, per unit thickness: those of copies are those of the originals.
#[derive(Debug)]
pub(super) struct JointStiffness<'a> {
    parts: Vec<PointStiffness<'a>>,
    /// Number of a field and of a copy in it, and those of the original.
    copies: Vec<[(usize, usize); 2]>,
}

impl<'a> JointStiffness<'a> {
    pub(super) fn new(fields: &'a [DiscreteField], copies: Vec<[(usize, usize); 2]>) -> Self {
        Self { parts: fields.iter().map(PointStiffness::new).collect(), copies }
    }
}

impl StiffnessOperator for JointStiffness<'_> {
    fn size(&self) -> usize {
        self.parts.iter().map(StiffnessOperator::size).sum()
    }

    fn divide_by_mass(&mut self, mut x: &[f64], mut out: &mut [f64]) {
        for part in &mut self.parts {
            let (own, rest) = x.split_at(part.size());
            let (own_out, rest_out) = out.split_at_mut(part.size());
            part.divide_by_mass(own, own_out);
            (x, out) = (rest, rest_out);
        }
    }

    fn stiffness(&mut self, mut x: &[f64], mut out: &mut [f64]) {
        for part in &mut self.parts {
            let (own, rest) = x.split_at(part.size());
            part.set(own);
            x = rest;
        }
        for &[(field, at), (of, original)] in &self.copies {
            let value = self.parts[of].value(original);
            self.parts[field].set_value(at, value);
        }
        self.parts.iter_mut().for_each(PointStiffness::find_forces);
        for &[(field, at), (of, original)] in &self.copies {
            let force = self.parts[field].force(at);
            self.parts[of].add_force(original, force);
        }
        for part in &self.parts {
            let (own, rest) = std::mem::take(&mut out).split_at_mut(part.size());
            part.forces(own);
            out = rest;
        }
    }
}
