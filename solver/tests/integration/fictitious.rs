//! The fictitious material under the phase field of moving points.

use crate::common::body;
use fisura::dynamics::updated_frame::fictitious::{FictitiousMaterial, WEIGHT};
use fisura::linear_algebra::extremes::larger;
use fisura::linear_algebra::stencil::Stencil;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::assembly::{Constant, Integrand, add_form};
use fisura::scene::{Mesh, Shape};
use fisura::splines::patch::Patch;

/// Points that fill the patch, with weights that integrate its functions exactly, make the same system times
/// α.
#[test]
fn it_is_a_body_that_fills_the_patch() {
    for degree in 1..=4 {
        let patch = Patch::new(&Mesh::uniform([degree; 2], [0.1, -0.2], [1.2, 0.7], [6, 9]));
        let (lattice, diffusion) = (Lattice::new(&patch, &body(Shape::Patch, [degree + 1; 2])), 0.37);
        let mut matrix = Stencil::zeros(lattice.grid, lattice.degree);
        let mut expected = matrix.clone();
        add_form(&mut expected, &lattice, Integrand::Mass, &Constant(WEIGHT));
        add_form(&mut expected, &lattice, Integrand::Diffusion, &Constant(WEIGHT * diffusion));
        let mut load = vec![f64::NAN; lattice.grid.len()];
        FictitiousMaterial::new(&patch, diffusion).begin(&mut matrix, &mut load);
        let expected_load = lattice.integrate(|_, _, _| WEIGHT);
        let largest = expected.coefficients().iter().fold(0.0, |m: f64, x| larger(m, x.abs()));
        let couplings =
            (0..lattice.grid.rows).flat_map(|row| (0..matrix.offsets().len()).map(move |offset| (row, offset)));
        for (row, offset) in couplings {
            for column in 0..lattice.grid.columns {
                let at = lattice.grid.index(column, 0);
                let (found, expected) = (matrix.row(row, offset)[at], expected.row(row, offset)[at]);
                assert!((found - expected).abs() <= 1e-14 * largest, "p = {degree}: {found} for {expected}");
            }
        }
        for at in lattice.grid.indices() {
            approx::assert_relative_eq!(load[at], expected_load[at], max_relative = 1e-13);
        }
    }
}
