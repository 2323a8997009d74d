//! Conjugate gradients with a preconditioner that is renewed when it is stale, and replaced where it is too
//! poor.

use crate::linear_algebra::conjugate_gradients::{ConjugateGradients, Convergence, SolveFailure};
use crate::linear_algebra::preconditioner::Preconditioner;
use crate::linear_algebra::stencil::Stencil;

/// Iterations after which a solve counts as failed.
pub(crate) const ITERATION_LIMIT: usize = 2000;

/// Working vectors, and the preconditioner as it was left by the last solve.
#[derive(Debug, Clone)]
pub(crate) struct PreconditionedSolver {
    pub workspace: ConjugateGradients,
    pub preconditioner: Preconditioner,
}

impl PreconditionedSolver {
    /// For a matrix that is assembled once, or `anew` for every solve.
    pub(crate) fn new(matrix: &Stencil, anew: bool) -> Self {
        Self { workspace: ConjugateGradients::new(matrix), preconditioner: Preconditioner::new(matrix, anew) }
    }

    /// Improves `x` until its error in the energy norm is about `tolerance`, once prepared. An incomplete
    /// factor is granted `patience` iterations before a better one takes over where it left off.
    ///
    /// # Errors
    /// If the iterations do not converge, or the matrix is not positive definite.
    pub(crate) fn solve(
        &mut self,
        matrix: &Stencil,
        load: &[f64],
        x: &mut [f64],
        tolerance: f64,
        mut patience: usize,
    ) -> Result<Convergence, SolveFailure> {
        let Self { workspace, preconditioner } = self;
        let mut spent = 0;
        loop {
            let limit = if preconditioner.is_complete() { ITERATION_LIMIT } else { patience };
            match workspace.solve(matrix, preconditioner, load, x, tolerance, limit) {
                Ok(Convergence { iterations, error }) => {
                    if preconditioner.learn(iterations) {
                        preconditioner.renew(matrix);
                        preconditioner.forget();
                    }
                    return Ok(Convergence { iterations: spent + iterations, error });
                }
                Err(SolveFailure::NotConverged { iterations, .. }) if preconditioner.improve(matrix) => {
                    spent += iterations;
                }
                Err(SolveFailure::NotConverged { iterations, .. }) if limit < ITERATION_LIMIT => {
                    (spent, patience) = (spent + iterations, ITERATION_LIMIT);
                }
                Err(failure) => return Err(failure),
            }
        }
    }
}
