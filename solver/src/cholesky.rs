//! Sparse Cholesky factorisation of a stencil matrix by faer: for the consistent mass, and the reference of the iterative
//! solver.
//!
//! The symbolic factorisation is done once and reused as long as the pattern stays.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

use crate::stencil::Stencil;

/// Direct solver for matrices of one pattern.
#[derive(Debug, Clone, Default)]
pub struct SparseCholesky {
    symbolic: Option<SymbolicLlt<usize>>,
}

/// A factored matrix.
#[derive(Debug, Clone)]
pub struct Factor {
    llt: Llt<usize, f64>,
    /// Index in a field of each unknown.
    indices: Vec<usize>,
    held: Vec<bool>,
}

impl SparseCholesky {
    /// Factors a matrix; the unknowns at the `held` indices of a field (all of them distinct) are zero and leave the system.
    /// `None` if it is not positive definite.
    pub fn factor(&mut self, matrix: &Stencil, held: &[usize]) -> Option<Factor> {
        let mut is_held = vec![false; matrix.grid.len()];
        held.iter().for_each(|&at| is_held[at] = true);
        let indices: Vec<usize> = matrix.grid.indices().collect();
        let held: Vec<bool> = indices.iter().map(|&at| is_held[at]).collect();
        let lower = lower_triangle(matrix, &held)?;
        if self.symbolic.is_none() {
            self.symbolic = Some(SymbolicLlt::try_new(lower.symbolic(), Side::Lower).ok()?);
        }
        let llt = Llt::try_new_with_symbolic(self.symbolic.clone()?, lower.as_ref(), Side::Lower).ok()?;
        Some(Factor { llt, indices, held })
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
        let mut solution = Mat::from_fn(self.indices.len(), 1, |i, _| value(i));
        self.llt.solve_in_place(solution.as_mut());
        for (i, &index) in self.indices.iter().enumerate() {
            x[index] = solution[(i, 0)];
        }
    }
}

/// All structural entries on and below the diagonal, control points numbered row by row; those of held unknowns are zero
/// but for a one on the diagonal.
fn lower_triangle(matrix: &Stencil, held: &[bool]) -> Option<SparseColMat<usize, f64>> {
    let grid = matrix.grid;
    let mut triplets = Vec::new();
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            for (index, offset) in matrix.offsets().iter().enumerate() {
                let (other_row, other) = (row + offset.rows, column as isize + offset.columns);
                if other_row < grid.rows && (0..grid.columns as isize).contains(&other) {
                    let (i, j) = (row * grid.columns + column, other_row * grid.columns + other as usize);
                    let value = match held[i] || held[j] {
                        false => matrix.row(row, index)[grid.index(column, 0)],
                        true => f64::from(u8::from(i == j)),
                    };
                    triplets.push(Triplet::new(j, i, value));
                }
            }
        }
    }
    let n = grid.rows * grid.columns;
    SparseColMat::try_new_from_triplets(n, n, &triplets).ok()
}
