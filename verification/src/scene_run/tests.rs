//! A pulled block, intact and notched.

use fisura::scene::TimeStep;

use super::*;
use crate::scene::SceneFile;

const BLOCK: &str = r#"
    title = "Block"
    mesh = { degree = 2, origin = [0, 0], size = ["20 mm", "10 mm"], cells = [20, 10] }
    analysis = { end_time = "5 us" }
    [material.glass]
    young_modulus = "32 GPa"
    poisson_ratio = 0.2
    density = "2450 kg/m^3"
    [[body]]
    name = "block"
    material = "glass"
    shape = { rectangle = { min = [0, 0], max = ["20 mm", "10 mm"] } }
    particles_per_cell = [2, 2]
    [[body.traction]]
    edge = "top"
    stress = [0, "1 MPa"]
    [output]
    samples = 10
    frames = [0, "2.5 us", "2.5000001 us", "5 us"]
"#;

fn block() -> Scene {
    SceneFile::parse("block.toml", BLOCK, &[]).unwrap().scene
}

#[test]
fn a_run_has_its_rows_its_frames_and_no_columns_of_what_it_does_not_model() {
    let (mut calls, mut frames) = (Vec::new(), Vec::new());
    let run = run_scene(&block(), &mut |p| calls.push(p), &mut |n, simulation| frames.push((n, simulation.time())));
    assert_eq!(run.breakdown, None);
    assert_eq!(run.history.rows(), 11);
    assert_eq!(run.history.column("time_s").unwrap()[0], 0.0);
    assert!(run.history.names.iter().all(|n| !["fracture_j", "min_phase_field", "crack_tip_x_m"].contains(&&**n)));
    let summary = &run.summary;
    assert_eq!(summary.models, ["momentum"]);
    assert_eq!((summary.particles, summary.steps), (800, summary.planned_steps));
    assert_eq!(calls.len(), summary.steps + 1);
    assert_eq!(calls.last().unwrap().fraction(), 1.0);
    assert!(summary.largest_closure_over_largest_energy < 1e-12, "{summary:?}");
    assert_eq!(summary.final_energies_j["elastic_j"], *run.history.column("elastic_j").unwrap().last().unwrap());

    let step = summary.time_step_s.unwrap();
    let times: Vec<f64> = run.frames.iter().map(|f| f.time).collect();
    assert_eq!(frames, times.iter().copied().enumerate().collect::<Vec<_>>());
    assert_eq!(times.len(), 3, "two of the four frames share a step: {times:?}");
    assert!(summary.warnings.iter().any(|w| w.contains("1 of 4 frames")), "{:?}", summary.warnings);
    assert!((times[1] - 2.5e-6).abs() <= 0.5 * step && (times[2] - 5e-6).abs() < 1e-15);
    assert_eq!(run.frames[0].pixels, [400, 200]);
}

#[test]
fn a_breakdown_keeps_what_was_computed_and_is_written() {
    let mut scene = block();
    let critical = run_scene(&scene, &mut |_| {}, &mut |_, _| {}).summary.critical_step_s.unwrap();
    scene.analysis.time_step = TimeStep::Fixed(1.2 * critical);
    scene.analysis.end_time = 240.0 * critical;
    scene.output = fisura::scene::Output { frames: vec![0.0], ..Output::rows(100) };
    let run = run_scene(&scene, &mut |_| {}, &mut |_, _| {});
    let breakdown = run.breakdown.as_ref().expect("1.2 times the critical step is unstable");
    assert!(run.history.rows() >= 2 && run.history.rows() < 101);
    assert!(run.history.column("elastic_j").unwrap().iter().all(|e| e.is_finite()));
    assert_eq!(run.frames.len(), 1);

    let folder = tempfile::tempdir().unwrap();
    let out = crate::output::OutputFolder::open(folder.path(), "run").unwrap();
    assert_eq!(run.write(&out).unwrap(), ["history.csv", "summary.json", "breakdown.json"]);
    assert_eq!(Table::read(&folder.path().join("history.csv")).unwrap(), run.history);
    let text = std::fs::read_to_string(folder.path().join("summary.json")).unwrap();
    let summary: Summary = serde_json::from_str(&text).unwrap();
    assert_eq!(summary.breakdown.unwrap().step, breakdown.step);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3 + 2, "beside manifest and lock; no temporary file");
}

#[test]
fn frames_are_taken_at_the_nearest_step() {
    let (steps, warnings) = frame_steps(&[0.9, 0.0, 0.26, 9.0], 0.1, 10);
    assert_eq!((steps, warnings.len()), (vec![0, 3, 9, 10], 0));
}
