//! Sparse Cholesky factorisation by faer: for the consistent mass, conditions on edges, and the reference of
//! the iterative solver.
//!
//! The symbolic factorisation is done once and reused as long as the pattern stays. All of it on one thread:
//! the order of sums, and with it the bits, must not depend on their number.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{ColMut, Conj, Par, Side};

use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::stencil::Stencil;

/// Direct solver for matrices of one pattern.
#[derive(Debug, Clone, Default)]
pub struct SparseCholesky {
    symbolic: Option<Arc<SymbolicCholesky<usize>>>,
}

/// A symmetric positive definite matrix, factored.
#[derive(Debug, Clone)]
pub(crate) struct LowerFactor {
    symbolic: Arc<SymbolicCholesky<usize>>,
    values: Vec<f64>,
}

impl LowerFactor {
    /// Factors a matrix, of which the entries on and below the diagonal are given, with the symbolic
    /// factorisation of its pattern if that is known. `None` if it is not positive definite.
    pub(crate) fn new(
        lower: &SparseColMat<usize, f64>,
        symbolic: Option<Arc<SymbolicCholesky<usize>>>,
    ) -> Option<Self> {
        let analyse =
            || factorize_symbolic_cholesky(lower.symbolic(), Side::Lower, Default::default(), Default::default());
        let symbolic = match symbolic {
            Some(symbolic) => symbolic,
            None => Arc::new(analyse().ok()?),
        };
        let (threads, regularization) = (Par::Seq, Default::default());
        let mut values = vec![0.0; symbolic.len_val()];
        let mut room = MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(threads, Default::default()));
        let room = MemStack::new(&mut room);
        let lower = lower.as_ref();
        symbolic
            .factorize_numeric_llt(&mut values, lower, Side::Lower, regularization, threads, room, Default::default())
            .ok()?;
        Some(Self { symbolic, values })
    }

    /// Solves `A x = b` in place.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let threads = Par::Seq;
        let mut room = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(1, threads));
        LltRef::<usize, f64>::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            ColMut::from_slice_mut(x).as_mat_mut(),
            threads,
            MemStack::new(&mut room),
        );
    }
}

/// A factored stencil matrix.
#[derive(Debug, Clone)]
pub struct Factor {
    pub(crate) grid: ControlGrid,
    lower: LowerFactor,
    /// Index in a field of each unknown.
    indices: Vec<usize>,
    held: Vec<bool>,
}

impl SparseCholesky {
    /// Factors a matrix; the unknowns at the `held` indices of a field (all of them distinct) are zero and
    /// leave the system. `None` if it is not positive definite.
    pub fn factor(&mut self, matrix: &Stencil, held: &[usize]) -> Option<Factor> {
        let mut is_held = vec![false; matrix.grid.len()];
        held.iter().for_each(|&at| is_held[at] = true);
        let indices: Vec<usize> = matrix.grid.indices().collect();
        let held: Vec<bool> = indices.iter().map(|&at| is_held[at]).collect();
        let lower = LowerFactor::new(&lower_triangle(matrix, &held), self.symbolic.clone())?;
        self.symbolic = Some(lower.symbolic.clone());
        Some(Factor { grid: matrix.grid, lower, indices, held })
    }

    /// Solves `A x = b`; `None` if the matrix is not positive definite.
    pub fn solve(&mut self, matrix: &Stencil, b: &[f64], x: &mut [f64]) -> Option<()> {
        self.factor(matrix, &[])?.solve(b, x);
        Some(())
    }
}

impl Factor {
    /// Solves `A x = b` for fields; held entries of x become zero.
    pub fn solve(&self, b: &[f64], x: &mut [f64]) {
        let value = |i: usize| if self.held[i] { 0.0 } else { b[self.indices[i]] };
        let mut solution: Vec<f64> = (0..self.indices.len()).map(value).collect();
        self.lower.solve(&mut solution);
        for (&index, value) in self.indices.iter().zip(solution) {
            x[index] = value;
        }
    }

    /// Heap memory of the factor, bytes; that of the pattern, which factors share, is left out.
    pub fn bytes(&self) -> usize {
        8 * self.lower.values.len()
    }
}

/// All structural entries on and below the diagonal, control points numbered row by row; those of held
/// unknowns are zero but for a one on the diagonal.
fn lower_triangle(matrix: &Stencil, held: &[bool]) -> SparseColMat<usize, f64> {
    let grid = matrix.grid;
    let n = grid.rows * grid.columns;
    let (mut starts, mut rows, mut values) = (Vec::with_capacity(n + 1), Vec::new(), Vec::new());
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            starts.push(rows.len());
            for (index, offset) in matrix.offsets().iter().enumerate() {
                let (other_row, other) = (row + offset.rows, column as isize + offset.columns);
                if other_row < grid.rows && (0..grid.columns as isize).contains(&other) {
                    let (i, j) = (row * grid.columns + column, other_row * grid.columns + other as usize);
                    rows.push(j); // offsets come in the order of the control points
                    values.push(match held[i] || held[j] {
                        false => matrix.row(row, index)[grid.index(column, 0)],
                        true => f64::from(u8::from(i == j)),
                    });
                }
            }
        }
    }
    starts.push(rows.len());
    SparseColMat::new(SymbolicSparseColMat::new_checked(n, n, starts, None, rows), values)
}
