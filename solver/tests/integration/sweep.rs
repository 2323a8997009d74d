//! The sweep over the lattice against a plain evaluation point by point.

use crate::common::{Random, body, graded_knots, rectangle};
use fisura::linear_algebra::extremes::larger;
use fisura::linear_algebra::lane::{LANES, Lane};
use fisura::particles::lattice::Lattice;
use fisura::scene::*;
use fisura::splines::patch::Patch;
use fisura::transfer::point_kernel::{Fields, PointKernel, PointValues, Stress};
use fisura::transfer::sweep::{StripForces, sweep};

/// Records what it is given and answers with a stress of its own making.
struct Recorder {
    values: Vec<PointValues>,
    weights: Vec<Lane>,
    order: Vec<usize>,
}

impl PointKernel for Recorder {
    const DISPLACEMENT: bool = true;
    const PHASE: bool = true;
    const PHASE_GRADIENT: bool = true;
    const STRESS: bool = true;
    const EVERY_STEP: bool = true;

    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress {
        self.values.push(*values);
        self.weights.push(weight);
        self.order.push(at);
        let [xx, yy, xy] = stress_of(values.gradient);
        Stress::symmetric([xx, yy, xy])
    }
}

/// Not symmetric in the gradient, so that no mixed-up component goes unseen.
fn stress_of(g: [Lane; 4]) -> [Lane; 3] {
    [g[0] * 2.0 + g[3] * 0.3 + g[1] * 0.7, g[3] * 1.7 - g[0] * 0.4 + g[2] * 0.9, g[1] * 1.1 + g[2] * 0.6 - g[0] * 0.2]
}

struct Naive {
    forces: [Vec<f64>; 2],
    scale: f64,
    gradient_error: f64,
    phase_error: f64,
    points: usize,
    area: f64,
}

/// Every point by itself, through [`Patch::evaluate`] and the shape functions of its position.
fn naive(
    patch: &Patch,
    lattice: &Lattice,
    fields: Fields,
    recorded: impl Fn(usize, usize) -> (PointValues, f64),
) -> Naive {
    let grid = patch.control_grid();
    let mut result = Naive {
        forces: [grid.zeros(), grid.zeros()],
        scale: 0.0,
        gradient_error: 0.0,
        phase_error: 0.0,
        points: 0,
        area: 0.0,
    };
    let mut lost = 0.0;
    lattice.for_each_point(|batch, lane, position, weight| {
        let (seen, seen_weight) = recorded(batch, lane);
        assert_eq!(seen_weight, weight);
        let ux = patch.evaluate(fields.displacement[0], position).unwrap();
        let uy = patch.evaluate(fields.displacement[1], position).unwrap();
        let c = patch.evaluate(fields.phase, position).unwrap();
        let gradient = [ux.gradient[0], ux.gradient[1], uy.gradient[0], uy.gradient[1]];
        let seen_gradient = seen.gradient.map(|g| g[lane]);
        for i in 0..4 {
            result.gradient_error = larger(result.gradient_error, (gradient[i] - seen_gradient[i]).abs());
        }
        result.phase_error = larger(result.phase_error, (c.value - seen.phase[lane]).abs());
        for d in 0..2 {
            let error = (c.gradient[d] - seen.phase_gradient[d][lane]).abs();
            result.gradient_error = larger(result.gradient_error, error);
        }
        result.scale = gradient.iter().fold(result.scale, |m: f64, g| larger(m, g.abs()));
        result.points += 1;
        let term = weight - lost; // compensated: thousands of weights must add up to the last digits
        let area = result.area + term;
        lost = (area - result.area) - term;
        result.area = area;
        let [xx, yy, xy] = stress_of(gradient.map(Lane::splat)).map(|s| s[0]);
        let [x, y] = &patch.spaces;
        let (i, j) = (x.find_span(position[0]).unwrap(), y.find_span(position[1]).unwrap());
        let (sx, sy) = (x.shape_functions(i, position[0]), y.shape_functions(j, position[1]));
        for l in 0..=y.degree() {
            for k in 0..=x.degree() {
                let at = grid.index(x.spans()[i].first + k, y.spans()[j].first + l);
                let (dx, dy) = (sx.derivative[k] * sy.value[l], sx.value[k] * sy.derivative[l]);
                result.forces[0][at] += weight * (xx * dx + xy * dy);
                result.forces[1][at] += weight * (xy * dx + yy * dy);
            }
        }
    });
    result
}

