//! The phase field of models with a threshold: c minimises the energy on control values between zero and
//! those of the step before, which bound the spline.
//!
//! By projected Newton (Bertsekas 1982): values that rest on a bound are held, the others solved for, and
//! what leaves the bounds is put back on them. A step that does not lower the energy is halved, so the held
//! values cannot return to what they were. With `r = K c − b`, a value rests on its upper bound where r ≤ 0,
//! and on zero where r ≥ 0. Energies are in the norm of the tolerance. Where the equation is not linear, K
//! and b are those at the present c, and the method ends when its step is within the tolerance.
//!
//! # Its work
//!
//! The bounds act on c with the forces `Gc/(2 l0) r`. Their work `Σ ½ (r_n + r_{n+1}) · Δc` is a term of the
//! ledger: that of a bound which is just reached or left, since one that stays does none.

use super::PhaseField;
use super::awake::{Awake, Bounds, Linearised};
use super::method::ITERATION_LIMIT;
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::conjugate_gradients::{Convergence, SolveFailure};
use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::lane::Lane;
use crate::particles::lattice::Lattice;

/// Most sets of held values, and most halvings of a step.
const MOST_SETS: usize = 200;
const MOST_HALVINGS: usize = 20;
/// Largest change of a value by a step of Newton's method: between two stationary states lies one that is
/// not the least.
const MOST_CHANGE: f64 = 0.05;
/// Tolerance over the last step of Newton's method, squared. A whole step with the second derivative leaves
/// its square, and what is stale of K, a thousandth, of it. Any other step has to be within the tolerance.
const STEP_IN_TOLERANCE: f64 = 1e-3;
/// What is lost of a residual in its sum, of the diagonal.
const ROUNDING: f64 = 10.0 * f64::EPSILON;
/// Distance of a value from a bound that counts as none: a few roundings of values up to 1. A free value so
/// close to its bound would stop every step.
const AT_BOUND: f64 = 1e-14;

/// What is assembled in the cells that are awake.
struct Equation<'a> {
    lattice: &'a Lattice,
    drive: &'a [Lane],
    awake: &'a Awake,
    linearised: Option<&'a mut Linearised>,
}

impl Equation<'_> {
    /// Assembles the matrix K and the right-hand side b in the cells that are awake.
    fn assemble(&mut self, field: &mut PhaseField) {
        if self.linearised.is_none() {
            let negligible = field.negligible();
            let awake = self.awake;
            field.assemble_increments(self.lattice, self.drive, negligible, |cell| awake.is_assembled(cell));
        }
        self.linearise(field, false);
    }

    /// Assembles K and b anew at another c, if they depend on it; K positive definite if `convex`.
    fn linearise(&mut self, field: &mut PhaseField, convex: bool) {
        if let Some(linearised) = &mut self.linearised {
            linearised.convex = convex;
            field.linearise(linearised, self.lattice, self.drive, self.awake);
        }
    }
}

impl PhaseField {
    /// Where c may change, if the model has a threshold.
    pub(crate) fn awake(&self) -> Option<&Awake> {
        self.bounds.as_ref().map(|bounds| &bounds.awake)
    }

    /// As [`Self::awake`], with the control values of c.
    pub(crate) fn awake_mut(&mut self) -> Option<(&mut Awake, &[f64])> {
        self.bounds.as_mut().map(|bounds| (&mut bounds.awake, &self.phase[..]))
    }

    /// Lets the values of these control points alone change, if the model has a threshold.
    pub(crate) fn allow(&mut self, allowed: Vec<bool>) {
        if let Some(bounds) = &mut self.bounds {
            bounds.awake.allow(allowed);
        }
    }

