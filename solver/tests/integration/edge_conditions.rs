//! Conditions on edges of bodies that are no sides of the mesh.

use approx::assert_relative_eq;
use fisura::dynamics::energy::Sample;
use fisura::dynamics::failure::Failure;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::linear_algebra::extremes::larger;
use fisura::scene::time::Course;
use fisura::scene::*;
use fisura::validate::validate;

use crate::common::{Random, elastic_scene, rectangle, relative_closure, run};

fn column(samples: &[Sample], name: &str) -> Vec<f64> {
    let value = |s: &Sample| s.named_values().into_iter().find(|(n, _)| n == name).expect("a column").1;
    samples.iter().map(value).collect()
}

fn named(name: &str, edge: Edge, hold: Hold) -> EdgeCondition {
    EdgeCondition { name: Some(name.to_string()), ..EdgeCondition::fixed(edge, hold) }
}

/// Corners (m) of a rectangle turned by an angle (rad) about the middle of a mesh of 10 mm.
fn turned([width, height]: [f64; 2], angle: f64, offset: f64) -> Vec<[f64; 2]> {
    let (sin, cos) = angle.sin_cos();
    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[x, y]| [x * width, y * height]);
    corners.map(|[x, y]| [0.005 + offset + cos * x - sin * y, 0.005 + sin * x + cos * y]).to_vec()
}

/// A rectangle at an angle, pressed at one end, that slides along two of its edges, in equilibrium.
fn pressed(degree: usize, angle: f64, offset: f64) -> Scene {
    let mut scene = elastic_scene(degree, [0.01; 2], [13; 2]);
    let corners = turned([0.0061, 0.0043], angle, offset);
    let segment = |i: usize| Edge::Segment([corners[i], corners[(i + 1) % 4]]);
    let body = &mut scene.bodies[0];
    body.particles_per_cell = [degree + 1; 2];
    body.shape = Shape::Polygon { points: corners.clone() };
    body.tractions = vec![Traction { edge: segment(1), load: Load::Pressure(2e6), time: TimeFactor::default() }];
    body.conditions = vec![named("base", segment(3), Hold::Normal), named("side", segment(0), Hold::Normal)];
    scene.equilibrium = true;
    scene.output.samples = 4;
    scene
}

/// To what the static start leaves: 1e-9 of the largest nodal force.
#[test]
fn rollers_at_any_angle_carry_a_uniform_stress() {
    for degree in [2, 3, 4] {
        for (angle, offset) in [(0.3, 1e-4), (std::f64::consts::FRAC_PI_4, 2.3e-4), (2.9, 3.1e-4)] {
            let scene = pressed(degree, angle, offset);
            assert!(validate(&scene).is_ok(), "{:?}", validate(&scene));
            let samples = run(&scene).1;
            let poisson = scene.materials["glass"].poisson_ratio;
            let modulus = scene.materials["glass"].young_modulus / (1.0 - poisson * poisson); // plane strain
            let exact = 0.5 * 2e6 * 2e6 / modulus * 0.0061 * 0.0043;
            let what = format!("p = {degree}, {angle} rad");
            assert_relative_eq!(samples[0].elastic, exact, max_relative = 1e-8);
            let moving = samples.iter().map(|s| s.kinetic).fold(0.0, larger);
            assert!(moving < 1e-12 * exact, "{what}: {moving:e}");
            let (force, (sin, cos)) = (2e6 * 0.0043, angle.sin_cos());
            let reactions =
                ["base", "side"].map(|name| ["x", "y"].map(|d| column(&samples, &format!("reaction_{name}_{d}_n"))[4]));
            assert_relative_eq!(reactions[0][0], force * cos, epsilon = 1e-6 * force);
            assert_relative_eq!(reactions[0][1], force * sin, epsilon = 1e-6 * force);
            assert_relative_eq!(reactions[1][0].hypot(reactions[1][1]), 0.0, epsilon = 1e-6 * force);
        }
    }
}

