//! The solvers of the phase-field system: incomplete Cholesky, conjugate gradients, sparse Cholesky.

use crate::common::{Random, body, fracture_model, rectangle};
use fisura::linear_algebra::cholesky::SparseCholesky;
use fisura::linear_algebra::conjugate_gradients::{ConjugateGradients, SolveFailure};
use fisura::linear_algebra::control_grid::ControlGrid;
use fisura::linear_algebra::extremes::larger;
use fisura::linear_algebra::incomplete_cholesky::IncompleteCholesky;
use fisura::linear_algebra::lane::Lane;
use fisura::linear_algebra::preconditioner::Preconditioner;
use fisura::linear_algebra::stencil::Stencil;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::assembly::{Constant, Integrand, PointCoefficients, add_form};
use fisura::scene::*;
use fisura::splines::patch::Patch;
use nalgebra::{DMatrix, DVector};

/// Round-off of a factor that is kept in single precision (6e-8), with room for the condition of the matrices
/// here.
const SINGLE: f64 = 2e-6;
/// Span of the test meshes, m: the length scale of the model.
const SPAN: f64 = 0.25e-3;

/// Reaction coefficient 1, and `contrast` within a span of a horizontal line from the left.
struct Crack<'a> {
    lattice: &'a Lattice,
    contrast: f64,
}

impl PointCoefficients for Crack<'_> {
    fn span(&self, first: usize, weights: &[Lane], out: &mut [Lane]) -> bool {
        let [_, top] = self.lattice.position(self.lattice.batches() - 1, 0);
        for (i, weight) in weights.iter().enumerate() {
            out[i] = *weight;
            for lane in 0..8 {
                let [x, y] = self.lattice.position(first + i, lane);
                if (y - 0.5 * top).abs() < 0.5 * SPAN && x < 10.0 * SPAN {
                    out[i][lane] *= self.contrast;
                }
            }
        }
        true
    }
}

/// The phase-field matrix of a plate with a crack whose reaction is `contrast` times that of the rest.
fn phase_field_matrix(degree: usize, cells: [usize; 2], contrast: f64) -> Stencil {
    let size = [SPAN * cells[0] as f64, SPAN * cells[1] as f64];
    let patch = Patch::new(&Mesh::uniform([degree; 2], [0.0; 2], size, cells));
    let lattice = Lattice::new(&patch, &body(rectangle([0.0; 2], size), [degree.max(2); 2]));
    let mut matrix = Stencil::zeros(lattice.grid, lattice.degree);
    add_form(&mut matrix, &lattice, Integrand::Mass, &Crack { lattice: &lattice, contrast });
    add_form(&mut matrix, &lattice, Integrand::Diffusion, &Constant(fracture_model().diffusion()));
    matrix
}

fn dense(matrix: &Stencil) -> DMatrix<f64> {
    let grid = matrix.grid;
    let n = grid.columns * grid.rows;
    let mut full = DMatrix::zeros(n, n);
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            for (index, offset) in matrix.offsets().iter().enumerate() {
                let (other_row, other) = (row + offset.rows, column as isize + offset.columns);
                if other_row < grid.rows && (0..grid.columns as isize).contains(&other) {
                    let value = matrix.row(row, index)[grid.index(column, 0)];
                    let (i, j) = (row * grid.columns + column, other_row * grid.columns + other as usize);
                    full[(i, j)] = value;
                    full[(j, i)] = value;
                }
            }
        }
    }
    full
}

fn packed(grid: ControlGrid, field: &[f64]) -> DVector<f64> {
    DVector::from_iterator(grid.columns * grid.rows, grid.indices().map(|at| field[at]))
}

/// Largest difference of two fields over the largest value of the first.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let scale = a.iter().fold(0.0, |m: f64, a| larger(m, a.abs()));
    a.iter().zip(b).fold(0.0, |m: f64, (a, b)| larger(m, (a - b).abs())) / scale
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `z = M⁻¹ r` with a factor, which works in single precision on the matrix times its unit, and `r·z`.
fn preconditioned(factor: &IncompleteCholesky, matrix: &Stencil, r: &[f64]) -> (Vec<f64>, f64) {
    let single: Vec<f32> = r.iter().map(|r| *r as f32).collect();
    let mut out = vec![0.0; r.len()];
    let product = factor.apply(matrix.active(), &single, &mut out);
    (out.iter().map(|z| factor.unit * f64::from(*z)).collect(), factor.unit * product)
}

