//! The consistent mass: total mass, rigid motions, momentum and ledger, and what validation refuses.

use crate::common::{annulus, bent_patch, body, closure_of_any_sample, elastic_scene, patch_scene, rectangle, run};
use fisura::Simulation;
use fisura::scene::*;
use fisura::validate::validate;

const DENSITY: f64 = 2450.0;

fn consistent(mut scene: Scene, points: usize) -> Scene {
    scene.analysis.mass = Mass::Consistent;
    scene.bodies[0].particles_per_cell = [points; 2];
    scene
}

/// Area, distance of the centre of mass from the origin, and polar moment of area about it of the quarter
/// annulus of radii 1 and 2.
fn quarter_annulus() -> (f64, [f64; 2], f64) {
    let area = 0.75 * std::f64::consts::PI;
    let center = 4.0 / (3.0 * std::f64::consts::PI) * 7.0 / 3.0;
    (area, [center; 2], area * (2.5 - 2.0 * center * center))
}

/// Area, centre and polar moment of a rectangle from the origin.
fn of_rectangle([a, b]: [f64; 2]) -> (f64, [f64; 2], f64) {
    (a * b, [0.5 * a, 0.5 * b], a * b * (a * a + b * b) / 12.0)
}

/// Mass, kinetic energy, momentum and angular momentum of a rigid motion are those of the rigid body.
#[test]
fn rigid_motion_has_the_energy_of_a_rigid_body() {
    let (velocity, omega) = ([3.0, -2.0], 40.0);
    let mut bodies = Vec::new();
    for degree in 1..=4 {
        let size = [0.01, 0.005];
        bodies.push((consistent(elastic_scene(degree, size, [9, 4]), degree + 1), of_rectangle(size)));
        // Rational functions: points enough for round-off.
        bodies.push((consistent(patch_scene(&annulus(degree.max(2), 4), 9), 9), quarter_annulus()));
    }
    for (mut scene, (area, center, moment)) in bodies {
        let name = format!("degree {:?}, {:?}", scene.mesh.degree, scene.bodies[0].shape);
        (scene.bodies[0].velocity, scene.bodies[0].angular_velocity) = (velocity, omega);
        scene.analysis.thickness = 0.3;
        let simulation = Simulation::new(&scene).unwrap();
        let frame = simulation.total_frame().unwrap();
        let (mut ones, mut image) = (frame.lattice.grid.zeros(), frame.lattice.grid.zeros());
        frame.lattice.grid.indices().for_each(|at| ones[at] = 1.0);
        frame.mass.multiply(&ones, &mut image);
        approx::assert_relative_eq!(image.iter().sum::<f64>(), DENSITY * area, max_relative = 1e-12);
        for (sum, row) in image.iter().zip(&frame.mass.row_sums) {
            assert!((sum - row).abs() <= 1e-13 * DENSITY * area, "{name}: row sums");
        }
        let sample = simulation.sample();
        let (mass, moment) = (0.3 * DENSITY * area, 0.3 * DENSITY * moment);
        let [vx, vy] = velocity;
        let exact = 0.5 * mass * (vx * vx + vy * vy) + 0.5 * moment * omega * omega;
        assert!((sample.kinetic / exact - 1.0).abs() <= 1e-12, "{name}: {} for {exact}", sample.kinetic);
        for d in 0..2 {
            approx::assert_relative_eq!(sample.momentum[d], mass * velocity[d], max_relative = 1e-12);
        }
        let angular = mass * (center[0] * vy - center[1] * vx) + moment * omega;
        approx::assert_relative_eq!(sample.angular_momentum, angular, max_relative = 1e-12);

        scene.analysis.mass = Mass::Lumped;
        let lumped = Simulation::new(&scene).unwrap().sample().kinetic;
        assert!(lumped / exact - 1.0 > 1e-6, "{name}: row sums overstate the moment of inertia: {lumped} for {exact}");
    }
}

/// A free spinning body under a moving load: momentum is the impulse, angular momentum stays where no load
/// has a moment.
#[test]
fn momentum_is_the_impulse_and_the_ledger_closes() {
    for degree in 1..=4 {
        for general in [false, true] {
            let mut scene = consistent(elastic_scene(degree, [0.01, 0.005], [12, 6]), degree + 1);
            if general {
                scene = consistent(patch_scene(&bent_patch(degree.max(2), 5), 5), 5);
                scene.analysis.end_time = 5e-4;
            }
            scene.bodies[0].velocity = [2.0, 1.0];
            scene.bodies[0].angular_velocity = 10.0;
            scene.analysis.gravity = [3e5, -7e5];
            let name = format!("degree {degree}, general {general}");
            let (simulation, samples) = run(&scene);
            assert!(simulation.steps() >= 20, "{name}: {} steps", simulation.steps());
            let (first, last) = (&samples[0], samples.last().unwrap());
            let closure = closure_of_any_sample(&samples);
            assert!(closure <= 1e-12, "{name}: closure {closure:e}");
            assert!(last.elastic > 0.0, "{name}: a body that spins is stretched");
            let mass = first.momentum[0] / 2.0;
            for d in 0..2 {
                let expected = first.momentum[d] + mass * scene.analysis.gravity[d] * last.time;
                approx::assert_relative_eq!(last.momentum[d], expected, max_relative = 1e-12);
            }
        }
    }
}

