//! Steps work in the memory of the model: what one allocates is lists with a number per strip of points, and
//! where systems are solved or bodies meet a share of the model.

use crate::common::{bent_patch, driven_plate, notched_plate, patch_scene, pulled_plate, two_discs, with_threads};
use fisura::Simulation;
use fisura::scene::*;

/// Steps before counting, and those that count.
const BEFORE: usize = 20;
const COUNTED: usize = 20;
/// Bytes of lists with a number per strip: some ten strips, some ten lists, and those of the velocity
/// gradients of APIC.
const LISTS: u64 = 6144;

/// Bytes a step allocates, on one thread, and bytes of the model.
fn bytes_per_step(scene: &Scene) -> (u64, usize) {
    with_threads(1, || {
        let mut simulation = Simulation::new(scene).unwrap();
        let mut advance = |steps: usize| (0..steps).for_each(|_| simulation.step().unwrap());
        advance(BEFORE);
        let found = allocation_counter::measure(|| advance(COUNTED));
        let extent = simulation.extent();
        (found.bytes_total / COUNTED as u64, extent.mechanics_bytes + extent.phase_field_bytes)
    })
}

fn only_lists(name: &str, scene: &Scene) {
    let (bytes, model) = bytes_per_step(scene);
    assert!(bytes <= LISTS, "{name}: {bytes} bytes a step, the model has {model}");
}

/// Found: 2.5 to 5 % of the model, and 21 % by spans, whose factors are made anew every few steps. A field or
/// a matrix that is allocated anew in each step is more than the difference to the bounds.
fn a_share(name: &str, scene: &Scene, share: f64) {
    let (bytes, model) = bytes_per_step(scene);
    assert!(bytes as f64 <= share * model as f64, "{name}: {bytes} bytes a step, the model has {model}");
}

#[test]
fn in_the_total_frame() {
    only_lists("elastic", &pulled_plate(1e5));
    only_lists("mapped", &patch_scene(&bent_patch(2, 10), 3));
    let mut driven = driven_plate([60, 30]);
    driven.analysis.end_time = 1e-3;
    only_lists("driven sides", &driven);
    let mut finite = driven.clone();
    finite.analysis.kinematics = Kinematics::Finite;
    only_lists("finite strains", &finite);
    driven.analysis.mass = Mass::Consistent;
    a_share("consistent mass, sparse solves", &driven, 0.1);
    a_share("fracture, factors now and then", &notched_plate(6e6), 0.1);
}

#[test]
fn in_the_updated_frame() {
    let updated = |mut scene: Scene, kinematics: Kinematics| {
        scene.mesh = Mesh::uniform([2; 2], [-0.001; 2], [0.012, 0.007], [36, 84]);
        scene.analysis = Analysis { frame: Frame::Updated, safety: 0.5, kinematics, ..scene.analysis };
        scene
    };
    only_lists("small strains", &updated(pulled_plate(1e5), Kinematics::Small));
    only_lists("finite strains", &updated(pulled_plate(1e5), Kinematics::Finite));
    a_share("fracture", &updated(notched_plate(6e6), Kinematics::Small), 0.1);
    a_share("fracture, finite strains", &updated(notched_plate(6e6), Kinematics::Finite), 0.1);
}

#[test]
fn in_contact() {
    let mut scene = two_discs();
    scene.analysis.end_time = 3e-5;
    // Points of cut spans enter other spans in most steps. Then points are sorted, control points join the
    // system of the phase field, and its factor is made anew (found: 35 and 47 %).
    a_share("fracture and impulses", &scene, 0.6);
    scene.materials.values_mut().for_each(|material| material.fracture = None);
    a_share("impulses", &scene, 0.6);
    (scene.analysis.frame, scene.analysis.kinematics) = (Frame::Total, Kinematics::Finite);
    a_share("the potential of the gap", &scene, 0.3);
}
