//! Spans that the boundary of a body cuts: what they integrate, what they balance, and what they cost.

use std::sync::Arc;

use fisura::dynamics::critical_step::StiffnessOperator;
use fisura::dynamics::forcing::{Forcing, VolumeLoad};
use fisura::dynamics::statics::StaticSolver;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::linear_algebra::extremes::{larger, smaller};
use fisura::scene::*;

use crate::common::{Random, elastic_scene, rectangle, relative_closure, run};

/// A body on a mesh of 10 mm with 16 spans a side, at a random place and, if it has one, a random angle.
fn random_bodies(random: &mut Random) -> Vec<Shape> {
    let mut place = || [0.005 + 0.0007 * random.next(), 0.005 + 0.0007 * random.next()];
    let center = place();
    let (ring, disk) = (place(), place());
    let angle = 400.0 * (place()[0] - 0.005);
    let corner = |n: usize| {
        let (sine, cosine) = (angle + std::f64::consts::TAU * n as f64 / 5.0).sin_cos();
        [center[0] + 0.0038 * cosine, center[1] + 0.0041 * sine]
    };
    let hole = place();
    vec![
        Shape::Disk { center: disk, radius: 0.0039 },
        Shape::Annulus { center: ring, inner_radius: 0.0017, outer_radius: 0.0041 },
        Shape::Polygon { points: (0..5).map(corner).collect() },
        Shape::Union(vec![
            Shape::Disk { center: [hole[0] - 0.001, hole[1]], radius: 0.0031 },
            rectangle([0.001, hole[1] - 0.001], [hole[0], hole[1] + 0.0012]),
            rectangle([hole[0], hole[1] - 0.001], [0.0091, hole[1] + 0.0012]),
        ]),
        Shape::Difference {
            of: Box::new(rectangle([0.0; 2], [0.01; 2])),
            minus: vec![
                Shape::Disk { center: hole, radius: 0.0021 },
                rectangle([hole[0], hole[1] - 0.0002], [0.02, hole[1] + 0.0002]),
            ],
        },
    ]
}

fn free_body(degree: usize, shape: Shape) -> Scene {
    let mut scene = elastic_scene(degree, [0.01; 2], [16; 2]);
    scene.bodies[0].shape = shape;
    scene.bodies[0].particles_per_cell = [degree + 1; 2];
    scene
}

/// The tractions of a uniform stress `[[xx, xy], [yx, yy]]`, Pa.
#[derive(Debug)]
struct Uniform([[f64; 2]; 2]);

impl Forcing for Uniform {
    fn acts_inside(&self) -> bool {
        false
    }

    fn volume(&self, _position: [f64; 2], _time: f64) -> VolumeLoad {
        VolumeLoad::default()
    }

    fn traction(&self, _position: [f64; 2], normal: [f64; 2], _time: f64) -> [f64; 2] {
        self.0.map(|row| row[0] * normal[0] + row[1] * normal[1])
    }
}

/// What the tractions of a uniform stress all around a body leave: the largest nodal force that the exact
/// displacement does not balance, of the largest of the tractions, and, where no function is parted, the
/// largest error of the stress of the static solution at a point, of the largest component. The second one is
/// round-off over the smallest part of a function.
fn errors_of_uniform_stress(scene: &Scene) -> [f64; 2] {
    const STRESS: [[f64; 2]; 2] = [[1e6, 4e5], [4e5, -6e5]];
    let mut frame = TotalFrame::new(scene).unwrap();
    let grid = frame.lattice.grid;
    let zeros = || [grid.zeros(), grid.zeros()];
    frame.start_from(zeros(), zeros(), Arc::new(Uniform(STRESS))).unwrap();
    let material = &scene.materials["glass"];
    let (young, poisson) = (material.young_modulus, material.poisson_ratio);
    let mean = poisson * (STRESS[0][0] + STRESS[1][1]); // plane strain
    let strain = |i: usize, j: usize| {
        ((1.0 + poisson) * STRESS[i][j] - if i == j { (1.0 + poisson) * mean } else { 0.0 }) / young
    };
    let [x, y] = frame.control_positions();
    let exact = |component: usize, at: usize| strain(component, 0) * x[at] + strain(component, 1) * y[at];
    let mut forces = frame.forced_loads();
    let mut operator = frame.stiffness_operator();
    let free = operator.free.clone();
    let linear: Vec<f64> = free.iter().map(|&(at, component)| exact(component, at)).collect();
    let mut image = vec![0.0; free.len()];
    operator.stiffness(&linear, &mut image);
    let loads = || free.iter().map(|&(at, component)| forces[component][at]);
    let left_over = loads().zip(&image).map(|(load, image)| (load - image).abs()).fold(0.0, larger);
    let residual = left_over / loads().map(f64::abs).fold(0.0, larger);
    if grid.rows > frame.patch.control_grid().rows {
        return [residual, 0.0];
    }
    // A spring in proportion to the mass, which does not act on the exact displacement, holds the free body.
    let shift = young / material.density / 1e-4;
    for (at, component) in free {
        forces[component][at] += shift * frame.mass.row_sums[at] * exact(component, at);
    }
    let displacement = StaticSolver::new(&frame, shift).unwrap().solve(&forces, &zeros());
    let mut worst = 0.0_f64;
    frame.lattice.for_each_point(|_, _, position, _| {
        let [xx, yy, xy] = frame.elastic_stress_at(&displacement, position);
        for (found, exact) in [(xx, STRESS[0][0]), (yy, STRESS[1][1]), (xy, STRESS[0][1])] {
            worst = larger(worst, (found - exact).abs() / STRESS[0][0]);
        }
    });
    [residual, worst]
}