/// Compares one sweep with the plain evaluation, to 1e-13 of the largest value; returns points and their
/// total area.
fn compare(mesh: &Mesh, body: &Body) -> (usize, f64) {
    let name = format!("degree {:?}, {:?}, {:?}", mesh.degree, body.particles_per_cell, body.shape);
    let patch = Patch::new(mesh);
    let lattice = Lattice::new(&patch, body);
    let mut random = Random::new(7);
    let [ux, uy, phase] = [1.0, 1.0, 1.0].map(|scale| random.field(lattice.grid, scale));
    let fields = Fields { displacement: [&ux, &uy], phase: &phase };
    let recorder = || Recorder { values: Vec::new(), weights: Vec::new(), order: Vec::new() };
    let mut kernels: Vec<_> = (0..lattice.strips()).map(|_| recorder()).collect();
    let mut strips = StripForces::new(&lattice);
    for _ in 0..2 {
        // the second sweep must not see what the first left behind
        kernels.iter_mut().for_each(|k| *k = recorder());
        sweep(&lattice, fields, &mut kernels, Some(&mut strips));
    }
    let mut at_batch = vec![None; lattice.batches()];
    for (strip, kernel) in kernels.iter().enumerate() {
        for (n, &at) in kernel.order.iter().enumerate() {
            let batch = strip * lattice.strip_batches() + at;
            assert!(at_batch[batch].replace((kernel.values[n], kernel.weights[n])).is_none(), "{name}: twice");
        }
    }
    let mut forces = [lattice.grid.zeros(), lattice.grid.zeros()];
    strips.assemble(lattice.grid.stride, &mut forces);
    let plain = naive(&patch, &lattice, fields, |batch, lane| {
        let (values, weight) = at_batch[batch].expect("every batch is visited");
        (values, weight[lane])
    });
    assert!(plain.gradient_error <= 1e-13 * plain.scale, "{name}: gradients {:e}", plain.gradient_error / plain.scale);
    assert!(plain.phase_error <= 1e-13, "{name}: phase {:e}", plain.phase_error);
    let largest = plain.forces.iter().flatten().fold(0.0, |m: f64, f| larger(m, f.abs()));
    for component in 0..2 {
        let mut total = 0.0;
        for at in 0..lattice.grid.len() {
            let (seen, expected) = (forces[component][at], plain.forces[component][at]);
            assert!((seen - expected).abs() <= 1e-13 * largest, "{name}: force {at} is {seen} for {expected}");
            total += seen;
        }
        assert!(total.abs() <= 1e-12 * largest, "{name}: forces inside a body add up to {total}");
    }
    (plain.points, plain.area)
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
            let (_, area) =
                compare(&Mesh { degree: [degree; 2], knots, geometry: None }, &body(rectangle([0.0; 2], end), [3, 2]));
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
        let mesh = Mesh { degree: [degree; 2], knots: [knots.clone(), knots], geometry: None };
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
fn a_disk_keeps_the_points_inside() {
    for degree in 1..=4 {
        let shape = Shape::Disk { center: [0.61, 0.5], radius: 0.37 };
        let (count, area) = compare(&mesh([degree; 2], [1.3, 1.0], [26, 20]), &body(shape.clone(), [3; 2]));
        let exact = std::f64::consts::PI * 0.37 * 0.37;
        assert!((area / exact - 1.0).abs() < 0.02, "{area} for {exact}");
        let patch = Patch::new(&mesh([degree; 2], [1.3, 1.0], [26, 20]));
        let lattice = Lattice::new(&patch, &body(shape.clone(), [3; 2]));
        assert!(count < lattice.batches() * LANES);
        lattice.for_each_point(|_, _, position, _| assert!(shape.contains(position)));
    }
}
