//! Preconditioned conjugate gradients on a stencil matrix, stopped by the energy norm of the error.
//!
//! Conjugate gradients lower the error `e = A⁻¹ b − x` in its energy norm, `‖e‖² = eᵀ A e`, at every
//! iteration, by exactly `α r·z` with the step length α, the residual r and the preconditioned residual z
//! (Hestenes and Stiefel 1952; Strakoš and Tichý 2002). The decreases that are still to come are the square
//! of the error; they are estimated from the last two, as a geometric series, and never taken for less than
//! the last. This costs nothing, and unlike the norm of the residual it does not depend on how finely or how
//! widely a mesh is cut.
//!
//! Iterations are in single precision, which halves what they read, on the equation of the correction,
//! `A e = r`. The residual is taken and the correction added in double precision (iterative refinement,
//! Wilkinson 1963; Higham 2002, *Accuracy and stability of numerical algorithms*, chapter 12). A correction
//! in single precision is good for [`DIGITS`]; a tolerance below that takes another one.
//!
//! A system may live on several nested grids: control values of a finer one next to a coarser one are those
//! of the coarser one (`interface.rs`). Each grid has a preconditioner of its own, for the values that are
//! its own.
//!
//! Rounded to single precision, a matrix whose coefficients differ by more than seven digits from one control
//! point to the next may no longer be positive definite: material under a strain of one and more has 1e9
//! times the reaction of intact material. Where iterations fail in single precision, or are many, they go on
//! in double precision.

use rayon::prelude::*;
use thiserror::Error;

use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::control_grid::CHUNK_ROWS;
use crate::linear_algebra::extremes::smaller;
use crate::linear_algebra::interface::{Interface, fold_all, spread_all};
use crate::linear_algebra::lane::{Scalar, Vectorised, add_product, dispatch};
use crate::linear_algebra::preconditioner::Preconditioner;
use crate::linear_algebra::stencil::Stencil;

/// Ratio of two decreases from which on iterations count as stagnating.
const STAGNATING: f64 = 0.999;
/// What is left of an error in the energy norm when the residual is taken anew: round-off of single precision
/// is a thousandth of it.
const DIGITS: f64 = 1e-4;
/// Iterations after which single precision is not trusted: a matrix so far from its factor may have lost its
/// small eigenvalues when it was rounded.
const TRUSTED: usize = 40;

/// Outcome of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Iterations taken; zero if the start already met the tolerance.
    pub iterations: usize,
    /// Estimate of the error that is left, in the energy norm.
    pub error: f64,
}

/// Why a system could not be solved.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum SolveFailure {
    /// Iterations ended short of the tolerance.
    #[error("stopped after {iterations} iterations at an error of {error:.3e}")]
    NotConverged {
        /// Number of iterations after which the solve was given up.
        iterations: usize,
        /// Estimate of the error reached, in the energy norm.
        error: f64,
    },
    /// A direction, or a pivot, whose energy is not positive.
    #[error("met a matrix that is not positive definite")]
    NotPositiveDefinite,
    /// Coefficients, right-hand side or start are not finite.
    #[error("ran into numbers that are not finite")]
    NotFinite,
}

/// Working vectors, kept between solves.
#[derive(Debug, Clone)]
pub struct ConjugateGradients {
    single: Workspace<f32>,
    /// Only where single precision has failed.
    double: Option<Box<Workspace<f64>>>,
    /// Room for the product `A x` when a residual is taken.
    product: Vec<f64>,
}

impl ConjugateGradients {
    /// Room for systems of the size of `matrix`.
    pub fn new(matrix: &Stencil) -> Self {
        Self { single: Workspace::new(matrix), double: None, product: matrix.grid.zeros() }
    }

    /// Improves `x` until its error in the energy norm is about `tolerance`; a start whose preconditioned
    /// residual says so is kept, if the preconditioner can judge it.
    ///
    /// # Errors
    /// If `limit` iterations do not suffice, or numbers or matrix are not what they must be.
    pub fn solve(
        &mut self,
        matrix: &Stencil,
        preconditioner: &Preconditioner,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        limit: usize,
    ) -> Result<Convergence, SolveFailure> {
        let own = matrix.active();
        solve_on_grids(&mut [OnGrid { workspace: self, matrix, preconditioner, own, b, x }], &[], tolerance, limit)
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        8 * self.product.len() + self.single.bytes() + self.double.as_ref().map_or(0, |double| double.bytes())
    }
}

