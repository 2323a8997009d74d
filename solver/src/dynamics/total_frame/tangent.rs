//! The critical step of a body with finite strains as it is deformed and broken now: compression raises the
//! stiffness.

use super::TotalFrame;
use super::stiffness::LatticeStiffness;
use crate::dynamics::critical_step::{StiffnessOperator, highest_frequency};
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::smaller;
use crate::linear_algebra::lane::Lane;
use crate::phase_field::fracture::LatticeFracture;
use crate::scene::{Kinematics, Split};
use crate::transfer::directional::{gradients, sweep_along};
use crate::transfer::elastic_forces::elastic_forces;
use crate::transfer::finite::sweep_with;
use crate::transfer::kernels::{ElasticStress, HeldPhaseStress, LeastStretch};
use crate::transfer::point_kernel::Fields;
use crate::transfer::sweep::{StripForces, sweep};

/// Stiffening, over that at which the critical step was last taken, at which it is taken again.
const NOTICEABLE: f64 = 1.5;

impl TotalFrame {
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
        let frequency = highest_frequency(&mut Tangent::new(self));
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
        if let Some(fracture) = fracture {
            let mut kernels: Vec<_> = self.held_phase(fracture).collect();
            let fields = Fields { displacement: [&displacement[0], &displacement[1]], phase: &[] };
            sweep_with(*kinematics, lattice, fields, &mut kernels, Some(&mut strips));
            strips.assemble(lattice.grid.stride, &mut out);
        } else {
            elastic_forces(lattice, *moduli, *kinematics, displacement, &mut strips, &mut out);
        }
        lattice.fold(&mut out);
        out
    }

    /// Stress with the phase field at the points as it is now, per strip.
    fn held_phase<'a>(&self, fracture: &'a LatticeFracture) -> impl Iterator<Item = HeldPhaseStress<'a>> {
        let (moduli, model) = (self.moduli, fracture.model);
        let phases = fracture.phase.chunks(self.lattice.strip_batches());
        phases.map(move |phase| HeldPhaseStress { moduli, model, phase })
    }
}

/// Tangent stiffness on the free degrees of freedom; the geometric part is in it.
pub(super) struct Tangent<'a> {
    frame: &'a TotalFrame,
    undeformed: LatticeStiffness<'a>,
    gradients: Vec<[Lane; 4]>,
    strips: StripForces,
    forces: VectorField,
}

impl<'a> Tangent<'a> {
    pub(super) fn new(frame: &'a TotalFrame) -> Self {
        Self {
            frame,
            undeformed: frame.stiffness_operator(),
            gradients: gradients(&frame.lattice, &frame.displacement),
            strips: frame.strip_forces.clone(),
            forces: [frame.grid.zeros(), frame.grid.zeros()],
        }
    }

    /// Change of the internal forces along the motion at hand, with the phase field at the points as it is
    /// now.
    fn forces_along(&mut self) {
        let Self { frame, undeformed, gradients, strips, forces } = self;
        let direction = &undeformed.field;
        let TotalFrame { lattice, moduli, kinematics, fracture, .. } = frame;
        match fracture {
            None => {
                let kernels = (0..lattice.strips()).map(|_| ElasticStress { moduli: *moduli, energy: Lane::ZERO });
                sweep_along(*kinematics, lattice, gradients, direction, kernels, strips);
            }
            Some(fracture) => {
                let kernels = frame.held_phase(fracture);
                sweep_along(*kinematics, lattice, gradients, direction, kernels, strips);
            }
        }
        strips.assemble(lattice.grid.stride, forces);
        lattice.fold(forces);
    }
}

impl StiffnessOperator for Tangent<'_> {
    fn size(&self) -> usize {
        self.undeformed.size()
    }

    fn stiffness(&mut self, x: &[f64], out: &mut [f64]) {
        self.undeformed.unpack(x);
        self.forces_along();
        for load in &self.frame.loads {
            load.add_change(-load.factor.at(self.frame.time), &self.undeformed.field, &mut self.forces);
        }
        self.undeformed.add_springs(&mut self.forces);
        self.undeformed.pack_forces(&mut self.forces, out);
    }

    fn divide_by_mass(&mut self, x: &[f64], out: &mut [f64]) {
        self.undeformed.divide_by_mass(x, out);
    }
}
