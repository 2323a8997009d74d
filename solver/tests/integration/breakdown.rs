//! What breaks a run down, in words, and what is only a warning.

use crate::common::{driven_plate, elastic_scene, notched_plate, run};
use fisura::Simulation;
use fisura::scene::*;
use fisura::simulation::breakdown::Breakdown;

/// The scene with a fixed step of `ratio` times its critical step, for `steps` steps.
fn with_step(mut scene: Scene, ratio: f64, steps: usize) -> Scene {
    let critical = Simulation::new(&scene).unwrap().plan().critical;
    scene.analysis.time_step = TimeStep::Fixed(ratio * critical);
    scene.analysis.end_time = ratio * critical * steps as f64;
    scene
}

fn breakdown(scene: &Scene) -> Breakdown {
    let mut simulation = Simulation::new(scene).unwrap();
    assert!(simulation.warnings().iter().any(|w| w.contains("times the critical step")));
    while !simulation.finished() {
        match simulation.advance_to_next_sample() {
            Err(breakdown) => return breakdown,
            Ok(sample) => sample.named_values().into_iter().for_each(|(name, value)| {
                assert!(value.is_finite() || name.starts_with("crack_tip"), "{name} is {value}");
            }),
        }
    }
    panic!("{} steps passed without a breakdown", simulation.steps());
}

fn moving(degree: usize) -> Scene {
    let mut scene = elastic_scene(degree, [0.01, 0.005], [20, 10]);
    scene.bodies[0].tractions = vec![Traction::on(Side::Right, [1e6, 0.0], TimeFactor::default())];
    scene
}

fn check(name: &str, scene: &Scene) {
    let found = breakdown(scene);
    assert!(found.step > 0 && found.time.is_finite() && found.time > 0.0, "{name}: {found:?}");
    assert!(scene.bodies[0].shape.contains(found.place), "{name}: {:?}", found.place);
    assert!(found.cause.contains("times the critical step"), "{name}: {}", found.cause);
    let text = found.to_string();
    assert!(!text.contains("NaN") && text.contains(&format!("step {}", found.step)), "{text}");
}

#[test]
fn beyond_the_critical_step_the_run_says_so() {
    for degree in 1..=3 {
        check(&format!("elastic, degree {degree}"), &with_step(moving(degree), 1.3, 2000));
    }
    check("far beyond", &with_step(moving(2), 10.0, 2000));
    let mut spinning = elastic_scene(2, [0.01, 0.005], [20, 10]);
    spinning.bodies[0].angular_velocity = 1e3;
    check("spinning, without loads", &with_step(spinning, 1.3, 4000));
    check("driven", &with_step(driven_plate([20, 10]), 1.3, 2000));
    // The unstable mode is torn apart by the phase field before its elastic energy has grown: this plate
    // shatters (fracture energy 0.019 J to 0.071 J on 0.014 J of work), and the ledger tells.
    check("fracture", &with_step(notched_plate(1e5), 1.3, 100));
}

/// The quadrature of a coarse step leaves the ledger open in the first steps under a hard pull: a warning,
/// not the end.
#[test]
fn below_the_critical_step_an_open_ledger_is_a_warning() {
    for samples in [1, 20, 100] {
        let mut scene = with_step(notched_plate(2e7), 0.8, 100);
        scene.output.samples = samples;
        run(&scene);
    }
}

/// Loads no solid bears.
fn crushing() -> Vec<Traction> {
    let press = |side, stress| Traction::on(side, [stress, 0.0], TimeFactor::default());
    vec![press(Side::Right, -2e12), press(Side::Left, 2e12)]
}

/// A load no solid bears turns the body inside out, elastic or fracturing: the run ends at that step and says
/// so instead of blaming the time step.
#[test]
fn a_body_turned_inside_out_is_named() {
    let brittle_with = |split| Some(Fracture { split, ..crate::common::brittle() });
    for fracture in [None, brittle_with(Split::Spectral), brittle_with(Split::None)] {
        for frame in [Frame::Total, Frame::Updated] {
            let mut scene = elastic_scene(2, [0.01, 0.005], [40, 20]);
            scene.analysis.frame = frame;
            scene.analysis.kinematics = Kinematics::Finite;
            scene.materials.get_mut("glass").unwrap().fracture = fracture.clone();
            scene.bodies[0].shape = crate::common::rectangle([0.003, 0.001], [0.007, 0.004]);
            scene.bodies[0].tractions = crushing();
            let name = format!("{frame:?}, {fracture:?}");
            let (simulation, found) = first_breakdown(&scene, &name);
            assert!(found.what.contains("a material point is inverted, det F = -"), "{name}: {found}");
            assert!(found.cause.contains("inside out"), "{name}: {found}");
            assert!(found.step == simulation.steps() && found.point.is_some(), "{name}: {found:?}");
            let inside = |d: usize| (0.0..=[0.01, 0.005][d]).contains(&found.place[d]);
            assert!(inside(0) && inside(1), "{name}: {found}");
        }
    }
}