/// The part of a system on one grid.
pub(crate) struct OnGrid<'a> {
    pub workspace: &'a mut ConjugateGradients,
    pub matrix: &'a Stencil,
    pub preconditioner: &'a Preconditioner,
    /// Control points with values of their own: the others that take part are those of the interface.
    pub own: &'a ActiveColumns,
    pub b: &'a [f64],
    pub x: &'a mut [f64],
}

/// As [`ConjugateGradients::solve`], on nested grids from coarse to fine with what lies between them.
///
/// # Errors
/// As there.
pub(crate) fn solve_on_grids(
    grids: &mut [OnGrid],
    interfaces: &[Interface],
    tolerance: f64,
    limit: usize,
) -> Result<Convergence, SolveFailure> {
    let mut system = Solving { grids, interfaces, tolerance, limit };
    let spent = match system.solve::<f32>() {
        Ok(found) if found.iterations < TRUSTED => return Ok(found),
        Err(SolveFailure::NotFinite) => return Err(SolveFailure::NotFinite),
        found => found.map_or(0, |found| found.iterations),
    };
    let found = system.solve::<f64>()?;
    Ok(Convergence { iterations: spent + found.iterations, ..found })
}

/// A precision of iterations.
trait Precision: Scalar {
    /// Matrix and vectors of this precision, and room for `A x`.
    fn vectors(room: &mut ConjugateGradients) -> (&mut Workspace<Self>, &mut Vec<f64>);
}

impl Precision for f32 {
    fn vectors(room: &mut ConjugateGradients) -> (&mut Workspace<Self>, &mut Vec<f64>) {
        (&mut room.single, &mut room.product)
    }
}

impl Precision for f64 {
    fn vectors(room: &mut ConjugateGradients) -> (&mut Workspace<Self>, &mut Vec<f64>) {
        let ConjugateGradients { single, double, product } = room;
        (&mut **double.get_or_insert_with(|| Box::new(Workspace::new(&single.matrix))), product)
    }
}

/// What is to be solved, and how well.
struct Solving<'a, 'b> {
    grids: &'a mut [OnGrid<'b>],
    interfaces: &'a [Interface],
    tolerance: f64,
    limit: usize,
}

/// Matrix and vectors of the iterations.
#[derive(Debug, Clone)]
struct Workspace<T> {
    matrix: Stencil<T>,
    correction: Vec<T>,
    residual: Vec<T>,
    preconditioned: Vec<T>,
    direction: Vec<T>,
    image: Vec<T>,
}

impl<T: Scalar> Workspace<T> {
    fn new<S: Scalar>(matrix: &Stencil<S>) -> Self {
        let zeros = || vec![T::ZERO; matrix.grid.len()];
        Self {
            matrix: matrix.empty(),
            correction: zeros(),
            residual: zeros(),
            preconditioned: zeros(),
            direction: zeros(),
            image: zeros(),
        }
    }

    /// Leaves the vectors zero where no control point takes part now.
    fn take_part(&mut self, matrix: &Stencil) {
        let Self { matrix: copy, correction, residual, preconditioned, direction, image } = self;
        if copy.active() != matrix.active() {
            let fields = [correction, residual, preconditioned, direction, image];
            fields.into_iter().for_each(|field| copy.active().clear_inside(matrix.grid, field));
        }
    }

    /// Whether a control point of a chunk takes part.
    fn is_active(&self, chunk: usize) -> bool {
        let first = chunk * CHUNK_ROWS;
        self.matrix.active().any_in(first..(first + CHUNK_ROWS).min(self.matrix.grid.rows))
    }

