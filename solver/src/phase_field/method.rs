//! How the system of the phase field is solved: conjugate gradients, or sparse Cholesky for reference.

use crate::linear_algebra::cholesky::SparseCholesky;
use crate::linear_algebra::conjugate_gradients::{ConjugateGradients, Convergence, SolveFailure};
use crate::linear_algebra::preconditioner::Preconditioner;
use crate::linear_algebra::stencil::Stencil;
use crate::scene::PhaseFieldSolver;

/// Iterations after which a solve counts as failed.
pub(crate) const ITERATION_LIMIT: usize = 2000;

#[derive(Debug, Clone)]
pub(super) enum Method {
    Iterative { workspace: Box<ConjugateGradients>, preconditioner: Box<Preconditioner> },
    Direct(Box<SparseCholesky>),
}

impl Method {
    /// For a matrix that is assembled once, or anew for every solve.
    pub(crate) fn new(matrix: &Stencil, solver: PhaseFieldSolver, anew: bool) -> Self {
        match solver {
            PhaseFieldSolver::Cholesky => Self::Direct(Box::default()),
            PhaseFieldSolver::ConjugateGradients => Self::iterative(matrix, anew),
        }
    }

    fn iterative(matrix: &Stencil, anew: bool) -> Self {
        Self::Iterative {
            workspace: Box::new(ConjugateGradients::new(matrix)),
            preconditioner: Box::new(Preconditioner::new(matrix, anew)),
        }
    }

    /// The same method for another matrix.
    pub(crate) fn anew(&self, matrix: &Stencil) -> Self {
        match self {
            Self::Direct(_) => Self::Direct(Box::default()),
            Self::Iterative { preconditioner, .. } => Self::iterative(matrix, preconditioner.is_scaled()),
        }
    }

    /// Improves `x` until its error in the energy norm is about `tolerance`. An incomplete factor is granted
    /// `patience` iterations before a better one takes over where it left off.
    pub(crate) fn solve(
        &mut self,
        matrix: &Stencil,
        load: &[f64],
        x: &mut [f64],
        tolerance: f64,
        mut patience: usize,
    ) -> Result<Convergence, SolveFailure> {
        let (workspace, preconditioner) = match self {
            Self::Direct(cholesky) => {
                let solved = cholesky.solve(matrix, load, x).map(|()| Convergence { iterations: 1, error: 0.0 });
                return solved.ok_or(SolveFailure::NotPositiveDefinite);
            }
            Self::Iterative { workspace, preconditioner } => (workspace, preconditioner),
        };
        preconditioner.prepare(matrix);
        let mut spent = 0;
        loop {
            let limit = if preconditioner.is_complete() { ITERATION_LIMIT } else { patience };
            match workspace.solve(matrix, preconditioner, load, x, tolerance, limit) {
                Ok(Convergence { iterations, error }) => {
                    preconditioner.learn(matrix, iterations);
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

    /// What preconditions an iterative method.
    pub(crate) fn preconditioner(&mut self) -> Option<&mut Preconditioner> {
        match self {
            Self::Iterative { preconditioner, .. } => Some(preconditioner),
            Self::Direct(_) => None,
        }
    }

    /// Bytes of factors, and of the matrix in single precision, that iterations have read so far.
    pub(crate) fn bytes_read(&self) -> u64 {
        match self {
            Self::Iterative { workspace, preconditioner } => workspace.bytes_read() + preconditioner.bytes_read(),
            Self::Direct(_) => 0,
        }
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Iterative { workspace, preconditioner } => workspace.bytes() + preconditioner.bytes(),
            Self::Direct(_) => 0,
        }
    }
}
