//! The energy ledger of the updated frame: works and transfer losses of a step.
//!
//! Let `v` be the velocity that leaves grid n (after the kick), `ẋ` its value at the points, which move and
//! strain with it, `w` the one that arrives on grid n + 1 (P2G), `w*` that velocity with the prescribed
//! components imposed, and f = f_ext − f_int. Then, for a linear elastic body, whatever the transfer, term by
//! term,
//!
//! ```text
//! Δ(kinetic − stagger) = 1/2 w*ᵀ M(n+1) w* − 1/2 vᵀ M(n) v + dt/2 [ (f + r)(n) · v + (f + r)(n+1) · w* ]
//! Δ elastic            = dt/2 Σ V [ sigma(n) + sigma(n+1) ] : d,   d = sym grad ẋ at the points, on grid n
//! ```
//!
//! with the reactions r. The forces of n and n + 1 work on the points' motion `ẋ` but on the grid's `v` and
//! `w*`. So the transfer loss of an elastic body has three parts, each measured where it happens:
//!
//! - `kinetic`: `1/2 vᵀ M(n) v − 1/2 wᵀ M(n+1) w`, the fall from the end of one step to the grid of the next.
//!   `w` holds what the transfer gives back, affine parts included;
//! - `power`: `dt/2 [ P(n+1) − f(n+1) · w* ]`, where
//!   `P(n+1) = t(n+1) · ẋ_s + Σ m g · ẋ_p − Σ V sigma(n+1) : d` is the power of the new forces on the motion
//!   the points just made; and `dt/2 f(n) · v` of the old ones at control points of negligible mass, which
//!   feel forces and do not follow them;
//! - `imposed`: `1/2 Σ m (v_prescribed − w)²` where a prescribed velocity is imposed on what arrived. The
//!   rest of that jump, `Σ m (v_prescribed − w) v_prescribed`, is work of the driven side.
//!
//! External work is force times motion of the points it acts on: `dt/2 [t(n) + t(n+1)] · ẋ_s` of surface
//! points, `dt g · Σ m ẋ_p` of gravity, and the mean reaction of driven sides. What closure remains is
//! round-off in an elastic body with small strains. With finite strains tau replaces sigma and V the
//! reference volume, d is taken with respect to the positions at n beside tau(n) and to those at n + 1 beside
//! tau(n+1), and the trapezoidal sum leaves O(dt²).
//!
//! With a phase field there is a fourth part. The equation of the phase field balances what c changes by
//! through its control values, but a point also sees c change because it moves through them by δx: in the
//! updated frame c is a field in space, and no stress answers to that. Where history and control values
//! are kept, a configurational force b acts on each point, and
//!
//! - `phase_field`: `Σ V [b(n) + b(n+1)]/2 · δx`,
//!   `b = −grad {(1 − k) c² H + Gc [(1 − c)²/(4 l0) + l0 |grad c|²]}`.
//!
//! It swings with the period of a span where a body moves on as a whole, and grows where a crack opens and
//! stretches the gradient of c across it. What then remains is the stress-work quadrature, O(dt²), as in the
//! total frame. Where a body falls into fragments its stored energy changes at once, by `partition`: see
//! [`super::fragments`]. Where steps change from dt to dt', the stagger `dt²/8 aᵀ M a` does too: that is
//! `step`.

use serde::{Deserialize, Serialize};

/// Parts of the transfer loss so far, J per metre of thickness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct TransferLosses {
    /// Fall of the kinetic energy from the grid at the end of a step to the next one.
    pub kinetic: f64,
    /// Work of the forces on the difference between the motion of the points and that of the grid.
    pub power: f64,
    /// Loss where prescribed velocities are imposed on what arrived.
    pub imposed: f64,
    /// Loss of the phase field as points move through it.
    pub phase_field: f64,
    /// Loss where bodies fell into fragments ([`fragments`](super::fragments)).
    pub partition: f64,
    /// Change of the stagger where the length of the steps changes.
    pub step: f64,
}

impl TransferLosses {
    /// Sum of all parts: the transfer loss so far, J/m.
    pub(super) fn sum(&self) -> f64 {
        self.kinetic + self.power + self.imposed + self.phase_field + self.partition + self.step
    }
}