#[test]
fn a_uniform_stress_is_exact_in_discs_rings_polygons_and_plates_with_holes_and_notches() {
    let mut random = Random::new(3);
    for _ in 0..2 {
        for shape in random_bodies(&mut random) {
            for degree in [2, 3, 4] {
                let [residual, error] = errors_of_uniform_stress(&free_body(degree, shape.clone()));
                assert!(residual < 1e-10 && error < 1e-8, "p = {degree}, {shape:?}: {residual:e} {error:e}");
            }
        }
    }
}

#[test]
fn the_mass_of_a_body_is_exact_and_no_function_is_parted_by_mistake() {
    let mut random = Random::new(5);
    let pi = std::f64::consts::PI;
    for _ in 0..20 {
        let shapes = random_bodies(&mut random);
        let areas = [pi * 0.0039_f64.powi(2), pi * (0.0041_f64.powi(2) - 0.0017_f64.powi(2))];
        for (shape, area) in shapes.iter().zip(areas) {
            let frame = TotalFrame::new(&free_body(2, shape.clone())).unwrap();
            let mass: f64 = frame.mass.row_sums.iter().sum();
            approx::assert_relative_eq!(mass, 2450.0 * area, max_relative = 1e-10);
        }
        for shape in [&shapes[0], &shapes[2]] {
            let frame = TotalFrame::new(&free_body(2, shape.clone())).unwrap();
            let rows = frame.patch.control_grid().rows;
            assert_eq!(frame.lattice.grid.rows, rows, "copies of control points in {shape:?}");
        }
    }
}

#[test]
fn cut_spans_do_not_shorten_the_step_much() {
    let mut random = Random::new(11);
    for degree in [2, 3] {
        let whole = TotalFrame::new(&free_body(degree, Shape::Patch)).unwrap().critical_step();
        let mut least = f64::INFINITY;
        for _ in 0..6 {
            for shape in random_bodies(&mut random) {
                let step = TotalFrame::new(&free_body(degree, shape)).unwrap().critical_step();
                least = smaller(least, step / whole);
            }
        }
        assert!(least > 0.9, "p = {degree}: {least}");
    }
}

#[test]
fn a_cracking_disc_closes_its_ledger_and_gives_the_same_bits_on_any_number_of_threads() {
    let mut scene = free_body(2, Shape::Disk { center: [0.00503, 0.00498], radius: 0.0041 });
    let arc = |angles: [f64; 2]| Edge::Arc {
        center: [0.00503, 0.00498],
        radius: 0.0041,
        angles: angles.map(f64::to_radians),
    };
    let press = |angles| Traction { edge: arc(angles), load: Load::Pressure(4e8), time: TimeFactor::ramp(2e-6) };
    scene.bodies[0].tractions = vec![press([70.0, 110.0]), press([250.0, 290.0])];
    scene.materials.get_mut("glass").unwrap().fracture =
        Some(Fracture { length_scale: 0.5e-3, ..crate::common::brittle() });
    scene.analysis.end_time = 4e-6;
    let samples = [1, 2].map(|threads| crate::common::with_threads(threads, || run(&scene).1));
    assert_eq!(samples[0], samples[1]);
    let last = samples[0].last().unwrap();
    let closure = relative_closure(&samples[0]);
    scene.analysis.safety *= 0.5;
    let finer = relative_closure(&run(&scene).1);
    assert!(finer < 0.4 * closure && closure < 1e-3, "{finer:e} after {closure:e}");
    assert!(last.fracture.as_ref().unwrap().min_phase < 0.5, "{last:?}");
}

