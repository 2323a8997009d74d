//! Dense matrices of the solver's operators, for eigenvalues that do not come from its own iteration.

use fisura::dynamics::critical_step::StiffnessOperator;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::linear_algebra::stencil::Stencil;
use fisura::phase_field::assembly::{Constant, Integrand, add_form};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::{StudyError, other};
use crate::watch::{self, Stopped};

/// The matrix of a linear map on `n` numbers.
///
/// # Errors
/// If the case is to stop.
pub fn matrix(n: usize, mut map: impl FnMut(&[f64], &mut [f64])) -> Result<DMatrix<f64>, Stopped> {
    let mut matrix = DMatrix::zeros(n, n);
    let (mut unit, mut image) = (vec![0.0; n], vec![0.0; n]);
    for column in 0..n {
        watch::check()?;
        unit[column] = 1.0;
        map(&unit, &mut image);
        matrix.set_column(column, &DVector::from_column_slice(&image));
        unit[column] = 0.0;
    }
    Ok(matrix)
}

/// Angular frequencies of a body with the mass it has, increasing.
///
/// # Errors
/// If the case is to stop, or the mass is not positive definite.
pub fn frequencies(frame: &TotalFrame) -> Result<Vec<f64>, StudyError> {
    let mut operator = frame.stiffness_operator();
    let n = operator.size();
    let stiffness = matrix(n, |x, out| operator.stiffness(x, out))?;
    let inverse_mass = matrix(n, |x, out| operator.divide_by_mass(x, out))?;
    let factor = inverse_mass.cholesky().ok_or_else(indefinite)?.l();
    Ok(frequencies_of(factor.transpose() * stiffness * factor))
}

/// The same with the consistent mass of `density` (kg/m³), also where a body cuts spans: masses are scaled to
/// a unit diagonal before they are factored, so that next to nothing in a span stays well conditioned.
///
/// # Errors
/// As [`frequencies`].
pub fn frequencies_of_consistent_mass(frame: &TotalFrame, density: f64) -> Result<Vec<f64>, StudyError> {
    let mut operator = frame.stiffness_operator();
    let free = operator.free.clone();
    let n = free.len();
    let lattice = &frame.lattice;
    let mut stencil = Stencil::zeros(lattice.grid, lattice.degree);
    add_form(&mut stencil, lattice, Integrand::Mass, &Constant(density));
    let mass = matrix(n, |x, out| {
        let (mut field, mut image) = ([lattice.grid.zeros(), lattice.grid.zeros()], lattice.grid.zeros());
        free.iter().zip(x).for_each(|(&(at, component), x)| field[component][at] = *x);
        for (component, field) in field.iter().enumerate() {
            stencil.apply(field, &mut image);
            let own = free.iter().zip(&mut *out).filter(|((_, c), _)| *c == component);
            own.for_each(|(&(at, _), out)| *out = image[at]);
        }
    })?;
    let stiffness = matrix(n, |x, out| operator.stiffness(x, out))?;
    let scale = DMatrix::from_diagonal(&mass.diagonal().map(|m| 1.0 / m.sqrt()));
    let (mass, stiffness) = (&scale * mass * &scale, &scale * stiffness * &scale);
    let reduced = mass.cholesky().and_then(|factor| {
        let lower = factor.l();
        let half = lower.solve_lower_triangular(&stiffness)?;
        lower.solve_lower_triangular(&half.transpose())
    });
    reduced.map(frequencies_of).ok_or_else(indefinite)
}

fn indefinite() -> StudyError {
    other("the mass is not positive definite")
}

/// The largest of frequencies that increase.
pub fn highest(frequencies: &[f64]) -> f64 {
    frequencies.last().copied().unwrap_or(f64::NAN)
}

/// Roots of the eigenvalues, increasing; those that round-off makes negative have none and come first.
fn frequencies_of(matrix: DMatrix<f64>) -> Vec<f64> {
    let mut squares: Vec<f64> = SymmetricEigen::new(matrix).eigenvalues.iter().copied().collect();
    squares.sort_by(f64::total_cmp);
    squares.into_iter().map(f64::sqrt).collect()
}
