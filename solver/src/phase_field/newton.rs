//! Newton's method for a phase field whose equation is not linear in c. With a cohesive crack the residual
//! and its derivative are
//!
//! ```text
//! r_I(c)  = Σ_p V_p N_I [4 l0 (1 − k) H/Gc s(c) − 2/π c] + 8/π l0² Σ_p V_p grad N_I · grad c
//! K_IJ(c) = Σ_p V_p N_I N_J [4 l0 (1 − k) H/Gc s'(c) − 2/π] + …
//! ```
//!
//! `− 2/π c²` is concave, and K need not be positive definite. Where it is not, or its step does not lower
//! the energy, a part of `2/π` stands for each bracket that is small or negative. The load is chosen so that
//! `K c − b` is r at the present c.

use rayon::prelude::*;

use super::PhaseField;
use super::awake::{Awake, Linearised};
use crate::linear_algebra::lane::Lane;
use crate::particles::lattice::Lattice;

/// Least bracket of K, of `2/π`.
const LEAST: f64 = 1e-3;
/// Change of the bracket that is left out of K, of `2/π`. It costs iterations, not accuracy.
const STALE: f64 = 1e-3;

impl PhaseField {
    /// Assembles K and b at the present c in the cells that are awake.
    pub(super) fn linearise(&mut self, linearised: &mut Linearised, lattice: &Lattice, drive: &[Lane], awake: &Awake) {
        let (reaction, source) = (self.model.reaction_per_energy(), self.model.source());
        let least = if linearised.convex { LEAST * source } else { f64::NEG_INFINITY };
        let span = lattice.points_per_span();
        let control_values = lattice.with_copies(self.phase.clone());
        let cells: Vec<usize> = (0..lattice.cells()).filter(|&cell| awake.is_assembled(cell)).collect();
        let batches: Vec<usize> = cells.iter().flat_map(|cell| cell * span..(cell + 1) * span).collect();
        let of_batch = |batch: &usize| {
            let c = lattice.value(*batch, &control_values);
            let force = drive[*batch] * reaction;
            let bracket = self.model.half_curvature(c) * force - Lane::splat(source);
            let local = self.model.half_slope(c) * force - c * source;
            (c, local, bracket.at_least(Lane::splat(least)) * (1.0 / reaction))
        };
        let states: Vec<_> = batches.par_iter().with_min_len(64).map(of_batch).collect();
        for (batch, (_, _, energy)) in batches.iter().zip(&states) {
            linearised.energies[*batch] = *energy;
        }
        self.assemble_increments(lattice, &linearised.energies, STALE * source / reaction, |cell| {
            awake.is_assembled(cell)
        });
        let mut load = lattice.grid.zeros();
        for (batch, (c, local, _)) in batches.into_iter().zip(states) {
            lattice.add_density(batch, self.assembled[batch] * c * reaction - local - Lane::splat(source), &mut load);
        }
        self.load = lattice.onto_patch(load);
        self.load.iter_mut().zip(&linearised.rest).for_each(|(load, rest)| *load += rest);
    }
}
