//! Points of patches with a geometry: sweep, assembly and integrals against plain sums over the NURBS basis
//! itself, with knots whose spans differ by up to 100, weights from 0.1 to 10, and degrees that differ
//! between the directions.

use crate::common::plain_points::{PerPoint, PlainPoint, assert_close, largest, plain_points, stress_of, swept};
use crate::common::{Random, annulus, bent_patch, body, random_patch};
use fisura::linear_algebra::lane::Lane;
use fisura::linear_algebra::stencil::Stencil;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::assembly::{Integrand, add_form};
use fisura::scene::*;
use fisura::splines::nurbs::NurbsPatch;
use fisura::splines::patch::Patch;
use fisura::transfer::point_kernel::Fields;

/// Round-off of sums over rational functions of weights 100 apart: 1e-13 of the largest entry.
const ROUND_OFF: f64 = 1e-13;

fn compare(name: &str, nurbs: &NurbsPatch, counts: [usize; 2], layout: Layout) {
    let patch = Patch::new(&Mesh::of(nurbs));
    let mut body = body(Shape::Patch, counts);
    body.layout = layout;
    let lattice = Lattice::new(&patch, &body);
    let (grid, points) = (lattice.grid, plain_points(nurbs, &lattice, &body));
    assert_eq!(lattice.count(), points.len(), "{name}");
    let mut random = Random::new(7);
    let [ux, uy, phase] = [(); 3].map(|()| random.field(grid, 1.0));
    let (seen, forces) = swept::<false>(&lattice, Fields { displacement: [&ux, &uy], phase: &phase });

    let [mut seen_gradient, mut gradient, mut seen_value, mut value] = [(); 4].map(|()| Vec::new());
    let [mut seen_weight, mut weight] = [(); 2].map(|()| Vec::new());
    let mut expected = [grid.zeros(), grid.zeros()];
    for p in &points {
        let (seen_w, values) = &seen[p.batch];
        let ((_, x), (_, y), (c, c_gradient)) =
            (p.interpolate(grid, &ux), p.interpolate(grid, &uy), p.interpolate(grid, &phase));
        seen_gradient.extend(values.phase_gradient.map(|g| g[p.lane]));
        gradient.extend(c_gradient);
        seen_gradient.extend(values.gradient.map(|g| g[p.lane]));
        gradient.extend([x, y].concat());
        seen_value.extend([values.phase[p.lane], lattice.position(p.batch, p.lane)[0]]);
        seen_value.push(lattice.position(p.batch, p.lane)[1]);
        value.extend([c, p.position[0], p.position[1]]);
        seen_weight.push(seen_w[p.lane]);
        weight.push(p.weight);
        let [xx, xy, yx, yy] = stress_of([x[0], x[1], y[0], y[1]].map(Lane::splat)).map(|s| s[0]);
        for (n, at, _) in p.terms(grid) {
            let [dx, dy] = p.gradients[n];
            expected[0][at] += p.weight * (xx * dx + xy * dy);
            expected[1][at] += p.weight * (yx * dx + yy * dy);
        }
    }
    assert_close(&format!("{name}: values and positions"), &seen_value, &value, ROUND_OFF);
    assert_close(&format!("{name}: gradients"), &seen_gradient, &gradient, ROUND_OFF);
    assert_close(&format!("{name}: weights"), &seen_weight, &weight, ROUND_OFF);
    for d in 0..2 {
        assert_close(&format!("{name}: forces {d}"), &forces[d], &expected[d], ROUND_OFF);
        let total: f64 = forces[d].iter().sum();
        assert!(total.abs() <= 1e-12 * largest(&expected[d]), "{name}: forces inside a body add up to {total:e}");
    }
    check_functions(name, &lattice, &points);
    check_integrals(name, &lattice, &points);
    check_assembly(name, &lattice, &points);
}

fn check_functions(name: &str, lattice: &Lattice, points: &[PlainPoint]) {
    let [mut seen, mut expected, mut seen_gradient, mut gradient] = [(); 4].map(|()| Vec::new());
    for p in points {
        let functions = lattice.shape_functions(p.batch);
        for n in 0..p.functions.count {
            seen.push(functions.value[n][p.lane]);
            expected.push(p.functions.value[n]);
            seen_gradient.extend(functions.gradient[n].map(|g| g[p.lane]));
            gradient.extend(p.gradients[n]);
        }
    }
    assert_close(&format!("{name}: shape functions"), &seen, &expected, ROUND_OFF);
    assert_close(&format!("{name}: their gradients"), &seen_gradient, &gradient, ROUND_OFF);
}

fn check_integrals(name: &str, lattice: &Lattice, points: &[PlainPoint]) {
    let grid = lattice.grid;
    let f = |[x, y]: [f64; 2]| 1.0 + 2.0 * x - y * y;
    let s = |[x, y]: [f64; 2]| [x - 3.0 * y, 0.5 + x * y];
    let (mut volume, mut both) = (grid.zeros(), [grid.zeros(), grid.zeros()]);
    for p in points {
        let (force, stress) = (f(p.position), s(p.position));
        for (n, at, value) in p.terms(grid) {
            volume[at] += p.weight * force * value;
            both[0][at] += p.weight * (force * value + stress[0] * p.gradients[n][0] + stress[1] * p.gradients[n][1]);
            both[1][at] += p.weight * (stress[1] * p.gradients[n][0] - stress[0] * p.gradients[n][1]);
        }
    }
    assert_close(&format!("{name}: integrate"), &lattice.integrate(|_, _, x| f(x)), &volume, ROUND_OFF);
    let mut seen = [grid.zeros(), grid.zeros()];
    let [x, y] = &mut seen;
    lattice.add_integral(&mut [x, y], |_, _, at| {
        let [a, b] = s(at);
        ([f(at), 0.0], [[a, b], [b, -a]])
    });
    for d in 0..2 {
        assert_close(&format!("{name}: add_integral {d}"), &seen[d], &both[d], ROUND_OFF);
    }
}

