//! The mass matrix of the control points, `M_IJ = Σ_p m_p N_I(x_p) N_J(x_p)` (E 14), or its row sums.
//!
//! The lumped mass converges with order 2 whatever the degree, the consistent one with p + 1. The consistent
//! matrix is factored once; prescribed components and control points without mass leave the system, and their
//! acceleration is zero.

use rayon::prelude::*;

use crate::dynamics::failure::Failure;
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::cholesky::{Factor, SparseCholesky};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::stencil::Stencil;
use crate::particles::lattice::Lattice;
use crate::phase_field::assembly::{Constant, Integrand, add_form};
use crate::scene;

/// Row sums below this fraction of the largest give no acceleration; their control points keep their
/// velocity. In a corner of a cut span, shape functions of such a mass are lost in round-off.
const NEGLIGIBLE: f64 = 1e-17;

/// Control points that a thread takes at least.
const CHUNK: usize = 4096;

/// Mass per unit thickness, kg/m.
#[derive(Debug, Clone)]
pub struct MassMatrix {
    /// Row sums, kg/m: the mass of each control point.
    pub row_sums: Vec<f64>,
    /// Row sums up to this, kg/m, are taken for none.
    negligible: f64,
    kind: MassKind,
}

#[derive(Debug, Clone)]
enum MassKind {
    /// Inverse row sums, zero where negligible.
    Lumped {
        inverse: Vec<f64>,
    },
    Consistent(Box<Consistent>),
}

#[derive(Debug, Clone)]
struct Consistent {
    matrix: Stencil,
    /// One for both components, or one for each.
    factors: Vec<Factor>,
}

impl MassMatrix {
    /// Mass of a body of `density` (kg/m³) whose components of velocity are prescribed at the `held` control
    /// points.
    ///
    /// # Errors
    /// If the consistent matrix is singular to round-off. Validation refuses too few points per span, which
    /// make it so exactly.
    pub fn new(lattice: &Lattice, density: f64, mass: scene::Mass, held: [Vec<usize>; 2]) -> Result<Self, Failure> {
        let mut row_sums = lattice.integrate(|_, _, _| 1.0);
        row_sums.iter_mut().for_each(|m| *m *= density);
        lattice.sheets.fold(&mut row_sums);
        let negligible = NEGLIGIBLE * row_sums.iter().copied().fold(0.0, larger);
        let kind = match fault!("mass-lumped", mass => scene::Mass::Lumped) {
            scene::Mass::Lumped => {
                let inverse = row_sums.iter().map(|&m| if m > negligible { 1.0 / m } else { 0.0 }).collect();
                MassKind::Lumped { inverse }
            }
            scene::Mass::Consistent => {
                let empty: Vec<usize> = lattice.grid.indices().filter(|&at| row_sums[at] <= negligible).collect();
                let consistent = Consistent::new(lattice, density, held, &empty).ok_or(Failure::SingularMass)?;
                MassKind::Consistent(Box::new(consistent))
            }
        };
        Ok(Self { row_sums, negligible, kind })
    }

    /// Takes other row sums (kg/m) of a lumped mass.
    pub(crate) fn set_row_sums(&mut self, row_sums: Vec<f64>) {
        if let MassKind::Lumped { inverse } = &mut self.kind {
            let of = |(inverse, &m): (&mut f64, &f64)| *inverse = if m > self.negligible { 1.0 / m } else { 0.0 };
            inverse.iter_mut().zip(&row_sums).for_each(of);
        }
        self.row_sums = row_sums;
    }

    /// Forces become accelerations: `M⁻¹ f`, zero where held (consistent mass) or without mass.
    pub(crate) fn divide(&self, forces: &mut VectorField) {
        for (component, force) in forces.iter_mut().enumerate() {
            match &self.kind {
                MassKind::Lumped { inverse } => {
                    force.par_iter_mut().zip(inverse).with_min_len(CHUNK).for_each(|(f, inverse)| *f *= inverse);
                }
                MassKind::Consistent(consistent) => {
                    let right = force.to_vec();
                    consistent.factors[component % consistent.factors.len()].solve(&right, force);
                }
            }
        }
    }

    /// [`Self::divide`] where control points are in use.
    pub(crate) fn divide_in_use(&self, in_use: &ActiveColumns, grid: ControlGrid, forces: &mut VectorField) {
        let MassKind::Lumped { inverse } = &self.kind else { return self.divide(forces) };
        for force in forces {
            in_use.for_each_part(grid, [force], |used, [force]| {
                force.iter_mut().zip(&inverse[used]).for_each(|(f, inverse)| *f *= inverse);
            });
        }
    }

    /// `out = M x` for one component.
    pub fn multiply(&self, x: &[f64], out: &mut [f64]) {
        match &self.kind {
            MassKind::Lumped { .. } => out.iter_mut().zip(x).zip(&self.row_sums).for_each(|((o, x), m)| *o = m * x),
            MassKind::Consistent(consistent) => drop(consistent.matrix.apply(x, out)),
        }
    }

    /// `M x` at a control point, for one component; the lumped mass multiplies only where it is asked.
    pub(crate) fn product<'a>(&'a self, x: &'a [f64]) -> impl Fn(usize) -> f64 + 'a {
        let image = match &self.kind {
            MassKind::Lumped { .. } => None,
            MassKind::Consistent(consistent) => {
                let mut image = consistent.matrix.grid.zeros();
                consistent.matrix.apply(x, &mut image);
                Some(image)
            }
        };
        move |at| image.as_ref().map_or_else(|| self.row_sums[at] * x[at], |image| image[at])
    }

    /// `½ vᵀ M v` of a vector field v: the kinetic energy (J/m) if v is a velocity.
    pub(crate) fn half_square(&self, v: &VectorField) -> f64 {
        match &self.kind {
            MassKind::Lumped { .. } => {
                let squares = self.row_sums.iter().zip(v[0].iter().zip(&v[1]));
                squares.map(|(m, (x, y))| 0.5 * m * (x * x + y * y)).sum()
            }
            MassKind::Consistent(consistent) => {
                let mut image = consistent.matrix.grid.zeros();
                v.iter().map(|v| 0.5 * consistent.matrix.apply(v, &mut image)).sum()
            }
        }
    }

    /// Whether a control point can be accelerated.
    pub fn moves(&self, at: usize) -> bool {
        self.row_sums[at] > self.negligible
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        let kind = match &self.kind {
            MassKind::Lumped { inverse } => 8 * inverse.len(),
            MassKind::Consistent(consistent) => {
                consistent.matrix.bytes() + consistent.factors.iter().map(Factor::bytes).sum::<usize>()
            }
        };
        8 * self.row_sums.len() + kind
    }
}

impl Consistent {
    /// None if the matrix is not positive definite.
    fn new(lattice: &Lattice, density: f64, held: [Vec<usize>; 2], empty: &[usize]) -> Option<Self> {
        let mut matrix = Stencil::zeros(lattice.grid, lattice.degree);
        add_form(&mut matrix, lattice, Integrand::Mass, &Constant(density));
        let mut cholesky = SparseCholesky::default(); // one symbolic factorisation for all
        let mut factor = |held: &[usize]| {
            let out: Vec<usize> = held.iter().chain(empty).copied().collect();
            cholesky.factor(&matrix, &out)
        };
        let factors =
            if held[0] == held[1] { vec![factor(&held[0])?] } else { vec![factor(&held[0])?, factor(&held[1])?] };
        Some(Self { matrix, factors })
    }
}