    /// Finds the next search direction, `d ← z + beta d`, from the preconditioned residual z.
    fn turn(&mut self, beta: T) {
        let chunk = CHUNK_ROWS * self.matrix.grid.stride;
        let mut direction = std::mem::take(&mut self.direction);
        let chunks = direction.par_chunks_mut(chunk).zip(self.preconditioned.par_chunks(chunk)).enumerate();
        let active = chunks.filter(|(index, _)| self.is_active(*index));
        active.for_each(|(_, (direction, preconditioned))| dispatch(Turn { direction, preconditioned, beta }));
        self.direction = direction;
    }

    /// `e += alpha d`, `r −= alpha A d`.
    fn advance(&mut self, alpha: T) {
        let chunk = CHUNK_ROWS * self.matrix.grid.stride;
        let [mut correction, mut residual] = [&mut self.correction, &mut self.residual].map(std::mem::take);
        let corrections = correction.par_chunks_mut(chunk).zip(self.direction.par_chunks(chunk));
        let residuals = residual.par_chunks_mut(chunk).zip(self.image.par_chunks(chunk));
        let active = corrections.zip(residuals).enumerate().filter(|(index, _)| self.is_active(*index));
        active.for_each(|(_, ((correction, direction), (residual, image)))| {
            dispatch(Advance { correction, direction, residual, image, alpha });
        });
        (self.correction, self.residual) = (correction, residual);
    }

    /// Adds the correction e to the solution: `x ← x + e`.
    fn add_to(&self, x: &mut [f64]) {
        let chunk = CHUNK_ROWS * self.matrix.grid.stride;
        let chunks = x.par_chunks_mut(chunk).zip(self.correction.par_chunks(chunk)).enumerate();
        chunks.filter(|(index, _)| self.is_active(*index)).for_each(|(_, (x, correction))| {
            x.iter_mut().zip(correction).for_each(|(x, e)| *x += (*e).into());
        });
    }

    fn bytes(&self) -> usize {
        self.matrix.bytes() + 5 * size_of::<T>() * self.image.len()
    }
}

impl Solving<'_, '_> {
    fn solve<T: Precision>(&mut self) -> Result<Convergence, SolveFailure> {
        let unit = self.grids.iter().map(|grid| grid.preconditioner.unit()).fold(f64::INFINITY, smaller);
        self.grids.iter_mut().for_each(|grid| T::vectors(grid.workspace).0.take_part(grid.matrix));
        let mut iterations = 0;
        loop {
            for OnGrid { workspace, matrix, b, x, .. } in &mut *self.grids {
                let (work, product) = T::vectors(workspace);
                matrix.residual(unit, b, x, product, &mut work.residual, &mut work.matrix);
                matrix.active().clear_inside(matrix.grid, &mut work.correction);
            }
            self.fold::<T>(|work| &mut work.residual);
            let corrected = self.correct::<T>(unit, &mut iterations);
            self.grids.iter_mut().for_each(|grid| T::vectors(grid.workspace).0.add_to(grid.x));
            if let Some(error) = corrected? {
                return Ok(Convergence { iterations, error });
            }
        }
    }

    /// Moves the values of a vector at the interfaces to the coarser grids.
    fn fold<T: Precision>(&mut self, vector: impl Fn(&mut Workspace<T>) -> &mut Vec<T>) {
        let mut fields: Vec<_> =
            self.grids.iter_mut().map(|grid| &mut vector(T::vectors(grid.workspace).0)[..]).collect();
        fold_all(self.interfaces, &mut fields);
    }

