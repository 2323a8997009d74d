//! Bodies that are cracked through fall into fragments that part, meet and rub.

use crate::common::{body, brittle, elastic_scene, glass, rectangle, run};
use fisura::Simulation;
use fisura::scene::*;

/// A glass bar of 8 by 2 mm with a crack through its middle, in a larger mesh.
fn cracked_bar() -> Scene {
    let mut scene = elastic_scene(2, [0.012, 0.003], [48, 12]);
    scene.materials.insert("glass".into(), Material { fracture: Some(brittle()), ..glass() });
    let crack = Crack::seed([0.004, 0.0], [0.004, 0.002]);
    scene.bodies = vec![Body { cracks: vec![crack], ..body(rectangle([0.0; 2], [0.008, 0.002]), [2, 2]) }];
    scene.analysis =
        Analysis { frame: Frame::Updated, kinematics: Kinematics::Finite, safety: 0.5, ..scene.analysis.clone() };
    scene.contact = Some(Contact { friction: 0.3, fragments: true, ..Contact::default() });
    scene.output.samples = 10;
    scene
}

fn fragments(simulation: &Simulation) -> usize {
    simulation.updated_frame().unwrap().fields.len()
}

/// What has parted feels gravity alone: once the gap is open it falls as Galilei says, to round-off, and no
/// force of the half that is held acts on it.
#[test]
fn half_of_a_parted_bar_falls_freely() {
    let mut scene = cracked_bar();
    let (gravity, end) = (2e5, 30e-6);
    scene.analysis.gravity = [gravity, 0.0];
    scene.analysis.end_time = end;
    scene.boundaries = vec![Boundary::fixed(Side::Left, [true, true])];
    fisura::validate::validate(&scene).unwrap();
    let mut simulation = Simulation::new(&scene).unwrap();
    assert_eq!(fragments(&simulation), 2);
    let time = |simulation: &Simulation, half: usize| {
        let field = &simulation.updated_frame().unwrap().fields[half];
        field.momentum()[0] / (field.mass() * gravity)
    };
    let mut opened = [0.0; 2];
    while !simulation.finished() {
        simulation.step().unwrap();
        if 3 * simulation.steps() < simulation.plan().steps() {
            opened = [simulation.sample().time, time(&simulation, 1)];
        }
    }
    let sample = simulation.sample();
    let (passed, fallen) = (sample.time - opened[0], time(&simulation, 1) - opened[1]);
    assert!((fallen - passed).abs() < 1e-12 * end, "{fallen:e} s of {passed:e} s");
    assert!(time(&simulation, 0).abs() < 0.5 * end, "the other half is held: {:e} s", time(&simulation, 0));
    assert!(sample.closure.abs() < 1e-3 * sample.largest_term(), "{:e} of {sample:?}", sample.closure);
}

/// A grip goes on with the fragment that its edge is on, and its column has all of the work.
#[test]
fn a_grip_holds_the_fragment_that_its_edge_is_on() {
    let mut scene = cracked_bar();
    scene.analysis.end_time = 30e-6;
    scene.boundaries = vec![Boundary::fixed(Side::Left, [true, true])];
    scene.bodies[0].conditions = vec![EdgeCondition {
        name: Some("grip".into()),
        edge: Edge::Side(Side::Right),
        hold: Hold::Components([true, true]),
        prescribed: Prescribed::velocity([0.1, 0.0]), // 1 MPa, a third of the strength
    }];
    let (simulation, samples) = run(&scene);
    assert_eq!(fragments(&simulation), 2);
    let fields = &simulation.updated_frame().unwrap().fields;
    let moved = [0, 1].map(|half| {
        let points = &fields[half].points;
        points.iter().map(|point| point.displacement[0]).sum::<f64>() / points.len() as f64
    });
    // A sudden start makes the half swing by a twentieth of the way.
    assert!(moved[0].abs() < 1e-8 && (moved[1] - 3e-6).abs() < 3e-7, "{moved:?} m");
    let last = samples.last().unwrap();
    let work = last.named_values().into_iter().find(|(name, _)| name == "work_grip_j").unwrap().1;
    assert!((work - last.external_work).abs() <= 1e-9 * last.largest_term(), "{work:e} of {last:?}");
}

/// Without the key the body is one, and what the crack does not carry the common velocity field does.
#[test]
fn fragments_are_asked_for() {
    let mut scene = cracked_bar();
    scene.contact = None;
    scene.analysis.end_time = 2e-6;
    let (simulation, samples) = run(&scene);
    assert_eq!((fragments(&simulation), samples[0].fragments.as_ref()), (1, None));
}

/// Halves thrown at a wall push each other through their faces: momentum is that of bodies in contact, and
/// the energy has names.
#[test]
fn fragments_meet_again() {
    let mut scene = cracked_bar();
    let wall = Body { name: "wall".into(), rigid: true, ..body(rectangle([0.00802, -0.001], [0.01, 0.003]), [2, 2]) };
    scene.bodies[0].velocity = [0.5, 0.0];
    scene.bodies.push(wall);
    scene.analysis.end_time = 55e-6;
    scene.output.bodies = true;
    fisura::validate::validate(&scene).unwrap();
    let (simulation, samples) = run(&scene);
    assert_eq!(fragments(&simulation), 2);
    let areas = samples[0].fragments.as_ref().unwrap();
    assert!(areas.iter().all(|area| (area / 8e-6 - 1.0).abs() < 1e-12), "{areas:?} m2");
    let velocity = |sample: &fisura::dynamics::energy::Sample| sample.bodies.as_ref().unwrap().bodies[0].velocity[0];
    assert!((velocity(&samples[0]) - 0.5).abs() < 1e-12);
    let last = samples.last().unwrap();
    assert!(velocity(last) < -0.3, "{} m/s after the impact", velocity(last));
    assert!(samples.iter().all(|sample| sample.closure.abs() < 1e-2 * samples[0].kinetic), "{}", last.closure);
}
