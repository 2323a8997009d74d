//! Whole runs on patches with a geometry: the same as over a rectangle where the geometry is one, the same
//! bits for any number of threads, energies that close, and pictures and crack tips where they belong.

use crate::common::{
    annulus, bent_patch, brittle, closure_of_any_sample, elastic_scene, notched_plate, patch_scene, run,
};
use fisura::dynamics::energy::Sample;
use fisura::linear_algebra::extremes::larger;
use fisura::scene::*;
use fisura::splines::nurbs::NurbsPatch;

/// The scene with its rectangular mesh written as a general patch, all weights `weight`.
fn as_patch(scene: &Scene, weight: f64) -> Scene {
    let Mesh { degree, knots, .. } = &scene.mesh;
    let (low, high) = (scene.mesh.origin(), scene.mesh.end());
    let rectangle = NurbsPatch::rectangle(*degree, [&knots[0], &knots[1]], low, high).unwrap();
    let mut general = scene.clone();
    general.mesh = Mesh::of(&rectangle);
    general.mesh.geometry.as_mut().unwrap().weights.fill(weight);
    general.bodies[0].shape = Shape::Patch;
    general
}

/// Largest relative difference of displacements and of energies between two runs of the same steps.
fn difference(a: &Scene, b: &Scene) -> [f64; 2] {
    let ((a, rows), (b, other_rows)) = (run(a), run(b));
    assert!(a.steps() >= 30 && a.steps() == b.steps(), "{} and {} steps", a.steps(), b.steps());
    let [a, b] = [&a, &b].map(|s| s.total_frame().unwrap().displacement.concat());
    let largest = |numbers: &mut dyn Iterator<Item = f64>| numbers.fold(0.0, |m: f64, x| larger(m, x.abs()));
    let displacement = largest(&mut a.iter().zip(&b).map(|(a, b)| a - b)) / largest(&mut a.iter().copied());
    let terms = |s: &Sample| {
        let fracture = s.fracture.as_ref().map_or(0.0, |f| f.energy + f.works[0].1);
        [s.kinetic, s.elastic, s.external_work, fracture]
    };
    let scale = rows.iter().map(Sample::largest_term).fold(0.0, larger);
    let gaps = rows.iter().zip(&other_rows).flat_map(|(a, b)| {
        let (a, b) = (terms(a), terms(b));
        (0..4).map(move |i| a[i] - b[i])
    });
    [displacement, largest(&mut { gaps }) / scale]
}

/// Graded knots, tractions on two sides, a driven and a held side.
#[test]
fn an_affine_patch_is_the_rectangle() {
    for degree in 1..=4 {
        let mut scene = elastic_scene(degree, [0.01, 0.005], [20, 10]);
        let inner = scene.mesh.knots[0].len() - degree - 1;
        for knot in &mut scene.mesh.knots[0][degree + 1..inner] {
            *knot *= 0.5 + 50.0 * *knot; // spans from 0.27 mm to 0.72 mm
        }
        scene.boundaries =
            vec![Boundary::fixed(Side::Left, [true, true]), Boundary::driven(Side::Right, [true, false], [0.5, 0.0])];
        let pull = |side, stress| Traction::on(side, stress, TimeFactor::ramp(1e-6));
        scene.bodies[0].tractions = vec![pull(Side::Top, [2e5, 1e6]), pull(Side::Bottom, [0.0, -1e6])];
        scene.analysis.gravity = [0.0, 1e5];
        scene.analysis.time_step = TimeStep::Fixed(1.5e-8 / degree as f64);
        scene.analysis.end_time = 1e-6;
        for mass in [Mass::Lumped, Mass::Consistent] {
            scene.analysis.mass = mass;
            scene.bodies[0].particles_per_cell = [degree + 1; 2];
            let [displacement, energy] = difference(&scene, &as_patch(&scene, 3.7));
            assert!(displacement <= 1e-13, "degree {degree}, {mass:?}: displacement differs by {displacement:e}");
            assert!(energy <= 1e-13, "degree {degree}, {mass:?}: energy differs by {energy:e}");
        }
    }
}

/// With fracture both are as close as the tolerance of the phase-field solver, 1e-13, makes them; measured
/// 2.4e-14.
#[test]
fn an_affine_patch_fractures_like_the_rectangle() {
    for degree in 1..=4 {
        let mut scene = notched_plate(6e6);
        scene.mesh = Mesh::uniform([degree; 2], [0.0; 2], [0.01, 0.005], [40, 20]);
        scene.bodies[0].particles_per_cell = [degree.max(2); 2];
        scene.solver.phase_field_tolerance = 1e-13;
        scene.analysis.time_step = TimeStep::Fixed(1.2e-8);
        scene.analysis.end_time = 1e-6;
        let [displacement, energy] = difference(&scene, &as_patch(&scene, 0.2));
        assert!(displacement <= 1e-12, "degree {degree}: displacement differs by {displacement:e}");
        assert!(energy <= 1e-12, "degree {degree}: energy differs by {energy:e}");
    }
}

