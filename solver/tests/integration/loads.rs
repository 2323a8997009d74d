//! No part of a traction is lost on its way to the control points, wherever its edge lies; nor is a body
//! without points begun.

use crate::common::{body, elastic_scene, rectangle, run};
use fisura::Simulation;
use fisura::scene::time::Course;
use fisura::scene::*;
use fisura::splines::nurbs::NurbsPatch;
use fisura::validate::validate;

const SIDES: [Side; 4] = [Side::Left, Side::Right, Side::Bottom, Side::Top];
const FRAMES: [Frame; 2] = [Frame::Total, Frame::Updated];

fn traction(edge: Edge, stress: [f64; 2]) -> Traction {
    Traction { edge, load: Load::Stress(stress), time: TimeFactor::default() }
}

/// A free body of `shape` on a mesh under one traction.
fn loaded(mesh: Mesh, shape: Shape, traction: Traction, frame: Frame) -> Scene {
    let mut scene = elastic_scene(mesh.degree[0], [1.0; 2], [1; 2]);
    let points = [mesh.degree[0].max(2); 2];
    scene.mesh = mesh;
    scene.bodies = vec![body(shape, points)];
    scene.bodies[0].tractions = vec![traction];
    scene.analysis.frame = frame;
    scene
}

/// Force and moment about the origin that act on a free body at t = 0: in the total frame by the momenta
/// after the first step, in the updated frame on the control points that can move.
fn force_and_moment(scene: &Scene) -> [f64; 3] {
    assert!(validate(scene).is_ok(), "{:?}", validate(scene));
    let simulation = Simulation::new(scene).unwrap();
    if let Some(frame) = simulation.updated_frame() {
        let nodes = &frame.fields[0].nodes;
        let moving = nodes.grid.indices().filter(|at| nodes.inverse_mass[*at] > 0.0);
        let act = |at: usize| {
            let ([x, y], [fx, fy]) = (nodes.position(at), [0, 1].map(|c| nodes.force[c][at]));
            [fx, fy, x * fy - y * fx]
        };
        return moving.map(act).fold([0.0; 3], |sum, f| [0, 1, 2].map(|i| sum[i] + f[i]));
    }
    let mut scene = scene.clone();
    // No stress yet, which control points without mass would take.
    scene.analysis.time_step = TimeStep::Fixed(1e-14);
    scene.analysis.end_time = 1e-13;
    let mut simulation = Simulation::new(&scene).unwrap();
    simulation.step().unwrap();
    let sample = simulation.sample();
    [sample.momentum[0], sample.momentum[1], sample.angular_momentum].map(|p| p / simulation.time())
}

/// Error of the force and the moment on a body under a uniform traction on a straight edge, of the force (and
/// the moment of that at the middle of the edge, or at its length).
fn error(scene: &Scene, [from, to]: [[f64; 2]; 2]) -> f64 {
    let [fx, fy, found] = force_and_moment(scene);
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let middle = [0, 1].map(|d| 0.5 * (from[d] + to[d]));
    let Load::Stress(stress) = &scene.bodies[0].tractions[0].load else { panic!("a traction vector") };
    let [tx, ty] = stress.map(|s| s * length);
    let moment = middle[0] * ty - middle[1] * tx;
    let (force, arm) = (tx.hypot(ty), middle[0].hypot(middle[1]).max(length));
    ((fx - tx).hypot(fy - ty) / force).max((found - moment).abs() / (force * arm))
}

/// The sum of two decimals is not the double of their sum: one end in six lies a bit short of it or beyond.
#[test]
fn edges_at_the_ends_of_a_mesh_are_loaded_for_all_one_decimal_origins_and_sizes() {
    let mut short = 0;
    for tenths in -9_i32..=9 {
        for size in 1..=12_i32 {
            let (origin, length) = (f64::from(tenths) / 10.0, f64::from(size) / 10.0);
            let end = f64::from(tenths + size) / 10.0;
            short += usize::from(end > origin + length);
            for (number, side) in SIDES.into_iter().enumerate() {
                let frame = FRAMES[(number + (size + tenths + 9) as usize) % 2];
                let mesh = Mesh::uniform([2, 2], [origin; 2], [length; 2], [3, 2]);
                let shape = rectangle([origin; 2], [end; 2]);
                let ends = shape.side(side).unwrap();
                let scene = loaded(mesh, shape, traction(Edge::Side(side), [1e6, -2e6]), frame);
                let error = error(&scene, ends);
                assert!(error <= 1e-12, "origin {origin}, size {length}, {side:?}, {frame:?}: {error:e}");
            }
        }
    }
    assert!(short >= 20, "{short} ends lie beyond their mesh");
}

