//! Local refinement: levels of truncated hierarchical splines that follow the crack.

use crate::common::{brittle, elastic_scene, make_cohesive, run};
use fisura::Simulation;
use fisura::linear_algebra::extremes::larger;
use fisura::scene::time::Course;
use fisura::scene::*;

/// A plate of 16 by 8 mm with a seed along the middle of its left half, pulled open, whose cells are halved
/// near the crack.
pub fn refined(degree: usize, cells: [usize; 2], halvings: usize) -> Scene {
    let mut scene = elastic_scene(degree, [0.016, 0.008], cells);
    scene.materials.get_mut("glass").unwrap().fracture = Some(brittle());
    let pull = |side, stress| Traction::on(side, [0.0, stress], TimeFactor::ramp(1e-6));
    let points = vec![[0.0, 0.004], [0.006, 0.004]];
    scene.bodies[0].tractions = vec![pull(Side::Top, 12e6), pull(Side::Bottom, -12e6)];
    scene.bodies[0].cracks = vec![Crack { points, kind: CrackKind::Seed(Some(0.5e-3)) }];
    scene.mesh.halvings = halvings;
    scene.analysis.end_time = 8e-6;
    scene
}

/// The same with AT2, AT1 or PF-CZM.
fn of_model(model: usize, mut scene: Scene) -> Scene {
    match model {
        1 => scene.materials.get_mut("glass").unwrap().fracture.as_mut().unwrap().model = CrackModel::At1,
        2 => make_cohesive(&mut scene, 7.5e6, Softening::Linear, Split::Rankine),
        _ => {}
    }
    scene
}

/// Where every tile is refined from the start, the run is that on the finest mesh.
#[test]
fn refined_everywhere_it_is_the_finest_mesh() {
    let models = [(1, [1.0, 0.0], 0), (2, [1.0, 0.0], 0), (2, [4.0, 0.5], 0), (3, [1.0, 0.0], 0)];
    let with_threshold = [(2, [1.0, 0.0], 1), (3, [4.0, 0.5], 1), (2, [1.0, 0.0], 2)];
    for (degree, tensor, model) in models.into_iter().chain(with_threshold) {
        let mut coarse = of_model(model, refined(degree, [16, 8], 1));
        coarse.bodies[0].cracks[0].points[1] = [0.009, 0.004];
        let [along, mixed] = tensor;
        let anisotropy = Anisotropy { tensor: [[along, mixed], [mixed, 1.0]], angle: 0.4 };
        coarse.materials.get_mut("glass").unwrap().fracture.as_mut().unwrap().anisotropy = Some(anisotropy);
        let mut fine = coarse.clone();
        fine.mesh = Mesh::uniform([degree; 2], [0.0; 2], [0.016, 0.008], [32, 16]);
        let [(_, coarse), (_, fine)] = [coarse, fine].map(|scene| run(&scene));
        for (coarse, fine) in coarse.iter().zip(&fine) {
            let scale = larger(fine.largest_term(), 1e-6);
            let differences = [
                coarse.kinetic - fine.kinetic,
                coarse.elastic - fine.elastic,
                coarse.external_work - fine.external_work,
                coarse.fracture.as_ref().unwrap().energy - fine.fracture.as_ref().unwrap().energy,
            ];
            assert!(differences.iter().all(|d| d.abs() < 1e-8 * scale), "p = {degree}: {differences:?} of {scale:e}");
            assert_eq!(coarse.refinement, Some(0.0));
        }
    }
}

/// Mass, momentum and loads are those of the body wherever a short seed lies, also where the finest level
/// borders the coarsest one.
#[test]
fn mass_and_loads_are_shared_between_levels() {
    for (degree, halvings) in [(1, 2), (2, 1), (2, 2), (3, 2), (2, 3)] {
        for place in [[0.0072, 0.0019], [0.0041, 0.0066], [0.0001, 0.0079], [0.0103, 0.0001]] {
            let mut scene = refined(degree, [32, 16], halvings);
            let end = [place[0] + 4e-4, (place[1] - 2e-4_f64).max(0.0)];
            scene.bodies[0].cracks = vec![Crack { points: vec![place, end], kind: CrackKind::Seed(Some(0.5e-3)) }];
            scene.bodies[0].velocity = [50.0, 0.0];
            scene.bodies[0].tractions = vec![Traction::on(Side::Top, [0.0, 1e5], TimeFactor::ramp(1e-9))];
            scene.analysis.end_time = 0.2e-6;
            let (_, samples) = run(&scene);
            let mass = 2450.0 * 0.016 * 0.008;
            approx::assert_relative_eq!(samples[0].kinetic, 0.5 * mass * 2500.0, max_relative = 1e-12);
            let [x, y] = samples.last().unwrap().momentum;
            approx::assert_relative_eq!(x, 50.0 * mass, max_relative = 1e-12);
            let impulse = 0.016 * 1e5 * (0.2e-6 - 0.5e-9);
            approx::assert_relative_eq!(y, impulse, max_relative = 1e-9);
        }
    }
}

