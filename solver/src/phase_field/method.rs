//! How the system of the phase field is solved: conjugate gradients with a preconditioner that is renewed
//! when it is stale, and replaced where it is too poor; or sparse Cholesky for reference.

use crate::linear_algebra::cholesky::SparseCholesky;
use crate::linear_algebra::conjugate_gradients::{ConjugateGradients, Convergence, SolveFailure};
use crate::linear_algebra::preconditioner::Preconditioner;
use crate::linear_algebra::stencil::Stencil;
use crate::scene::PhaseFieldSolver;

/// Iterations after which a solve counts as failed.
pub(crate) const ITERATION_LIMIT: usize = 2000;

#[derive(Debug, Clone)]
pub(super) enum Method {
    Iterative(Box<PreconditionedSolver>),
    Direct(Box<SparseCholesky>),
}

impl Method {
    /// For a matrix that is assembled once, or anew for every solve.
    pub(crate) fn new(matrix: &Stencil, solver: PhaseFieldSolver, anew: bool) -> Self {
        match solver {
            PhaseFieldSolver::Cholesky => Self::Direct(Box::default()),
            PhaseFieldSolver::ConjugateGradients => Self::Iterative(Box::new(PreconditionedSolver::new(matrix, anew))),
        }
    }

    /// The same method for another matrix.
    pub(crate) fn anew(&self, matrix: &Stencil) -> Self {
        match self {
            Self::Direct(_) => Self::Direct(Box::default()),
            Self::Iterative(solver) => {
                Self::Iterative(Box::new(PreconditionedSolver::new(matrix, solver.preconditioner.is_scaled)))
            }
        }
    }

    /// Improves `x` until its error in the energy norm is about `tolerance`; `patience` is that of
    /// [`PreconditionedSolver::solve`].
    pub(crate) fn solve(
        &mut self,
        matrix: &Stencil,
        load: &[f64],
        x: &mut [f64],
        tolerance: f64,
        patience: usize,
    ) -> Result<Convergence, SolveFailure> {
        match self {
            Self::Direct(cholesky) => {
                let held = matrix.active().others(matrix.grid);
                let factor = cholesky.factor(matrix, &held).ok_or(SolveFailure::NotPositiveDefinite)?;
                if held.is_empty() {
                    factor.solve(load, x);
                } else {
                    let (mut residual, mut change) = (matrix.grid.zeros(), matrix.grid.zeros());
                    matrix.apply(x, &mut residual);
                    residual.iter_mut().zip(load).for_each(|(residual, load)| *residual = load - *residual);
                    factor.solve(&residual, &mut change); // what is held keeps its value
                    x.iter_mut().zip(change).for_each(|(x, change)| *x += change);
                }
                Ok(Convergence { iterations: 1, error: 0.0 })
            }
            Self::Iterative(solver) => {
                solver.preconditioner.prepare(matrix);
                solver.solve(matrix, load, x, tolerance, patience)
            }
        }
    }

    /// What preconditions an iterative method.
    pub(crate) fn preconditioner(&mut self) -> Option<&mut Preconditioner> {
        match self {
            Self::Iterative(solver) => Some(&mut solver.preconditioner),
            Self::Direct(_) => None,
        }
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Iterative(solver) => solver.workspace.bytes() + solver.preconditioner.bytes(),
            Self::Direct(_) => 0,
        }
    }
}

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