/// So many spans along an edge that the round-off of a plain sum over its points is more than the balance
/// allows.
#[test]
fn long_edges_are_loaded() {
    for frame in FRAMES {
        for degree in [1, 2] {
            let mesh = Mesh::uniform([degree; 2], [0.1, 0.0], [0.7, 1e-4], [16_000, 1]);
            let shape = rectangle([0.1, 0.0], [0.8, 1e-4]);
            let ends = shape.side(Side::Top).unwrap();
            let error = error(&loaded(mesh, shape, traction(Edge::Side(Side::Top), [1e6, -2e6]), frame), ends);
            // The sums of the test are plain ones.
            assert!(error <= 1e-11, "degree {degree}, {frame:?}: {error:e}");
        }
    }
}

#[test]
fn edges_that_cut_spans_are_loaded() {
    for degree in 1..=4 {
        for sliver in [0.0, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3, 0.3, 1.0 - 1e-9] {
            for frame in FRAMES {
                let mesh = Mesh::uniform([degree; 2], [0.0; 2], [6.0; 2], [6, 6]);
                let shape = rectangle([1.0, 2.0 - sliver], [4.0 + sliver, 5.0 + 0.5 * sliver]);
                for side in SIDES {
                    let ends = shape.side(side).unwrap();
                    let scene = loaded(mesh.clone(), shape.clone(), traction(Edge::Side(side), [1e6, 3e6]), frame);
                    let error = error(&scene, ends);
                    // round-off: momenta of control points with next to no mass, polynomials continued beyond
                    // their span
                    assert!(error <= 1e-11, "degree {degree}, sliver {sliver:e}, {side:?}, {frame:?}: {error:e}");
                }
            }
        }
    }
}

/// Impulses of loads that end or peak between two steps; velocities of sides give exact displacements.
#[test]
fn impulses_and_displacements_are_exact_however_short_they_are() {
    let pulse = Course::Table(vec![[0.55, 0.0], [0.6, 2.0], [0.7, 0.0]]);
    let courses = [(Course::Constant, Some(1.1), 1.1), (pulse, None, 0.15), (Course::Ramp(0.7), Some(1.1), 0.75)];
    for ((course, until, exact), frame) in courses.iter().flat_map(|course| FRAMES.map(|frame| (course, frame))) {
        let time = TimeFactor { course: course.clone(), until: *until };
        let pushed = Traction::on(Side::Right, [1e-3, 0.0], time.clone());
        let mut scene =
            loaded(Mesh::uniform([2; 2], [0.0; 2], [2.0; 2], [8; 2]), rectangle([0.25; 2], [1.25; 2]), pushed, frame);
        scene
            .materials
            .values_mut()
            .for_each(|m| *m = Material { young_modulus: 1e-2, poisson_ratio: 0.0, density: 1.0, fracture: None });
        scene.analysis.time_step = TimeStep::Fixed(0.25);
        scene.analysis.end_time = 2.0;
        let (_, samples) = run(&scene);
        let last = samples.last().unwrap();
        assert!((last.momentum[0] / (1e-3 * exact) - 1.0).abs() < 1e-12, "{frame:?} {time:?}: {:?}", last.momentum);
        assert!(last.closure.abs() < 1e-3 * last.external_work, "{frame:?} {time:?}: {}", last.closure);
        let moved = Prescribed { motion: Motion::Velocity([1.0, 0.0]), time };
        let way: f64 = (0..8).map(|n| 0.25 * n as f64).map(|t| 0.25 * moved.mean_velocity(t, 0.25)[0]).sum();
        assert!((way / exact - 1.0).abs() < 1e-12, "{moved:?}: {way}");
    }
}

