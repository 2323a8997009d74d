//! Conditions on sides and on parts of them: what is prescribed happens, and its work and reaction are known.

use approx::assert_relative_eq;
use fisura::Simulation;
use fisura::dynamics::energy::Sample;
use fisura::linear_algebra::extremes::larger;
use fisura::scene::time::{Course, TimeFormula};
use fisura::scene::*;
use fisura::validate::validate;

use crate::common::{elastic_scene, relative_closure, run};

/// A bar of 40 mm that does not contract, driven at its left end, with a sample at every step.
fn driven(motion: Motion, time: TimeFactor) -> Scene {
    let mut scene = elastic_scene(2, [0.04, 0.002], [40, 2]);
    scene.materials.get_mut("glass").unwrap().poisson_ratio = 0.0;
    let name = Some("Drive 1".to_string());
    scene.boundaries =
        vec![Boundary { name, prescribed: Prescribed { motion, time }, ..Boundary::fixed(Side::Left, [true, false]) }];
    scene.output.samples = 100;
    scene.analysis.time_step = TimeStep::Fixed(5e-8);
    assert!(validate(&scene).is_ok(), "{:?}", validate(&scene));
    scene
}

fn column(samples: &[Sample], name: &str) -> Vec<f64> {
    let value = |s: &Sample| s.named_values().into_iter().find(|(n, _)| n == name).expect("a column").1;
    samples.iter().map(value).collect()
}

fn courses() -> Vec<TimeFactor> {
    let table = Course::Table(vec![[0.0, 0.0], [1e-6, 1.0], [2e-6, -0.5]]);
    let formula = TimeFormula::new("sin(t / 1 us)", |t| (t / 1e-6).sin());
    let courses = [Course::Constant, Course::Ramp(2e-6), Course::Smooth(2e-6), table, Course::Formula(formula)];
    let until = [None, Some(3e-6)];
    courses.into_iter().flat_map(|course| until.map(|until| TimeFactor { course: course.clone(), until })).collect()
}

/// Whether a displacement may follow a factor.
fn jumps_nowhere(time: &TimeFactor) -> bool {
    time.until.is_none() && time.value(0.0) == 0.0
}

#[test]
fn every_course_closes_the_ledger_and_its_reaction_is_the_rate_of_the_momentum() {
    for time in courses() {
        let displaced = jumps_nowhere(&time).then_some(Motion::Displacement([1e-6, 0.0]));
        for motion in [Some(Motion::Velocity([1.0, 0.0])), displaced].into_iter().flatten() {
            let what = format!("{motion:?} {time:?}");
            let samples = run(&driven(motion, time.clone())).1;
            assert!(relative_closure(&samples) < 1e-12, "{what}: closure {:e}", relative_closure(&samples));
            let work = column(&samples, "work_drive_1_j");
            assert_relative_eq!(work[100], samples[100].external_work, max_relative = 1e-12);
            let reaction = column(&samples, "reaction_drive_1_x_n");
            let impulse: f64 = reaction.windows(2).map(|pair| 5e-8 * 0.5 * (pair[0] + pair[1])).sum();
            let largest = samples.iter().map(|s| s.momentum[0].abs()).fold(0.0, larger);
            let change = samples[100].momentum[0] - samples[0].momentum[0];
            assert_relative_eq!(impulse, change, epsilon = 1e-9 * largest);
        }
    }
}

#[test]
fn the_side_is_where_the_course_puts_it() {
    for (time, end) in [
        (TimeFactor::default(), 5e-6),
        (TimeFactor::ramp(2e-6), 4e-6),
        (TimeFactor { course: Course::Smooth(2e-6), until: None }, 4e-6),
        (TimeFactor { course: Course::Ramp(2e-6), until: Some(3e-6) }, 2e-6),
    ] {
        let moved = |motion, time| {
            let (simulation, _) = run(&driven(motion, time));
            let frame = simulation.total_frame().unwrap();
            frame.patch.evaluate(&frame.displacement[0], [0.0, 0.001]).unwrap().value
        };
        assert_relative_eq!(moved(Motion::Velocity([1.0, 0.0]), time.clone()), end, max_relative = 1e-3);
        if jumps_nowhere(&time) {
            assert_relative_eq!(moved(Motion::Displacement([1e-6, 0.0]), time), 1e-6, epsilon = 1e-18);
        }
    }
}

#[test]
fn a_part_of_a_side_is_held_and_the_rest_is_free() {
    for degree in [1, 2, 3] {
        let mut scene = elastic_scene(degree, [0.01; 2], [10; 2]);
        let lower = |part| Boundary { part, ..Boundary::driven(Side::Left, [true, false], [1.0, 0.0]) };
        let held = |part| {
            scene.boundaries = vec![lower(part)];
            run(&scene).0.total_frame().unwrap().constraints.held(0)
        };
        let mut held = held;
        let all = held(None);
        assert_eq!(held(Some([0.0, 0.01])), all, "p = {degree}");
        let (below, above) = (held(Some([0.0, 0.004])), held(Some([0.004, 0.01])));
        assert!(below.iter().chain(&above).all(|at| all.contains(at)));
        let twice = below.iter().filter(|at| above.contains(at)).count();
        assert!(twice <= 1 && below.len() + above.len() - twice == all.len(), "p = {degree}: {below:?} {above:?}");
        assert!(below.len() >= 4 && above.len() >= 6, "p = {degree}");
    }
}

