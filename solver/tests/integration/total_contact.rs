//! Contact in the total frame: what is told, and what is not there before bodies meet.

use crate::common::{body, elastic_scene, glass, rectangle, run, unit_solid, updated_scene};
use fisura::Simulation;
use fisura::dynamics::failure::Failure;
use fisura::dynamics::total_frame::bodies::TotalBodies;
use fisura::linear_algebra::extremes::larger;
use fisura::scene::*;

const RADIUS: f64 = 0.2;

/// Two discs that meet off centre, `gap` metres apart at the start.
fn discs(degree: usize, cells: usize, gap: f64) -> Scene {
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [1.4, 1.2], [7 * cells / 5, 6 * cells / 5]);
    let offset: f64 = 0.15;
    let apart = (2.0 * RADIUS + gap).powi(2) - offset * offset;
    let center = [0.7 - 0.5 * apart.sqrt(), 0.6 - 0.5 * offset];
    let mut scene = updated_scene(unit_solid(), mesh, Shape::Disk { center, radius: RADIUS });
    scene.bodies[0].particles_per_cell = [degree + 1; 2];
    scene.bodies[0].layout = Layout::Gauss;
    scene.bodies[0].velocity = [0.05, 0.0];
    let center = [1.4 - center[0], 1.2 - center[1]];
    scene.bodies.push(Body {
        name: "right".into(),
        shape: Shape::Disk { center, radius: RADIUS },
        velocity: [-0.05, 0.0],
        ..scene.bodies[0].clone()
    });
    scene.contact = Some(Contact::default());
    scene.analysis.kinematics = Kinematics::Finite;
    scene.analysis.frame = Frame::Total;
    scene.analysis.safety = 0.5;
    scene
}

#[test]
fn a_rigid_plate_works_on_the_disc_it_pushes() {
    let mut scene = discs(2, 20, 0.01);
    scene.bodies[0].velocity = [0.0; 2];
    let plate = Shape::Rectangle { min: [0.9, 0.0], max: [1.2, 1.2] };
    let left = scene.bodies[0].shape.bounding_box().1[0];
    scene.bodies[1] = Body { rigid: true, shape: plate, ..scene.bodies[1].clone() };
    scene.contact = Some(Contact { friction: 0.5, ..Contact::default() });
    scene.analysis.end_time = (0.9 - left) / 0.05 + 1.5;
    let (simulation, samples) = crate::common::run(&scene);
    let last = samples.last().unwrap();
    let closure = samples.iter().map(|s| s.closure.abs()).fold(0.0, larger);
    assert!(last.external_work > 0.0 && closure < 0.02 * last.external_work, "{last:?}");
    // Elastic: the disc leaves at twice the speed of the plate, but for its vibration.
    let (mass, momentum) = simulation.momenta()[0];
    let speed = momentum[0] / mass;
    assert!((-0.1..-0.09).contains(&speed), "{speed}");
    let work = 0.05 * mass * -speed;
    assert!((last.external_work - work).abs() < 0.02 * work, "{} {work}", last.external_work);
}

#[test]
fn there_is_no_force_before_boundaries_meet() {
    for degree in [2, 3] {
        let scene = discs(degree, 20, 0.004); // a twelfth of a span
        let mut simulation = Simulation::new(&scene).unwrap();
        assert_eq!(simulation.extent().models, ["momentum", "contact"]);
        let step = simulation.plan().step;
        // they approach by 0.1 m/s, along a line that is nearly that of the centres
        let touching = (0.004 / 0.1 / step) as usize;
        for _ in 0..touching {
            simulation.step().unwrap();
            assert!(simulation.contact_forces().is_empty() && simulation.sample().elastic <= 1e-24);
        }
        (0..40).for_each(|_| simulation.step().unwrap());
        assert!(!simulation.contact_forces().is_empty());
    }
}

#[test]
fn a_condition_that_cannot_be_met_names_its_body() {
    let mut scene = discs(2, 20, 0.01);
    let hold = Hold::Components([true, true]);
    let prescribed = Prescribed::velocity([0.0; 2]);
    let edge = Edge::Segment([[0.01, 0.01], [0.02, 0.01]]);
    scene.bodies[1].conditions = vec![EdgeCondition { name: None, edge, hold, prescribed }];
    let failure = TotalBodies::new(&scene).unwrap_err();
    assert_eq!(failure, Failure::HeldTwice { body: 1, condition: 0 });
}

