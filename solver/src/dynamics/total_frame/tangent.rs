//! The critical step of a body with finite strains as it is deformed and broken now: compression raises the
//! stiffness.

use super::TotalFrame;
use super::stiffness::LatticeStiffness;
use crate::dynamics::critical_step::{StiffnessOperator, highest_frequency};
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::{largest, smaller};
use crate::linear_algebra::lane::Lane;
use crate::particles::spans::lengths_of_chords;
use crate::scene::{Kinematics, Split};
use crate::transfer::elastic_forces::elastic_forces;
use crate::transfer::finite::sweep_with;
use crate::transfer::kernels::{HeldPhaseStress, LeastStretch};
use crate::transfer::point_kernel::Fields;
use crate::transfer::sweep::{StripForces, sweep};

/// Displacement gradients of the probes: small against strains that matter, large against round-off.
const PROBE: f64 = 1e-8;
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

    /// Internal forces (N/m) under a displacement (m), with the phase field at the points as it is now.
    pub(super) fn forces_now(&self, displacement: &VectorField, strips: &mut StripForces, out: &mut VectorField) {
        let Self { lattice, moduli, kinematics, fracture, .. } = self;
        let Some(fracture) = fracture else {
            elastic_forces(lattice, *moduli, *kinematics, displacement, strips, out);
            return self.fold(out);
        };
        let phases = fracture.phase.chunks(lattice.strip_batches());
        let mut kernels: Vec<_> =
            phases.map(|phase| HeldPhaseStress { moduli: *moduli, model: fracture.model, phase }).collect();
        let fields = Fields { displacement: [&displacement[0], &displacement[1]], phase: &[] };
        sweep_with(*kinematics, lattice, fields, &mut kernels, Some(strips));
        strips.assemble(lattice.grid.stride, out);
        self.fold(out);
    }
}

/// Tangent stiffness on the free degrees of freedom, by central differences of the internal forces: the
/// geometric part is in it.
pub(super) struct Tangent<'a> {
    frame: &'a TotalFrame,
    undeformed: LatticeStiffness<'a>,
    shortest_span: f64,
    strips: StripForces,
    displacement: VectorField,
    forces: [VectorField; 2],
}

impl<'a> Tangent<'a> {
    pub(super) fn new(frame: &'a TotalFrame) -> Self {
        let spans = frame.patch.spaces.iter().flat_map(|space| space.spans());
        let shortest_span = match &frame.patch.geometry {
            None => spans.map(|span| span.length()).fold(f64::INFINITY, smaller),
            Some(patch) => lengths_of_chords(patch)[0],
        };
        let zeros = || [frame.grid.zeros(), frame.grid.zeros()];
        Self {
            frame,
            undeformed: frame.stiffness_operator(),
            shortest_span,
            strips: frame.strip_forces(),
            displacement: frame.displacement.clone(),
            forces: [zeros(), zeros()],
        }
    }
}

impl StiffnessOperator for Tangent<'_> {
    fn size(&self) -> usize {
        self.undeformed.size()
    }

    fn stiffness(&mut self, x: &[f64], out: &mut [f64]) {
        let Self { frame, undeformed, strips, displacement, forces, .. } = self;
        let free = undeformed.degrees_of_freedom();
        let probe = PROBE * self.shortest_span / largest(x.iter().map(|x| x.abs()));
        for (sign, forces) in [1.0, -1.0].into_iter().zip(forces.iter_mut()) {
            for (&(at, component), x) in free.iter().zip(x) {
                displacement[component][at] = frame.displacement[component][at] + sign * probe * x;
            }
            if let Some(sheets) = frame.lattice.sheets() {
                sheets.spread(displacement);
            }
            frame.forces_now(displacement, strips, forces);
        }
        let [ahead, back] = forces;
        for (ahead, back) in ahead.iter_mut().zip(back) {
            ahead.iter_mut().zip(back).for_each(|(ahead, back)| *ahead = (*ahead - *back) / (2.0 * probe));
        }
        undeformed.add_springs(x, ahead);
        undeformed.pack_forces(ahead, out);
    }

    fn divide_by_mass(&mut self, x: &[f64], out: &mut [f64]) {
        self.undeformed.divide_by_mass(x, out);
    }
}