#[test]
fn a_side_that_the_body_does_not_reach_holds_nothing() {
    for degree in [1, 2, 3] {
        for gap in [0.02e-3, 0.3e-3, 0.9e-3] {
            let mut scene = elastic_scene(degree, [0.01; 2], [10; 2]);
            scene.bodies[0].shape = Shape::Rectangle { min: [gap, 0.0], max: [0.01, 0.01] };
            scene.boundaries = vec![Boundary::driven(Side::Left, [true, true], [1.0, 0.0])];
            let warnings = validate(&scene).unwrap();
            assert!(warnings.iter().any(|warning| warning.message.contains("nothing is held there")), "{warnings:?}");
            let samples = run(&scene).1;
            assert_eq!(samples.last().unwrap().kinetic, 0.0, "p = {degree}, a gap of {gap} m");
        }
    }
}

#[test]
fn a_part_that_holds_nothing_is_bad_input() {
    let mut scene = elastic_scene(2, [0.01; 2], [10; 2]);
    let held = |from, to| Boundary { part: Some([from, to]), ..Boundary::fixed(Side::Left, [true, false]) };
    let refused = |scene: &Scene| {
        let breakdown = Simulation::new(scene).unwrap_err();
        breakdown.scene.expect("an error of the scene").key
    };
    scene.boundaries = vec![held(0.0, 0.004), held(0.0051, 0.0052)];
    assert_eq!(refused(&scene), "boundary.1.from", "shorter than the support of a function");
    scene.boundaries = vec![held(0.004, 0.009)];
    scene.bodies[0].shape = Shape::Rectangle { min: [0.0, 0.0], max: [0.01, 0.002] };
    assert_eq!(refused(&scene), "boundary.0.from", "where no body is");
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let keys = |change: fn(&mut Boundary)| {
        let mut scene = driven(Motion::Velocity([1.0, 0.0]), TimeFactor::default());
        change(&mut scene.boundaries[0]);
        validate(&scene).unwrap_err().into_iter().map(|e| e.key).collect::<Vec<_>>()
    };
    assert_eq!(keys(|b| b.part = Some([0.001, 0.0])), ["boundary.0.to"]);
    assert_eq!(keys(|b| b.part = Some([-1.0, 0.001])), ["boundary.0.from"]);
    assert_eq!(keys(|b| b.part = Some([f64::NAN, 0.001])), ["boundary.0.to"]);
    assert_eq!(keys(|b| b.prescribed.time = TimeFactor::ramp(0.0)), ["boundary.0.time.ramp"]);
    assert_eq!(keys(|b| b.prescribed.time.until = Some(-1.0)), ["boundary.0.time.until"]);
    assert_eq!(keys(|b| b.prescribed.time.course = Course::Table(vec![[0.0, 0.0], [0.0, 1.0]])), ["boundary.0.time"]);
    assert_eq!(
        keys(|b| {
            b.prescribed.motion = Motion::Displacement([1e-6, 0.0]);
            b.prescribed.time = TimeFactor { until: Some(1e-6), ..TimeFactor::ramp(1e-6) };
        }),
        ["boundary.0.time.until"]
    );
    let mut jumps = driven(Motion::Velocity([1.0, 0.0]), TimeFactor::default());
    jumps.boundaries[0].prescribed.motion = Motion::Displacement([1e-6, 0.0]);
    assert_eq!(validate(&jumps).unwrap_err()[0].key, "boundary.0.displacement", "the body is at rest and undeformed");
    jumps.equilibrium = true;
    assert!(validate(&jumps).is_ok());
    let mut twice = driven(Motion::Velocity([1.0, 0.0]), TimeFactor::default());
    twice.boundaries.push(Boundary { part: Some([0.0, 0.001]), ..Boundary::fixed(Side::Left, [true, false]) });
    assert_eq!(validate(&twice).unwrap_err()[0].key, "boundary.1.fix");
}

#[test]
fn parts_that_meet_in_a_control_point_move_alike() {
    let mut scene = elastic_scene(1, [0.01; 2], [10; 2]);
    let part = |ends, speed| Boundary { part: Some(ends), ..Boundary::driven(Side::Left, [true, false], [speed, 0.0]) };
    scene.boundaries = vec![part([0.0, 0.004], 1.0), part([0.004, 0.01], -1.0)];
    assert!(validate(&scene).is_ok());
    let breakdown = Simulation::new(&scene).unwrap_err();
    assert_eq!(breakdown.scene.expect("an error of the scene").key, "boundary.1.from");
    scene.boundaries[1] = part([0.005, 0.01], -1.0);
    assert!(Simulation::new(&scene).is_ok(), "a span between them");
    scene.boundaries[1] = part([0.004, 0.01], 1.0);
    assert!(Simulation::new(&scene).is_ok(), "the same motion");
}
