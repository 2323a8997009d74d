//! Small strains do not follow rotations: a run whose material turns says so.

use crate::common::{brittle, elastic_scene, rectangle, run};
use fisura::scene::*;

/// A free bar that turns by about `angle` (rad) as a whole.
fn spinning(frame: Frame, kinematics: Kinematics, angle: f64) -> Scene {
    let mut scene = elastic_scene(2, [0.02, 0.02], [20, 20]);
    (scene.analysis.frame, scene.analysis.kinematics) = (frame, kinematics);
    scene.bodies[0].shape = rectangle([0.006, 0.008], [0.014, 0.012]);
    scene.bodies[0].angular_velocity = angle / scene.analysis.end_time;
    scene
}

/// Warnings of a run to its end.
fn warnings(scene: &Scene) -> Vec<String> {
    let (simulation, _) = run(scene);
    simulation.warnings().iter().filter(|warning| warning.contains("has turned by")).cloned().collect()
}

#[test]
fn a_bar_that_turns_with_small_strains_is_told_once() {
    for frame in [Frame::Total, Frame::Updated] {
        for (kinematics, angle, told) in
            [(Kinematics::Small, 0.13, 1), (Kinematics::Small, 0.08, 0), (Kinematics::Finite, 0.13, 0)]
        {
            let found = warnings(&spinning(frame, kinematics, angle));
            assert_eq!(found.len(), told, "{frame:?}, {kinematics:?}, {angle} rad: {found:?}");
            assert!(found.iter().all(|text| text.contains("kinematics = \"finite\"")), "{found:?}");
        }
    }
}

#[test]
fn a_bar_that_stretches_with_small_strains_is_told_once() {
    for frame in [Frame::Total, Frame::Updated] {
        for (kinematics, strain, told) in
            [(Kinematics::Small, 0.13, 1), (Kinematics::Small, 0.08, 0), (Kinematics::Finite, 0.13, 0)]
        {
            let mut scene = spinning(frame, kinematics, 0.0);
            let rate = strain / scene.analysis.end_time;
            scene.bodies[0].velocity_gradient = [[rate, 0.0], [0.0, 0.0]];
            scene.materials.get_mut("glass").unwrap().young_modulus *= 1e-6; // no stress in that time
            let (simulation, _) = run(&scene);
            let found: Vec<_> = simulation.warnings().iter().filter(|text| text.contains("is strained by")).collect();
            assert_eq!(found.len(), told, "{frame:?}, {kinematics:?}, {strain}: {:?}", simulation.warnings());
        }
    }
}

#[test]
fn a_larger_strain_does_not_hide_the_rotation_of_a_body_that_can_break() {
    for frame in [Frame::Total, Frame::Updated] {
        let mut scene = spinning(frame, Kinematics::Small, 0.13);
        scene.bodies[0].velocity_gradient = [[0.2 / scene.analysis.end_time, 0.0], [0.0, 0.0]];
        let glass = scene.materials.get_mut("glass").unwrap();
        (glass.young_modulus, glass.fracture) = (1e-6 * glass.young_modulus, Some(brittle()));
        assert_eq!(warnings(&scene).len(), 1, "{frame:?}");
    }
}

/// A part that bends away counts as much as a body that turns as a whole, and a place is named where it does.
#[test]
fn the_place_that_turns_is_named() {
    let mut scene = spinning(Frame::Total, Kinematics::Small, 0.13);
    scene.materials.get_mut("glass").unwrap().fracture = Some(brittle());
    let found = warnings(&scene);
    assert_eq!(found.len(), 1, "{found:?}");
    let (_, place) = found[0].split_once("near (").unwrap();
    let (place, _) = place.split_once(") m").unwrap();
    let place: Vec<f64> = place.split(", ").map(|x| x.parse().unwrap()).collect();
    assert!(scene.bodies[0].shape.contains([place[0], place[1]]), "{found:?}");
}

/// Spans at a stepped edge may hold one point, which does not turn.
#[test]
fn a_disc_that_flies_straight_has_not_turned() {
    let mut scene = spinning(Frame::Updated, Kinematics::Small, 0.0);
    scene.bodies[0].shape = Shape::Disk { center: [0.0098, 0.0101], radius: 0.0043 };
    scene.bodies[0].velocity = [3.0, 1.7];
    assert_eq!(warnings(&scene), Vec::<String>::new());
}
