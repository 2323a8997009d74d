//! The velocities that the grid gives the points: the transfers PIC, FLIP, MUSL, APIC, TPIC and XPIC.
//!
//! Let w be the velocity that arrived on the grid, `v = w + dt a` the one after the step (conditions on the
//! sides imposed), S the interpolation to the points and `S⁺ S` the way there and back ([`Smoothing`]). A
//! point gets `v_p ← k v_p + S Δv`, k being the kept fraction and Δv the increment, and moves and strains
//! with `motion`:
//!
//! ```text
//!          k     Δv                                      motion
//! PIC      0     v                                       v
//! FLIP     1     v − w                                   v
//! MUSL     1     v − w                                   w + S⁺ S (v − w), conditions imposed again
//! APIC     0     v, and C from v (see `affine`)          v
//! TPIC     0     v, and C from v                         v
//! XPIC(m)  0     [Σ_{j<m} (I − S⁺ S)^j] w + (v − w)      v
//! ```
//!
//! MUSL's motion is what a second P2G of the new point velocities would give. Points move with it as well as
//! strain (Sulsky et al. move them with v), so that the strain is that of the motion. XPIC(1) is PIC, and
//! XPIC(m) tends to a FLIP without velocities the grid cannot see (Hammerquist and Nairn 2017).
//!
//! # The critical step
//!
//! For points at rest, a mode of the grid with frequency ω that `S⁺ S` (with the affine part, for APIC and
//! TPIC) multiplies by s obeys, with Ω = ω dt,
//!
//! ```text
//! FLIP      u ← u + dt (w − dt ω² u),   w ← w − s dt ω² u          stable up to Ω² = 4/(2 − s)
//! others    u ← u + dt (w − dt ω² u),   w ← q w − s dt ω² u        stable up to Ω² = 2 (1 + q)/(1 + q − s)
//! MUSL      w ← w − s dt ω² u,          u ← u + dt w               stable up to Ω² = 4/s
//! ```
//!
//! with q = s for PIC, APIC and TPIC and q = 1 − (1 − s)^m ≥ s for XPIC(m). 0 ≤ s ≤ 1 is a theorem, but for
//! TPIC, where it was measured (all eigenvalues of bodies at random offsets: real, 0 to 1). So Ω ≤ √2 is
//! stable for all, and Ω ≤ 2 for MUSL.

use super::grid::NodalFields;
use super::smoothing::Smoothing;
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::control_grid::VectorField;
use crate::scene::Transfer;

/// Velocities from the grid to the points.
#[derive(Debug, Clone)]
pub(crate) struct VelocityTransfer {
    /// Velocity with which the points move and strain, m/s.
    pub motion: VectorField,
    /// What the points add to the kept part of their velocity, m/s.
    pub increment: VectorField,
    /// Part of its own velocity that a point keeps.
    pub kept_fraction: f64,
    transfer: Transfer,
}

impl VelocityTransfer {
    /// Nothing yet.
    pub(crate) fn new(grid: ControlGrid, transfer: Transfer) -> Self {
        let zeros = || [grid.zeros(), grid.zeros()];
        Self { motion: zeros(), increment: zeros(), kept_fraction: 1.0, transfer }
    }

    /// Fraction of `1/ω_max` up to which the step is stable (see the module).
    pub(crate) fn stable_fraction(&self) -> f64 {
        let others = fault!("stable-fraction-of-musl", std::f64::consts::SQRT_2 => 2.0);
        if self.transfer == Transfer::Musl { 2.0 } else { others }
    }

    /// The transfer.
    pub(crate) fn transfer(&self) -> Transfer {
        self.transfer
    }

    /// From the velocities on the grid before and after the step.
    pub(crate) fn update(&mut self, nodes: &NodalFields, smoothing: &Smoothing) {
        let Self { motion, increment, kept_fraction, transfer } = self;
        let of_flip = fault!("transfer-keeps-less", 1.0 => 0.999);
        *kept_fraction = if matches!(transfer, Transfer::Flip | Transfer::Musl) { of_flip } else { 0.0 };
        copy(motion, &nodes.velocity);
        copy(increment, &nodes.velocity);
        match *transfer {
            Transfer::Pic | Transfer::Apic | Transfer::Tpic => (),
            Transfer::Flip => add(increment, -1.0, &nodes.arrived),
            Transfer::Musl => {
                add(increment, -1.0, &nodes.arrived);
                fault!("musl-not-smoothed", smoothing.apply(increment, motion) => copy(motion, increment));
                add(motion, 1.0, &nodes.arrived);
                nodes.constrain(motion);
            }
            Transfer::Xpic(order) => {
                let (mut rest, mut smooth) = (nodes.arrived.clone(), nodes.arrived.clone());
                for _ in fault!("xpic-a-power-short", 1 => 2)..order {
                    smoothing.apply(&rest, &mut smooth);
                    add(&mut rest, -1.0, &smooth);
                    add(increment, 1.0, &rest);
                }
            }
        }
    }

    /// The points follow `motion` and keep their velocities.
    pub(crate) fn prescribe(&mut self, motion: &VectorField) {
        copy(&mut self.motion, motion);
        self.increment.iter_mut().for_each(|component| component.fill(0.0));
        self.kept_fraction = 1.0;
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        8 * 4 * self.motion[0].len()
    }
}

fn copy(to: &mut VectorField, from: &VectorField) {
    for (to, from) in to.iter_mut().zip(from) {
        to.copy_from_slice(from);
    }
}

/// `to += factor from`.
fn add(to: &mut VectorField, factor: f64, from: &VectorField) {
    for (to, from) in to.iter_mut().flatten().zip(from.iter().flatten()) {
        *to += factor * from;
    }
}
