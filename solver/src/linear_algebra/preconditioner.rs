//! What preconditions the solves for the phase field and by the masses of spans: an incomplete factorisation,
//! made anew when it has grown stale, or a complete one where the incomplete one is too poor.
//!
//! Couplings that an incomplete factor drops matter little as long as every span is full of points. In
//! material that is broken and drawn out, spans hold a point or two with a reaction 1e5 times that of intact
//! material, and conjugate gradients would need hundreds of iterations. A complete factor then costs less,
//! although it is made anew for every solve: combinations of control values that vanish at the points of one
//! step do not at those of the next, and an older factor takes them for soft.

use serde::{Deserialize, Serialize};

use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::cholesky::{Factor, SparseCholesky};
use crate::linear_algebra::incomplete_cholesky::{IncompleteCholesky, unit};
use crate::linear_algebra::lane::Scalar;
use crate::linear_algebra::stencil::Stencil;

/// A factor is renewed once a solve needs this many more iterations than the one after its renewal.
const EXTRA_ITERATIONS: usize = 3;
/// More iterations than this with a fresh incomplete factor call for a complete one: five times what a
/// cracked plate needs.
pub(crate) const TOO_MANY: usize = 80;
/// Solves with complete factors before the incomplete one is tried again; twice as many each time it is still
/// too poor, up to the last. Looking for it so costs at most five iterations a solve, and in the end a sixth
/// of one.
const FIRST_PAUSE: usize = 16;
const LONGEST_PAUSE: usize = 512;

/// Factor of a matrix as it was some solves ago.
#[derive(Debug, Clone)]
pub struct Preconditioner {
    factor: PreconditionerKind,
    /// Whether the matrix is still the one that was factored.
    is_fresh: bool,
    /// Iterations of the first solve with the present factor.
    fresh_iterations: Option<usize>,
    pause: Pause,
    /// Whether the matrix is assembled anew for every solve, and scaled: see [`IncompleteCholesky`].
    pub(crate) is_scaled: bool,
}

#[derive(Debug, Clone)]
enum PreconditionerKind {
    Incomplete(IncompleteCholesky),
    /// With its unit; none between a checkpoint and the solve that makes one.
    Complete(SparseCholesky, Option<(Factor, f64)>),
}

/// How long complete factors serve.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Pause {
    /// Solves until the incomplete factor is tried again.
    left: usize,
    /// Solves of the next pause.
    next: usize,
}

impl Preconditioner {
    /// Incomplete factor of `matrix`, which is scaled if it is assembled anew for every solve.
    pub fn new(matrix: &Stencil, is_scaled: bool) -> Self {
        Self {
            factor: PreconditionerKind::Incomplete(IncompleteCholesky::new(matrix, is_scaled)),
            is_fresh: true,
            fresh_iterations: None,
            pause: Pause { left: 0, next: FIRST_PAUSE },
            is_scaled,
        }
    }

    /// What the matrix is multiplied by, a power of two: see [`IncompleteCholesky::unit`].
    pub fn unit(&self) -> f64 {
        match &self.factor {
            PreconditionerKind::Incomplete(factor) => factor.unit,
            PreconditionerKind::Complete(_, factor) => factor.as_ref().map_or(1.0, |(_, unit)| *unit),
        }
    }

    /// `out = (unit M)⁻¹ r` on the control points that take part in the system, for an `out` that is zero
    /// elsewhere; returns `rᵀ out`.
    pub fn apply<T: Scalar>(&self, active: &ActiveColumns, r: &[T], out: &mut [T]) -> f64 {
        match &self.factor {
            PreconditionerKind::Incomplete(factor) => {
                let product = factor.apply(active, r, out); // r is zero where out is not to be
                active.clear_left_out(out, 0);
                product
            }
            PreconditionerKind::Complete(_, factor) => {
                let (factor, unit) = factor.as_ref().expect("it is made before the solve");
                let right: Vec<f64> = r.iter().map(|r| (*r).into() / unit).collect();
                let mut solution = vec![0.0; out.len()];
                factor.solve(&right, &mut solution);
                out.iter_mut().zip(solution).for_each(|(out, solution)| *out = T::of(solution));
                active.clear_outside(factor.grid, out, 0);
                r.iter().zip(out).map(|(r, out)| (*r).into() * (*out).into()).sum()
            }
        }
    }