#[track_caller]
fn assert_refused(scene: &Scene, words: &[&str]) {
    let errors = validate(scene).expect_err("refused");
    assert!(errors.iter().all(|error| error.key == "analysis.mass"), "{errors:?}");
    let text = format!("{}; {}", errors[0], errors[0].remedy);
    assert!(words.iter().all(|w| text.contains(w)), "{text} should say {words:?}");
}

#[test]
fn what_it_cannot_do_is_refused() {
    let sound = consistent(elastic_scene(2, [0.01, 0.008], [10, 8]), 3);
    assert_eq!(validate(&sound), Ok(vec![]));

    let mut updated = sound.clone();
    updated.analysis.frame = Frame::Updated;
    assert_refused(&updated, &["updated", "mass = \"lumped\"", "frame = \"total\""]);

    let mut cut = sound.clone();
    cut.bodies[0].shape = rectangle([0.0; 2], [0.0095, 0.008]);
    assert_refused(&cut, &["cuts spans", "end at knots", "lumped"]);
    cut.bodies[0].shape = Shape::Disk { center: [0.005, 0.004], radius: 0.003 };
    assert_refused(&cut, &["cuts spans", "lumped"]);
    cut.bodies[0].shape = rectangle([0.002, 0.0], [0.009, 0.006]);
    assert_eq!(validate(&cut), Ok(vec![]), "a body may end at any knot");

    let mut part = consistent(patch_scene(&annulus(2, 8), 3), 3);
    part.analysis.end_time *= 10.0; // waves cross a cell and more
    assert_eq!(validate(&part), Ok(vec![]));
    part.bodies[0] = body(Shape::Disk { center: [1.1, 1.1], radius: 0.2 }, [3; 2]);
    assert_refused(&part, &["cuts spans", "lumped"]);
}

/// Points determine a spline if each function has one of its own (Schoenberg and Whitney): not span by span,
/// but in all.
#[test]
fn too_few_points_are_refused() {
    for degree in 1..=4 {
        for points in 1..=5 {
            let scene = consistent(elastic_scene(degree, [0.01, 0.008], [10, 8]), points);
            let verdict = validate(&scene);
            // 10 spans have 10 + p functions; two points per span are enough for all degrees on so many
            // spans.
            let enough = points >= 2;
            assert_eq!(verdict.is_ok(), enough, "degree {degree}, {points} points: {verdict:?}");
            if enough {
                let (_, samples) = run(&Scene { analysis: Analysis { end_time: 1e-7, ..scene.analysis }, ..scene });
                assert!(samples.iter().all(|s| s.closure.is_finite()));
            } else {
                assert_refused(
                    &scene,
                    &["1 points per cell in direction x", "singular", &format!("give {} ", degree + 1)],
                );
            }
        }
        let one = consistent(elastic_scene(degree, [0.01, 0.008], [1, 1]), degree);
        assert_refused(&one, &["singular", &format!("give {} particles_per_cell", degree + 1)]);
        assert!(validate(&consistent(elastic_scene(degree, [0.01, 0.008], [1, 1]), degree + 1)).is_ok());
    }
}

/// Quartics on spans a millionth as long as their neighbours, four by four: seen from afar they are one knot
/// at which only the value is continuous, and the two points of each long span, with next to no weight of
/// those between, cannot tell the functions apart. As many points as functions there are by far: a breakdown
/// in words.
#[test]
fn a_matrix_that_is_singular_to_round_off_is_said_to_be() {
    let mut scene = consistent(elastic_scene(4, [0.01, 0.008], [10, 8]), 2);
    let [first, last] = [0.0, 0.01];
    let inner = (1..10).flat_map(|span| (-2..=2).map(move |n| 1e-3 * f64::from(span) + 1e-9 * f64::from(n)));
    scene.mesh.knots[0] = [first; 5].into_iter().chain(inner).chain([last; 5]).collect();
    assert!(validate(&scene).is_ok(), "{:?}", validate(&scene));
    let broken = Simulation::new(&scene).unwrap_err();
    assert!(broken.what.contains("singular") && broken.cause.contains("lumped"), "{broken}");
}
