//! Sparse Cholesky factorisation of a stencil matrix by faer: the reference for the iterative solver.
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

impl SparseCholesky {
    /// Solves `A x = b`; `None` if the matrix is not positive definite.
    pub fn solve(&mut self, matrix: &Stencil, b: &[f64], x: &mut [f64]) -> Option<()> {
        let lower = lower_triangle(matrix)?;
        if self.symbolic.is_none() {
            self.symbolic = Some(SymbolicLlt::try_new(lower.symbolic(), Side::Lower).ok()?);
        }
        let factor = Llt::try_new_with_symbolic(self.symbolic.clone()?, lower.as_ref(), Side::Lower).ok()?;
        let indices: Vec<usize> = matrix.grid.indices().collect();
        let mut solution = Mat::from_fn(indices.len(), 1, |i, _| b[indices[i]]);
        factor.solve_in_place(solution.as_mut());
        for (i, &index) in indices.iter().enumerate() {
            x[index] = solution[(i, 0)];
        }
        Some(())
    }
}

/// All structural entries on and below the diagonal, control points numbered row by row.
fn lower_triangle(matrix: &Stencil) -> Option<SparseColMat<usize, f64>> {
    let grid = matrix.grid;
    let mut triplets = Vec::new();
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            for (index, offset) in matrix.offsets().iter().enumerate() {
                let (other_row, other) = (row + offset.rows, column as isize + offset.columns);
                if other_row < grid.rows && (0..grid.columns as isize).contains(&other) {
                    let value = matrix.row(row, index)[grid.index(column, 0)];
                    let (i, j) = (row * grid.columns + column, other_row * grid.columns + other as usize);
                    triplets.push(Triplet::new(j, i, value));
                }
            }
        }
    }
    let n = grid.rows * grid.columns;
    SparseColMat::try_new_from_triplets(n, n, &triplets).ok()
}