    /// Makes the factor anew; one that cannot be complete becomes incomplete.
    pub fn renew(&mut self, matrix: &Stencil) {
        match &mut self.factor {
            PreconditionerKind::Incomplete(factor) => factor.refactor(matrix),
            PreconditionerKind::Complete(cholesky, factor) => {
                *factor = None; // two would take twice the memory
                *factor = complete(cholesky, matrix);
                if factor.is_none() {
                    self.factor = PreconditionerKind::Incomplete(IncompleteCholesky::new(matrix, self.is_scaled));
                }
            }
        }
        self.is_fresh = true;
    }

    /// Makes ready for a solve: an incomplete factor takes the scale of the matrix, a complete factor is made
    /// anew, unless its time is over and the incomplete one is tried again.
    pub fn prepare(&mut self, matrix: &Stencil) {
        if let PreconditionerKind::Incomplete(factor) = &mut self.factor {
            return factor.rescale(matrix);
        }
        if self.pause.left == 0 {
            *self = Self { pause: self.pause, ..Self::new(matrix, self.is_scaled) };
        } else {
            self.pause.left -= 1;
            self.renew(matrix);
        }
    }

    /// Whether `rᵀ M⁻¹ r` says how large the error of a start is: a factor with a raised diagonal would make
    /// it out smaller.
    pub fn judges_starts(&self) -> bool {
        match &self.factor {
            PreconditionerKind::Incomplete(factor) => !factor.is_raised(),
            PreconditionerKind::Complete(..) => true,
        }
    }

    /// Whether the factor serves one solve alone.
    pub fn is_complete(&self) -> bool {
        matches!(self.factor, PreconditionerKind::Complete(..))
    }

    /// The next solve counts as the first with the present factor.
    pub(crate) fn forget(&mut self) {
        self.fresh_iterations = None;
    }

    /// Learns what a solve needed that came to its end; whether the factor is stale.
    pub fn learn(&mut self, iterations: usize) -> bool {
        self.is_fresh = false;
        if self.is_complete() {
            return false;
        }
        self.pause.next = FIRST_PAUSE;
        iterations > *self.fresh_iterations.get_or_insert(iterations) + EXTRA_ITERATIONS
    }

    /// A better factor for the solve under way: a fresh one, or else a complete one for this solve and some
    /// to come; false if there is none to be had.
    pub fn improve(&mut self, matrix: &Stencil) -> bool {
        self.forget();
        if !self.is_fresh {
            self.renew(matrix);
            return true;
        }
        if self.is_complete() {
            return false;
        }
        let mut cholesky = SparseCholesky::default();
        let Some(factor) = complete(&mut cholesky, matrix) else { return false };
        self.factor = PreconditionerKind::Complete(cholesky, Some(factor));
        self.pause = Pause { left: self.pause.next, next: (2 * self.pause.next).min(LONGEST_PAUSE) };
        true
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        match &self.factor {
            PreconditionerKind::Incomplete(factor) => factor.bytes(),
            PreconditionerKind::Complete(_, factor) => factor.as_ref().map_or(0, |(factor, _)| factor.bytes()),
        }
    }

    /// Stores or takes up what steps change. A complete factor is made anew for every solve, so that there is
    /// one is all that counts.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive, matrix: &Stencil) -> Result<(), StateError> {
        let Self { factor, is_fresh, fresh_iterations, pause, is_scaled } = self;
        archive.value(is_fresh)?;
        archive.value(fresh_iterations)?;
        archive.value(pause)?;
        let mut complete = matches!(factor, PreconditionerKind::Complete(..));
        archive.value(&mut complete)?;
        if archive.is_reader() {
            *factor = match complete {
                true => PreconditionerKind::Complete(SparseCholesky::default(), None),
                false => PreconditionerKind::Incomplete(IncompleteCholesky::new(matrix, *is_scaled)),
            };
        }
        match factor {
            PreconditionerKind::Incomplete(factor) => factor.exchange(archive),
            PreconditionerKind::Complete(..) => Ok(()),
        }
    }
}

/// The complete factor of the control points that take part and have any material, with its unit; none if
/// there is none.
fn complete(cholesky: &mut SparseCholesky, matrix: &Stencil) -> Option<(Factor, f64)> {
    let grid = matrix.grid;
    let empty = |at: &usize| matrix.diagonal(*at) == 0.0;
    let mut others = matrix.active().others(grid);
    others.extend(grid.indices().filter(empty));
    others.sort_unstable();
    others.dedup();
    cholesky.factor(matrix, &others).map(|factor| (factor, unit(matrix)))
}
