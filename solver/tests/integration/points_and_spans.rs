//! What a look at a run shows: every point, and the spans with material.

use crate::common::{annulus, elastic_scene, notched_plate, patch_scene, rectangle, run};
use fisura::Simulation;
use fisura::linear_algebra::extremes::smaller;
use fisura::output::inspection::PointState;
use fisura::output::span_grid::SpanGrid;
use fisura::scene::*;

fn points(simulation: &Simulation) -> Vec<PointState> {
    let mut points = Vec::new();
    simulation.for_each_point(&mut |point| points.push(point));
    assert_eq!(points.len(), simulation.extent().particles);
    assert!(points.iter().all(PointState::is_finite));
    points
}

/// Areas of the quadrilaterals, m²; positive if they are counter-clockwise.
fn areas(grid: &SpanGrid) -> Vec<f64> {
    let area = |span: &[usize; 4]| {
        let [a, b, c, d] = span.map(|corner| grid.corners[corner].position);
        0.5 * ((c[0] - a[0]) * (d[1] - b[1]) - (d[0] - b[0]) * (c[1] - a[1]))
    };
    grid.spans.iter().map(area).collect()
}

fn close(seen: [f64; 2], expected: [f64; 2], tolerance: f64) -> bool {
    (0..2).all(|d| (seen[d] - expected[d]).abs() <= tolerance)
}

#[test]
fn in_the_total_frame_points_and_corners_are_displaced() {
    let mut scene = notched_plate(2e6);
    // Spans without material beside the body.
    scene.mesh = Mesh::uniform([2; 2], [0.0; 2], [0.011, 0.006], [44, 24]);
    scene.bodies[0].velocity = [3.0, -2.0];
    let (simulation, samples) = run(&scene);
    let points = points(&simulation);
    let [mut momentum, mut moved] = [[0.0; 2]; 2];
    for point in &points {
        assert_eq!(point.present, [0, 1].map(|d| point.position[d] + point.displacement[d]));
        for d in 0..2 {
            // All of the same volume.
            momentum[d] += 2450.0 * 0.01 * 0.005 * point.velocity[d] / points.len() as f64;
            moved[d] += point.displacement[d] / points.len() as f64;
        }
    }
    let last = samples.last().unwrap();
    assert!(close(momentum, last.momentum, 1e-9 * 3.0 * 2450.0 * 0.01 * 0.005), "{momentum:?} {:?}", last.momentum);
    assert!(close(moved, [3.0 * last.time, -2.0 * last.time], 1e-12), "{moved:?}: no force acts on the whole");
    let phases = || points.iter().map(|p| p.fracture.unwrap().phase);
    assert_eq!(phases().fold(f64::INFINITY, smaller), last.fracture.as_ref().unwrap().min_phase);

    let grid = simulation.span_grid();
    assert_eq!((grid.spans.len(), grid.corners.len()), (40 * 20, 41 * 21), "spans with material only");
    let areas = areas(&grid);
    assert!(areas.iter().all(|&area| area > 0.0), "counter-clockwise");
    assert!((areas.iter().sum::<f64>() / 5e-5 - 1.0).abs() < 1e-3, "strains are small");
    let frame = simulation.total_frame().unwrap();
    for corner in &grid.corners {
        // Displacements are far below a span.
        let reference = corner.position.map(|x| (x / 0.25e-3).round() * 0.25e-3);
        let at = |field| frame.patch.evaluate(field, reference).unwrap().value;
        let displacement = frame.displacement.each_ref().map(|u| at(u));
        assert!(close(corner.position, [0, 1].map(|d| reference[d] + displacement[d]), 1e-15), "{corner:?}");
        assert!(close(corner.velocity, frame.velocity.each_ref().map(|v| at(v)), 1e-9), "{corner:?}");
        let phase = at(frame.fracture.as_ref().unwrap().field.control_values());
        assert!((corner.phase.unwrap() - phase).abs() < 1e-9, "{corner:?}");
    }
}

#[test]
fn curved_spans_are_quadrilaterals_between_their_corners() {
    let simulation = Simulation::new(&patch_scene(&annulus(2, 8), 3)).unwrap();
    assert_eq!(points(&simulation).len(), 8 * 8 * 9);
    let grid = simulation.span_grid();
    assert_eq!((grid.spans.len(), grid.corners.len()), (64, 81));
    // chords of a quarter circle cut into 8: sin(π/16)/(π/16) of the area
    let exact = 0.75 * std::f64::consts::PI;
    let chords = (std::f64::consts::PI / 16.0).sin() / (std::f64::consts::PI / 16.0);
    let area = areas(&grid).iter().sum::<f64>();
    assert!(area < exact && area > 0.99 * chords * exact, "{area} of {exact}");
}

#[test]
fn in_the_updated_frame_bodies_fly_through_a_grid_that_stays() {
    let mut scene = elastic_scene(2, [0.01, 0.005], [40, 20]);
    scene.analysis.frame = Frame::Updated;
    let (left, right) = ([20.0, -10.0], [-30.0, 0.0]);
    let mut other = scene.bodies[0].clone();
    scene.bodies[0].shape = rectangle([0.001, 0.001], [0.003, 0.003]);
    scene.bodies[0].velocity = left;
    (other.name, other.shape) = ("other".into(), rectangle([0.007, 0.001], [0.009, 0.003]));
    other.velocity = right;
    scene.bodies.push(other);
    let (simulation, _) = run(&scene);
    let velocity = |body: usize| [left, right][body];
    let points = points(&simulation);
    for point in &points {
        assert!(close(point.velocity, velocity(point.body), 1e-9), "{point:?}");
        assert!(close(point.displacement, velocity(point.body).map(|v| v * simulation.time()), 1e-15), "{point:?}");
        assert_eq!((point.present, point.fracture), (point.position, None));
    }
    let grid = simulation.span_grid();
    assert!(areas(&grid).iter().all(|area| (area / (0.25e-3 * 0.25e-3) - 1.0).abs() < 1e-9));
    for corner in &grid.corners {
        assert!(close(corner.velocity, velocity(corner.body), 1e-9) && corner.phase.is_none(), "{corner:?}");
    }
    for point in &points {
        let holds = |span: &[usize; 4]| {
            let [low, high] = [grid.corners[span[0]], grid.corners[span[2]]];
            let inside = |d: usize| (low.position[d]..=high.position[d]).contains(&point.present[d]);
            low.body == point.body && inside(0) && inside(1)
        };
        assert!(grid.spans.iter().any(holds), "{point:?} is in no span of its body");
    }
}
