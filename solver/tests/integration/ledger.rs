//! The energy ledger of a fracturing plate: it closes, and every term counts.

use crate::common::{closure_of_any_sample, elastic_scene, notched_plate, relative_closure, run};
use fisura::Simulation;
use fisura::dynamics::energy::{FractureSample, Sample};
use fisura::scene::*;

/// The plate under 4 MPa, up to the time at which the crack has run half of its way: kinetic and fracture
/// energy are then of a size. Once it is in two, the halves fly off and their kinetic energy dwarfs whatever
/// closure there is.
#[test]
fn a_fracturing_plate_closes_and_every_term_moves_closure() {
    let mut scene = notched_plate(4e6);
    scene.analysis.end_time = 3.2e-6;
    scene.analysis.safety = 0.3;
    let initial = Simulation::new(&scene).unwrap().sample().stored();
    let (simulation, samples) = run(&scene);
    assert!(simulation.steps() >= 150, "{} steps", simulation.steps());
    let tip = |s: &Sample| s.fracture.as_ref().unwrap().crack_tip.unwrap().place[0];
    let grown = tip(samples.last().unwrap()) - tip(&samples[0]);
    assert!(grown > 1e-3, "the crack grew by {grown:e} m");
    assert!(relative_closure(&samples) <= 1e-3, "closure {:e}", relative_closure(&samples));
    let last = samples.last().unwrap();
    let scale = last.largest_term();
    let change = 0.01 * scale;
    type Change = fn(&mut Sample, f64);
    let fracture: fn(&mut Sample) -> &mut FractureSample = |s| s.fracture.as_mut().unwrap();
    let terms: [(&str, f64, Change); 7] = [
        ("kinetic", 1.0, |s, by| s.kinetic += by),
        ("stagger", -1.0, |s, by| s.stagger += by),
        ("elastic", 1.0, |s, by| s.elastic += by),
        ("fracture", 1.0, |s, by| s.fracture.as_mut().unwrap().energy += by),
        ("external work", -1.0, |s, by| s.external_work += by),
        ("history work", -1.0, |s, by| s.fracture.as_mut().unwrap().works[0].1 += by),
        ("transfer loss", 1.0, |s, by| s.transfer_loss = Some(by)),
    ];
    let mut same = last.clone();
    same.close(initial);
    assert_eq!(same, *last, "closing a sample again changes nothing");
    for (name, sign, alter) in terms {
        let mut altered = last.clone();
        alter(&mut altered, change);
        altered.close(initial);
        let moved = altered.closure - last.closure;
        assert!((moved - sign * change).abs() <= 1e-13 * scale, "{name}: closure moved by {moved:e} for {change:e}");
        assert!(altered.closure.abs() > 5e-3 * scale, "{name}: an error of 1 % is seen");
    }
    let mut moved_start = last.clone();
    moved_start.close(initial + change);
    assert!((moved_start.closure - last.closure + change).abs() <= 1e-13 * scale);

    let mut forgotten = last.clone();
    let work = std::mem::take(&mut fracture(&mut forgotten).works[0].1);
    forgotten.close(initial);
    assert!((forgotten.closure - last.closure - work).abs() <= 1e-13 * scale);
    assert!(work > 0.0 && work > 10.0 * last.closure.abs(), "history work {work:e} J is no part of closure");
}