/// Banded matrices on one row of control points, where nothing falls outside the stencil, and on rows that
/// are not coupled to each other, of which every block solves its own.
#[test]
fn without_fill_the_factor_is_exact() {
    for (degree, columns, rows) in [(1, 43, 1), (2, 43, 1), (3, 43, 1), (4, 43, 1), (3, 21, 61)] {
        let grid = ControlGrid::new(columns, rows);
        let mut matrix = Stencil::zeros(grid, [degree, degree.min(rows)]);
        let mut random = Random::new(degree as u64);
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            for ahead in 1..=degree.min(columns - 1 - column) {
                let at = row * matrix.row_length() + ahead * grid.stride + grid.index(column, 0);
                matrix.coefficients_mut()[at] = random.next();
            }
            matrix.set_diagonal(matrix.grid.index(column, row), 2.0 * degree as f64 + 0.1);
        }
        let r = random.field(grid, 1.0);
        let (x, product) = preconditioned(&IncompleteCholesky::new(&matrix, false), &matrix, &r);
        let exact = dense(&matrix).cholesky().expect("positive definite").solve(&packed(grid, &r));
        for (i, at) in grid.indices().enumerate() {
            approx::assert_abs_diff_eq!(x[at], exact[i], epsilon = SINGLE * exact.amax());
        }
        approx::assert_relative_eq!(product, inner(&r, &x), max_relative = SINGLE);
    }
}

#[test]
fn the_preconditioner_is_symmetric_and_positive_definite() {
    for degree in 1..=4 {
        for (contrast, scaled) in [(1.0, false), (1e3, false), (1e6, false), (1.0, true), (1e6, true)] {
            let matrix = phase_field_matrix(degree, [31, 57], contrast);
            let factor = IncompleteCholesky::new(&matrix, scaled);
            let mut random = Random::new(11);
            for _ in 0..20 {
                let (r, s) = (random.field(matrix.grid, 1.0), random.field(matrix.grid, 1.0));
                let (x, product) = preconditioned(&factor, &matrix, &r);
                assert!(product > 0.0, "degree {degree}, contrast {contrast}: r·z = {product}");
                approx::assert_relative_eq!(product, inner(&r, &x), max_relative = SINGLE);
                let (y, _) = preconditioned(&factor, &matrix, &s);
                let scale = (inner(&x, &x) * inner(&s, &s)).sqrt();
                approx::assert_abs_diff_eq!(inner(&s, &x), inner(&r, &y), epsilon = SINGLE * scale);
            }
        }
    }
}

/// The matrix of a plate with a crack, the load of one without and the solution of the direct solver.
fn cracked_system(degree: usize, contrast: f64) -> (Stencil, Vec<f64>, Vec<f64>) {
    let matrix = phase_field_matrix(degree, [31, 57], contrast);
    let [mut b, mut ones, mut direct] = [(); 3].map(|()| matrix.grid.zeros());
    matrix.grid.indices().for_each(|at| ones[at] = 1.0);
    phase_field_matrix(degree, [31, 57], 1.0).apply(&ones, &mut b);
    SparseCholesky::default().solve(&matrix, &b, &mut direct).expect("positive definite");
    (matrix, b, direct)
}

#[test]
fn conjugate_gradients_reach_the_solution_of_the_direct_solver() {
    for degree in 1..=4 {
        for contrast in [1.0, 1e3, 1e6] {
            let (matrix, b, direct) = cracked_system(degree, contrast);
            let mut x = matrix.grid.zeros();
            let factor = Preconditioner::new(&matrix, false);
            let mut solver = ConjugateGradients::new(&matrix);
            let unit = fracture_model().diffusion().sqrt();
            for tolerance in [1e-3, 1e-6, 1e-9, 1e-11] {
                let outcome = solver.solve(&matrix, &factor, &b, &mut x, unit * tolerance, 500).expect("it converges");
                let [estimate, error] = [outcome.error, energy_norm(&matrix, &direct, &x)].map(|e| e / unit);
                let text =
                    format!("degree {degree}, contrast {contrast}, tolerance {tolerance:e}: {outcome:?}, {error:e}");
                assert!(estimate <= tolerance && error <= 2.0 * tolerance, "{text}");
                assert!(outcome.iterations <= 60, "{text}");
            }
            assert!(difference(&direct, &x) <= 1e-10, "degree {degree}: {:e}", difference(&direct, &x));
            let again = solver.solve(&matrix, &factor, &b, &mut x, 1e-10 * unit, 500).expect("it converges");
            let needed = usize::from(!factor.judges_starts());
            assert_eq!(again.iterations, needed, "a start that meets the tolerance is kept, if the factor can tell");
        }
    }
}