    /// Finds a correction, and counts its iterations; returns the error that is left, or none if the
    /// tolerance is below what a correction is good for.
    fn correct<T: Precision>(&mut self, unit: f64, iterations: &mut usize) -> Result<Option<f64>, SolveFailure> {
        let &mut Self { tolerance, limit, .. } = self;
        let judges_starts = self.grids.iter().all(|grid| grid.preconditioner.judges_starts());
        let mut rho = self.precondition::<T>(unit);
        let mut remaining = Remaining::from_start(rho / unit);
        let enough = DIGITS * remaining.estimate.sqrt();
        let mut beta = 0.0;
        loop {
            let error = remaining.estimate.sqrt();
            if !error.is_finite() {
                return Err(SolveFailure::NotFinite);
            } else if fault!("one-iteration-is-enough", error <= tolerance => *iterations > 0)
                && (*iterations > 0 || error == 0.0 || judges_starts)
            {
                return Ok(Some(error));
            } else if *iterations == limit {
                return Err(SolveFailure::NotConverged { iterations: limit, error });
            } else if error <= enough {
                return Ok(None);
            } else if remaining.last.is_some() {
                let previous = std::mem::replace(&mut rho, self.precondition::<T>(unit));
                beta = rho / previous;
            }
            let curvature = self.turn(T::of(beta));
            if curvature <= 0.0 {
                return Err(SolveFailure::NotPositiveDefinite);
            }
            let alpha = rho / curvature;
            self.grids.iter_mut().for_each(|grid| T::vectors(grid.workspace).0.advance(T::of(alpha)));
            remaining.learn(alpha * rho / unit);
            *iterations += 1;
        }
    }

    /// `z = M⁻¹ r`; returns `r·z`.
    fn precondition<T: Precision>(&mut self, unit: f64) -> f64 {
        let of_grid = |grid: &mut OnGrid| {
            let Workspace { residual, preconditioned, .. } = T::vectors(grid.workspace).0;
            let product = grid.preconditioner.apply(grid.own, residual, preconditioned);
            let ratio = grid.preconditioner.unit() / unit; // a power of two
            if ratio != 1.0 {
                preconditioned.iter_mut().for_each(|z| *z = *z * T::of(ratio));
            }
            ratio * product
        };
        self.grids.iter_mut().map(of_grid).sum()
    }

    /// `d ← z + beta d` and its image `A d`; returns `d·A d`.
    fn turn<T: Precision>(&mut self, beta: T) -> f64 {
        self.grids.iter_mut().for_each(|grid| T::vectors(grid.workspace).0.turn(beta));
        let mut directions: Vec<_> =
            self.grids.iter_mut().map(|grid| &mut T::vectors(grid.workspace).0.direction[..]).collect();
        spread_all(self.interfaces, &mut directions);
        let curvature = |Workspace { matrix, direction, image, .. }: &mut Workspace<T>| matrix.apply(direction, image);
        let sum = self.grids.iter_mut().map(|grid| curvature(T::vectors(grid.workspace).0)).sum();
        self.fold::<T>(|work| &mut work.image);
        sum
    }
}

/// The next search direction, `d ← z + beta d`, on a chunk of rows.
struct Turn<'a, T> {
    direction: &'a mut [T],
    preconditioned: &'a [T],
    beta: T,
}

impl<T: Scalar> Vectorised for Turn<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (d, z) in self.direction.iter_mut().zip(self.preconditioned) {
            *d = add_product::<FMA, _>(*z, self.beta, *d);
        }
    }
}

/// `e += alpha d`, `r −= alpha A d`.
struct Advance<'a, T> {
    correction: &'a mut [T],
    direction: &'a [T],
    residual: &'a mut [T],
    image: &'a [T],
    alpha: T,
}

impl<T: Scalar> Vectorised for Advance<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (e, d) in self.correction.iter_mut().zip(self.direction) {
            *e = add_product::<FMA, _>(*e, self.alpha, *d);
        }
        for (r, image) in self.residual.iter_mut().zip(self.image) {
            *r = add_product::<FMA, _>(*r, -self.alpha, *image);
        }
    }
}

/// Square of the energy norm of the error that is left, from the decreases so far.
#[derive(Debug, Clone, Copy)]
pub struct Remaining {
    /// Present estimate of that square.
    pub estimate: f64,
    last: Option<f64>,
}

impl Remaining {
    /// Before any iteration: `r·z`, which is the square as far as the preconditioner is the matrix.
    pub fn from_start(preconditioned: f64) -> Self {
        Self { estimate: preconditioned, last: None }
    }