/// Steps up to the breakdown.
fn first_breakdown(scene: &Scene, name: &str) -> (Simulation, Breakdown) {
    let mut simulation = Simulation::new(scene).unwrap();
    loop {
        match simulation.step() {
            Err(found) => return (simulation, found),
            Ok(()) => assert!(!simulation.finished(), "{name}: the load was borne"),
        }
    }
}

/// Energies that overflow in a body of either kinematics and material: the run ends where the first number is
/// none.
#[test]
fn no_number_that_is_not_finite_outlives_its_step() {
    for kinematics in [Kinematics::Small, Kinematics::Finite] {
        for frame in [Frame::Total, Frame::Updated] {
            for mut scene in [notched_plate(1e308), crate::common::pulled_plate(1e308)] {
                scene.bodies[0].tractions.iter_mut().for_each(|traction| traction.time = TimeFactor::default());
                (scene.analysis.frame, scene.analysis.kinematics) = (frame, kinematics);
                let fractures = scene.materials["glass"].fracture.is_some();
                let name = format!("{frame:?}, {kinematics:?}, fracture: {fractures}");
                let (simulation, found) = first_breakdown(&scene, &name);
                assert!(found.step == simulation.steps() && found.step <= 3, "{name}: {found}");
                assert!(found.place.iter().all(|x| x.is_finite()), "{name}: {found}");
                let named = ["not finite", "is not a number", "inverted"];
                assert!(named.iter().any(|words| found.what.contains(words)), "{name}: {found}");
            }
        }
    }
}

/// Constants whose products overflow have no critical step, which no minimum with other steps may hide.
#[test]
fn a_critical_step_that_is_no_number_is_refused() {
    for frame in [Frame::Total, Frame::Updated] {
        let mut scene = moving(2);
        scene.analysis.frame = frame;
        scene.materials.get_mut("glass").unwrap().young_modulus = f64::MAX;
        let found = Simulation::new(&scene).unwrap_err();
        assert!(found.what.contains("critical time step is not a number") && found.step == 0, "{frame:?}: {found}");
    }
}

/// Loads so large that energies overflow: the step in which that begins says so at the point where it does,
/// and does not blame the tolerance of the phase field, which is what met the numbers first.
#[test]
fn numbers_that_are_not_finite_are_named_where_they_begin() {
    for frame in [Frame::Total, Frame::Updated] {
        let mut scene = notched_plate(1e200);
        scene.bodies[0].tractions[1].time = TimeFactor::default();
        scene.analysis.frame = frame;
        let (simulation, found) = first_breakdown(&scene, &format!("{frame:?}"));
        let text = format!("{frame:?}: {found}");
        assert!(found.step == simulation.steps() && found.step <= 3, "{text}");
        assert!(found.place.iter().all(|x| x.is_finite()), "{text}");
        assert!(!text.contains("tolerance") && !text.contains("enlarge mesh.size"), "{text}");
        assert!(found.cause.contains("may be extreme"), "{text}");
        let inspection = simulation.inspect();
        assert!(inspection.not_finite > 0 || inspection.largest_strain > 1e3, "{text}: {inspection:?}");
        assert_eq!(inspection.points, 3200);
        let worst = &inspection.worst[0];
        assert!(found.point.is_none_or(|point| point == worst.point && found.place == worst.position), "{text}");
    }
}

/// A time step above the critical one does not hide why a run ends: a body leaves the mesh, or is turned
/// inside out.
#[test]
fn a_long_step_is_named_beside_the_cause_and_not_for_it() {
    let mut leaving = elastic_scene(2, [0.01, 0.005], [20, 10]);
    leaving.analysis.frame = Frame::Updated;
    leaving.bodies[0].shape = crate::common::rectangle([0.002, 0.001], [0.008, 0.004]);
    leaving.bodies[0].velocity = [1000.0, 0.0];
    let mut crushed = leaving.clone();
    crushed.analysis.kinematics = Kinematics::Finite;
    crushed.bodies[0].velocity = [0.0; 2];
    crushed.bodies[0].tractions = crushing();
    let scenes =
        [("leaving", leaving, "the body moves out of the mesh"), ("crushed", crushed, "the body is turned inside")];
    for (name, scene, cause) in scenes {
        for ratio in [0.5, 1.02] {
            let found = first_breakdown(&with_step(scene.clone(), ratio, 200), name).1;
            assert!(found.cause.starts_with(cause), "{name}, {ratio}: {found}");
            let is_off_mesh = found.place[0] > 0.01 && found.what.contains("left the mesh");
            assert_eq!(is_off_mesh && found.cause.contains("enlarge mesh.size"), name == "leaving", "{ratio}: {found}");
            assert_eq!(found.cause.contains("besides, the time step"), ratio > 1.0, "{name}, {ratio}: {found}");
        }
    }
}
