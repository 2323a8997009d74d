//! The sweep over the lattice against a plain evaluation point by point.

use crate::common::plain_points::{assert_close, largest, stress_of, swept};
use crate::common::{Random, body, graded_knots, rectangle};
use fisura::linear_algebra::extremes::larger;
use fisura::linear_algebra::lane::Lane;
use fisura::particles::lattice::Lattice;
use fisura::scene::*;
use fisura::splines::patch::Patch;
use fisura::transfer::point_kernel::Fields;

/// Compares one sweep with the plain evaluation point by point, to 1e-13 of the largest value; returns points
/// and their total area.
fn compare(mesh: &Mesh, body: &Body) -> (usize, f64) {
    let name = format!("degree {:?}, {:?}, {:?}", mesh.degree, body.particles_per_cell, body.shape);
    let patch = Patch::new(mesh);
    let lattice = Lattice::new(&patch, body);
    let mut random = Random::new(7);
    let [ux, uy, phase] = [(); 3].map(|()| random.field(lattice.grid, 1.0));
    let (seen, forces) = swept::<true>(&lattice, Fields { displacement: [&ux, &uy], phase: &phase });
    let mut found: [Vec<f64>; 3] = Default::default(); // gradients of the displacement, of c, and c
    let mut expected = found.clone();
    let mut plain = [lattice.grid.zeros(), lattice.grid.zeros()];
    let (mut area, mut lost) = (0.0, 0.0);
    lattice.for_each_point(|batch, lane, position, weight| {
        let (seen_weight, values) = &seen[batch];
        assert_eq!(seen_weight[lane], weight);
        let [x, y, c] = [&ux, &uy, &phase].map(|field| patch.evaluate(field, position).unwrap());
        let gradient = [x.gradient[0], x.gradient[1], y.gradient[0], y.gradient[1]];
        found[0].extend(values.gradient.map(|g| g[lane]));
        expected[0].extend(gradient);
        found[1].extend(values.phase_gradient.map(|g| g[lane]));
        expected[1].extend(c.gradient);
        found[2].push(values.phase[lane]);
        expected[2].push(c.value);
        let term = weight - lost; // compensated: thousands of weights must add up to the last digits
        lost = (area + term - area) - term;
        area += term;
        let [xx, xy, yx, yy] = stress_of(gradient.map(Lane::splat)).map(|s| s[0]);
        let [x, y] = &patch.spaces;
        let (i, j) = (x.find_span(position[0]).unwrap(), y.find_span(position[1]).unwrap());
        let (sx, sy) = (x.shape_functions(i, position[0]), y.shape_functions(j, position[1]));
        for l in 0..=y.degree() {
            for k in 0..=x.degree() {
                let at = lattice.grid.index(x.spans()[i].first + k, y.spans()[j].first + l);
                let (dx, dy) = (sx.derivative[k] * sy.value[l], sx.value[k] * sy.derivative[l]);
                plain[0][at] += weight * (xx * dx + xy * dy);
                plain[1][at] += weight * (yx * dx + yy * dy);
            }
        }
    });
    for (what, (found, expected)) in ["gradients", "phase gradients", "phase"].iter().zip(found.iter().zip(&expected)) {
        assert_close(&format!("{name}: {what}"), found, expected, 1e-13);
    }
    let largest = plain.iter().map(|plain| largest(plain)).fold(0.0, larger);
    for (seen, expected) in forces.iter().zip(&plain) {
        for (at, (seen, expected)) in seen.iter().zip(expected).enumerate() {
            assert!((seen - expected).abs() <= 1e-13 * largest, "{name}: force {at} is {seen} for {expected}");
        }
        let total: f64 = seen.iter().sum();
        assert!(total.abs() <= 1e-12 * largest, "{name}: forces inside a body add up to {total}");
    }
    (expected[2].len(), area)
}

fn mesh(degree: [usize; 2], size: [f64; 2], cells: [usize; 2]) -> Mesh {
    Mesh::uniform(degree, [0.0; 2], size, cells)
}

