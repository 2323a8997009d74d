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
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::conjugate_gradients::{Convergence, SolveFailure};
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::Lane;
use crate::linear_algebra::preconditioner::TOO_MANY;
use crate::particles::lattice::Lattice;
use crate::scene::PhaseFieldInterval;

/// Largest change of c at a control point between two solves, and the most steps, of the automatic interval.
const MOST_CHANGE: f64 = 0.05;
const MOST_STEPS: usize = 4;

/// State between two solves.
#[derive(Debug, Clone)]
pub(super) struct Lag {
    interval: PhaseFieldInterval,
    /// Control values of the last solve; those of the solve before are `previous` of the field.
    solved: Vec<f64>,
    /// Steps between the last two solves, zero before the second one, and steps since the last one.
    apart: usize,
    since: usize,
    /// Largest decrease of a control value per step between the last two solves.
    fastest: f64,
    /// `Gc/(2 l0) (K c − b)`, J/m² per control value.
    residual: Vec<f64>,
    /// Work of the changes of c on the residual, J/m.
    work: f64,
    /// Largest increase of a control value by a solve.
    healing: f64,
    /// Whether the coming step is to solve.
    expected: bool,
}

impl Lag {
    /// `None` if every step solves.
    pub(super) fn new(interval: PhaseFieldInterval, phase: &[f64]) -> Option<Box<Self>> {
        (interval != PhaseFieldInterval::Steps(1)).then(|| {
            Box::new(Self {
                interval,
                solved: phase.to_vec(),
                apart: 0,
                since: 0,
                fastest: 0.0,
                residual: vec![0.0; phase.len()],
                work: 0.0,
                healing: 0.0,
                expected: false,
            })
        })
    }

    /// Takes the control values of a first solve.
    pub(super) fn begin(&mut self, phase: &[f64]) {
        self.solved.copy_from_slice(phase);
    }

    /// Whether the step after `since` steps without a solve is to solve.
    fn is_due(&self) -> bool {
        let coming = self.since + 1;
        self.expected
            || match self.interval {
                PhaseFieldInterval::Steps(steps) => coming >= steps,
                PhaseFieldInterval::Automatic => {
                    self.apart == 0 || coming >= MOST_STEPS || coming as f64 * self.fastest > MOST_CHANGE
                }
            }
    }

    /// Part of the decrease between the last two solves that the present number of steps makes up.
    fn ahead(&self) -> f64 {
        if self.apart == 0 { 0.0 } else { self.since as f64 / self.apart as f64 }
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { interval: _, solved, apart, since, fastest, residual, work, healing, expected } = self;
        archive.list(solved)?;
        archive.list(residual)?;
        [apart, since].into_iter().try_for_each(|count| archive.value(count))?;
        [fastest, work, healing].into_iter().try_for_each(|value| archive.value(value))?;
        archive.value(expected)
    }

    /// Heap memory, bytes.
    pub(super) fn bytes(&self) -> usize {
        8 * (self.solved.len() + self.residual.len())
    }
}

impl PhaseField {
    /// c at the end of a step: solved for, or carried on where the interval allows it. The convergence of a
    /// solve.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub(crate) fn advance(&mut self, lattice: &Lattice, history: &[Lane]) -> Result<Option<Convergence>, SolveFailure> {
        let Some(mut lag) = self.lag.take() else { return self.solve(lattice, history).map(Some) };
        self.assemble_increments(lattice, history);
        let due = lag.is_due();
        lag.since += 1;
        let result = if due { self.solve_after(&mut lag).map(Some) } else { Ok(None) };
        if !due {
            self.carry_on(&mut lag);
        }
        self.lag = Some(lag);
        result
    }

    /// Makes the coming step solve.
    pub(crate) fn expect_solve(&mut self) {
        if let Some(lag) = &mut self.lag {
            lag.expected = true;
        }
    }

    /// Work of the changes of c between solves, J/m, if there are steps without a solve.
    pub(crate) fn lag_work(&self) -> Option<f64> {
        self.lag.as_ref().map(|lag| lag.work)
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
