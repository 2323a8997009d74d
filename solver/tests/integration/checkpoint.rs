//! A run taken up from a checkpoint goes on bit by bit, whatever it models, and a checkpoint leaves the run
//! alone.

use crate::common::{
    body, brittle, driven_plate, elastic_scene, glass, horseshoe, make_at1, make_cohesive, notched_plate, patch_scene,
    rectangle,
};
use crate::pressure::spinning_ring;
use fisura::Simulation;
use fisura::scene::*;
use fisura::simulation::state::ResumeError;

/// Steps that are run again from a checkpoint; from the one in the middle, the run is continued to its end.
const FEW: usize = 10;

/// Runs `scene`, and parts of it again from checkpoints after some of its steps. The last states are compared
/// byte by byte, and so are all samples on the way.
#[track_caller]
fn goes_on_bit_by_bit(name: &str, scene: &Scene) {
    fisura::validate::validate(scene).unwrap_or_else(|errors| panic!("{name}: {errors:?}"));
    let mut undisturbed = Simulation::new(scene).unwrap();
    let rest = |simulation: &mut Simulation, most: usize| {
        let mut samples = Vec::new();
        while !simulation.finished() && samples.len() < most {
            simulation.step().unwrap_or_else(|b| panic!("{name}: {b}"));
            samples.push(format!("{:?}", simulation.sample()));
        }
        (samples, simulation.checkpoint().unwrap())
    };
    let (samples, end) = rest(&mut undisturbed, usize::MAX);
    let steps = samples.len();
    assert!(steps >= 20, "{name}: {steps} steps are hardly a run");

    let mut simulation = Simulation::new(scene).unwrap();
    for step in 0..steps {
        if [0, 1, steps / 2, steps - 1].contains(&step) {
            let state = simulation.checkpoint().unwrap();
            let mut resumed = Simulation::resume(scene, &state).unwrap_or_else(|e| panic!("{name}, step {step}: {e}"));
            assert_eq!(resumed.steps(), step);
            assert_eq!(resumed.checkpoint().unwrap(), state, "{name}: the state of step {step} is not taken up whole");
            let (again, last) = rest(&mut resumed, if step == steps / 2 { usize::MAX } else { FEW });
            let first = again.iter().zip(&samples[step..]).position(|(a, b)| a != b);
            assert_eq!(first, None, "{name}: from step {step} on, this step differs first");
            if resumed.finished() {
                assert!(last == end, "{name}: the states at the end differ, from step {step} on");
                assert_eq!(resumed.warnings(), undisturbed.warnings());
                let picture = |of: &Simulation| format!("{:?}", of.picture([40, 20]));
                assert_eq!(picture(&resumed), picture(&undisturbed));
            }
        }
        simulation.step().unwrap();
    }
    assert!(simulation.checkpoint().unwrap() == end, "{name}: storing the state changed the run");
}

fn pulled_and_driven() -> Scene {
    let mut scene = driven_plate([20, 10]);
    scene.analysis.gravity = [0.0, -9.81];
    scene.bodies[0].tractions = vec![Traction::on(Side::Top, [1e5, 1e6], TimeFactor::ramp(2e-6))];
    scene
}

#[test]
fn in_the_total_frame() {
    goes_on_bit_by_bit("elastic, driven", &pulled_and_driven());
    let mut held = pulled_and_driven();
    let hold = Hold::Components([false, true]);
    let edge = EdgeCondition::fixed(Edge::Side(Side::Bottom), hold);
    held.bodies[0].conditions = vec![EdgeCondition { name: Some("base".to_string()), ..edge }];
    goes_on_bit_by_bit("held at an edge", &held);
    let mut consistent = pulled_and_driven();
    consistent.analysis.mass = Mass::Consistent;
    goes_on_bit_by_bit("consistent mass", &consistent);
    let mut refined = crate::refinement::refined(2, [32, 16], 2);
    refined.solver.phase_field_interval = PhaseFieldInterval::Automatic;
    goes_on_bit_by_bit("refined along a crack", &refined);
    for kinematics in [Kinematics::Small, Kinematics::Finite] {
        let mut scene = notched_plate(2e7);
        scene.analysis.kinematics = kinematics;
        scene.analysis.end_time = 3e-6;
        goes_on_bit_by_bit("cracking", &scene);
        scene.solver.phase_field_interval = PhaseFieldInterval::Automatic;
        goes_on_bit_by_bit("cracking, an automatic interval", &scene);
        scene.solver.phase_field_interval = PhaseFieldInterval::Steps(1);
        for split in [Split::Spectral, Split::StarConvex(2.0)] {
            make_at1(&mut scene, split);
            goes_on_bit_by_bit("cracking, with a threshold", &scene);
        }
        make_cohesive(&mut scene, 7.5e6, Softening::Exponential, Split::Rankine);
        goes_on_bit_by_bit("cracking, cohesive", &scene);
    }
    let mut direct = notched_plate(2e7);
    direct.analysis.end_time = 1e-6;
    direct.solver.phase_field_solver = PhaseFieldSolver::Cholesky;
    goes_on_bit_by_bit("cracking, direct solver", &direct);
    let mut mapped = patch_scene(&crate::common::annulus(2, 6), 3);
    mapped.analysis.end_time = 1e-3;
    mapped.bodies[0].tractions = vec![Traction::on(Side::Right, [1e6, 0.0], TimeFactor::default())];
    goes_on_bit_by_bit("general patch", &mapped);
}

