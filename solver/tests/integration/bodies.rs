//! Bodies that are recorded one by one.

use approx::assert_relative_eq;
use fisura::dynamics::body_sample::{BodySample, BodySamples};
use fisura::scene::*;
use fisura::validate::validate;

use crate::common::{body, run, unit_solid, updated_scene};

/// A disc that flies and turns, and hits another one.
fn discs() -> Scene {
    let disc = |x: f64| Shape::Disk { center: [x, 0.5], radius: 0.15 };
    let mut scene = updated_scene(unit_solid(), Mesh::uniform([2; 2], [0.0; 2], [1.0; 2], [16; 2]), disc(0.3));
    scene.analysis.transfer = Transfer::Apic;
    scene.analysis.kinematics = Kinematics::Finite;
    scene.analysis.thickness = 0.5;
    scene.bodies[0].name = "Disc 1".into();
    scene.bodies[0].velocity = [0.05, 0.0];
    scene.bodies[0].angular_velocity = 0.3;
    scene.bodies.push(Body { name: "other".into(), material: "solid".into(), ..body(disc(0.62), [2, 2]) });
    scene.contact = Some(Contact::default());
    scene.output.bodies = true;
    scene
}

fn of(samples: &BodySamples) -> [&BodySample; 2] {
    [&samples.bodies[0], &samples.bodies[1]]
}

#[test]
fn every_body_has_its_centre_velocity_and_spin() {
    let scene = discs();
    validate(&scene).unwrap();
    let (_, samples) = run(&scene);
    let [first, other] = of(samples[0].bodies.as_ref().unwrap());
    assert!((first.center[0] - 0.3).abs() < 0.1 / 16.0, "the points of a disc end in a staircase");
    assert_relative_eq!(first.velocity[0], 0.05, max_relative = 1e-12);
    assert_relative_eq!(first.spin, 0.3, max_relative = 1e-10);
    assert!(other.spin.abs() < 1e-14 && other.kinetic == 0.0);
    for sample in &samples {
        let bodies = sample.bodies.as_ref().unwrap();
        let [one, two] = of(bodies);
        for d in 0..2 {
            let momentum = one.mass * one.velocity[d] + two.mass * two.velocity[d];
            assert!((momentum - sample.momentum[d]).abs() < 1e-15 * one.mass, "{momentum} {:?}", sample.momentum);
        }
        assert_relative_eq!(one.kinetic + two.kinetic, sample.kinetic, max_relative = 1e-12);
    }
    let last = samples.last().unwrap().bodies.as_ref().unwrap();
    assert!(of(last)[1].velocity[0] > 0.0, "they have met");
    assert!(samples.iter().any(|s| s.bodies.as_ref().unwrap().forces[0].force[0] > 0.0), "the other is pushed ahead");
}

#[test]
fn columns_are_those_that_a_scene_announces_and_absent_where_none_is_wanted() {
    let mut scene = discs();
    scene.analysis.end_time = 0.1;
    let (_, samples) = run(&scene);
    let names = |bodies: &BodySamples| bodies.named_values().into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    let found = names(samples[0].bodies.as_ref().unwrap());
    assert_eq!(found, names(&BodySamples::blank(&scene)));
    assert!(found.contains(&"disc_1_spin_rad_per_s".into()) && found.contains(&"force_disc_1_other_x_n".into()));
    scene.output.bodies = false;
    let (_, samples) = run(&scene);
    assert!(samples[0].bodies.is_none());
    assert!(samples[0].named_values().iter().all(|(name, _)| !name.starts_with("disc")));
}

#[test]
fn bodies_that_cannot_be_told_apart_are_refused() {
    let wrong = |change: fn(&mut Scene)| {
        let mut scene = discs();
        change(&mut scene);
        let errors = validate(&scene).unwrap_err();
        errors.iter().find(|error| error.key == "output.bodies").unwrap().message.clone()
    };
    assert!(wrong(|scene| scene.bodies[1].name = "disc-1".into()).contains("disc_1_x_m"));
    assert!(wrong(|scene| scene.bodies = vec![scene.bodies[0].clone(); 70]).contains("70 bodies"));
}
