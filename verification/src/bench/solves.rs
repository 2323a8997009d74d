//! The phase-field solve of a cold crack: incomplete Cholesky against a plain Jacobi preconditioner and a
//! direct solver.
//!
//! The length scale is one span or two, which is what decides how many iterations a plain solver needs: ids
//! are `solves/p<degree>/l<spans>/<solver>`. One matrix, one start (c = 1 everywhere), one tolerance, one
//! thread. The incomplete factors count as part of their solve, and so does the numeric factorisation of the
//! direct one; its symbolic part is done once and left out.

use fisura::linear_algebra::cholesky::SparseCholesky;
use fisura::linear_algebra::conjugate_gradients::{ConjugateGradients, Remaining};
use fisura::linear_algebra::preconditioner::Preconditioner;
use fisura::linear_algebra::stencil::Stencil;
use fisura::phase_field::integrate_shape_functions;

use super::block::{Block, SPAN, cracked_scene};
use super::record::BenchRecord;
use super::timing::{Contestant, pool, round_robin, timed};
use super::{BenchError, Settings};
use crate::extremes::smallest;

/// Error of the phase field in the norm of `solver.phase_field_tolerance`.
const TOLERANCE: f64 = 2e-6;
/// Largest number of iterations of a solve.
const LIMIT: usize = 5000;

/// Times the solvers.
///
/// # Errors
/// If the block cannot be prepared.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let cells = if settings.quick { 128 } else { 320 };
    pool(1)?.install(|| {
        let mut records = Vec::new();
        for (degree, spans) in [(2, 1), (2, 2), (3, 1), (3, 2)] {
            let system = System::new(&block(degree, cells, spans)?);
            let contestants = system.contestants(&format!("p{degree}/l{spans}"))?;
            records.extend(round_robin(contestants, settings.rounds(), settings.budget())?);
        }
        Ok(records)
    })
}

/// The cracked block with a length scale of some spans.
fn block(degree: usize, cells: usize, spans: usize) -> Result<Block, BenchError> {
    let mut scene = cracked_scene(degree, 2, cells, 0);
    for fracture in scene.materials.values_mut().filter_map(|material| material.fracture.as_mut()) {
        fracture.length_scale = spans as f64 * SPAN;
    }
    Block::of(scene)
}

/// Linear system of the phase field of a block with a seeded crack, and the start of its solution.
struct System {
    matrix: Stencil,
    load: Vec<f64>,
    start: Vec<f64>,
    /// What the energy norm of the matrix is divided by, m: 2 l0.
    unit: f64,
}

/// A way to solve: improves the start, and says how many iterations that took.
type Solver<'a> = Box<dyn FnMut(&mut Vec<f64>) -> usize + 'a>;

impl System {
    fn new(block: &Block) -> Self {
        let (matrix, _) = block.matrix();
        let mut start = matrix.grid.zeros();
        matrix.grid.indices().for_each(|at| start[at] = 1.0);
        let materials = block.scene.materials.values();
        let unit = 2.0 * smallest(materials.filter_map(|m| m.fracture.as_ref()).map(|f| f.length_scale));
        Self { matrix, load: integrate_shape_functions(&block.lattice), start, unit }
    }

