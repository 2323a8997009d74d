//! What a run shows of bodies of every kind: the velocity of the mesh where a body moves as it is, and
//! stresses out of the plane.

use crate::common::{body, brittle, elastic_scene, glass, rectangle};
use fisura::Simulation;
use fisura::linear_algebra::extremes::largest;
use fisura::scene::*;

const VELOCITY: [f64; 2] = [3.0, -2.0];

/// A block on its way through a larger mesh.
fn moving(frame: Frame, kinematics: Kinematics) -> Scene {
    let mut scene = elastic_scene(2, [0.012, 0.01], [24, 20]);
    scene.analysis = Analysis { frame, kinematics, ..scene.analysis };
    scene.bodies = vec![Body { velocity: VELOCITY, ..body(rectangle([0.002, 0.004], [0.006, 0.006]), [3, 3]) }];
    scene
}

/// A moving block that a crack parts.
fn parted() -> Scene {
    let mut scene = moving(Frame::Updated, Kinematics::Finite);
    scene.materials.insert("glass".into(), Material { fracture: Some(brittle()), ..glass() });
    let crack = Crack::wide_seed([0.004, 0.004], [0.004, 0.006], Some(0.25e-3));
    scene.mesh = Mesh::uniform([2, 2], [0.0; 2], [0.012, 0.01], [48, 40]);
    scene.bodies[0].cracks = vec![crack];
    scene.contact = Some(Contact { friction: 0.3, fragments: true, ..Contact::default() });
    scene
}

#[test]
fn the_mesh_of_a_moving_block_moves_with_it() {
    use {Frame::*, Kinematics::*};
    for (name, scene, fields) in [
        ("total, small", moving(Total, Small), 1),
        ("total, finite", moving(Total, Finite), 1),
        ("updated, small", moving(Updated, Small), 1),
        ("updated, finite", moving(Updated, Finite), 1),
        ("fragments", parted(), 2),
    ] {
        let mut simulation = Simulation::new(&scene).unwrap();
        let found = simulation.updated_frame().map_or(1, |frame| frame.fields.len());
        assert!(found >= fields, "{name}: {found} fields");
        for _ in 0..4 {
            let grid = simulation.span_grid();
            assert!(grid.spans.len() > 20, "{name}: {} spans", grid.spans.len());
            for corner in &grid.corners {
                let off = largest((0..2).map(|d| (corner.velocity[d] - VELOCITY[d]).abs()));
                assert!(off < 1e-6, "{name}, step {}: {corner:?}", simulation.steps());
            }
            let speed = simulation.inspect().fastest.1;
            assert!((speed - VELOCITY[0].hypot(VELOCITY[1])).abs() < 1e-6, "{name}: {speed} m/s");
            simulation.step().unwrap();
        }
    }
}

#[test]
fn stress_out_of_the_plane_is_that_of_the_plane_state() {
    let pulled = |plane, frame| {
        let mut scene = moving(frame, Kinematics::Finite);
        scene.analysis.plane = plane;
        scene.bodies[0].angular_velocity = 1e4;
        scene
    };
    for frame in [Frame::Total, Frame::Updated] {
        for (plane, ratio) in [(Plane::Strain, 0.2), (Plane::Stress, 0.0)] {
            let mut simulation = Simulation::new(&pulled(plane, frame)).unwrap();
            (0..20).for_each(|_| simulation.step().unwrap());
            let mut stresses = Vec::new();
            simulation.for_each_point(&mut |point| {
                let [xx, yy, _] = point.stress;
                let expected = ratio * (xx + yy);
                let off = (point.stress_out_of_plane - expected).abs();
                assert!(off <= 1e-12 * (xx.abs() + yy.abs()), "{frame:?}, {plane:?}: {point:?}");
                stresses.push(point.von_mises());
            });
            assert!(largest(stresses) > 1e5, "{frame:?}, {plane:?}");
        }
    }
}