#[test]
fn a_side_holds_the_bodies_that_reach_it_and_no_others() {
    let mut scene = discs(2, 20, 0.01);
    let block = |x: f64, y: f64| Shape::Rectangle { min: [x, y], max: [x + 0.4, y + 0.4] };
    scene.bodies[0].shape = block(0.2, 0.0);
    scene.bodies[1].shape = block(0.8, 0.02); // its first span reaches the side
    scene.bodies.iter_mut().for_each(|body| body.velocity = [0.0, 0.05]);
    scene.boundaries = vec![Boundary::fixed(Side::Bottom, [true; 2])];
    scene.analysis.end_time = 0.2;
    let (simulation, _) = crate::common::run(&scene);
    let [(_, held), (mass, free)] = simulation.momenta()[..] else { panic!("two bodies") };
    assert!((free[1] / mass - 0.05).abs() < 1e-12 && held[1] < 0.9 * free[1], "{held:?} {free:?}");
}

#[test]
fn a_disc_may_fill_a_hole_and_rigid_bodies_that_approach_are_told() {
    let mut scene = discs(2, 20, 0.01);
    let Shape::Disk { center, radius } = scene.bodies[0].shape else { panic!("a disc") };
    scene.bodies[1].shape = Shape::Annulus { center, inner_radius: radius, outer_radius: 1.4 * radius };
    let told = |scene: &Scene| fisura::validate::validate(scene).unwrap().iter().any(|w| w.message.contains("rigid"));
    assert!(!told(&scene));
    scene.bodies.extend([0.05, 0.35].map(|y| Body {
        name: format!("block at {y}"),
        shape: Shape::Rectangle { min: [1.1, y], max: [1.3, y + 0.1] },
        velocity: [0.0, 0.2 - y],
        rigid: true,
        ..scene.bodies[0].clone()
    }));
    assert!(told(&scene));
}

/// Bodies that overlap a little at the start are pushed apart by what contact holds, which the ledger knows.
#[test]
fn an_overlap_at_the_start_is_energy_put_in() {
    for overlap in [1e-9, 1e-7, 2e-5] {
        let mut scene = elastic_scene(2, [1.0, 1.0], [20, 20]);
        scene.mesh = Mesh::uniform([2; 2], [-0.5, -0.3], [1.0, 1.0], [20, 20]);
        scene.materials.insert("glass".into(), Material { young_modulus: 1e7, density: 1e3, ..glass() });
        let block = |name: &str, min, max| Body { name: name.into(), ..body(rectangle(min, max), [2; 2]) };
        scene.bodies = vec![block("upper", [-0.2, -overlap], [0.2, 0.2]), block("lower", [-0.45, -0.25], [0.45, 0.0])];
        scene.contact = Some(Contact::default());
        scene.analysis.kinematics = Kinematics::Finite;
        scene.analysis.end_time = 0.02;
        scene.analysis.safety = 0.2;
        let (_, samples) = run(&scene);
        let (first, last) = (samples[0].contact.unwrap().loss, samples.last().unwrap());
        assert!(first > 0.0 && last.contact.unwrap().loss < 0.1 * first, "{overlap}: {first:e} J, then {last:?}");
        assert!(last.closure.abs() < 1e-2 * first, "{overlap}: open by {:e} of {first:e} J", last.closure);
        assert!(last.kinetic + last.elastic > 0.8 * first);
    }
}

/// A corner reaches just into a span at many of these places. The functions there have slopes, but next to no
/// mass.
#[test]
fn turned_bodies_in_contact_do_not_take_much_shorter_steps() {
    let step = |angle: f64, shift: f64| {
        let mut scene = discs(2, 20, 0.1);
        let turned = |[x, y]: [f64; 2], center: [f64; 2]| {
            let (sin, cos) = angle.sin_cos();
            [center[0] + x * cos - y * sin + shift, center[1] + x * sin + y * cos + 0.7 * shift]
        };
        for (body, center) in scene.bodies.iter_mut().zip([[0.4, 0.6], [1.0, 0.6]]) {
            let corners = [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1]];
            body.shape = Shape::Polygon { points: corners.map(|corner| turned(corner, center)).to_vec() };
        }
        Simulation::new(&scene).unwrap().plan().step
    };
    let along = step(0.0, 0.0);
    for (angle, shift) in (0..24).map(|i| (0.13 + 0.061 * f64::from(i), 0.0023 * f64::from(i))) {
        let share = step(angle, shift) / along;
        assert!(share > 0.5, "{share} at {angle} and {shift}");
    }
}
