//! What a scene does not declare is not modelled: no memory, no solve, no column.

use crate::common::{brittle, pulled_plate, run};

#[test]
fn an_elastic_scene_has_no_phase_field() {
    let scene = pulled_plate(1e5);
    let (simulation, samples) = run(&scene);
    let extent = simulation.extent();
    assert_eq!(extent.phase_field_bytes, 0);
    assert_eq!(extent.models, ["momentum"]);
    let counts = simulation.phase_field_counts();
    assert_eq!([counts.solves, counts.iterations], [0; 2]);
    assert!(samples.iter().all(|s| s.fracture.is_none()));
    let fracture_columns = ["fracture", "history_work", "crack_tip", "phase_field"];
    let columns = samples[0].named_values();
    assert!(columns.iter().all(|(name, _)| !fracture_columns.iter().any(|f| name.contains(f))), "{columns:?}");
    assert!(simulation.picture([8, 4]).phase.is_none());
}

#[test]
fn the_same_scene_with_fracture_has_one_solve_per_step_and_one_at_the_start() {
    let elastic = run(&pulled_plate(1e5)).0;
    let mut scene = pulled_plate(1e5);
    scene.materials.get_mut("glass").unwrap().fracture = Some(brittle());
    let (simulation, samples) = run(&scene);
    assert_eq!(simulation.phase_field_counts().solves, simulation.steps() + 1);
    let extent = simulation.extent();
    assert!(extent.phase_field_bytes > 0);
    assert_eq!(extent.models, ["momentum", "phase field"]);
    assert_eq!(extent.mechanics_bytes, elastic.extent().mechanics_bytes, "mechanics costs the same memory");
    assert_eq!(extent.particles, elastic.extent().particles);
    assert!(samples.iter().all(|s| s.fracture.is_some()));
    assert!(simulation.picture([8, 4]).phase.is_some());
}