    /// Learns by how much an iteration lowered the square.
    pub fn learn(&mut self, decrease: f64) {
        let ratio = self.last.map_or(0.0, |last| decrease / last).min(STAGNATING);
        self.estimate = decrease * (ratio / (1.0 - ratio)).max(1.0);
        self.last = Some(decrease);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::linear_algebra::active_columns::ActiveColumns;
    use crate::linear_algebra::control_grid::ControlGrid;

    /// Every coupling −0.05 and a diagonal of `factor(column, row)` times 2: diagonally dominant for 0.7 and
    /// more.
    fn matrix(grid: ControlGrid, factor: impl Fn(usize, usize) -> f64) -> Stencil {
        let mut matrix = Stencil::zeros(grid, [2, 2]);
        for (row, column) in (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (row, column))) {
            for (index, offset) in matrix.offsets().to_vec().into_iter().enumerate() {
                let (column_there, row_there) = (column as isize + offset.columns, row + offset.rows);
                let inside = row_there < grid.rows && (0..grid.columns as isize).contains(&column_there);
                let at = row * matrix.row_length() + index * grid.stride + grid.index(column, 0);
                let value = if index == 0 { 2.0 * factor(column, row) } else { -0.05 };
                matrix.coefficients_mut()[at] = if inside { value } else { 0.0 };
            }
        }
        matrix
    }

    /// The values of control points that take no part stand, and the others solve their own equations, with a
    /// factor that was made when others took part and material was elsewhere.
    #[test]
    fn control_points_that_take_no_part_keep_their_values() {
        let grid = ControlGrid::new(45, 30);
        let within = |column: usize, row: usize, radius: f64| {
            let distance = (column as f64 - 22.0).hypot(row as f64 - 14.0);
            distance < radius && distance > radius - 6.0
        };
        let marks = |radius: f64| {
            let mut marks = vec![false; grid.len()];
            for (row, column) in (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (row, column))) {
                marks[grid.index(column, row)] = within(column, row, radius);
            }
            marks
        };
        let mut before = matrix(grid, |column, row| if within(column, row, 10.0) { 1.0 } else { 1e3 });
        before.restrict(ActiveColumns::marked(grid, &marks(10.0)));
        let mut preconditioner = Preconditioner::new(&before, true);
        let mut now = matrix(grid, |column, row| 1.0 + (column * row) as f64);
        now.restrict(ActiveColumns::marked(grid, &marks(13.0)));
        preconditioner.prepare(&now);

        let taking_part: Vec<usize> = (0..grid.rows)
            .flat_map(|row| {
                now.active().row(row).iter().flat_map(move |r| grid.index(r.start, row)..grid.index(r.end, row))
            })
            .collect();
        assert!(taking_part.len() > 200 && taking_part.len() < 1000, "{}", taking_part.len());
        let all = ActiveColumns::all(grid);
        let column_of = |at: usize| {
            let (mut unit, mut image, mut full) = (grid.zeros(), grid.zeros(), now.clone());
            full.restrict(all.clone());
            unit[at] = 1.0;
            full.apply(&unit, &mut image);
            image
        };
        let mut x = grid.zeros();
        grid.indices().for_each(|at| x[at] = 0.5);
        let b: Vec<f64> = (0..grid.len()).map(|at| if grid.indices().any(|i| i == at) { 1.0 } else { 0.0 }).collect();
        let outside: Vec<usize> = grid.indices().filter(|at| !taking_part.contains(at)).collect();
        let mut right = b.clone();
        for &at in &outside {
            column_of(at).iter().zip(&mut right).for_each(|(entry, right)| *right -= 0.5 * entry);
        }
        let n = taking_part.len();
        let columns: Vec<Vec<f64>> = taking_part.iter().map(|&at| column_of(at)).collect();
        let dense = DMatrix::from_fn(n, n, |i, j| columns[j][taking_part[i]]);
        let exact = dense.cholesky().unwrap().solve(&DVector::from_fn(n, |i, _| right[taking_part[i]]));
        let mut solver = ConjugateGradients::new(&now);
        let found = solver.solve(&now, &preconditioner, &b, &mut x, 1e-13, 100).unwrap();
        assert!(found.iterations < 30, "{found:?}");
        for (i, &at) in taking_part.iter().enumerate() {
            approx::assert_abs_diff_eq!(x[at], exact[i], epsilon = 1e-12);
        }
        assert!(outside.iter().all(|&at| x[at] == 0.5));
    }
}
