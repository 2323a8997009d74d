//! Steps between two solves of the phase field.
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
//! which is a term of the energy ledger; after a solve r is zero.

use super::PhaseField;
use super::lag::Lag;
use crate::linear_algebra::conjugate_gradients::{Convergence, SolveFailure};
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::Lane;
use crate::linear_algebra::preconditioner::TOO_MANY;
use crate::particles::lattice::Lattice;

impl PhaseField {
    /// c at the end of a step: solved for, or carried on where the interval allows it. The convergence of a
    /// solve.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub(crate) fn advance(&mut self, lattice: &Lattice, history: &[Lane]) -> Result<Option<Convergence>, SolveFailure> {
        let Some(mut lag) = self.lag.take() else { return self.solve(lattice, history).map(Some) };
        self.assemble_history(lattice, history);
        let due = lag.is_due();
        lag.since += 1;
        let result = if due {
            self.solve_after(&mut lag).map(Some)
        } else {
            self.carry_on(&mut lag);
            Ok(None)
        };
        self.lag = Some(lag);
        result
    }

    /// Makes the coming step solve.
    pub(crate) fn expect_solve(&mut self) {
        if let Some(lag) = &mut self.lag {
            lag.expected = true;
        }
    }

    /// Work of the changes of c on the residual of its equation, J/m: on the bounds, if there are any;
    /// between solves, if there are steps without one.
    pub(crate) fn residual_work(&self) -> Option<f64> {
        let of_bounds = self.bounds.as_ref().map(|bounds| bounds.work);
        of_bounds.or_else(|| self.lag.as_ref().map(|lag| lag.work))
    }

    /// Largest increase of a control value by a solve so far, if there are steps without one.
    pub(crate) fn healing(&self) -> Option<f64> {
        self.lag.as_ref().map(|lag| lag.healing)
    }

    fn solve_after(&mut self, lag: &mut Lag) -> Result<Convergence, SolveFailure> {
        let carried = std::mem::replace(&mut self.phase, lag.solved.clone());
        let convergence = self.solve_with(TOO_MANY, lag.ahead())?;
        let mut work = 0.0;
        for at in self.matrix.grid.indices() {
            let change = self.phase[at] - carried[at];
            work += 0.5 * lag.residual[at] * change;
            lag.healing = larger(lag.healing, change);
        }
        lag.work += work;
        lag.residual.fill(0.0);
        (lag.apart, lag.since, lag.expected) = (lag.since, 0, false);
        lag.solved.copy_from_slice(&self.phase);
        let steps = lag.apart as f64;
        let decreases = self.previous.iter().zip(&self.phase).map(|(before, now)| (before - now) / steps);
        lag.fastest = decreases.fold(0.0, larger);
        Ok(convergence)
    }

    fn carry_on(&mut self, lag: &mut Lag) {
        let before = self.phase.clone();
        let ahead = fault!("phase-field-carried-too-far", lag.ahead() => 2.0 * lag.ahead());
        for ((phase, solved), previous) in self.phase.iter_mut().zip(&lag.solved).zip(&self.previous) {
            *phase = larger(solved.min(0.0), solved + ahead * (solved - previous).min(0.0));
        }
        let mut image = self.matrix.grid.zeros();
        self.matrix.apply(&self.phase, &mut image);
        let unit = self.model.toughness / (2.0 * self.model.length_scale);
        let mut work = 0.0;
        for at in self.matrix.grid.indices() {
            let residual = unit * (image[at] - self.load[at]);
            work += 0.5 * (lag.residual[at] + residual) * (self.phase[at] - before[at]);
            lag.residual[at] = residual;
        }
        lag.work += fault!("phase-lag-work-left-out", work => 0.0);
    }
}