/// The terms are recomputed from what the simulation holds, without its ledger: kinetic energy and momentum
/// from masses and velocities, external work of gravity from the fall of the centre of mass.
#[test]
fn terms_equal_their_definitions() {
    let mut scene = elastic_scene(2, [0.01, 0.005], [20, 10]);
    scene.analysis.gravity = [3e6, -7e6];
    scene.analysis.thickness = 0.003;
    scene.bodies[0].velocity = [2.0, 1.0];
    scene.bodies[0].angular_velocity = 100.0;
    let (simulation, samples) = run(&scene);
    let (frame, last) = (simulation.total_frame().unwrap(), samples.last().unwrap());
    let [vx, vy] = &frame.velocity;
    let [ux, uy] = &frame.displacement;
    let (mut kinetic, mut momentum, mut work) = (0.0, [0.0; 2], 0.0);
    for at in frame.patch.control_grid().indices() {
        let m = frame.mass.row_sums[at] * scene.analysis.thickness;
        kinetic += 0.5 * m * (vx[at] * vx[at] + vy[at] * vy[at]);
        momentum = [momentum[0] + m * vx[at], momentum[1] + m * vy[at]];
        work += m * (ux[at] * scene.analysis.gravity[0] + uy[at] * scene.analysis.gravity[1]);
    }
    approx::assert_relative_eq!(last.kinetic, kinetic, max_relative = 1e-12);
    approx::assert_relative_eq!(last.external_work, work, max_relative = 1e-11);
    let mass = 2450.0 * 0.01 * 0.005 * 0.003;
    for d in 0..2 {
        approx::assert_relative_eq!(last.momentum[d], momentum[d], max_relative = 1e-12);
        let fallen = mass * (scene.bodies[0].velocity[d] + scene.analysis.gravity[d] * last.time);
        approx::assert_relative_eq!(last.momentum[d], fallen, max_relative = 1e-11);
    }
    assert!(relative_closure(&samples) <= 1e-12, "{:e}", relative_closure(&samples));
}

/// Elastic bodies close to round-off, whatever moves them; with the consistent mass the reaction of a driven
/// side includes the inertia of all control points it is coupled to.
#[test]
fn elastic_scenes_close_to_round_off() {
    let drive = |side, fix, velocity| Boundary::driven(side, fix, [velocity, 0.0]);
    for (degree, mass) in (1..=4).flat_map(|degree| [Mass::Lumped, Mass::Consistent].map(|mass| (degree, mass))) {
        let mut scene = elastic_scene(degree, [0.01, 0.005], [20, 10]);
        scene.analysis.mass = mass;
        scene.bodies[0].particles_per_cell = [degree + 1; 2];
        scene.boundaries = vec![
            drive(Side::Left, [true, false], 0.0),
            drive(Side::Right, [true, false], 0.5),
            drive(Side::Bottom, [false, true], 0.0),
        ];
        scene.bodies[0].tractions = vec![Traction::on(Side::Top, [2e5, 1e6], TimeFactor::default())];
        scene.analysis.gravity = [0.0, 1e5];
        let (_, samples) = run(&scene);
        let (last, closure) = (samples.last().unwrap(), closure_of_any_sample(&samples));
        assert!(closure <= 1e-12, "degree {degree}, {mass:?}: {closure:e}");
        assert!(last.external_work > 0.0 && last.elastic > 0.01 * last.external_work && last.stagger > 0.0);
    }
}

/// After the first step under a ramp no work is done yet, and the kinetic energy and its stagger cancel to
/// round-off: the ledger is not open.
#[test]
fn the_first_step_under_a_ramp_closes() {
    let mut scene = crate::common::pulled_plate(1e6);
    scene.analysis.end_time = 1e-6;
    scene.output.samples = 1000;
    let (simulation, _) = run(&scene);
    assert_eq!(simulation.plan().steps_per_sample, 1);
    let open: Vec<_> = simulation.warnings().iter().filter(|warning| warning.contains("ledger")).collect();
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn a_crack_in_an_intact_body_has_a_tip_whoever_takes_the_steps() {
    let mut scene = notched_plate(8e6);
    scene.bodies[0].cracks.clear();
    scene.analysis.end_time = 3e-6;
    let samples = run(&scene).1;
    let tip = |sample: &Sample| sample.fracture.as_ref().unwrap().crack_tip;
    assert!(tip(&samples[0]).is_none() && tip(samples.last().unwrap()).is_some());
    let mut simulation = Simulation::new(&scene).unwrap();
    while !simulation.finished() {
        simulation.step().unwrap();
    }
    assert_eq!(tip(&simulation.sample()), tip(samples.last().unwrap()));
}