/// A slot of a fiftieth of a span, within a span, parts a plate in two: a pressure on one of its faces
/// moves that side alone.
#[test]
fn a_pressure_on_a_face_of_a_narrow_slot_moves_its_own_side() {
    for degree in [2, 3] {
        let h = 0.01 / 16.0;
        let [left, right] = [7.9 * h, 7.92 * h];
        let slotted = Shape::Difference {
            of: Box::new(rectangle([0.0; 2], [0.01; 2])),
            minus: vec![rectangle([left, -1.0], [right, 1.0])],
        };
        for (x, moves) in [(left, [true, false]), (right, [false, true])] {
            let mut scene = free_body(degree, slotted.clone());
            let edge = Edge::Segment([[x, 0.001], [x, 0.009]]);
            scene.bodies[0].tractions = vec![Traction { edge, load: Load::Pressure(1e6), time: TimeFactor::default() }];
            scene.analysis.end_time = 1e-6;
            let simulation = run(&scene).0;
            let mut fastest = [0.0_f64; 2];
            simulation.for_each_point(&mut |point| {
                let side = &mut fastest[usize::from(point.position[0] > left)];
                *side = larger(*side, point.velocity[0].abs());
            });
            assert_eq!(fastest.map(|speed| speed > 0.0), moves, "p = {degree}, face at {x}: {fastest:?}");
        }
    }
}

/// Functions of a pointed tip just beyond a knot are alike to round-off.
#[test]
fn a_tip_just_beyond_a_knot_has_a_phase_field() {
    let h = 0.01 / 16.0;
    for solver in [PhaseFieldSolver::ConjugateGradients, PhaseFieldSolver::Cholesky] {
        for (degree, beyond) in [2, 3, 4].into_iter().flat_map(|p| [1e-2, 1e-3, 1e-4].map(|beyond| (p, beyond))) {
            let tip = (10.0 + beyond) * h;
            let points = vec![[3.3 * h, 8.2 * h], [tip - 2.0 * h, 6.2 * h], [tip, 8.2 * h], [tip - 2.0 * h, 10.2 * h]];
            let mut scene = free_body(degree, Shape::Polygon { points });
            scene.materials.get_mut("glass").unwrap().fracture =
                Some(Fracture { length_scale: 0.5e-3, ..crate::common::brittle() });
            scene.solver.phase_field_solver = solver;
            let frame = TotalFrame::new(&scene);
            assert!(frame.is_ok(), "p = {degree}, {beyond:e}, {solver:?}: {:?}", frame.err());
        }
    }
}

#[test]
fn a_segment_or_arc_across_the_narrow_mouth_of_a_notch_is_refused() {
    use fisura::validate::validate;
    let plate = |notch: [f64; 2]| Shape::Difference {
        of: Box::new(rectangle([0.0; 2], [0.01; 2])),
        minus: vec![rectangle([notch[0], -1.0], [notch[1], 0.002])],
    };
    let refused = |shape: Shape, edge: Edge| {
        let mut scene = free_body(2, shape);
        scene.bodies[0].tractions =
            vec![Traction { edge, load: Load::Stress([0.0, 1e6]), time: TimeFactor::default() }];
        validate(&scene).err().map(|errors| errors[0].message.clone())
    };
    for (x, width) in [(0.0070131, 1e-4), (0.0033, 5e-6), (0.005, 3e-5)] {
        let whole = refused(plate([x, x + width]), Edge::Segment([[0.0; 2], [0.01, 0.0]]));
        assert!(whole.is_some_and(|message| message.contains("lies outside")), "{x} {width}");
        assert_eq!(refused(plate([x, x + width]), Edge::Segment([[0.0; 2], [x, 0.0]])), None);
    }
    let (center, radius) = ([0.005; 2], 0.004);
    let disk = Shape::Difference {
        of: Box::new(Shape::Disk { center, radius }),
        minus: vec![rectangle([0.0049, 0.0], [0.00491, 0.002])],
    };
    let circle = Edge::Arc { center, radius, angles: [-1.0, std::f64::consts::TAU - 1.0] };
    assert!(refused(disk, circle).is_some_and(|message| message.contains("lies outside")));
}