/// A side that is held while the body moves: functions between two levels begin with the velocities of the
/// coarser one.
#[test]
fn the_ledger_closes_beside_a_held_side() {
    for halvings in [1, 2] {
        let mut scene = refined(2, [32, 16], halvings);
        scene.bodies[0].cracks[0].points = vec![[0.0135, 0.0], [0.0127, 5e-4]];
        scene.bodies[0].tractions.clear();
        scene.bodies[0].velocity = [1.0, 0.0];
        let hold = Boundary::fixed(Side::Right, [true, false]);
        scene.boundaries = vec![Boundary { name: Some("wall".into()), ..hold }];
        scene.analysis.end_time = 0.5e-6;
        let (_, samples) = run(&scene);
        let (first, last) = (&samples[0], samples.last().unwrap());
        let stopped = first.kinetic - last.kinetic;
        assert!(stopped > 0.0 && last.closure.abs() < 1e-3 * stopped, "open by {:e} of {stopped:e} J", last.closure);
    }
}

/// Cells that are halved at a side while it speeds up do not change how it moves.
#[test]
fn a_driven_side_moves_as_prescribed() {
    for (model, halvings) in [(0, 1), (1, 1), (1, 2)] {
        let mut scene = elastic_scene(2, [0.02, 0.004], [40, 8]);
        scene.materials.get_mut("glass").unwrap().fracture = Some(brittle());
        scene = of_model(model, scene);
        scene.mesh.halvings = halvings;
        let motion = Motion::Displacement([6e-6, 0.0]);
        let time = TimeFactor { course: Course::Smooth(2e-6), until: None };
        let sides = [Side::Left, Side::Right].map(|side| Boundary::fixed(side, [true, false]));
        let [left, right] = sides;
        scene.boundaries = vec![left, Boundary { prescribed: Prescribed { motion, time }, ..right }];
        scene.output.probes = vec![Probe { name: "side".to_string(), at: [0.02, 0.002] }];
        scene.analysis.end_time = 3e-6;
        let (_, samples) = run(&scene);
        let last = samples.last().unwrap();
        assert_ne!(last.refinement, Some(0.0), "cells were halved");
        let (_, moved) = last.named_values().into_iter().find(|(name, _)| name == "side_ux_m").unwrap();
        approx::assert_relative_eq!(moved, 6e-6, max_relative = 1e-12);
    }
}

/// A crack that runs into coarse cells refines them; momentum is kept, and the ledger has the energy.
#[test]
fn what_refinement_changes_is_a_term_of_the_ledger() {
    for (degree, halvings, model) in [(2, 1, 0), (3, 1, 0), (2, 2, 0), (2, 1, 1), (3, 2, 1), (2, 1, 2)] {
        let cells = [128 >> halvings, 64 >> halvings];
        let mut scene = of_model(model, refined(degree, cells, halvings));
        scene.bodies[0].velocity = [3.0, 1.0];
        let (simulation, samples) = run(&scene);
        let (first, last) = (&samples[0], samples.last().unwrap());
        let tips = [first, last].map(|s| s.fracture.as_ref().unwrap().crack_tip.unwrap().place[0]);
        assert!(tips[1] > tips[0] + 4e-3, "p = {degree}: the crack runs by {:e} m", tips[1] - tips[0]);
        let mass = 2450.0 * 0.016 * 0.008;
        for sample in &samples {
            let drift = [0, 1].map(|d| sample.momentum[d] - [3.0, 1.0][d] * mass);
            assert!(drift.iter().all(|p| p.abs() < 1e-10 * mass), "p = {degree}, {halvings}: {drift:?}");
        }
        let added = last.refinement.unwrap();
        let loads = last.external_work.abs();
        assert!(added != 0.0 && added.abs() < 2e-3 * loads, "p = {degree}, {halvings}: {added:e} of {loads:e} J");
        assert!(last.closure.abs() < 2e-3 * loads, "p = {degree}, {halvings}: open by {:e} J", last.closure);
        let points = |simulation: &Simulation| {
            let mut points = 0;
            simulation.for_each_point(&mut |_| points += 1);
            points
        };
        let coarse = cells[0] * cells[1] * degree.pow(2);
        let [start, end] = [points(&Simulation::new(&scene).unwrap()), points(&simulation)];
        assert!(coarse < start && start < end && end <= coarse << (2 * halvings), "{start} points, then {end}");
    }
}

#[test]
fn what_it_cannot_be_used_with_is_refused() {
    let refuses = |what: &str, change: &dyn Fn(&mut Scene)| {
        let mut scene = refined(2, [32, 16], 1);
        change(&mut scene);
        let errors = fisura::validate::validate(&scene).unwrap_err();
        let found = errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        assert!(found.contains(what) && found.contains("mesh.refine"), "{found}");
    };
    assert!(fisura::validate::validate(&refined(2, [32, 16], 1)).is_ok());
    refuses("frame = \"updated\"", &|scene| scene.analysis.frame = Frame::Updated);
    refuses("conditions on edges", &|scene| {
        let held = EdgeCondition::fixed(Edge::Side(Side::Left), Hold::Components([true; 2]));
        scene.bodies[0].conditions = vec![held];
    });
    refuses("a static start", &|scene| scene.equilibrium = true);
    refuses("does not cover the mesh", &|scene| {
        scene.bodies[0].shape = Shape::Rectangle { min: [0.0; 2], max: [0.016, 0.006] };
    });
    refuses("a body that does not break", &|scene| scene.materials.get_mut("glass").unwrap().fracture = None);
}
