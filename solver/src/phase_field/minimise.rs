//! The phase field of models with a threshold: c minimises the energy on control values between zero and
//! those of the step before, which bound the spline.
//!
//! By projected Newton (Bertsekas 1982): values that rest on a bound are held, the others solved for, and
//! what leaves the bounds is put back on them. A step that does not lower the energy is halved, so the held
//! values cannot return to what they were. With `r = K c − b`, a value rests on its upper bound where r ≤ 0,
//! and on zero where r ≥ 0. Energies are in the norm of the tolerance.
//!
//! # Its work
//!
//! The bounds act on c with the forces `Gc/(2 l0) r`. Their work `Σ ½ (r_n + r_{n+1}) · Δc` is a term of the
//! ledger: that of a bound which is just reached or left, since one that stays does none.

use super::PhaseField;
use super::awake::Awake;
use super::bounds::Bounds;
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::conjugate_gradients::{Convergence, SolveFailure};
use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::lane::Lane;
use crate::linear_algebra::preconditioned::ITERATION_LIMIT;
use crate::particles::lattice::Lattice;

/// Most sets of held values, and most halvings of a step.
const MOST_SETS: usize = 200;
const MOST_HALVINGS: usize = 20;
/// Distance of a value from a bound that counts as none: a few roundings of values up to 1. A free value so
/// close to its bound would stop every step.
const AT_BOUND: f64 = 1e-14;

impl PhaseField {
    /// Where c may change, if the model has a threshold.
    pub(crate) fn awake(&self) -> Option<&Awake> {
        self.bounds.as_ref().map(|bounds| &bounds.awake)
    }

    /// As [`Self::awake`], with the control values of c.
    pub(crate) fn awake_mut(&mut self) -> Option<(&mut Awake, &[f64])> {
        self.bounds.as_mut().map(|bounds| (&mut bounds.awake, &self.phase[..]))
    }

    /// Makes everything take part in the coming solve.
    pub(crate) fn wake_everything(&mut self) {
        if let Some(bounds) = &mut self.bounds {
            bounds.awake.everything = true;
        }
    }

    /// Gives c = 0 to control points as their upper bound.
    pub(crate) fn break_at(&mut self, control_points: &[usize]) {
        for &at in control_points {
            (self.phase[at], self.previous[at]) = (0.0, 0.0);
        }
    }