/// A quarter annulus torn open from its inner side, brittle, with spans of about l0.
fn cracked_annulus() -> Scene {
    let mut scene = patch_scene(&annulus(2, 30), 2);
    let glass = scene.materials.get_mut("glass").unwrap();
    glass.fracture = Some(Fracture { length_scale: 0.06, critical_energy_release_rate: 3.0, ..brittle() });
    let at = |r: f64| [r * std::f64::consts::FRAC_1_SQRT_2; 2];
    scene.bodies[0].cracks = vec![Crack::wide_seed(at(1.0), at(1.5), Some(0.06))];
    let pull = |side, stress| Traction::on(side, stress, TimeFactor::default());
    scene.bodies[0].tractions = vec![pull(Side::Bottom, [0.0, -2e5]), pull(Side::Top, [-2e5, 0.0])];
    scene.analysis.end_time = 3e-4;
    scene
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut scene = cracked_annulus();
    scene.analysis.end_time = 5e-5;
    for mass in [Mass::Lumped, Mass::Consistent] {
        scene.analysis.mass = mass;
        scene.bodies[0].particles_per_cell = [3; 2];
        crate::determinism::check(&scene);
    }
}

/// Pixels outside the ring are empty, those on the crack broken; the tip begins at the crack's end, and only
/// moves outwards.
#[test]
fn pictures_and_tips_lie_where_the_patch_does() {
    let (simulation, samples) = run(&cracked_annulus());
    let tip = |s: &Sample| s.fracture.as_ref().unwrap().crack_tip.expect("a crack").place;
    let [x, y] = tip(&samples[0]);
    let end = 1.5 * std::f64::consts::FRAC_1_SQRT_2;
    assert!((x - end).hypot(y - end) <= 0.08, "the tip begins at ({x}, {y})");
    let radius = |s: &Sample| tip(s)[0].hypot(tip(s)[1]);
    let last = samples.last().unwrap();
    assert!(radius(last) >= radius(&samples[0]) && radius(last) <= 2.0, "{} to {}", radius(&samples[0]), radius(last));
    let closure = closure_of_any_sample(&samples);
    assert!(closure <= 1e-3, "closure {closure:e}");

    let picture = simulation.picture([60, 60]);
    let phase = picture.phase.as_ref().unwrap();
    let (mut inside, mut broken) = (0, 0);
    for (index, &c) in phase.iter().enumerate() {
        let [x, y] = picture.center(index);
        let on_ring = (1.0..=2.0).contains(&x.hypot(y));
        assert_eq!(c.is_nan(), !on_ring, "({x}, {y})");
        assert_eq!(picture.stress[index].is_nan(), !on_ring);
        inside += usize::from(on_ring);
        broken += usize::from(c < 0.1);
        let off = (x - y).abs() * std::f64::consts::FRAC_1_SQRT_2;
        if c < 0.1 {
            assert!(off <= 0.12, "broken at ({x}, {y}), {off} m off the crack");
        } else if off <= 0.02 && x.hypot(y) <= 1.4 && on_ring {
            panic!("c = {c} on the crack at ({x}, {y})");
        }
    }
    assert!((inside as f64 / 3600.0 * 4.0 / (0.75 * std::f64::consts::PI) - 1.0).abs() < 0.02 && broken > 20);
}

/// Energies of elastic bodies on curved patches close to round-off, whatever moves them.
#[test]
fn elastic_energies_close_on_curved_patches() {
    for mass in [Mass::Lumped, Mass::Consistent] {
        for (name, patch) in [("annulus", annulus(3, 6)), ("bent", bent_patch(2, 8))] {
            let mut scene = patch_scene(&patch, 4);
            scene.analysis = Analysis { mass, end_time: 1e-3, gravity: [3e3, -1e4], ..scene.analysis };
            let drive = |side, velocity| Boundary::driven(side, [true, true], velocity);
            scene.boundaries = vec![drive(Side::Bottom, [0.0; 2]), drive(Side::Top, [0.3, 0.4])];
            let load = Traction::on(Side::Right, [1e5, -2e5], TimeFactor::ramp(1e-4));
            scene.bodies[0].tractions = vec![load];
            let (simulation, samples) = run(&scene);
            assert!(simulation.steps() >= 30 && samples.last().unwrap().external_work > 0.0);
            let closure = closure_of_any_sample(&samples);
            assert!(closure <= 1e-12, "{name}, {mass:?}: closure {closure:e}");
        }
    }
}

#[test]
fn a_probe_off_the_patch_is_refused() {
    let mut scene = patch_scene(&annulus(2, 6), 3);
    let corners = &scene.mesh.geometry.as_ref().unwrap().control_points;
    let [x, y] = corners[0];
    for (at, found) in [([x, y], 0), ([0.0, 0.0], 1), ([10.0 * x, 10.0 * y], 1)] {
        scene.output.probes = vec![Probe { name: "place".into(), at }];
        let errors = fisura::validate::validate(&scene).err().unwrap_or_default();
        assert_eq!(errors.iter().filter(|error| error.key == "output.probe.0.at").count(), found, "{at:?}");
    }
}
