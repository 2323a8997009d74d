//! Stiffness of the undamaged body in the total frame, and the critical step it implies.

use super::{TotalFrame, VectorField};
use crate::critical_step::{StiffnessOperator, highest_frequency};
use crate::kernels::ElasticStress;
use crate::lane::Lane;
use crate::sweep::{Fields, StripForces, sweep};

impl TotalFrame {
    /// Critical time step of the undamaged body, s; infinite if nothing can move.
    pub fn critical_step(&self) -> f64 {
        let frequency = highest_frequency(&mut self.stiffness_operator());
        if frequency > 0.0 { 2.0 / frequency } else { f64::INFINITY }
    }

    /// Stiffness of the undamaged body on its free degrees of freedom.
    pub fn stiffness_operator(&self) -> Stiffness<'_> {
        let fixed: std::collections::BTreeSet<_> = self.constraints.iter().map(|(at, c, _)| (at, c)).collect();
        let moving = |&(at, c): &(usize, usize)| self.inverse_mass[at] > 0.0 && !fixed.contains(&(at, c));
        let free: Vec<_> = self.grid.indices().flat_map(|at| [(at, 0), (at, 1)]).filter(moving).collect();
        Stiffness {
            frame: self,
            masses: free.iter().map(|&(at, _)| self.mass[at]).collect(),
            free,
            field: [self.grid.zeros(), self.grid.zeros()],
            image: [self.grid.zeros(), self.grid.zeros()],
            strips: self.strip_forces.clone(),
        }
    }
}

/// Stiffness of the undamaged body on its free degrees of freedom, per unit thickness.
#[derive(Debug)]
pub struct Stiffness<'a> {
    frame: &'a TotalFrame,
    masses: Vec<f64>,
    free: Vec<(usize, usize)>,
    field: VectorField,
    image: VectorField,
    strips: StripForces,
}

impl Stiffness<'_> {
    /// Control point and component of each degree of freedom.
    pub fn degrees_of_freedom(&self) -> &[(usize, usize)] {
        &self.free
    }
}

impl StiffnessOperator for Stiffness<'_> {
    fn masses(&self) -> &[f64] {
        &self.masses
    }

    fn stiffness(&mut self, x: &[f64], out: &mut [f64]) {
        for (&(at, component), x) in self.free.iter().zip(x) {
            self.field[component][at] = *x;
        }
        let lattice = &self.frame.lattice;
        let moduli = self.frame.moduli;
        let mut kernels: Vec<_> = (0..lattice.strips()).map(|_| ElasticStress { moduli, energy: Lane::ZERO }).collect();
        let fields = Fields { displacement: [&self.field[0], &self.field[1]], phase: &[] };
        sweep(lattice, fields, &mut kernels, Some(&mut self.strips));
        self.strips.assemble(self.frame.grid.stride, &mut self.image);
        for (&(at, component), out) in self.free.iter().zip(out) {
            *out = self.image[component][at];
        }
    }
}