/// Segments along slanted edges and through corners, where a span on the edge often has no point at all.
#[test]
fn segments_of_other_shapes_are_loaded() {
    let triangle = vec![[0.63, 0.51], [5.27, 1.98], [2.11, 5.43]];
    let square = vec![[3.0, 0.2], [5.8, 3.0], [3.0, 5.8], [0.2, 3.0]];
    let disk = Shape::Disk { center: [3.0, 3.0], radius: 2.1 };
    let mut cases = vec![(disk.clone(), [[3.0, 0.9], [3.0, 5.1]])];
    cases.push((
        Shape::Difference { of: Box::new(disk), minus: vec![rectangle([0.0; 2], [6.0, 3.3])] },
        [[1.0, 3.3 + 1e-9], [5.0, 3.3 + 1e-9]],
    ));
    for points in [triangle, square] {
        let edges = (0..points.len()).map(|i| [points[i], points[(i + 1) % points.len()]]);
        cases.extend(edges.map(|edge| (Shape::Polygon { points: points.clone() }, edge)).collect::<Vec<_>>());
    }
    for (shape, ends) in cases {
        for degree in 1..=3 {
            for frame in FRAMES.into_iter().filter(|frame| degree > 1 || *frame == Frame::Updated) {
                let mesh = Mesh::uniform([degree; 2], [0.0; 2], [6.0; 2], [12, 12]);
                let scene = loaded(mesh, shape.clone(), traction(Edge::Segment(ends), [1e6, 3e6]), frame);
                let error = error(&scene, ends);
                assert!(error <= 1e-11, "{shape:?}, {ends:?}, degree {degree}, {frame:?}: {error:e}");
            }
        }
    }
}

/// On a side of an annulus the force is that of its arc, but for the error of the points' rule.
#[test]
fn sides_of_a_patch_are_loaded() {
    let ring = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap().elevate(0).unwrap().subdivide(6).unwrap();
    let quarter = std::f64::consts::FRAC_PI_2;
    for (side, length) in [(Side::Left, quarter), (Side::Right, 2.0 * quarter), (Side::Bottom, 1.0), (Side::Top, 1.0)] {
        let traction = traction(Edge::Side(side), [1e6, 0.0]);
        let mut scene = loaded(Mesh::of(&ring), Shape::Patch, traction, Frame::Total);
        scene.bodies[0].particles_per_cell = [6, 6];
        let mut simulation = Simulation::new(&scene).unwrap();
        simulation.step().unwrap();
        let force = simulation.sample().momentum[0] / simulation.time();
        approx::assert_relative_eq!(force, 1e6 * length, max_relative = 1e-11);
    }
}

/// The spans that a needle cuts have points of their own.
#[test]
fn a_traction_acts_on_the_point_of_a_needle() {
    let needle =
        Shape::Polygon { points: vec![[0.5, 0.5], [1.5, 0.5], [5.5, 0.503], [1.5, 0.51], [1.5, 1.5], [0.5, 1.5]] };
    for frame in FRAMES {
        let mesh = Mesh::uniform([2, 2], [0.0; 2], [6.0, 2.0], [12, 4]);
        let tip = traction(Edge::Segment([[4.5, 0.503], [5.4, 0.503]]), [0.0, 1e6]);
        let [_, fy, _] = force_and_moment(&loaded(mesh, needle.clone(), tip, frame));
        assert!((fy / 0.9e6 - 1.0).abs() < 1e-9, "{frame:?}: {fy}");
    }
}

#[test]
fn a_body_without_a_point_is_bad_input() {
    for frame in FRAMES {
        let mesh = Mesh::uniform([2, 2], [0.0; 2], [6.0; 2], [6, 6]);
        let speck = Shape::Disk { center: [3.0, 3.0], radius: 0.1 };
        let mut scene = loaded(mesh, speck, traction(Edge::Side(Side::Left), [0.0; 2]), frame);
        scene.bodies[0].tractions.clear();
        assert!(validate(&scene).is_ok() && Simulation::new(&scene).is_ok(), "it has points of cut spans");
    }
    let ring = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap().elevate(0).unwrap().subdivide(6).unwrap();
    let speck = Shape::Disk { center: [1.1, 1.1], radius: 0.01 };
    let mut scene = loaded(Mesh::of(&ring), speck, traction(Edge::Side(Side::Left), [0.0; 2]), Frame::Total);
    scene.bodies[0].tractions.clear();
    let found = validate(&scene).unwrap_err();
    assert_eq!(found.iter().map(|e| e.key.as_str()).collect::<Vec<_>>(), ["body.0.shape"]);
    assert!(found[0].message.contains("no material point"), "{found:?}");
    let error = *Simulation::new(&scene).unwrap_err().scene.expect("the scene is to blame");
    assert_eq!(error.key, "body.0.shape");
    scene.bodies[0].particles_per_cell = [16, 16];
    assert!(validate(&scene).is_ok() && Simulation::new(&scene).is_ok(), "the remedy helps");
}