/// A cracked plate that flies through spans, spinning.
fn flying(transfer: Transfer, kinematics: Kinematics) -> Scene {
    let mut scene = notched_plate(1e3);
    scene.mesh = Mesh::uniform([2, 2], [-0.003, -0.003], [0.020, 0.012], [80, 48]);
    scene.bodies[0].velocity = [150.0, 60.0];
    scene.analysis = Analysis { frame: Frame::Updated, transfer, kinematics, end_time: 1.5e-6, ..scene.analysis };
    scene.analysis.safety = 0.5;
    scene.bodies[0].angular_velocity = 1e4; // drives the phase field
    if transfer != Transfer::Flip {
        scene.bodies[0].tractions.clear();
    }
    scene
}

#[test]
fn in_the_updated_frame_with_every_transfer() {
    for transfer in [Transfer::Flip, Transfer::Pic, Transfer::Apic, Transfer::Tpic, Transfer::Xpic(3)] {
        let kinematics = if transfer == Transfer::Pic { Kinematics::Small } else { Kinematics::Finite };
        goes_on_bit_by_bit(&format!("{transfer:?}"), &flying(transfer, kinematics));
    }
    let mut driven = flying(Transfer::Apic, Kinematics::Finite);
    let prescribed = Prescribed { motion: Motion::Velocity([150.0, 60.0]), time: TimeFactor::default() };
    let hold = Hold::Components([true, true]);
    let name = Some("grip".into());
    driven.bodies[0].conditions = vec![EdgeCondition { name, edge: Edge::Side(Side::Left), hold, prescribed }];
    goes_on_bit_by_bit("an edge that is driven", &driven);
    for frame in [Frame::Total, Frame::Updated] {
        goes_on_bit_by_bit(&format!("a pressure that follows, {frame:?}"), &spinning_ring(frame, 0.01));
    }
    let mut sliding = flying(Transfer::Apic, Kinematics::Finite);
    sliding.mesh = Mesh::uniform([2, 2], [-0.003, 0.0], [0.020, 0.012], [80, 48]);
    (sliding.bodies[0].velocity, sliding.bodies[0].angular_velocity) = ([900.0, 0.0], 0.0);
    sliding.analysis.end_time = 4e-6;
    sliding.boundaries = vec![Boundary::fixed(Side::Bottom, [false, true])];
    goes_on_bit_by_bit("a side that a body slides along", &sliding);
    let mut far = flying(Transfer::Flip, Kinematics::Small);
    far.bodies[0].tractions.clear();
    (far.bodies[0].velocity, far.analysis.end_time) = ([900.0, 100.0], 4e-6); // the part follows the body
    goes_on_bit_by_bit("far", &far);
}

/// Discs that fly at each other and turn, and a rigid floor that rises and turns.
fn rubbing(gap: f64, points: usize) -> Scene {
    let mut scene = elastic_scene(2, [0.02, 0.02], [40, 40]);
    let disc = |name: &str, x: f64, speed: f64| Body {
        name: name.into(),
        velocity: [speed, -20.0],
        angular_velocity: 2e3,
        ..body(Shape::Disk { center: [x, 0.009], radius: 0.004 }, [points; 2])
    };
    let floor = Body {
        rigid: true,
        velocity: [5.0, 30.0],
        angular_velocity: 100.0,
        name: "floor".into(),
        ..body(rectangle([0.001, 0.001], [0.019, 0.0049]), [2, 2])
    };
    scene.bodies = vec![disc("left", 0.006 - gap, 60.0), disc("right", 0.014 + gap, -60.0), floor];
    scene.contact = Some(Contact { friction: 0.4, ..Contact::default() });
    scene.analysis.frame = Frame::Updated;
    scene
}

#[test]
fn with_contact_friction_and_rigid_bodies() {
    let mut scene = rubbing(1e-4, 2);
    scene.materials.get_mut("glass").unwrap().fracture = Some(Fracture { length_scale: 0.5e-3, ..brittle() });
    scene.analysis.end_time = 8e-6;
    let (simulation, samples) = crate::common::run(&scene);
    let end = samples.last().unwrap().contact.unwrap();
    assert!(end.loss > 0.0 && end.friction > 0.0, "the bodies meet and rub: {end:?}");
    assert_eq!(simulation.extent().models, ["momentum", "phase field", "contact"]);
    goes_on_bit_by_bit("contact", &scene);
}

