//! What preconditions the phase-field solve: an incomplete factorisation, made anew when it has grown stale, or a complete one
//! where the incomplete one is too poor.
//!
//! Couplings that an incomplete factor drops matter little as long as every span is full of points. In material that is broken and
//! drawn out, spans hold a point or two with a reaction 1e5 times that of intact material, and conjugate gradients would
//! need hundreds of iterations. A complete factor then costs less, although it is made anew for every solve: combinations of control
//! values that vanish at the points of one step do not at those of the next, and an older factor takes them for soft.

use crate::checkpoint::{Archive, StateError};
use crate::cholesky::{Factor, SparseCholesky};
use crate::incomplete_cholesky::IncompleteCholesky;
use crate::stencil::Stencil;

/// A factor is renewed once a solve needs this many more iterations than the one after its renewal.
const EXTRA_ITERATIONS: usize = 3;
/// More iterations than this with a fresh incomplete factor call for a complete one: five times what a cracked plate needs.
const TOO_MANY: usize = 80;

/// Factor of a matrix as it was some solves ago.
#[derive(Debug, Clone)]
pub struct Preconditioner {
    factor: Kind,
    /// Iterations of the first solve with the present factor.
    fresh_iterations: Option<usize>,
}

#[derive(Debug, Clone)]
enum Kind {
    Incomplete(IncompleteCholesky),
    /// None until the next solve makes one.
    Complete(SparseCholesky, Option<Factor>),
}

impl Preconditioner {
    /// Incomplete factor of `matrix`.
    pub fn new(matrix: &Stencil) -> Self {
        Self { factor: Kind::Incomplete(IncompleteCholesky::new(matrix)), fresh_iterations: None }
    }

    /// `out = M⁻¹ r`; returns `rᵀ out`.
    pub fn apply(&self, r: &[f64], out: &mut [f64]) -> f64 {
        match &self.factor {
            Kind::Incomplete(factor) => factor.apply(r, out),
            Kind::Complete(_, factor) => {
                match factor {
                    Some(factor) => factor.solve(r, out),
                    None => out.copy_from_slice(r),
                }
                r.iter().zip(out).map(|(r, out)| r * *out).sum()
            }
        }
    }

    /// Makes the factor anew.
    pub fn renew(&mut self, matrix: &Stencil) {
        match &mut self.factor {
            Kind::Incomplete(factor) => factor.refactor(matrix),
            Kind::Complete(cholesky, factor) => *factor = cholesky.factor(matrix, &[]),
        }
    }

    /// Whether the factor serves one solve alone.
    pub fn is_complete(&self) -> bool {
        matches!(self.factor, Kind::Complete(..))
    }

    /// The next solve counts as the first with the present factor.
    pub fn forget(&mut self) {
        self.fresh_iterations = None;
    }

    /// Learns what the last solve needed, and renews a stale factor.
    pub fn learn(&mut self, matrix: &Stencil, iterations: usize) {
        let Some(fresh) = self.fresh_iterations else {
            if iterations <= TOO_MANY || !self.complete(matrix) {
                self.fresh_iterations = Some(iterations);
            }
            return;
        };
        if iterations > fresh + EXTRA_ITERATIONS {
            self.renew(matrix);
            self.forget();
        }
    }

    /// Goes over to a complete factor; false if there is one already, or none to be had.
    pub fn complete(&mut self, matrix: &Stencil) -> bool {
        if self.is_complete() {
            return false;
        }
        let mut cholesky = SparseCholesky::default();
        let Some(factor) = cholesky.factor(matrix, &[]) else { return false };
        self.factor = Kind::Complete(cholesky, Some(factor));
        self.fresh_iterations = None;
        true
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        match &self.factor {
            Kind::Incomplete(factor) => factor.bytes(),
            Kind::Complete(_, factor) => factor.as_ref().map_or(0, |factor| factor.bytes()),
        }
    }

    /// Stores or takes up what steps change. A complete factor is made anew for every solve, so that there is one is all that counts.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { factor, fresh_iterations } = self;
        archive.value(fresh_iterations)?;
        let mut complete = matches!(factor, Kind::Complete(..));
        archive.value(&mut complete)?;
        if complete && archive.is_reader() {
            *factor = Kind::Complete(SparseCholesky::default(), None);
        }
        match factor {
            Kind::Incomplete(factor) => archive.list(factor.values_mut()),
            Kind::Complete(..) => Ok(()),
        }
    }
}