#[test]
fn degrees_and_points_per_span() {
    for degree in 1..=4 {
        for points in 1..=5 {
            let (count, area) =
                compare(&mesh([degree; 2], [1.3, 0.9], [13, 9]), &body(rectangle([0.0; 2], [1.3, 0.9]), [points; 2]));
            assert_eq!(count, 13 * 9 * points * points);
            approx::assert_relative_eq!(area, 1.3 * 0.9, max_relative = 1e-14);
        }
    }
}

#[test]
fn mixed_degrees_and_points() {
    for (degree, points) in [([1, 4], [2, 5]), ([4, 1], [5, 1]), ([2, 3], [3, 2]), ([3, 2], [1, 4]), ([4, 3], [2, 3])] {
        compare(&mesh(degree, [2.1, 1.0], [21, 10]), &body(rectangle([0.0; 2], [2.1, 1.0]), points));
    }
}

#[test]
fn any_number_of_columns_and_rows() {
    for cells in [1, 2, 7, 8, 9, 15, 16, 17, 24, 25] {
        for other in [1, 8, 17] {
            for degree in 1..=3 {
                let size = [0.1 * cells as f64, 0.1 * other as f64];
                compare(&mesh([degree; 2], size, [cells, other]), &body(rectangle([0.0; 2], size), [2; 2]));
                let turned = [size[1], size[0]];
                compare(&mesh([degree; 2], turned, [other, cells]), &body(rectangle([0.0; 2], turned), [2; 2]));
            }
        }
    }
}

#[test]
fn graded_and_repeated_knots() {
    for degree in 1..=4 {
        for repeated in [&[][..], &[3, 8, 9], &[1, 2, 3, 4, 5, 6]] {
            let knots = [graded_knots(degree, 19, repeated), graded_knots(degree, 21, repeated)];
            let end = [knots[0][knots[0].len() - 1], knots[1][knots[1].len() - 1]];
            let (_, area) = compare(&Mesh::of_knots([degree; 2], knots), &body(rectangle([0.0; 2], end), [3, 2]));
            approx::assert_relative_eq!(area, end[0] * end[1], max_relative = 1e-14);
        }
    }
}

/// Knots of multiplicity p, where the basis is only continuous: rows of spans then advance by p control rows
/// at once.
#[test]
fn knots_repeated_to_continuity() {
    for degree in 2..=4 {
        let mut knots = vec![0.0; degree + 1];
        for i in 1..18 {
            knots.extend(std::iter::repeat_n(0.1 * f64::from(i), if i % 3 == 0 { degree } else { 1 }));
        }
        knots.extend(vec![1.8; degree + 1]);
        let mesh = Mesh::of_knots([degree; 2], [knots.clone(), knots]);
        compare(&mesh, &body(rectangle([0.0; 2], [1.8; 2]), [2; 2]));
    }
}

#[test]
fn a_rectangle_cuts_spans_exactly() {
    for degree in 1..=4 {
        for layout in [Layout::Gauss, Layout::Uniform, Layout::Maclaurin] {
            for (min, max) in [
                ([0.013, 0.27], [1.291, 0.901]),
                ([0.3, 0.0], [0.9, 1.0]),
                ([0.41, 0.41], [0.43, 0.45]),
                ([0.0999, 0.1], [1.2001, 0.95]),
            ] {
                let mut body = body(rectangle(min, max), [3; 2]);
                body.layout = layout;
                let (_, area) = compare(&mesh([degree; 2], [1.3, 1.0], [13, 10]), &body);
                approx::assert_relative_eq!(area, (max[0] - min[0]) * (max[1] - min[1]), max_relative = 1e-14);
            }
        }
    }
}

#[test]
fn the_boundary_of_a_disk_cuts_spans() {
    for degree in 1..=4 {
        let shape = Shape::Disk { center: [0.61, 0.5], radius: 0.37 };
        let mesh = mesh([degree; 2], [1.3, 1.0], [26, 20]);
        let (_, area) = compare(&mesh, &body(shape.clone(), [3; 2]));
        approx::assert_relative_eq!(area, std::f64::consts::PI * 0.37 * 0.37, max_relative = 1e-12);
        let lattice = Lattice::new(&Patch::new(&mesh), &body(shape.clone(), [3; 2]));
        lattice.for_each_point(|_, _, position, _| assert!(shape.contains(position)));
    }
}