/// A reaction of 1e10 at four points of a span with nine functions: rounded to single precision, the matrix
/// is not positive definite any more.
#[test]
fn where_single_precision_fails_double_precision_goes_on() {
    for contrast in [1e7, 1e8, 1e9, 1e10] {
        let (matrix, b, direct) = cracked_system(2, contrast);
        let (mut x, size) = (matrix.grid.zeros(), inner(&b, &direct).sqrt());
        let mut solver = ConjugateGradients::new(&matrix);
        let before = solver.bytes();
        let factor = Preconditioner::new(&matrix, false);
        let found = solver.solve(&matrix, &factor, &b, &mut x, 1e-6 * size, 500);
        let outcome = found.unwrap_or_else(|failure| panic!("contrast {contrast:e}: {failure}"));
        let error = energy_norm(&matrix, &direct, &x) / size;
        // the estimate is as good as the factor: in double precision alone the errors are up to 4.6e-5
        assert!(error <= 1e-4, "contrast {contrast:e}: {outcome:?}, {error:e}");
        assert!(contrast < 1e10 || solver.bytes() > before, "it takes double precision");
    }
}

/// `‖a − b‖` in the energy norm of the matrix.
fn energy_norm(matrix: &Stencil, a: &[f64], b: &[f64]) -> f64 {
    let error: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    matrix.apply(&error, &mut matrix.grid.zeros()).sqrt()
}

#[test]
fn systems_without_a_solution_say_why() {
    let mut matrix = phase_field_matrix(2, [13, 11], 1.0);
    let b = Random::new(2).field(matrix.grid, 1.0);
    let mut solver = ConjugateGradients::new(&matrix);
    let factor = Preconditioner::new(&matrix, false);
    let mut solve = |matrix: &Stencil, b: &[f64], limit| {
        solver.solve(matrix, &factor, b, &mut matrix.grid.zeros(), 1e-12, limit).unwrap_err()
    };
    let short = solve(&matrix, &b, 2);
    assert!(matches!(short, SolveFailure::NotConverged { iterations: 2, error } if error > 1e-12), "{short:?}");
    let mut broken = b.clone();
    broken[matrix.grid.index(3, 3)] = f64::NAN;
    assert_eq!(solve(&matrix, &broken, 500), SolveFailure::NotFinite);
    matrix.set_diagonal(matrix.grid.index(4, 4), -1.0);
    assert_eq!(solve(&matrix, &b, 500), SolveFailure::NotPositiveDefinite);
}

/// Complete factors serve for a while; then the incomplete one is tried again, and less often while it stays
/// poor.
#[test]
fn complete_factors_take_over_and_go_back() {
    let matrix = phase_field_matrix(3, [31, 57], 1e6);
    let b = Random::new(5).field(matrix.grid, 1.0);
    let mut exact = matrix.grid.zeros();
    SparseCholesky::default().solve(&matrix, &b, &mut exact).expect("positive definite");
    let size = inner(&b, &exact).sqrt(); // in the energy norm
    let mut solver = ConjugateGradients::new(&matrix);
    let mut solve = |preconditioner: &Preconditioner| {
        let mut x = matrix.grid.zeros();
        solver.solve(&matrix, preconditioner, &b, &mut x, 1e-9 * size, 500).expect("it converges").iterations
    };
    let mut preconditioner = Preconditioner::new(&matrix, false);
    let incomplete = solve(&preconditioner);
    preconditioner.learn(incomplete);
    assert_eq!(solve(&preconditioner), incomplete, "so few iterations call for nothing");
    preconditioner.renew(&matrix);
    for pause in [16, 32, 64, 128, 256, 512, 512] {
        preconditioner.prepare(&matrix);
        assert!(!preconditioner.is_complete(), "the incomplete factor is tried before a pause of {pause}");
        assert!(preconditioner.improve(&matrix), "its patience is over");
        assert!(preconditioner.is_complete() && !preconditioner.improve(&matrix), "there is nothing beyond it");
        for _ in 0..pause {
            preconditioner.prepare(&matrix);
            assert!(preconditioner.is_complete());
        }
        // nine digits are three corrections in single precision; in each an iteration solves, and one more
        // finds nothing left but round-off
        assert!(solve(&preconditioner) <= 6, "the factor is exact");
    }
    preconditioner.prepare(&matrix);
    preconditioner.learn(incomplete);
    assert_eq!(solve(&preconditioner), incomplete, "the incomplete factor is good again, and stays");
    preconditioner.prepare(&matrix);
    assert!(!preconditioner.is_complete());
    assert!(preconditioner.improve(&matrix) && !preconditioner.is_complete(), "first a stale factor is made anew");
}