/// A bar of 20 mm that is driven at an end, along x: on a side of the mesh or beside it.
fn driven(on_side: bool, from: f64) -> Scene {
    let mut scene = elastic_scene(2, [0.024, 0.002], [48, 4]);
    scene.materials.get_mut("glass").unwrap().poisson_ratio = 0.0;
    scene.bodies[0].shape = rectangle([from, 0.0], [from + 0.02, 0.002]);
    let prescribed = Prescribed {
        motion: Motion::Velocity([1.0, 0.0]),
        time: TimeFactor { course: Course::Smooth(2e-6), until: None },
    };
    if on_side {
        let side = Boundary::fixed(Side::Left, [true, false]);
        scene.boundaries = vec![Boundary { name: Some("end".to_string()), prescribed, ..side }];
    } else {
        let end = named("end", Edge::Side(Side::Left), Hold::Components([true, false]));
        scene.bodies[0].conditions = vec![EdgeCondition { prescribed, ..end }];
    }
    scene.output.samples = 125;
    scene.analysis.time_step = TimeStep::Fixed(4e-8);
    scene
}

/// Exactly where the end is on the side; else to 2 %: the mesh ends otherwise, and the lumped mass disperses
/// the wave by 0.8 % at 0.5 mm.
#[test]
fn a_driven_end_beside_the_mesh_is_one_on_its_side() {
    let reference = column(&run(&driven(true, 0.0)).1, "reaction_end_x_n");
    let largest = reference.iter().map(|f| f.abs()).fold(0.0, larger);
    for (from, tolerance) in [(0.0, 1e-9), (0.0005, 0.02), (0.00071, 0.02), (0.00099, 0.02), (0.0031, 0.02)] {
        let samples = run(&driven(false, from)).1;
        assert!(relative_closure(&samples) < 1e-11, "{from}: closure {:e}", relative_closure(&samples));
        let reaction = column(&samples, "reaction_end_x_n");
        let apart = reaction.iter().zip(&reference).map(|(a, b)| (a - b).abs()).fold(0.0, larger);
        assert!(apart < tolerance * largest, "{from}: {:e}", apart / largest);
        let impulse: f64 = reaction.windows(2).map(|pair| 4e-8 * 0.5 * (pair[0] + pair[1])).sum();
        assert_relative_eq!(impulse, samples[125].momentum[0], max_relative = 1e-9);
    }
}

/// Bodies at random places with the edges on which they are held.
fn random_bodies(random: &mut Random) -> Vec<(Shape, Vec<Edge>)> {
    let mut number = |size: f64| size * random.next();
    let corners = turned([0.005 + number(0.001), 0.004 + number(0.001)], number(3.2), number(3e-4));
    let edges = (0..4).map(|i| Edge::Segment([corners[i], corners[(i + 1) % 4]])).collect();
    let center = [0.005 + number(5e-4), 0.005 + number(5e-4)];
    let (inner, outer) = (0.0015 + number(4e-4), 0.0038 + number(4e-4));
    let start = number(3.0);
    let arc = |radius, sweep| Edge::Arc { center, radius, angles: [start, start + sweep] };
    vec![
        (Shape::Polygon { points: corners }, edges),
        (Shape::Annulus { center, inner_radius: inner, outer_radius: outer }, vec![arc(inner, 6.2), arc(outer, 1.0)]),
        (Shape::Disk { center, radius: outer }, vec![arc(outer, std::f64::consts::TAU)]),
    ]
}

/// To 0.1 %: the estimate of the step has an error of 0.25 %, most of which is the same for both.
#[test]
fn conditions_do_not_shorten_the_step() {
    let mut random = Random::new(7);
    for _ in 0..2 {
        for (shape, edges) in random_bodies(&mut random) {
            for degree in [2, 3] {
                for hold in [Hold::Components([true, true]), Hold::Normal] {
                    let mut scene = elastic_scene(degree, [0.01; 2], [16; 2]);
                    scene.bodies[0].shape = shape.clone();
                    scene.bodies[0].particles_per_cell = [degree + 1; 2];
                    let free = TotalFrame::new(&scene).unwrap().critical_step();
                    let condition = |edge: &Edge| EdgeCondition::fixed(edge.clone(), hold);
                    scene.bodies[0].conditions = edges.iter().map(condition).collect();
                    let held = TotalFrame::new(&scene).unwrap_or_else(|e| panic!("{scene:?}: {e:?}")).critical_step();
                    assert!(held >= 0.999 * free, "p = {degree}, {hold:?}: {held:e} of {free:e} s, {shape:?}");
                }
            }
        }
    }
}

/// The left edge of a square on a mesh of 13 spans, held in parts that touch.
fn held_in_parts(degree: usize, parts: &[[f64; 2]]) -> Scene {
    let mut scene = pressed(degree, 0.0, 0.0);
    let corners = turned([0.0061, 0.0043], 0.0, 0.0);
    let at = |s: f64| [0, 1].map(|d| corners[3][d] + (corners[0][d] - corners[3][d]) * s);
    let part = |[a, b]: &[f64; 2]| EdgeCondition::fixed(Edge::Segment([at(*a), at(*b)]), Hold::Components([true; 2]));
    scene.bodies[0].conditions = parts.iter().map(part).collect();
    scene
}

