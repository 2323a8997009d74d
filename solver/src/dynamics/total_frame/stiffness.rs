//! Stiffness of the undamaged body in the total frame, and the critical step it implies; with finite strains
//! also those of the body as it is deformed and broken now, since compression raises the stiffness.

use std::collections::BTreeSet;

use super::TotalFrame;
use crate::dynamics::critical_step::{StiffnessOperator, highest_frequency};
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::smaller;
use crate::linear_algebra::lane::Lane;
use crate::phase_field::fracture::LatticeFracture;
use crate::scene::{Kinematics, Split};
use crate::transfer::finite::{Elastic, elastic_forces, gradients, sweep_along, sweep_with};
use crate::transfer::kernels::{ElasticStress, HeldPhaseStress, LeastStretch};
use crate::transfer::point_kernel::Fields;
use crate::transfer::sweep::{StripForces, sweep};

/// Stiffening, over that at which the critical step was last taken, at which it is taken again.
const NOTICEABLE: f64 = 1.5;

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
        let body = Elastic { lattice: &self.lattice, moduli: self.moduli, kinematics: Kinematics::Small };
        elastic_forces(body, displacement, strips, out);
        self.lattice.fold(out);
    }

    /// Stiffness of the undamaged body on its free degrees of freedom.
    pub fn stiffness_operator(&self) -> LatticeStiffness<'_> {
        LatticeStiffness::new(self, None)
    }

    /// Tangent stiffness on the free degrees of freedom; the geometric part is in it.
    pub(super) fn tangent(&self) -> LatticeStiffness<'_> {
        LatticeStiffness::new(self, Some(gradients(&self.lattice, &self.displacement)))
    }

    /// Takes the critical time step (s) of the body as it is now if finite strains may have made it shorter
    /// than `dt` (s), and the body is stiffer than when it was last taken; `undeformed` is the critical step
    /// of the undeformed body, s.
    pub fn retake_critical_step(&mut self, dt: f64, undeformed: f64) -> Option<f64> {
        if self.kinematics == Kinematics::Small {
            return None;
        }
        let stiffening = self.stiffening();
        let due = stiffening > NOTICEABLE * self.judged_stiffening && stiffening.sqrt() * dt > undeformed;
        if !due {
            return None;
        }
        self.judged_stiffening = stiffening;
        let frequency = highest_frequency(&mut self.tangent());
        Some(2.0 / frequency).filter(|step| *step > 0.0)
    }

    /// By how much the squared frequency of a wave has grown at most, 1 or more; infinite or not a number for
    /// numbers that are.
    ///
    /// Along a principal direction of stretch s, Hencky's law has `dP/ds = E (1 − ln s)/s²`; the other
    /// direction adds as much of the stress at most. Broken points that do not resist compression are left
    /// out: they may be crushed to nothing.
    fn stiffening(&self) -> f64 {
        let lattice = &self.lattice;
        let degraded =
            self.fracture.as_ref().filter(|fracture| matches!(fracture.model.split, Split::None | Split::Rankine));
        let phase = degraded.map_or(&[][..], |fracture| &fracture.phase);
        let mut phases = phase.chunks(lattice.strip_batches());
        let mut kernel = |_| LeastStretch { phase: phases.next().unwrap_or_default(), squared: Lane::splat(1.0) };
        let mut kernels: Vec<_> = (0..lattice.strips()).map(&mut kernel).collect();
        let fields = Fields { displacement: [&self.displacement[0], &self.displacement[1]], phase: &[] };
        sweep(lattice, fields, &mut kernels, None);
        let all = kernels.iter().flat_map(|kernel| kernel.squared.0);
        let squared = all.fold(1.0, smaller);
        (1.0 - squared.ln()) / squared
    }

    /// Internal forces (N/m), with the phase field at the points as it is now.
    pub(super) fn forces_now(&self) -> VectorField {
        let Self { lattice, moduli, kinematics, displacement, fracture, .. } = self;
        let (mut out, mut strips) = ([self.grid.zeros(), self.grid.zeros()], self.strip_forces.clone());
        let body = Elastic { lattice, moduli: *moduli, kinematics: *kinematics };
        if let Some(fracture) = fracture {
            let mut kernels: Vec<_> = self.held_phase(fracture).collect();
            let fields = Fields { displacement: [&displacement[0], &displacement[1]], phase: &[] };
            sweep_with(body, fields, &mut kernels, Some(&mut strips));
            strips.assemble(lattice.grid.stride, &mut out);
        } else {
            elastic_forces(body, displacement, &mut strips, &mut out);
        }
        lattice.fold(&mut out);
        out
    }

    /// Change of the internal forces (N/m per m) along a motion u from the deformation with these gradients,
    /// with the phase field at the points as it is now, less that of loads that follow.
    fn forces_along(&self, from: &[[Lane; 4]], u: &VectorField, strips: &mut StripForces, out: &mut VectorField) {
        let Self { lattice, moduli, kinematics, fracture, .. } = self;
        if let Some(fracture) = fracture {
            sweep_along(*kinematics, lattice, from, u, self.held_phase(fracture), strips);
        } else {
            let kernels = (0..lattice.strips()).map(|_| ElasticStress { moduli: *moduli, energy: Lane::ZERO });
            sweep_along(*kinematics, lattice, from, u, kernels, strips);
        }
        strips.assemble(lattice.grid.stride, out);
        lattice.fold(out);
        for load in &self.loads {
            load.add_change(-load.factor.at(self.time), u, out);
        }
    }

    /// Stress with the phase field at the points as it is now, per strip.
    fn held_phase<'a>(&self, fracture: &'a LatticeFracture) -> impl Iterator<Item = HeldPhaseStress<'a>> {
        let (moduli, model) = (self.moduli, fracture.model);
        let phases = fracture.phase.chunks(self.lattice.strip_batches());
        phases.map(move |phase| HeldPhaseStress { moduli, model, phase })
    }
}

