//! Finite kinematics in the updated frame: memory, cracks, and the limit of small strains.

use crate::common::{brittle, relative_closure, run, unit_solid, updated_scene};
use fisura::dynamics::energy::Sample;
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::linear_algebra::extremes::larger;
use fisura::scene::*;
use fisura::simulation::Simulation;

/// A body of modulus and density 1 on a square mesh of equal spans.
fn scene(degree: usize, side: f64, cells: usize, shape: Shape, kinematics: Kinematics) -> Scene {
    let mesh = Mesh::uniform([degree; 2], [-0.5 * side; 2], [side; 2], [cells; 2]);
    let mut scene = updated_scene(unit_solid(), mesh, shape);
    scene.bodies[0].particles_per_cell = [degree + 1; 2];
    scene.analysis = Analysis { plane: Plane::Stress, kinematics, transfer: Transfer::Apic, ..scene.analysis };
    scene.output.samples = 200;
    scene
}

fn block() -> Shape {
    Shape::Rectangle { min: [-0.21, 0.05], max: [0.34, 0.33] }
}

#[test]
fn the_deformation_gradient_takes_memory_only_where_it_is_used() {
    let bytes = |kinematics| {
        let simulation = Simulation::new(&scene(2, 1.2, 12, block(), kinematics)).unwrap();
        (simulation.extent().mechanics_bytes, simulation.extent().particles)
    };
    let ((small, points), (finite, _)) = (bytes(Kinematics::Small), bytes(Kinematics::Finite));
    assert_eq!(finite - small, 32 * points);
}

#[test]
fn a_cracking_body_cracks_as_with_small_strains_and_its_ledger_is_as_open() {
    let crack = |kinematics| {
        let shape = Shape::Rectangle { min: [-0.5, -0.4], max: [0.5, 0.4] };
        let mut scene = scene(2, 1.2, 24, shape, kinematics);
        let fracture = Fracture { critical_energy_release_rate: 1e-4, length_scale: 0.05, ..brittle() };
        scene.materials.get_mut("solid").unwrap().fracture = Some(fracture);
        let pull = |side, stress| Traction::on(side, [0.0, stress], TimeFactor::ramp(0.2));
        scene.bodies[0].tractions = vec![pull(Side::Top, 5e-3), pull(Side::Bottom, -5e-3)];
        scene.bodies[0].cracks = vec![Crack::seed([-0.5, 0.0], [0.0, 0.0])];
        scene.analysis.end_time = 0.8;
        scene.output.samples = 8;
        let (_, samples) = run(&scene);
        let energy = |sample: &Sample| sample.fracture.as_ref().unwrap().energy;
        [energy(samples.last().unwrap()) - energy(&samples[0]), relative_closure(&samples)]
    };
    let ([small, least], [finite, closure]) = (crack(Kinematics::Small), crack(Kinematics::Finite));
    println!("fracture energy {small:.4e} (small), {finite:.4e} (finite), closure {closure:.1e}");
    // At h = l0 with a body that moves by a tenth of a span the ledger is open by 2 % of the seeded energy
    // with either kinematics, so the cause is not theirs; energy of the phase field at moving points is not
    // booked.
    assert!((closure - least).abs() <= 1e-3, "closure {closure:e}, with small strains {least:e}");
    assert!(small > 1e-7 && (finite / small - 1.0).abs() <= 0.05, "{finite:e} against {small:e}");
}

#[test]
fn small_motions_are_those_of_small_strains() {
    let end = |kinematics| {
        let mut scene = scene(2, 1.2, 12, block(), kinematics);
        let pull = Traction::on(Side::Right, [1e-9, 2e-9], TimeFactor::ramp(0.5));
        scene.bodies[0].tractions = vec![pull];
        let mut frame = UpdatedFrame::new(&scene).unwrap();
        (0..100).for_each(|_| frame.step(0.02).unwrap());
        frame.fields[0].points.to_vec()
    };
    let (small, finite) = (end(Kinematics::Small), end(Kinematics::Finite));
    let largest = small.iter().flat_map(|p| p.strain).fold(0.0_f64, |a, e| larger(a, e.abs()));
    let apart = small.iter().zip(&finite).flat_map(|(a, b)| [0, 1, 2].map(|i| (a.strain[i] - b.strain[i]).abs()));
    let apart = apart.fold(0.0, larger);
    assert!(largest > 1e-10 && apart <= 10.0 * largest * largest + 1e-13 * largest, "{apart:e} of {largest:e}");
}