    fn contestants(&self, system: &str) -> Result<Vec<Contestant<'_>>, BenchError> {
        let Self { matrix, load, .. } = self;
        let mut workspace = ConjugateGradients::new(matrix);
        let mut factor = Preconditioner::new(matrix, false);
        let mut cholesky = SparseCholesky::default();
        let singular = || BenchError::other("the matrix of the phase field is not positive definite");
        let mut exact = self.start.clone();
        cholesky.solve(matrix, load, &mut exact).ok_or_else(singular)?;
        let tolerance = self.unit * TOLERANCE;
        // of the solver alone: neither the matrix nor the load and the solution
        let memory = [factor.bytes() + workspace.bytes(), 4 * 8 * load.len(), cholesky_bytes(matrix)?];
        let incomplete: Solver = Box::new(move |x| {
            factor.renew(matrix);
            workspace.solve(matrix, &factor, load, x, tolerance, LIMIT).map_or(LIMIT, |found| found.iterations)
        });
        let jacobi: Solver = Box::new(move |x| jacobi(matrix, load, x, tolerance, LIMIT));
        let direct: Solver = Box::new(move |x| cholesky.solve(matrix, load, x).map_or(usize::MAX, |()| 1));
        let named = [
            ("incomplete-cholesky", "conjugate gradients, incomplete Cholesky", incomplete),
            ("jacobi", "conjugate gradients, Jacobi", jacobi),
            ("cholesky", "sparse Cholesky (faer)", direct),
        ];
        let all = named.into_iter().zip(memory);
        Ok(all
            .map(|((name, label, solver), bytes)| {
                self.contestant(&format!("solves/{system}/{name}"), label, solver, bytes, exact.clone())
            })
            .collect())
    }

    fn contestant<'a>(
        &'a self,
        id: &str,
        label: &str,
        mut solver: Solver<'a>,
        bytes: usize,
        exact: Vec<f64>,
    ) -> Contestant<'a> {
        let grid = self.matrix.grid;
        let mut record = BenchRecord::new(id, label, 1.0, "solve").with("unknowns", grid.columns * grid.rows);
        record.memory_bytes = bytes as u64;
        let run = move |record: &mut BenchRecord| {
            let mut x = self.start.clone();
            let (sample, iterations) = timed(|| solver(&mut x));
            record.parameters.insert("iterations".into(), iterations.into());
            record.verify_at_most("error against a direct solution", self.error(&x, &exact), 2.0 * TOLERANCE);
            Ok(sample)
        };
        Contestant { record, run: Box::new(run) }
    }

    /// Energy norm of `x − exact` over 2 l0.
    fn error(&self, x: &[f64], exact: &[f64]) -> f64 {
        let error: Vec<f64> = x.iter().zip(exact).map(|(x, exact)| x - exact).collect();
        self.matrix.apply(&error, &mut self.matrix.grid.zeros()).sqrt() / self.unit
    }
}

/// Heap memory of the factors, bytes.
fn cholesky_bytes(matrix: &Stencil) -> Result<usize, BenchError> {
    let factor = SparseCholesky::default().factor(matrix, &[]);
    factor.map(|f| f.bytes()).ok_or_else(|| BenchError::other("the matrix of the phase field is not positive definite"))
}

/// Conjugate gradients preconditioned by the diagonal: improves `x` until its error in the energy norm is
/// about `tolerance`, and counts the iterations.
fn jacobi(matrix: &Stencil, b: &[f64], x: &mut [f64], tolerance: f64, limit: usize) -> usize {
    let grid = matrix.grid;
    let mut inverse = grid.zeros();
    for at in grid.indices() {
        inverse[at] = 1.0 / matrix.diagonal(at);
    }
    let (mut image, mut direction) = (grid.zeros(), grid.zeros());
    matrix.apply(x, &mut image);
    let mut residual: Vec<f64> = b.iter().zip(&image).map(|(b, a)| b - a).collect();
    let square = |residual: &[f64]| residual.iter().zip(&inverse).map(|(r, d)| r * r * d).sum::<f64>();
    let (mut rho, mut beta) = (square(&residual), 0.0);
    let mut remaining = Remaining::from_start(rho);
    for iterations in 0..limit {
        if remaining.estimate.sqrt() <= tolerance {
            return iterations;
        }
        for ((d, r), inverse) in direction.iter_mut().zip(&residual).zip(&inverse) {
            *d = r * inverse + beta * *d;
        }
        let alpha = rho / matrix.apply(&direction, &mut image);
        for (((x, r), d), image) in x.iter_mut().zip(&mut residual).zip(&direction).zip(&image) {
            *x += alpha * d;
            *r -= alpha * image;
        }
        remaining.learn(alpha * rho);
        let previous = std::mem::replace(&mut rho, square(&residual));
        beta = rho / previous;
    }
    limit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_three_solvers_find_the_same_phase_field() {
        let system = System::new(&Block::new(2, 2, 16, 0).unwrap());
        let records = round_robin(system.contestants("p2/l1").unwrap(), 1, 1.0).unwrap();
        assert!(records.iter().all(|r| r.verified), "{records:?}");
        let iterations: Vec<f64> = records.iter().map(|r| r.number("iterations").unwrap()).collect();
        assert!(iterations[0] < iterations[1] && iterations[2] == 1.0, "{iterations:?}");
    }
}