/// The matrix times random fields: an entry that is wrong, missing or misplaced moves the product.
fn check_assembly(name: &str, lattice: &Lattice, points: &[PlainPoint]) {
    let grid = lattice.grid;
    let mut random = Random::new(3);
    let coefficients = PerPoint::new(lattice, Some(3));
    for form in [Integrand::Mass, Integrand::Diffusion, Integrand::Anisotropic([1.3, 0.7, -0.4])] {
        let mut matrix = Stencil::zeros(grid, lattice.degree);
        add_form(&mut matrix, lattice, form, &coefficients);
        let field = random.field(grid, 1.0);
        let (mut seen, mut expected) = (grid.zeros(), grid.zeros());
        for p in points {
            let (row, tile, ..) = lattice.unbatch(p.batch);
            if coefficients.skips(lattice.batch(row, tile, 0, 0)) {
                continue;
            }
            let scale = p.weight * coefficients.values[p.batch][p.lane];
            let (value, gradient) = p.interpolate(grid, &field);
            for (n, at, function) in p.terms(grid) {
                expected[at] += scale
                    * match form {
                        Integrand::Mass => function * value,
                        Integrand::Diffusion => p.gradients[n][0] * gradient[0] + p.gradients[n][1] * gradient[1],
                        Integrand::Anisotropic([xx, yy, xy]) => {
                            let [x, y] = gradient;
                            p.gradients[n][0] * (xx * x + xy * y) + p.gradients[n][1] * (xy * x + yy * y)
                        }
                    };
            }
        }
        matrix.apply(&field, &mut seen);
        assert_close(&format!("{name}: {form:?} matrix"), &seen, &expected, ROUND_OFF);
    }
}

#[test]
fn degrees_points_and_weights() {
    for degree in 1..=4 {
        for points in [1, 2, 3, 5] {
            let seed = (10 * degree + points) as u64;
            let patch = random_patch([degree; 2], [11, 10], seed);
            compare(&format!("degree {degree}, {points} points"), &patch, [points; 2], Layout::Gauss);
        }
    }
}

#[test]
fn mixed_degrees_points_and_layouts() {
    let mixed = [([1, 4], [2, 5]), ([4, 1], [5, 1]), ([2, 3], [3, 2]), ([3, 2], [1, 4]), ([4, 3], [2, 3])];
    for (n, (degree, points)) in mixed.into_iter().enumerate() {
        let patch = random_patch(degree, [9, 18], 100 + n as u64);
        compare(&format!("degree {degree:?}, {points:?} points"), &patch, points, Layout::Uniform);
    }
}

#[test]
fn any_number_of_columns_and_rows() {
    for (n, spans) in [[1, 1], [1, 9], [8, 1], [7, 8], [17, 2], [3, 25]].into_iter().enumerate() {
        let degree = 1 + n % 4;
        let patch = random_patch([degree; 2], spans, 200 + n as u64);
        compare(&format!("{spans:?} spans"), &patch, [2; 2], Layout::Maclaurin);
    }
    compare("an annulus", &annulus(2, 9), [3; 2], Layout::Gauss);
    compare("a polynomial patch", &bent_patch(3, 9), [3; 2], Layout::Gauss);
}

/// A displacement linear in the position has one strain at every point of any patch.
#[test]
fn a_linear_displacement_is_one_strain() {
    for degree in 1..=4 {
        for seed in 0..4 {
            let nurbs = random_patch([degree, 1 + (degree + seed as usize) % 4], [9, 7], 300 + seed);
            let patch = Patch::new(&Mesh::of(&nurbs));
            let lattice = Lattice::new(&patch, &body(Shape::Patch, [3; 2]));
            let [x, y] = patch.control_positions();
            let linear = |a: f64, b: f64| -> Vec<f64> { x.iter().zip(&y).map(|(x, y)| a * x + b * y).collect() };
            let (ux, uy, c) = (linear(0.3, -0.7), linear(0.2, 0.5), linear(-0.4, 0.9));
            let (seen, _) = swept::<false>(&lattice, Fields { displacement: [&ux, &uy], phase: &c });
            let exact = [0.3, -0.7, 0.2, 0.5, -0.4, 0.9];
            lattice.for_each_point(|batch, lane, position, _| {
                let values = &seen[batch].1;
                let found = values.gradient.into_iter().chain(values.phase_gradient).map(|g| g[lane]);
                for (found, exact) in found.zip(exact) {
                    assert!((found - exact).abs() <= 1e-12, "degree {degree}: {found} for {exact} at {position:?}");
                }
                assert!((values.phase[lane] + 0.4 * position[0] - 0.9 * position[1]).abs() <= 1e-13);
            });
        }
    }
}
