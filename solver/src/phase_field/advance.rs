//! Steps between two solves of the phase field, and what of it a checkpoint stores.
//!
//! A time step follows the fastest wave. A crack moves by some thirtieth of a span in it, so c need not be
//! solved for in every step. Between two solves c decreases as it did between the last two, which are m steps
//! apart. In the step j after the last one it is
//!
//! ```text
//! c = max(min(0, c_n), c_n + j min(0, c_n − c_{n−m})/m)
//! ```
//!
//! Nothing heals, and a value that was solved as negative is not raised. Such a c does not solve its
//! equation. With the residual `r = Gc/(2 l0) (K c − b)` its changes do the work `Σ ½ (r_n + r_{n+1}) · Δc`,
//! which is a term of the energy ledger; after a solve r is zero. The part of r that comes from the surface
//! energy Γ(c), which is quadratic, does the work that Γ changes by. What is left is a sum over the points,
//!
//! ```text
//! Γ(c_n) − Γ(c_0) + (1 − k) Σ_steps Σ_p V [s(c) H + s(c') H'] (c' − c),
//! ```
//!
//! with H, c before a step and H', c' after it: no matrix is needed between solves
//! ([`LagWork`](super::lag::LagWork)).

use std::ops::Range;

use super::PhaseField;
use super::lag::Lag;
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::conjugate_gradients::{Convergence, SolveFailure};
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::Lane;
use crate::linear_algebra::preconditioner::TOO_MANY;
use crate::particles::lattice::Lattice;

/// Least diagonal of the matrix, of the coefficient of the gradient term, with which a control point counts
/// for how fast c changes: it is at least some 0.4 for functions inside a body. Those that hardly reach into
/// it at a cut span have any values.
const REACH: f64 = 0.05;

impl PhaseField {
    /// c at the end of a step: solved for, or carried on where the interval allows it. The convergence of a
    /// solve.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub(crate) fn advance(&mut self, lattice: &Lattice, history: &[Lane]) -> Result<Option<Convergence>, SolveFailure> {
        let Some(mut lag) = self.lag.take() else { return self.solve(lattice, history).map(Some) };
        let due = lag.is_due();
        lag.since += 1;
        let result = if due {
            self.assemble_history(lattice, history);
            self.solve_after(&mut lag).map(Some)
        } else {
            self.carry_on(&lag);
            Ok(None)
        };
        self.lag = Some(lag);
        result
    }

    /// Whether the coming step solves.
    pub(crate) fn is_due(&self) -> bool {
        self.lag.as_ref().is_none_or(|lag| lag.is_due())
    }

    /// Whether the present c was carried on.
    pub(crate) fn is_carried_on(&self) -> bool {
        self.lag.as_ref().is_some_and(|lag| lag.since > 0)
    }

    /// Whether there are steps without a solve.
    pub(crate) fn skips_solves(&self) -> bool {
        self.lag.is_some()
    }

    /// Makes the coming step solve.
    pub(crate) fn expect_solve(&mut self) {
        if let Some(lag) = &mut self.lag {
            lag.expected = true;
        }
    }

    /// Work of the changes of c on its bounds, if there are any, J/m.
    pub(crate) fn work_on_bounds(&self) -> Option<f64> {
        self.bounds.as_ref().map(|bounds| bounds.work)
    }

    /// Largest increase of a control value by a solve so far, if there are steps without one.
    pub(crate) fn healing(&self) -> Option<f64> {
        self.lag.as_ref().map(|lag| lag.healing)
    }

    fn solve_after(&mut self, lag: &mut Lag) -> Result<Convergence, SolveFailure> {
        self.go_back(lag);
        let convergence = self.solve_with(TOO_MANY, lag.ahead())?;
        self.end_solve(lag);
        Ok(convergence)
    }

    /// Goes back to the last solve.
    pub(super) fn go_back(&mut self, lag: &mut Lag) {
        let grid = self.matrix.grid;
        for used in self.matrix.active().within(grid, 0..grid.rows) {
            lag.carried[used.clone()].copy_from_slice(&self.phase[used.clone()]);
            self.phase[used.clone()].copy_from_slice(&lag.solved[used]);
        }
    }

    /// Learns what a solve changed.
    pub(super) fn end_solve(&mut self, lag: &mut Lag) {
        (lag.apart, lag.since, lag.expected) = (lag.since, 0, false);
        lag.fastest = 0.0;
        let steps = lag.apart as f64;
        let least = REACH * self.model.diffusion();
        for at in self.taking_part().flatten() {
            lag.solved[at] = self.phase[at];
            if self.matrix.diagonal(at) > least {
                lag.healing = larger(lag.healing, self.phase[at] - lag.carried[at]);
                lag.fastest = larger(lag.fastest, (self.previous[at] - self.phase[at]) / steps);
            }
        }
    }

    pub(super) fn carry_on(&mut self, lag: &Lag) {
        let ahead = fault!("phase-field-carried-too-far", lag.ahead() => 2.0 * lag.ahead());
        let grid = self.matrix.grid;
        for used in self.matrix.active().within(grid, 0..grid.rows) {
            let solved = self.phase[used.clone()].iter_mut().zip(&lag.solved[used.clone()]);
            for ((phase, solved), previous) in solved.zip(&self.previous[used]) {
                *phase = larger(solved.min(0.0), solved + ahead * (solved - previous).min(0.0));
            }
        }
    }

    /// Indices of the control points that take part in the system, range by range.
    pub(crate) fn taking_part(&self) -> impl Iterator<Item = Range<usize>> {
        let grid = self.matrix.grid;
        self.matrix.active().within(grid, 0..grid.rows)
    }

    /// Stores or takes up what steps change. A system that is assembled anew at every step is not part of it.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { model: _, tolerance: _, matrix, load: _, phase, previous, assembled, method, lag, bounds, counts } =
            self;
        if !assembled.is_empty() {
            archive.list(matrix.coefficients_mut())?;
        }
        archive.list(phase)?;
        archive.list(previous)?;
        archive.list(assembled)?;
        archive.value(counts)?;
        bounds.as_mut().map_or(Ok(()), |bounds| bounds.exchange(archive))?;
        lag.as_mut().map_or(Ok(()), |lag| lag.exchange(archive))?;
        method.preconditioner().map_or(Ok(()), |preconditioner| preconditioner.exchange(archive, matrix))
    }
}
