//! A mass matrix with its penalty, and its solves.
//!
//! The penalty reaches one control point further than the masses, so that the matrix has the pattern of
//! splines one degree higher. An incomplete factor on it takes the thin rings along a boundary, where the
//! penalty alone ties control values to their neighbours, as well as the inside: 5 to 12 iterations a solve
//! (p = 2 and 3). Without the couplings that are zero in the matrix a step takes 1.3 to 1.6 times as long.

use super::penalty::Penalty;
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::preconditioned::PreconditionedSolver;
use crate::linear_algebra::preconditioner::TOO_MANY;
use crate::linear_algebra::stencil::Stencil;
use crate::splines::patch::Patch;

/// When a solve ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Accuracy {
    /// Relative to the solution.
    pub tolerance: f64,
    /// In units of the solution.
    pub round_off: f64,
}

/// `A = Σ m N_i N_j + w Jᵀ J` on the control points that take part.
#[derive(Debug, Clone)]
pub(crate) struct MassSystem {
    /// The matrix; its masses are to be assembled.
    pub matrix: Stencil,
    penalty: Penalty,
    weight: f64,
    marks: Vec<bool>,
    /// Control points whose component is not held, by component.
    free: [ActiveColumns; 2],
    /// Sum of the diagonal without penalty, kg/m.
    mass: f64,
    /// None before the first solve.
    solver: Option<Box<PreconditionedSolver>>,
    preconditioned: Vec<f64>,
}

impl MassSystem {
    /// The zero matrix on a patch, with a penalty of weight w, kg/m.
    pub(crate) fn new(patch: &Patch, weight: f64) -> Self {
        let grid = patch.control_grid();
        Self {
            matrix: Stencil::zeros(grid, patch.spaces.each_ref().map(|space| space.degree() + 1)),
            penalty: Penalty::new(patch),
            weight,
            marks: Vec::new(),
            free: [0, 1].map(|_| ActiveColumns::all(grid)),
            mass: 0.0,
            solver: None,
            preconditioned: grid.zeros(),
        }
    }

    /// Takes the marked control points, once the masses are assembled, and adds the penalty to them: once for
    /// each assembly.
    pub(crate) fn begin(&mut self, marks: Vec<bool>, held: &[Vec<usize>; 2]) {
        let Self { matrix, penalty, weight, free, .. } = self;
        let grid = matrix.grid;
        if marks != self.marks {
            penalty.restrict(grid, &marks);
            *free = held.each_ref().map(|held| {
                let mut free = marks.clone();
                held.iter().for_each(|&at| free[at] = false);
                ActiveColumns::marked(grid, &free)
            });
            self.marks = marks;
        }
        let masses = grid.indices().filter(|&at| self.marks[at]);
        self.mass = masses.map(|at| matrix.diagonal(grid.column_of(at), grid.row_of(at))).sum();
        penalty.add(*weight, matrix);
    }

    /// Whether a control point takes part.
    pub(crate) fn takes(&self, at: usize) -> bool {
        self.marks.get(at).is_some_and(|mark| *mark)
    }

    /// Stores or takes up the factor.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { matrix, solver, .. } = self;
        let solver = solver.get_or_insert_with(|| Box::new(PreconditionedSolver::new(matrix, true)));
        solver.preconditioner.exchange(archive, matrix)
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        let solver = self.solver.as_ref().map_or(0, |solver| solver.bytes());
        self.matrix.bytes() + solver + 8 * self.preconditioned.len() + self.marks.len()
    }

    /// Solves `A x = b` for both components; those that are held keep their values. The error in the energy
    /// norm falls below `tolerance` times that of a start from zero, or below that of `round_off` all over
    /// the body: one that moves as it is has nothing else.
    ///
    /// # Errors
    /// If the iterations do not converge.
    pub(crate) fn solve(
        &mut self,
        b: &VectorField,
        x: &mut VectorField,
        Accuracy { tolerance, round_off }: Accuracy,
    ) -> Result<(), SolveFailure> {
        let Self { matrix, marks, free, mass, solver, preconditioned, .. } = self;
        let solver = solver.get_or_insert_with(|| Box::new(PreconditionedSolver::new(matrix, true)));
        let alike = free[0] == free[1];
        for ((component, free), (b, x)) in free.iter().enumerate().zip(b.iter().zip(x)) {
            x.iter_mut().zip(&*marks).for_each(|(x, mark)| *x = if *mark { *x } else { 0.0 });
            matrix.restrict(free.clone());
            preconditioned.fill(0.0);
            if component == 0 || !alike {
                solver.prepare(matrix);
            }
            let preconditioner = &solver.preconditioner;
            let from_zero = preconditioner.apply(free, b, preconditioned) * preconditioner.unit();
            let tolerance = larger(tolerance * from_zero.sqrt(), mass.sqrt() * round_off);
            solver.solve(matrix, b, x, tolerance, TOO_MANY)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    /// A body in the middle of a patch with unit masses on the diagonal: the penalty vanishes for polynomials
    /// of degree p, solves leave no residual, and what is held keeps its value.
    #[test]
    fn the_penalty_spares_polynomials_and_solves_leave_no_residual() {
        for degree in 1..=4 {
            let patch = Patch::new(&Mesh::uniform([degree; 2], [0.0; 2], [1.0, 0.8], [14, 9]));
            let mut system = MassSystem::new(&patch, 0.3);
            let grid = system.matrix.grid;
            let mut marks = vec![false; grid.len()];
            grid.indices().filter(|&at| grid.column_of(at) < 10).for_each(|at| marks[at] = true);
            let held: Vec<usize> = (0..grid.rows).map(|row| grid.index(0, row)).collect();
            let knots = |d: usize| patch.spaces[d].greville();
            let (x, y) = (knots(0), knots(1));
            system.begin(marks.clone(), &[vec![], held.clone()]);
            let mut linear = grid.zeros();
            for at in grid.indices().filter(|&at| marks[at]) {
                linear[at] = 2.0 + x[grid.column_of(at)] - 3.0 * y[grid.row_of(at)];
            }
            let mut image = grid.zeros();
            let energy = system.matrix.apply(&linear, &mut image);
            // round-off of sums of 1e5
            assert!(energy.abs() <= 1e-9, "p = {degree}: {energy:e}");
            linear[grid.index(4, 4)] += 1.0;
            assert!(system.matrix.apply(&linear, &mut image) > 0.1, "p = {degree}: a control value apart counts");

            grid.indices().filter(|&at| marks[at]).for_each(|at| {
                let (column, row) = (grid.column_of(at), grid.row_of(at));
                system.matrix.set_diagonal(column, row, 1.0 + system.matrix.diagonal(column, row));
            });
            system.mass = 1.0;
            let b = [linear.clone(), linear];
            let mut found = [grid.zeros(), grid.zeros()];
            system.solve(&b, &mut found, Accuracy { tolerance: 1e-10, round_off: 0.0 }).unwrap();
            for (c, held) in [vec![], held].iter().enumerate() {
                system.matrix.restrict(ActiveColumns::all(grid));
                system.matrix.apply(&found[c], &mut image);
                for at in grid.indices().filter(|at| marks[*at]) {
                    let off = if held.contains(&at) { found[c][at] } else { image[at] - b[c][at] };
                    assert!(off.abs() <= 1e-8, "p = {degree}, component {c}: {off:e}");
                }
            }
        }
    }
}