/// A matrix that is none any more has no complete factor: an incomplete one takes its place, never none.
#[test]
fn a_complete_factor_that_fails_becomes_incomplete() {
    let mut matrix = phase_field_matrix(2, [13, 11], 1.0);
    let mut preconditioner = Preconditioner::new(&matrix, false);
    assert!(preconditioner.improve(&matrix) && preconditioner.is_complete());
    let sound = matrix.diagonal(matrix.grid.index(4, 4));
    matrix.set_diagonal(matrix.grid.index(4, 4), -1.0);
    preconditioner.prepare(&matrix);
    assert!(!preconditioner.is_complete() && preconditioner.bytes() > 0);
    assert!(!preconditioner.improve(&matrix), "there is nothing better");
    matrix.set_diagonal(matrix.grid.index(4, 4), sound);
    assert!(preconditioner.improve(&matrix) && preconditioner.is_complete());
}

/// Kershaw's ring of four (1978): positive definite, but the coupling that is dropped makes the last pivot
/// negative.
#[test]
fn a_factor_whose_pivot_falls_is_shifted() {
    let grid = ControlGrid { columns: 3, rows: 3, stride: 24 };
    let mut matrix = Stencil::zeros(grid, [1, 1]);
    (0..9).for_each(|n| matrix.set_diagonal(matrix.grid.index(n % 3, n / 3), if n % 2 == 1 { 3.0 } else { 1.0 }));
    for (column, row, columns, value) in [(1, 0, -1, -2.0), (1, 0, 1, 2.0), (0, 1, 1, -2.0), (2, 1, -1, -2.0)] {
        let offset = Stencil::offset_index([1, 1], columns, 1);
        let at = row * matrix.row_length() + offset * grid.stride + grid.index(column, 0);
        matrix.coefficients_mut()[at] = value;
    }
    // On the stencil the factor is the matrix with its diagonal times 1 + s. The last pivot is positive for 3
    // (1 + s) > √12.
    let factor = IncompleteCholesky::new(&matrix, false);
    let mut inverse = DMatrix::zeros(9, 9);
    for (n, at) in grid.indices().enumerate() {
        let mut unit = grid.zeros();
        unit[at] = 1.0;
        let (column, _) = preconditioned(&factor, &matrix, &unit);
        inverse.set_column(n, &packed(grid, &column));
    }
    let (product, full) = (inverse.try_inverse().expect("a factor that is not singular"), dense(&matrix));
    let shift = product[(1, 1)] / 3.0 - 1.0;
    assert!(shift > (12f64.sqrt() / 3.0 - 1.0) && shift < 0.7, "{shift}");
    for (i, j) in (0..9).flat_map(|i| (0..9).map(move |j| (i, j))) {
        let expected = if i == j { (1.0 + shift) * full[(i, i)] } else { full[(i, j)] };
        let dropped = [(3, 5), (5, 3)].contains(&(i, j));
        assert!(
            dropped || (product[(i, j)] - expected).abs() <= SINGLE,
            "({i}, {j}): {} for {expected}",
            product[(i, j)]
        );
    }
    let mut random = Random::new(3);
    let exact = full.cholesky().expect("positive definite");
    let b = random.field(grid, 1.0);
    let (mut x, preconditioner) = (grid.zeros(), Preconditioner::new(&matrix, false));
    assert!(!preconditioner.judges_starts(), "the factor is that of a matrix with a diagonal raised by {shift}");
    ConjugateGradients::new(&matrix).solve(&matrix, &preconditioner, &b, &mut x, 1e-13, 20).expect("it converges");
    let exact = exact.solve(&packed(grid, &b));
    grid.indices()
        .zip(exact.iter())
        .for_each(|(at, exact)| approx::assert_relative_eq!(x[at], *exact, max_relative = 1e-11));
}

#[test]
fn sparse_cholesky_agrees_with_a_dense_one() {
    let mut solver = SparseCholesky::default();
    for contrast in [1.0, 1e6] {
        let matrix = phase_field_matrix(3, [13, 11], contrast);
        let b = Random::new(2).field(matrix.grid, 1.0);
        let mut x = matrix.grid.zeros();
        solver.solve(&matrix, &b, &mut x).expect("positive definite");
        let exact = dense(&matrix).cholesky().expect("positive definite").solve(&packed(matrix.grid, &b));
        for (i, at) in matrix.grid.indices().enumerate() {
            approx::assert_abs_diff_eq!(x[at], exact[i], epsilon = 1e-10 * exact.amax());
        }
    }
    let mut indefinite = phase_field_matrix(3, [13, 11], 1.0);
    indefinite.set_diagonal(indefinite.grid.index(4, 4), -1.0);
    let b = indefinite.grid.zeros();
    assert_eq!(solver.solve(&indefinite, &b, &mut b.clone()), None, "an indefinite matrix is refused");
}
