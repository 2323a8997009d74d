//! Fictitious material under the phase field of moving points: the finite cell method (Parvizian, Düster and
//! Rank 2007).
//!
//! Where a body is cut, or drawn out once it is broken, a span holds fewer points than functions: the points
//! leave combinations of control values open that vanish at all of them, and the system is singular to
//! round-off. The whole part of the patch is therefore filled with intact material of `WEIGHT` times the
//! body's,
//!
//! ```text
//! K0_IJ = α ∫ (N_I N_J + 4 l0² grad N_I · grad N_J) dx,   load0_I = α ∫ N_I dx
//! ```
//!
//! which gives such combinations smooth values, holds control points without material at c = 1, and changes
//! the phase field of the points by O(α). Over a rectangle the integrals are products of those of either
//! direction.

use rayon::prelude::*;

use crate::linear_algebra::stencil::{Offset, Stencil};
use crate::scene::Layout;
use crate::splines::patch::Patch;
use crate::splines::quadrature::Rule;
use crate::splines::spline::{MAX_ORDER, SplineSpace};

/// Its weight α, against that of the body.
pub const WEIGHT: f64 = 1e-6;

/// Integrals over the whole part of the patch.
#[derive(Debug, Clone)]
pub struct FictitiousMaterial {
    directions: [Integrals; 2],
    diffusion: f64,
}

/// Integrals of one direction: of the functions, and of the products of each with itself and those after it.
#[derive(Debug, Clone)]
struct Integrals {
    value: Vec<f64>,
    product: Vec<[f64; MAX_ORDER]>,
    slope_product: Vec<[f64; MAX_ORDER]>,
}

impl FictitiousMaterial {
    /// Of a part of the patch; `diffusion` is `4 l0²`, m².
    pub fn new(patch: &Patch, diffusion: f64) -> Self {
        Self { directions: [0, 1].map(|d| Integrals::of(&patch.spaces[d])), diffusion }
    }

    /// Sets a system to that of the fictitious material alone.
    pub fn begin(&self, matrix: &mut Stencil, load: &mut [f64]) {
        let (grid, row_length) = (matrix.grid, matrix.row_length());
        let heaviness = fault!("fictitious-material-heavy", WEIGHT => 1.0);
        let offsets = matrix.offsets().to_vec();
        let rows = matrix.coefficients_mut().par_chunks_mut(row_length).zip(load.par_chunks_mut(grid.stride));
        rows.enumerate().for_each(|(row, (coefficients, load))| {
            let lead = grid.index(0, 0);
            let [x, y] = &self.directions;
            for (coefficients, &Offset { columns, rows }) in coefficients.chunks_mut(grid.stride).zip(&offsets) {
                let value = heaviness * y.product[row][rows];
                let (in_x, in_y) = (self.diffusion * value, self.diffusion * heaviness * y.slope_product[row][rows]);
                for column in 0..grid.columns {
                    let Some(first) = column.checked_add_signed(columns.min(0)) else { continue };
                    let (product, slope) =
                        (x.product[first][columns.unsigned_abs()], x.slope_product[first][columns.unsigned_abs()]);
                    coefficients[lead + column] = (value + in_y) * product + in_x * slope;
                }
            }
            for column in 0..grid.columns {
                load[lead + column] = heaviness * x.value[column] * y.value[row];
            }
        });
    }
}

impl Integrals {
    fn of(space: &SplineSpace) -> Self {
        let (functions, order) = (space.dimension(), space.degree() + 1);
        let zeros = vec![[0.0; MAX_ORDER]; functions];
        let mut integrals = Self { value: vec![0.0; functions], product: zeros.clone(), slope_product: zeros };
        let rule = Rule::new(Layout::Gauss, order);
        for (number, span) in space.spans().iter().enumerate() {
            for (at, weight) in rule.points.iter().zip(&rule.weights) {
                let shape = space.shape_functions(number, span.left + at * span.length());
                let weight = weight * span.length();
                for k in 0..order {
                    integrals.value[span.first + k] += weight * shape.value[k];
                    for l in k..order {
                        let pair = (span.first + k, l - k);
                        integrals.product[pair.0][pair.1] += weight * shape.value[k] * shape.value[l];
                        integrals.slope_product[pair.0][pair.1] += weight * shape.derivative[k] * shape.derivative[l];
                    }
                }
            }
        }
        integrals
    }
}