    /// c at the end of a step: the least energy between the bounds. The iterations of all its solves.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub(super) fn minimise(
        &mut self,
        bounds: &mut Bounds,
        lattice: &Lattice,
        drive: &[Lane],
    ) -> Result<Convergence, SolveFailure> {
        let Bounds { awake, image, .. } = bounds;
        awake.sleep();
        awake.wake(lattice, drive, &self.phase);
        self.matrix.restrict(awake.active(lattice));
        self.extrapolate(1.0); // `previous` is now c of the step before: the upper bound
        for &at in &awake.candidates {
            self.phase[at] = larger(smaller(self.phase[at], self.previous[at]), 0.0);
        }
        let mut total = Convergence { iterations: 0, error: 0.0 };
        let residual = loop {
            self.assemble_increments(lattice, drive, |cell| awake.is_assembled(cell));
            let (convergence, residual) = self.minimise_on(&awake.candidates, awake.active(lattice), image)?;
            total = Convergence { iterations: total.iterations + convergence.iterations, ..convergence };
            if !awake.wake(lattice, drive, &self.phase) {
                break residual;
            }
        };
        awake.everything = false;
        let unit = self.model.toughness / (2.0 * self.model.length_scale);
        let mut work = 0.0;
        for (&at, residual) in awake.candidates.iter().zip(&residual) {
            work += 0.5 * (residual + bounds.residual[at]) * (self.phase[at] - self.previous[at]);
        }
        bounds.work += unit * work;
        bounds.held.iter().for_each(|&at| bounds.residual[at] = 0.0);
        awake.candidates.iter().zip(residual).for_each(|(&at, residual)| bounds.residual[at] = residual);
        bounds.held.clone_from(&awake.candidates);
        Ok(total)
    }

    /// The least energy with the candidates that there are, and the residual of each.
    fn minimise_on(
        &mut self,
        candidates: &[usize],
        active: ActiveColumns,
        image: &mut [f64],
    ) -> Result<(Convergence, Vec<f64>), SolveFailure> {
        let grid = self.matrix.grid;
        let enough = self.model.diffusion() * self.tolerance * self.tolerance;
        let mut total = Convergence { iterations: 0, error: 0.0 };
        let mut free = vec![false; candidates.len()];
        let mut settled = false;
        self.matrix.restrict(active.clone());
        let mut residual = self.residual(candidates, image);
        let diagonal: Vec<f64> = candidates.iter().map(|&at| self.diagonal(at)).collect();
        for _ in 0..MOST_SETS {
            let mut released = 0.0;
            for (((&at, r), free), diagonal) in candidates.iter().zip(&residual).zip(&mut free).zip(&diagonal) {
                let c = self.phase[at];
                let held = (c >= self.previous[at] - AT_BOUND && *r <= 0.0) || (c <= AT_BOUND && *r >= 0.0);
                if !held && !*free {
                    released += r * r / diagonal;
                }
                *free = !held;
            }
            if released <= enough && settled || !free.contains(&true) {
                return Ok((total, residual));
            }
            let from: Vec<f64> = candidates.iter().map(|&at| self.phase[at]).collect();
            let free = candidates.iter().zip(&free).filter(|(_, free)| **free).map(|(at, _)| *at);
            self.matrix.restrict(ActiveColumns::exactly(grid, free));
            let convergence = self.solve_from_here(ITERATION_LIMIT)?;
            total = Convergence { iterations: total.iterations + convergence.iterations, ..convergence };
            self.matrix.restrict(active.clone());
            let Some(left) = self.put_on_bounds(candidates, &diagonal, &from, &mut residual, image) else { break };
            settled = left <= enough;
        }
        Err(SolveFailure::NotConverged { iterations: total.iterations, error: total.error })
    }

    /// Projects c onto its bounds, and halves the way from the last c until the energy does not rise. The
    /// square of what was projected, in the norm of the energy; none if it always rises.
    fn put_on_bounds(
        &mut self,
        candidates: &[usize],
        diagonal: &[f64],
        from: &[f64],
        residual: &mut Vec<f64>,
        image: &mut [f64],
    ) -> Option<f64> {
        let found: Vec<f64> = candidates.iter().map(|&at| self.phase[at]).collect();
        for halvings in 0..MOST_HALVINGS {
            let part = 0.5_f64.powi(halvings as i32);
            let mut left = 0.0;
            for ((&at, diagonal), (from, found)) in candidates.iter().zip(diagonal).zip(from.iter().zip(&found)) {
                let wanted = from + part * (found - from);
                let c = larger(fault!("phase-field-heals", smaller(wanted, self.previous[at]) => wanted), 0.0);
                left += (wanted - c) * (wanted - c) * diagonal;
                self.phase[at] = c;
            }
            let now = self.residual(candidates, image);
            let steps = candidates.iter().zip(from).map(|(&at, from)| self.phase[at] - from);
            let rises = steps.zip(residual.iter().zip(&now)).map(|(step, (r, now))| 0.5 * (r + now) * step);
            let (rise, scale) = rises.fold((0.0, 0.0), |(sum, scale), rise| (sum + rise, scale + rise.abs()));
            if rise <= f64::EPSILON * candidates.len() as f64 * scale {
                *residual = now;
                return Some(left);
            }
        }
        None
    }

    /// `K c − b` at the candidates; `image` is room for `K c`.
    fn residual(&self, candidates: &[usize], image: &mut [f64]) -> Vec<f64> {
        self.matrix.apply(&self.phase, image);
        candidates.iter().map(|&at| image[at] - self.load[at]).collect()
    }

    fn diagonal(&self, at: usize) -> f64 {
        let grid = self.matrix.grid;
        larger(self.matrix.diagonal(grid.column_of(at), grid.row_of(at)), f64::MIN_POSITIVE)
    }
}