#[test]
fn parts_too_short_to_be_independent_are_refused() {
    let starts = |degree, parts: &[[f64; 2]]| TotalFrame::new(&held_in_parts(degree, parts)).map(|_| ());
    let of_spans = |length: f64| length / 5.59;
    for degree in [2, 3, 4] {
        assert!(starts(degree, &[[0.0, 0.5], [0.5, 1.0]]).is_ok(), "p = {degree}: 2.8 spans each");
        assert!(starts(degree, &[[0.5, 0.5 + of_spans(1e-3)]]).is_ok(), "p = {degree}: a thousandth of a span");
    }
    let short = [[0.5 - of_spans(0.3), 0.5], [0.5, 0.5 + of_spans(0.3)]];
    assert!(matches!(starts(2, &short), Err(Failure::HeldTwice { .. })), "0.3 spans each");
}

/// All functions of the body along either part would prescribe the motion of the gap twice.
#[test]
fn parts_of_a_side_a_span_apart_move_differently() {
    for degree in [1, 2, 3] {
        let mut scene = held_in_parts(degree, &[[0.0, 0.4], [0.4 + 1.0 / 5.59, 1.0]]);
        let body = &mut scene.bodies[0];
        body.tractions.clear();
        body.conditions[1].prescribed = Prescribed::velocity([0.1, 0.0]);
        scene.equilibrium = false;
        let samples = run(&scene).1;
        let last = &samples[4];
        assert!(last.closure.abs() <= 1e-9 * last.largest_term(), "p = {degree}: {last:?}");
        // As if all of the body had the strain of the gap.
        let strain = 0.1 * last.time / (0.0043 / 5.59);
        let most = 32e9 * strain * strain * 0.0061 * 0.0043;
        assert!(last.elastic < most, "p = {degree}: {:e} J/m instead of less than {most:e}", last.elastic);
    }
}

#[test]
fn what_is_prescribed_twice_is_refused() {
    let keys = |scene: &Scene| {
        let errors = validate(scene).err().unwrap_or_default();
        errors.into_iter().map(|error| error.key).collect::<Vec<_>>()
    };
    assert_eq!(keys(&held_in_parts(2, &[[0.0, 0.5], [0.5, 1.0]])), [""; 0]);
    assert_eq!(keys(&held_in_parts(2, &[[0.0, 0.5], [0.4999, 1.0]])), ["body.0.condition.1.fix"]);
    let mut scene = driven(false, 0.0);
    assert_eq!(keys(&scene), [""; 0]);
    scene.boundaries = vec![Boundary { part: Some([0.0, 1e-4]), ..Boundary::fixed(Side::Left, [true, false]) }];
    assert_eq!(keys(&scene), ["body.0.condition.0.fix"]);
    scene.boundaries[0].fix = [false, true];
    assert_eq!(keys(&scene), [""; 0]);
    scene.boundaries = vec![Boundary::fixed(Side::Bottom, [true, false])];
    assert_eq!(keys(&scene), ["body.0.condition.0.fix"], "the corner would be driven and held");
    scene.boundaries[0].prescribed = scene.bodies[0].conditions[0].prescribed.clone();
    assert_eq!(keys(&scene), [""; 0]);
    let mut apart = held_in_parts(2, &[[0.0, 0.5], [0.5, 1.0]]);
    apart.bodies[0].conditions[1].prescribed = Prescribed::velocity([0.0, 1.0]);
    assert_eq!(keys(&apart), ["body.0.condition.1.fix"], "parts that meet and move apart");
    let arc = |angles| EdgeCondition::fixed(Edge::Arc { center: [0.005; 2], radius: 0.004, angles }, Hold::Normal);
    let mut disc = elastic_scene(2, [0.01; 2], [13; 2]);
    disc.bodies[0].shape = Shape::Disk { center: [0.005; 2], radius: 0.004 };
    disc.bodies[0].conditions = vec![arc([0.0, 2.0]), arc([2.0, 4.0])];
    assert_eq!(keys(&disc), [""; 0]);
    disc.bodies[0].conditions.push(arc([-0.1, 0.001]));
    assert_eq!(keys(&disc), ["body.0.condition.2.fix"]);
}
