//! Matrices of the phase field: entries against plain sums over the points, and the same bits for any thread
//! count.

use crate::common::plain_points::PerPoint;
use crate::common::{body, graded_knots, rectangle, with_threads};
use fisura::linear_algebra::extremes::larger;
use fisura::linear_algebra::stencil::Stencil;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::assembly::{Constant, Integrand, add_form};
use fisura::phase_field::integrate_shape_functions;
use fisura::scene::*;
use fisura::splines::patch::Patch;

fn compare(mesh: &Mesh, body: &Body, skip: Option<usize>) {
    let name = format!("degree {:?}, {:?}, {:?}", mesh.degree, body.particles_per_cell, body.shape);
    let patch = Patch::new(mesh);
    let lattice = Lattice::new(&patch, body);
    let grid = lattice.grid;
    let coefficients = PerPoint::new(&lattice, skip);
    for form in [Integrand::Mass, Integrand::Diffusion, Integrand::Anisotropic([1.3, 0.7, -0.4])] {
        let mut matrix = Stencil::zeros(grid, lattice.degree);
        add_form(&mut matrix, &lattice, form, &coefficients);
        let mut expected = vec![0.0; matrix.coefficients().len()];
        lattice.for_each_point(|batch, lane, position, weight| {
            let (row, tile, ..) = lattice.unbatch(batch);
            if coefficients.skips(lattice.batch(row, tile, 0, 0)) {
                return;
            }
            let coefficient = weight * coefficients.values[batch][lane];
            let functions = [0, 1].map(|d| {
                let space = &patch.spaces[d];
                let span = space.find_span(position[d]).unwrap();
                (space.spans()[span].first, space.shape_functions(span, position[d]))
            });
            let [(column, x), (row, y)] = &functions;
            for (j, offset_rows) in
                (0..=lattice.degree[1]).flat_map(|j| (0..=lattice.degree[1] - j).map(move |o| (j, o)))
            {
                for (i, l) in (0..=lattice.degree[0]).flat_map(|i| (0..=lattice.degree[0]).map(move |l| (i, l))) {
                    if offset_rows == 0 && l < i {
                        continue;
                    }
                    let m = j + offset_rows;
                    let product = match form {
                        Integrand::Mass => x.value[i] * y.value[j] * x.value[l] * y.value[m],
                        Integrand::Diffusion => {
                            x.derivative[i] * y.value[j] * x.derivative[l] * y.value[m]
                                + x.value[i] * y.derivative[j] * x.value[l] * y.derivative[m]
                        }
                        Integrand::Anisotropic([xx, yy, xy]) => {
                            let [ax, ay] = [x.derivative[i] * y.value[j], x.value[i] * y.derivative[j]];
                            let [bx, by] = [x.derivative[l] * y.value[m], x.value[l] * y.derivative[m]];
                            ax * (xx * bx + xy * by) + ay * (xy * bx + yy * by)
                        }
                    };
                    let coupling = Stencil::offset_index(lattice.degree, l as isize - i as isize, offset_rows);
                    let at = (row + j) * matrix.row_length() + coupling * grid.stride + grid.index(column + i, 0);
                    expected[at] += coefficient * product;
                }
            }
        });
        let largest = expected.iter().fold(0.0, |m: f64, e| larger(m, e.abs()));
        assert!(largest > 0.0, "{name}");
        for (at, (seen, expected)) in matrix.coefficients().iter().zip(&expected).enumerate() {
            assert!((seen - expected).abs() <= 1e-13 * largest, "{name}, {form:?}: {at} is {seen} for {expected}");
        }
    }
}

#[test]
fn entries_are_sums_over_the_points() {
    for degree in 1..=4 {
        for points in [1, 2, 3, 5] {
            let body = body(rectangle([0.0; 2], [1.9, 1.8]), [points; 2]);
            compare(&Mesh::uniform([degree; 2], [0.0; 2], [1.9, 1.8], [19, 18]), &body, None);
        }
    }
    for (degree, points) in [([1, 4], [2, 3]), ([3, 2], [1, 4]), ([2, 3], [3, 2])] {
        let body = body(rectangle([0.013, 0.27], [1.55, 1.71]), points);
        compare(&Mesh::uniform(degree, [0.0; 2], [1.9, 1.8], [19, 18]), &body, None);
    }
}

#[test]
fn entries_on_graded_and_repeated_knots_and_in_a_disk() {
    for degree in 2..=4 {
        let knots = [graded_knots(degree, 19, &[3, 8, 9]), graded_knots(degree, 21, &[1, 2, 3, 17])];
        let end = [knots[0][knots[0].len() - 1], knots[1][knots[1].len() - 1]];
        compare(&Mesh::of_knots([degree; 2], knots), &body(rectangle([0.0; 2], end), [2, 3]), None);
        let disk = Shape::Disk { center: [0.91, 0.8], radius: 0.6 };
        compare(&Mesh::uniform([degree; 2], [0.0; 2], [1.9, 1.8], [19, 18]), &body(disk, [2; 2]), None);
    }
}

#[test]
fn spans_without_a_coefficient_are_left_out() {
    let mesh = Mesh::uniform([2; 2], [0.0; 2], [1.9, 1.8], [19, 18]);
    compare(&mesh, &body(rectangle([0.0; 2], [1.9, 1.8]), [2; 2]), Some(3));
}

#[test]
fn two_threads_give_the_bits_of_one() {
    for degree in 1..=4 {
        let patch = Patch::new(&Mesh::uniform([degree; 2], [0.0; 2], [2.0, 9.7], [20, 97]));
        let lattice = Lattice::new(&patch, &body(rectangle([0.0; 2], [2.0, 9.7]), [2; 2]));
        assert!(lattice.strips() > 8, "more strips than threads");
        let coefficients = PerPoint::new(&lattice, None);
        let assemble = || {
            let mut matrix = Stencil::zeros(lattice.grid, lattice.degree);
            add_form(&mut matrix, &lattice, Integrand::Diffusion, &coefficients);
            let bits: Vec<u64> = matrix.coefficients().iter().map(|c| c.to_bits()).collect();
            bits
        };
        let one = with_threads(1, assemble);
        for _ in 0..5 {
            assert!(with_threads(2, assemble) == one && with_threads(5, assemble) == one, "degree {degree}");
        }
    }
}

/// Row sums of the mass matrix are the integrals of the shape functions, which add up to the area.
#[test]
fn row_sums_are_integrals_of_the_shape_functions() {
    for degree in 1..=4 {
        let patch = Patch::new(&Mesh::uniform([degree; 2], [0.0; 2], [1.9, 1.8], [19, 18]));
        let lattice = Lattice::new(&patch, &body(rectangle([0.013, 0.27], [1.55, 1.71]), [3; 2]));
        let mut matrix = Stencil::zeros(lattice.grid, lattice.degree);
        add_form(&mut matrix, &lattice, Integrand::Mass, &Constant(1.0));
        let (mut ones, mut sums) = (lattice.grid.zeros(), lattice.grid.zeros());
        lattice.grid.indices().for_each(|at| ones[at] = 1.0);
        let area = matrix.apply(&ones, &mut sums);
        approx::assert_relative_eq!(area, 1.537 * 1.44, max_relative = 1e-13);
        for (sum, integral) in sums.iter().zip(integrate_shape_functions(&lattice)) {
            approx::assert_abs_diff_eq!(*sum, integral, epsilon = 1e-16);
        }
    }
}