/// Stiffness on the free degrees of freedom, per unit thickness.
#[derive(Debug)]
pub struct LatticeStiffness<'a> {
    frame: &'a TotalFrame,
    /// Control points and components that move.
    pub free: Vec<(usize, usize)>,
    field: VectorField,
    image: VectorField,
    strips: StripForces,
    /// Displacement gradients that the tangent belongs to; none for the undamaged body at rest.
    gradients: Option<Vec<[Lane; 4]>>,
}

impl<'a> LatticeStiffness<'a> {
    fn new(frame: &'a TotalFrame, gradients: Option<Vec<[Lane; 4]>>) -> Self {
        let [field, image] = [(); 2].map(|()| [frame.grid.zeros(), frame.grid.zeros()]);
        let (free, strips) = (frame.free_components(), frame.strip_forces.clone());
        Self { frame, free, field, image, strips, gradients }
    }

    /// Writes a motion of the free degrees of freedom into the field.
    fn unpack(&mut self, x: &[f64]) {
        for (&(at, component), x) in self.free.iter().zip(x) {
            self.field[component][at] = *x;
        }
        self.frame.lattice.sheets.spread(&mut self.field);
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

    /// Without what conditions on edges carry: what they would leave to round-off grows from iteration to
    /// iteration (Gould, Hribar and Nocedal 2001).
    fn stiffness(&mut self, x: &[f64], out: &mut [f64]) {
        self.unpack(x);
        let Self { frame, field, image, strips, gradients, .. } = self;
        match gradients {
            None => frame.elastic_forces(field, strips, image),
            Some(gradients) => frame.forces_along(gradients, field, strips, image),
        }
        if let Some(boundary) = &frame.boundary {
            boundary.add_springs(field, image);
        }
        if let Some(edges) = &frame.edges {
            edges.multipliers.project_forces(image);
        }
        self.pack(&self.image, out);
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