    /// Makes a body with a threshold intact, for good.
    pub(crate) fn rest(&mut self) {
        self.matrix.grid.indices().for_each(|at| (self.phase[at], self.previous[at]) = (1.0, 1.0));
        self.allow(vec![false; self.phase.len()]);
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
        let Bounds { awake, image, linearised, .. } = bounds;
        awake.sleep();
        awake.wake(lattice, drive, &self.phase);
        self.matrix.restrict(awake.active(lattice));
        self.extrapolate(1.0); // `previous` is now c of the step before: the upper bound
        let reach = if linearised.is_some() { MOST_CHANGE } else { 1.0 };
        for &at in &awake.candidates {
            let least = larger(self.previous[at] - reach, 0.0);
            self.phase[at] = larger(smaller(self.phase[at], self.previous[at]), least);
        }
        let mut total = Convergence { iterations: 0, error: 0.0 };
        let residual = loop {
            let mut equation = Equation { lattice, drive, awake, linearised: linearised.as_deref_mut() };
            equation.assemble(self);
            let (convergence, residual) = self.minimise_on(&mut equation, image)?;
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
        equation: &mut Equation,
        image: &mut [f64],
    ) -> Result<(Convergence, Vec<f64>), SolveFailure> {
        let (candidates, active) = (&equation.awake.candidates[..], equation.awake.active(equation.lattice));
        let grid = self.matrix.grid;
        let enough = self.model.diffusion() * self.tolerance * self.tolerance;
        let mut total = Convergence { iterations: 0, error: 0.0 };
        let mut free = vec![false; candidates.len()];
        let mut settled = false;
        self.matrix.restrict(active.clone());
        let mut residual = self.residual(candidates, image);
        for _ in 0..MOST_SETS {
            let diagonal: Vec<f64> = candidates.iter().map(|&at| self.diagonal(at)).collect();
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
            let free_columns = ActiveColumns::exactly(grid, free_among(candidates, &free));
            let left = loop {
                self.matrix.restrict(free_columns.clone());
                let can_be_safer = equation.linearised.as_ref().is_some_and(|linearised| !linearised.convex);
                let solved =
                    if can_be_safer && free_among(candidates, &free).any(|at| self.diagonal(at) <= f64::MIN_POSITIVE) {
                        Err(SolveFailure::NotPositiveDefinite)
                    } else {
                        self.solve_from_here(ITERATION_LIMIT)
                    };
                self.matrix.restrict(active.clone());
                let left = match solved {
                    Ok(convergence) => {
                        total = Convergence { iterations: total.iterations + convergence.iterations, ..convergence };
                        self.put_on_bounds(equation, &diagonal, &from, &mut residual, image)
                    }
                    Err(_) if can_be_safer => None,
                    Err(failure) => return Err(failure),
                };
                if left.is_some() || !can_be_safer {
                    break left;
                }
                candidates.iter().zip(&from).for_each(|(&at, from)| self.phase[at] = *from);
                equation.linearise(self, true);
            };
            let Some(left) = left else { break };
            settled = left <= enough;
        }
        Err(SolveFailure::NotConverged { iterations: total.iterations, error: total.error })
    }

    /// Projects c onto its bounds, and halves the way from the last c until the energy does not rise. The
    /// square of what was projected, and of the step where the equation is not linear, in the norm of the
    /// energy; none if it always rises.
    fn put_on_bounds(
        &mut self,
        equation: &mut Equation,
        diagonal: &[f64],
        from: &[f64],
        residual: &mut Vec<f64>,
        image: &mut [f64],
    ) -> Option<f64> {
        let candidates = &equation.awake.candidates[..];
        let found: Vec<f64> = candidates.iter().map(|&at| self.phase[at]).collect();
        let convex = equation.linearised.as_ref().map(|linearised| linearised.convex);
        let bounded = |at: usize, c: f64| larger(smaller(c, self.previous[at]), 0.0);
        let changes = candidates.iter().zip(from.iter().zip(&found));
        let furthest = changes.map(|(&at, (from, found))| (bounded(at, *found) - from).abs()).fold(0.0, larger);
        let whole = if convex.is_some() { smaller(1.0, MOST_CHANGE / furthest) } else { 1.0 };
        for halvings in 0..MOST_HALVINGS {
            let part = whole * 0.5_f64.powi(halvings as i32);
            let accuracy = convex.map(|convex| if convex || part < 1.0 { part.recip() } else { STEP_IN_TOLERANCE });
            let mut left = 0.0;
            for ((&at, diagonal), (from, found)) in candidates.iter().zip(diagonal).zip(from.iter().zip(&found)) {
                let wanted = from + part * (found - from);
                let c = larger(fault!("phase-field-heals", smaller(wanted, self.previous[at]) => wanted), 0.0);
                left += (wanted - c) * (wanted - c) * diagonal;
                self.phase[at] = c;
            }
            equation.linearise(self, false);
            let now = self.residual(candidates, image);
            let steps = || candidates.iter().zip(from).map(|(&at, from)| self.phase[at] - from);
            let rises = steps().zip(residual.iter().zip(&now)).map(|(step, (r, now))| 0.5 * (r + now) * step);
            let (rise, scale) = rises.fold((0.0, 0.0), |(sum, scale), rise| (sum + rise, scale + rise.abs()));
            let noise: f64 = steps().zip(diagonal).map(|(step, diagonal)| ROUNDING * diagonal * step.abs()).sum();
            if let Some(accuracy) = accuracy {
                left += accuracy * steps().zip(&*residual).map(|(step, r)| (r * step).abs()).sum::<f64>();
            }
            if rise <= f64::EPSILON * candidates.len() as f64 * scale + noise {
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
        larger(self.matrix.diagonal(at), f64::MIN_POSITIVE)
    }
}

/// The candidates that are free.
fn free_among<'a>(candidates: &'a [usize], free: &'a [bool]) -> impl Iterator<Item = usize> + 'a {
    candidates.iter().zip(free).filter(|(_, free)| **free).map(|(at, _)| *at)
}
