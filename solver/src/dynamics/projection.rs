//! Least-squares projection of a function onto the spline space, with the consistent mass of the material
//! points.
//!
//! `Σ_J M_IJ u_J = Σ_p V_p N_I(x_p) f(x_p)`: the discrete least-squares fit at the points, of order p + 1 for
//! every layout.

use crate::linear_algebra::cholesky::{Factor, SparseCholesky};
use crate::linear_algebra::stencil::Stencil;
use crate::particles::lattice::Lattice;
use crate::phase_field::assembly::{Constant, Integrand, add_form};

/// Projector on the points of one lattice.
#[derive(Debug)]
pub struct Projection<'a> {
    lattice: &'a Lattice,
    factor: Factor,
}

impl<'a> Projection<'a> {
    /// Factors the mass matrix; fields are zero at the `held` control points, and at those whose functions
    /// see no point. `None` if the points do not determine a field, as with fewer than p + 1 of them in some
    /// span, or where control points have copies.
    pub fn new(lattice: &'a Lattice, held: &[usize]) -> Option<Self> {
        if !lattice.sheets.is_empty() {
            return None;
        }
        let mut matrix = Stencil::zeros(lattice.grid, lattice.degree);
        add_form(&mut matrix, lattice, Integrand::Mass, &Constant(1.0));
        let grid = lattice.grid;
        let is_empty = |at: &usize| matrix.diagonal(*at) == 0.0;
        let out: Vec<usize> = held.iter().copied().chain(grid.indices().filter(is_empty)).collect();
        Some(Self { lattice, factor: SparseCholesky::default().factor(&matrix, &out)? })
    }

    /// Control values of the projection of a function of position (m).
    pub fn project(&self, function: impl Fn([f64; 2]) -> f64 + Sync) -> Vec<f64> {
        let right = self.lattice.integrate(|_, _, position| function(position));
        let mut field = self.lattice.grid.zeros();
        self.factor.solve(&right, &mut field);
        field
    }
}