/// A traction on an arc has the force and the moment of the arc; a pressure pushes against the normal, on a
/// disk and in a hole.
#[test]
fn arcs_are_loaded() {
    let (center, radius) = ([3.0, 3.1], 2.1);
    let disk = Shape::Disk { center, radius };
    let hole = Shape::Difference { of: Box::new(rectangle([0.0; 2], [6.0; 2])), minus: vec![disk.clone()] };
    for (shape, inwards) in [(disk, 1.0), (hole, -1.0)] {
        for angles in [[0.3, 0.9], [-2.0, 1.0], [0.0, std::f64::consts::TAU]] {
            let edge = Edge::Arc { center, radius, angles };
            let mesh = || Mesh::uniform([2; 2], [0.0; 2], [6.0; 2], [20, 20]);
            let (swept, [sines, cosines]) = (angles[1] - angles[0], [angles.map(f64::sin), angles.map(f64::cos)]);
            // integrals of the radial unit vector over the arc
            let radial = [radius * (sines[1] - sines[0]), radius * (cosines[0] - cosines[1])];
            for frame in FRAMES {
                let scene = loaded(mesh(), shape.clone(), traction(edge.clone(), [1e6, -2e6]), frame);
                let [fx, fy, moment] = force_and_moment(&scene);
                let length = radius * swept;
                let arm = [0, 1].map(|d| center[d] * length + radius * radial[d]);
                let expected = [1e6 * length, -2e6 * length, -2e6 * arm[0] - 1e6 * arm[1]];
                for (found, expected) in [fx, fy, moment].into_iter().zip(expected) {
                    assert!(
                        (found - expected).abs() <= 1e-9 * 1e7 * length,
                        "{frame:?} {angles:?}: {found} {expected}"
                    );
                }
            }
            for frame in FRAMES {
                let load = Traction { edge: edge.clone(), load: Load::Pressure(1e6), time: TimeFactor::default() };
                let [fx, fy, _] = force_and_moment(&loaded(mesh(), shape.clone(), load, frame));
                for (found, radial) in [fx, fy].into_iter().zip(radial) {
                    let expected = -1e6 * inwards * radial;
                    assert!(
                        (found - expected).abs() <= 1e-6 * 1e6 * radius,
                        "{frame:?} {angles:?}: {found} {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_stress_field_pulls_by_its_normal_and_has_to_be_finite() {
    let field = |text: &str, xy: f64| StressField::new(text, move |[x, y]| [1e6 * x, 2e6 * y, xy]);
    let on = |field: StressField| Traction { load: Load::Field(field), ..traction(Edge::Segment(ENDS), [0.0; 2]) };
    const ENDS: [[f64; 2]; 2] = [[5.0, 1.0], [5.0, 5.0]];
    let mesh = || Mesh::uniform([2; 2], [0.0; 2], [6.0; 2], [20, 20]);
    let body = || rectangle([1.0; 2], [5.0; 2]);
    for frame in FRAMES {
        let [fx, fy, _] = force_and_moment(&loaded(mesh(), body(), on(field("fine", 3e6)), frame));
        assert!((fx / 2e7 - 1.0).abs() < 1e-9 && (fy / 1.2e7 - 1.0).abs() < 1e-9, "{frame:?}: {fx} {fy}");
        let broken = Simulation::new(&loaded(mesh(), body(), on(field("broken", f64::NAN)), frame)).err().unwrap();
        assert!(format!("{broken:?}").contains("not finite"), "{broken:?}");
    }
}

#[test]
fn what_has_no_meaning_inside_a_body_is_bad_input() {
    let refused = |load: &Load, ends, cracks: Vec<Crack>| {
        let mesh = Mesh::uniform([2; 2], [0.0; 2], [6.0; 2], [20, 20]);
        let traction = Traction { load: load.clone(), ..traction(Edge::Segment(ends), [0.0; 2]) };
        let mut scene = loaded(mesh, rectangle([0.0; 2], [6.0; 2]), traction, Frame::Total);
        scene.bodies[0].cracks = cracks;
        validate(&scene).err().map(|errors| errors[0].key.clone())
    };
    let inside = Some("body.0.traction.0.segment".to_string());
    let (pressure, stress) = (Load::Pressure(1.0), Load::Stress([1.0, 0.0]));
    let slit = || vec![Crack { points: vec![[0.0, 3.0], [3.0, 3.0]], kind: CrackKind::Slit }];
    assert_eq!(refused(&stress, [[0.0, 3.0], [3.0, 3.0]], slit()), inside, "a slit has two faces");
    assert_eq!(refused(&pressure, [[1.0, 0.0], [6.0, 5.0]], vec![]), inside, "no side to push");
    assert_eq!(refused(&stress, [[1.0, 0.0], [6.0, 5.0]], slit()), None, "a line of forces");
    assert_eq!(refused(&pressure, [[1.0, 0.0], [5.0, 0.0]], vec![]), None, "on the boundary");
}