#[test]
fn with_fragments() {
    let mut scene = elastic_scene(2, [0.016, 0.01], [64, 40]);
    scene.materials.insert("glass".into(), Material { fracture: Some(brittle()), ..glass() });
    let crack = Crack::seed([0.008, 0.004], [0.008, 0.006]);
    scene.bodies = vec![Body {
        cracks: vec![crack],
        angular_velocity: 2e4,
        ..body(rectangle([0.004, 0.004], [0.012, 0.006]), [2, 2])
    }];
    scene.contact = Some(Contact { friction: 0.2, fragments: true, ..Contact::default() });
    scene.analysis = Analysis { frame: Frame::Updated, end_time: 3e-6, safety: 0.5, ..scene.analysis };
    let (simulation, _) = crate::common::run(&scene);
    assert!(simulation.updated_frame().unwrap().fields.len() >= 2);
    goes_on_bit_by_bit("fragments", &scene);
    let edge = Edge::Segment([[0.004, 0.004], [0.004, 0.006]]);
    scene.bodies[0].conditions = vec![EdgeCondition::fixed(edge, Hold::Components([true; 2]))];
    goes_on_bit_by_bit("fragments of a held body", &scene);
}

#[test]
fn with_contact_of_a_body_with_itself() {
    let scene = horseshoe();
    let (_, samples) = crate::common::run(&scene);
    assert!(samples.last().unwrap().contact.unwrap().friction > 0.0, "its sides meet");
    goes_on_bit_by_bit("a body that may meet itself", &scene);
}

#[test]
fn with_contact_in_the_total_frame() {
    let mut scene = rubbing(5e-5, 3);
    let (frame, kinematics) = (Frame::Total, Kinematics::Finite);
    scene.analysis = Analysis { frame, kinematics, end_time: 4e-6, ..scene.analysis };
    let (_, samples) = crate::common::run(&scene);
    let end = samples.last().unwrap();
    assert!(end.contact.unwrap().friction > 0.0 && end.external_work != 0.0, "the bodies meet and rub: {end:?}");
    goes_on_bit_by_bit("friction and a rigid body in the total frame", &scene);
    scene.bodies.truncate(2);
    scene.contact = Some(Contact::default());
    let (_, samples) = crate::common::run(&scene);
    assert!(samples.last().unwrap().contact.unwrap().loss > 0.0, "the bodies meet");
    goes_on_bit_by_bit("contact in the total frame", &scene);
}

#[test]
fn a_state_of_another_scene_or_cut_short_is_refused_in_words() {
    let scene = notched_plate(1e6);
    let mut simulation = Simulation::new(&scene).unwrap();
    simulation.step().unwrap();
    let state = simulation.checkpoint().unwrap();
    let refused = |scene: &Scene, state: &[u8]| match Simulation::resume(scene, state) {
        Err(ResumeError::State(error)) => error.0,
        other => panic!("{other:?}"),
    };
    for length in [0, 1, state.len() / 2, state.len() - 1] {
        assert!(refused(&scene, &state[..length]).contains("damaged"), "{length} bytes");
    }
    let mut finer = scene.clone();
    finer.mesh = Mesh::uniform([2, 2], [0.0; 2], [0.01, 0.005], [44, 20]);
    assert!(refused(&finer, &state).contains("another scene"));
    let mut elastic = scene.clone();
    elastic.materials.get_mut("glass").unwrap().fracture = None;
    elastic.bodies[0].cracks.clear();
    refused(&elastic, &state);
    let mut updated = flying(Transfer::Flip, Kinematics::Small);
    updated.bodies[0].shape = scene.bodies[0].shape.clone();
    refused(&updated, &state);
}

#[test]
fn what_a_failed_step_leaves_is_not_stored() {
    let mut scene = pulled_and_driven();
    let critical = Simulation::new(&scene).unwrap().plan().critical;
    scene.analysis.time_step = TimeStep::Fixed(1.2 * critical);
    scene.analysis.end_time = 1000.0 * critical;
    let mut simulation = Simulation::new(&scene).unwrap();
    while simulation.step().is_ok() {
        assert!(!simulation.finished(), "1.2 times the critical step is unstable");
    }
    let error = simulation.checkpoint().unwrap_err().to_string();
    assert!(error.contains(&format!("step {} failed", simulation.steps())), "{error}");
}

/// What a sample finds broken is no state to go on from.
#[test]
fn a_sample_that_breaks_is_not_stored() {
    let mut simulation = Simulation::new(&pulled_and_driven()).unwrap();
    simulation.step().unwrap();
    assert!(simulation.checkpoint().is_ok());
    let mut sample = simulation.sample();
    sample.kinetic = f64::NAN;
    let found = simulation.watch_ledger(&sample).unwrap_err();
    assert!(found.what.contains("kinetic"), "{found}");
    assert!(simulation.checkpoint().is_err());
}
