//! A mass matrix with its penalty, and conjugate gradients on it.

use super::kronecker::Kronecker;
use super::penalty::Penalty;
use super::weak::Weak;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::stencil::Stencil;
use crate::splines::patch::Patch;

/// A control point with less than this part of the mass it would have within the body is weak.
const WEAK: f64 = 0.3;
/// Most iterations of a solve.
const LIMIT: usize = 300;

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
    /// The mass matrix, to be assembled.
    pub matrix: Stencil,
    penalty: Penalty,
    weight: f64,
    marks: Vec<bool>,
    scale: Vec<f64>,
    weak: Weak,
    /// Sum of the diagonal, kg/m.
    mass: f64,
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

impl MassSystem {
    /// The zero matrix on a patch, with a penalty of weight w, kg/m.
    pub(crate) fn new(patch: &Patch, weight: f64) -> Self {
        let grid = patch.control_grid();
        let zeros = || grid.zeros();
        Self {
            matrix: Stencil::zeros(grid, patch.spaces.each_ref().map(|space| space.degree())),
            penalty: Penalty::new(patch),
            weight,
            marks: Vec::new(),
            scale: zeros(),
            weak: Weak::default(),
            mass: 0.0,
            residual: zeros(),
            preconditioned: zeros(),
            direction: zeros(),
            image: zeros(),
        }
    }

    /// Takes the marked control points, once the matrix is assembled.
    pub(crate) fn begin(&mut self, kronecker: &Kronecker, marks: Vec<bool>, held: &[Vec<usize>; 2]) {
        let Self { matrix, penalty, weight, scale, .. } = self;
        let grid = matrix.grid;
        if marks != self.marks {
            penalty.restrict(grid, &marks);
            self.marks = marks;
        }
        let mut mass = grid.zeros();
        for at in grid.indices().filter(|&at| self.marks[at]) {
            mass[at] = matrix.diagonal(grid.column_of(at), grid.row_of(at));
        }
        self.mass = mass.iter().sum();
        let mut diagonal = mass.clone();
        penalty.add_diagonal(*weight, &mut diagonal);
        scale.fill(0.0);
        let weak = kronecker.scale([&mass, &diagonal], WEAK, held, scale);
        self.weak = Weak::new(&weak, matrix, penalty, *weight);
    }

    /// Whether a control point takes part.
    pub(crate) fn takes(&self, at: usize) -> bool {
        self.marks.get(at).is_some_and(|mark| *mark)
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.matrix.bytes() + 5 * 8 * self.scale.len() + self.marks.len()
    }

    /// Solves `A x = b` for both components; those of `held` keep their values. The error in the norm of the
    /// preconditioner falls below `tolerance` times that of a start from zero, or below that of `round_off`
    /// all over the body: one that moves as it is has nothing else.
    ///
    /// # Errors
    /// If the iterations do not converge.
    pub(crate) fn solve(
        &mut self,
        kronecker: &Kronecker,
        b: &VectorField,
        x: &mut VectorField,
        held: [&[usize]; 2],
        Accuracy { tolerance, round_off }: Accuracy,
    ) -> Result<(), SolveFailure> {
        let floor = self.mass * round_off * round_off;
        (0..2).try_for_each(|c| self.solve_component(kronecker, &b[c], &mut x[c], held[c], [tolerance, floor]))
    }

    fn solve_component(
        &mut self,
        kronecker: &Kronecker,
        b: &[f64],
        x: &mut [f64],
        held: &[usize],
        [tolerance, floor]: [f64; 2],
    ) -> Result<(), SolveFailure> {
        let Self { matrix, penalty, weight, marks, scale, weak, residual, preconditioned, direction, image, .. } = self;
        let mut scale = std::mem::take(scale);
        let kept: Vec<f64> = held.iter().map(|&at| std::mem::replace(&mut scale[at], 0.0)).collect();
        let mut precondition = |r: &[f64], z: &mut [f64]| -> f64 {
            weak.eliminate(r, z);
            kronecker.apply(&scale, z);
            weak.substitute(r, z);
            r.iter().zip(&*z).map(|(r, z)| r * z).sum()
        };
        x.iter_mut().zip(&*marks).for_each(|(x, mark)| *x = if *mark { *x } else { 0.0 });
        let apply = |x: &[f64], out: &mut [f64]| matrix.apply(x, out) + penalty.add(*weight, x, out);
        let from_zero = precondition(b, preconditioned);
        apply(x, image);
        residual.iter_mut().zip(b).zip(&*image).for_each(|((r, b), image)| *r = b - image);
        let mut rho = precondition(residual, preconditioned);
        direction.copy_from_slice(preconditioned);
        let mut iterations = 0;
        let mut outcome = Ok(());
        loop {
            if rho <= larger(tolerance * tolerance * from_zero, floor) {
                break;
            }
            let curvature = apply(direction, image);
            if !curvature.is_finite() {
                outcome = Err(SolveFailure::NotFinite);
                break;
            } else if curvature <= 0.0 {
                outcome = Err(SolveFailure::NotPositiveDefinite);
                break;
            } else if iterations == LIMIT {
                outcome = Err(SolveFailure::NotConverged { iterations, error: rho.sqrt() });
                break;
            }
            let alpha = rho / curvature;
            x.iter_mut().zip(&*direction).for_each(|(x, d)| *x += alpha * d);
            residual.iter_mut().zip(&*image).for_each(|(r, image)| *r -= alpha * image);
            let previous = std::mem::replace(&mut rho, precondition(residual, preconditioned));
            let beta = rho / previous;
            direction.iter_mut().zip(&*preconditioned).for_each(|(d, z)| *d = z + beta * *d);
            iterations += 1;
        }
        held.iter().zip(kept).for_each(|(&at, kept)| scale[at] = kept);
        self.scale = scale;
        outcome
    }
}
