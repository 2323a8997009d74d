//! The phase field with a threshold: where damage is the least energy, the ledger, what is refused.

use fisura::Simulation;
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::linear_algebra::lane::Lane;
use fisura::linear_algebra::stencil::Stencil;
use fisura::material::degradation::FractureModel;
use fisura::material::split::driving_energy;
use fisura::phase_field::assembly::{Constant, Integrand, PointCoefficients, add_form};
use fisura::phase_field::integrate_shape_functions;
use fisura::scene::*;
use fisura::validate::validate;

use crate::common::{
    annulus, at1, elastic_scene, make_at1, make_cohesive, notched_plate, patch_scene, relative_closure, run,
};

const L0: f64 = 0.25e-3;

/// A notched plate that cracks.
fn cracking(split: Split, stress: f64) -> Scene {
    let mut scene = notched_plate(stress);
    make_at1(&mut scene, split);
    scene.analysis.end_time = 8e-6;
    scene
}

/// A strip across x, seeded across its middle.
fn seeded_strip() -> Scene {
    let h = L0 / 2.0;
    let size = [48.0 * h, 4.0 * h];
    let mut scene = elastic_scene(2, size, [48, 4]);
    let x = 24.0 * h;
    scene.bodies[0].cracks = vec![Crack { points: vec![[x, 0.0], [x, size[1]]], kind: CrackKind::Seed(None) }];
    make_at1(&mut scene, Split::Spectral);
    scene
}

/// Coefficients `4 l0 (1 − k) H/Gc` at the points.
struct Reaction<'a>(&'a [Lane], f64);

impl PointCoefficients for Reaction<'_> {
    fn span(&self, first: usize, weights: &[Lane], out: &mut [Lane]) -> bool {
        for (i, weight) in weights.iter().enumerate() {
            out[i] = self.0[first + i] * *weight * self.1;
        }
        true
    }
}

/// Where c is free its equation holds; where it rests on what it was, the residual holds it there. Assembled
/// anew from the strains of all points, those asleep too.
#[test]
fn damage_is_the_least_energy_between_its_bounds() {
    for (split, degree) in [(Split::Spectral, 2), (Split::StarConvex(2.0), 3), (Split::Rankine, 2)] {
        let mut scene = cracking(split, 4e6);
        scene.mesh = Mesh::uniform([degree; 2], [0.0; 2], [0.01, 0.005], [48, 24]);
        let (simulation, _) = run(&scene);
        let frame = simulation.total_frame().unwrap();
        let (fracture, lattice) = (frame.fracture.as_ref().unwrap(), &frame.lattice);
        let model = FractureModel::of(&scene.materials["glass"]).unwrap();
        let mut drive = vec![Lane::ZERO; lattice.batches()];
        for (batch, drive) in drive.iter_mut().enumerate() {
            let [x, y] = frame.displacement.each_ref().map(|u| lattice.interpolate(batch, u).1);
            let strain = [x[0], y[1], (x[1] + y[0]) * 0.5];
            *drive = driving_energy(&frame.moduli, split, strain).at_least(Lane::ZERO);
        }
        let mut matrix = Stencil::zeros(lattice.patch_grid, lattice.degree);
        add_form(&mut matrix, lattice, Integrand::Mass, &Reaction(&drive, model.reaction_per_energy()));
        add_form(&mut matrix, lattice, Integrand::Diffusion, &Constant(model.diffusion()));
        let (c, mut residual) = (fracture.field.control_values(), lattice.patch_grid.zeros());
        matrix.apply(c, &mut residual);
        let load = integrate_shape_functions(lattice);
        let (mut damaged, mut free) = (0, 0);
        for at in lattice.patch_grid.indices() {
            let r = (residual[at] - 0.375 * load[at]) / load[at];
            assert!((0.0..=1.0).contains(&c[at]), "c = {}", c[at]);
            assert!(r < 1e-6 || c[at] == 0.0, "{split:?}: residual {r:e} where c = {}", c[at]);
            damaged += usize::from(c[at] < 1.0);
            free += usize::from(r.abs() < 1e-6);
        }
        let all = lattice.patch_grid.indices().count();
        assert!(damaged > 100 && damaged < all && free > 20, "{damaged} of {all} damaged, {free} free");
    }
}

#[test]
fn the_ledger_closes_with_the_square_of_the_step() {
    for split in [Split::Spectral, Split::VolumetricDeviatoric, Split::StarConvex(3.0), Split::Rankine, Split::None] {
        let closure = |safety: f64| {
            let mut scene = cracking(split, 4e6);
            scene.analysis.safety = safety;
            let (_, samples) = run(&scene);
            let end = samples.last().unwrap().fracture.clone().unwrap();
            assert!(end.energy > 1.3 * samples[0].fracture.as_ref().unwrap().energy, "{split:?}: it cracks");
            let columns: Vec<_> = end.works.iter().map(|(name, _)| *name).collect();
            match split {
                Split::StarConvex(_) | Split::Rankine => {
                    assert_eq!(columns, ["driving_work_j", "phase_field_bounds_j"]);
                }
                _ => assert_eq!(columns, ["phase_field_bounds_j"]),
            }
            if split == Split::Rankine {
                let work = end.works[0].1.abs();
                assert!(work > 0.01 * end.energy, "the driving energy of {split:?} is not psi+: {work:e}");
            }
            relative_closure(&samples)
        };
        let [coarse, fine] = [0.8, 0.4].map(closure);
        assert!(coarse < 2e-4 && fine < 0.4 * coarse, "{split:?}: {coarse:e}, {fine:e} with half the step");
    }
}

/// Broken material resists compression more than intact material does, and the step follows it: a cracked
/// strip under a fast push stays in balance.
#[test]
fn the_step_of_the_star_convex_split_is_that_of_broken_material() {
    let [plain, stiff] = [0.0, 8.0].map(|gamma| Simulation::new(&cracking(Split::StarConvex(gamma), 4e6)).unwrap());
    let moduli = stiff.total_frame().unwrap().moduli;
    let ratio = (9.0 * moduli.volumetric / (moduli.lambda + moduli.mu)).sqrt();
    let steps = [plain, stiff].map(|simulation| simulation.total_frame().unwrap().critical_step());
    assert!((steps[0] / steps[1] / ratio - 1.0).abs() < 1e-9, "{steps:?} for {ratio}");
    let [plain, stiff] = [0.0, 8.0].map(|gamma| {
        let mut scene = cracking(Split::StarConvex(gamma), 4e6);
        scene.analysis.frame = Frame::Updated;
        scene.materials.get_mut("glass").unwrap().fracture.as_mut().unwrap().model = CrackModel::At2;
        UpdatedFrame::new(&scene).unwrap().critical_step()
    });
    assert!((plain / stiff / ratio - 1.0).abs() < 1e-9, "{plain} and {stiff} in the updated frame, for {ratio}");
    for model in [CrackModel::At2, CrackModel::At1] {
        let mut scene = cracking(Split::StarConvex(8.0), -6e6);
        scene.materials.get_mut("glass").unwrap().fracture.as_mut().unwrap().model = model;
        let (_, samples) = run(&scene);
        let closure = relative_closure(&samples);
        assert!(closure < 2e-3, "{model:?}: closure {closure:e}");
    }
}

#[test]
fn an_unloaded_body_stays_intact_and_a_seed_as_it_is() {
    let mut scene = seeded_strip();
    scene.analysis.end_time = 2e-7;
    let (simulation, samples) = run(&scene);
    let energies: Vec<f64> = samples.iter().map(|s| s.fracture.as_ref().unwrap().energy).collect();
    assert!(energies.iter().all(|energy| (energy / energies[0] - 1.0).abs() < 1e-9), "{energies:?}");
    scene.bodies[0].cracks.clear();
    let (intact, samples) = run(&scene);
    assert!(samples.iter().all(|s| s.fracture.as_ref().unwrap().energy.abs() < 1e-15));
    assert_eq!(intact.phase_field_counts().iterations, 0, "nothing is solved where nothing is driven");
    assert!(simulation.steps() > 5);
}

/// Cut spans, slits, patches, graded knots, finite strains, the direct solver.
#[test]
fn every_body_of_the_total_frame_can_have_a_threshold() {
    let plate = cracking(Split::Spectral, 5e6);
    let mut slit = plate.clone();
    slit.bodies[0].cracks = vec![Crack { points: vec![[0.0, 0.0025], [0.004, 0.0025]], kind: CrackKind::Slit }];
    let mut cut = plate.clone();
    let hole = Shape::Disk { center: [0.0061, 0.0024], radius: 0.0007 };
    cut.bodies[0].shape = Shape::Difference { of: Box::new(cut.bodies[0].shape.clone()), minus: vec![hole] };
    for (traction, y) in cut.bodies[0].tractions.iter_mut().zip([0.005, 0.0]) {
        traction.edge = Edge::Segment([[0.0, y], [0.01, y]]);
    }
    let mut finite = plate.clone();
    finite.analysis.kinematics = Kinematics::Finite;
    let mut graded = plate.clone();
    for (knots, end) in graded.mesh.knots.iter_mut().zip([0.01, 0.005]) {
        knots.iter_mut().for_each(|x| *x = end * (*x / end).powf(1.2));
    }
    let mut inclined = plate.clone();
    inclined.bodies[0].cracks[0].points = vec![[0.0, 0.002], [0.0021, 0.0022], [0.004, 0.0031]];
    for (name, scene) in [("slit", slit), ("cut", cut), ("finite", finite), ("graded", graded), ("inclined", inclined)]
    {
        assert_eq!(validate(&scene).err(), None, "{name}");
        let mut cohesive = scene.clone();
        make_cohesive(&mut cohesive, 7.5e6, Softening::Cornelissen, Split::Rankine);
        if let Some(slit) = scene.bodies[0].cracks.first().filter(|crack| crack.is_slit()) {
            cohesive.bodies[0].cracks = vec![slit.clone()];
        }
        for scene in [scene, cohesive] {
            let (_, samples) = run(&scene);
            let energy = |sample: usize| samples[sample].fracture.as_ref().unwrap().energy;
            assert!(
                energy(samples.len() - 1) > energy(0) + 1e-3,
                "{name}: {} to {}",
                energy(0),
                energy(samples.len() - 1)
            );
            let closure = relative_closure(&samples);
            assert!(closure < 5e-4, "{name}: closure {closure:e}");
        }
    }
    let mut ring = patch_scene(&annulus(2, 12), 3);
    ring.materials.get_mut("glass").unwrap().fracture = Some(Fracture { length_scale: 0.3, ..at1(Split::Spectral) });
    ring.analysis.end_time = 1e-4;
    assert!(run(&ring).1.iter().all(|s| s.fracture.as_ref().unwrap().min_phase > 1.0 - 1e-12));
    let cracked = &mut ring.materials.get_mut("glass").unwrap().fracture.as_mut().unwrap().model;
    *cracked = CrackModel::PfCzm { tensile_strength: 1e3, softening: Softening::Linear };
    assert!(run(&ring).1.iter().all(|s| s.fracture.as_ref().unwrap().min_phase > 1.0 - 1e-12));

    let mut direct = plate.clone();
    direct.solver.phase_field_solver = PhaseFieldSolver::Cholesky;
    (direct.analysis.end_time, direct.solver.phase_field_tolerance) = (3e-6, 1e-8);
    let iterative = Scene {
        solver: SolverSettings { phase_field_solver: PhaseFieldSolver::ConjugateGradients, ..direct.solver.clone() },
        ..direct.clone()
    };
    let [a, b] = [&direct, &iterative].map(|scene| run(scene).1.pop().unwrap().fracture.unwrap().energy);
    assert!((a / b - 1.0).abs() < 1e-7, "{a} and {b}");
}

#[test]
fn what_does_not_combine_is_refused() {
    let errors = |change: fn(&mut Scene)| {
        let mut scene = cracking(Split::Spectral, 1e6);
        change(&mut scene);
        validate(&scene).err().unwrap_or_default().into_iter().map(|error| error.key).collect::<Vec<_>>()
    };
    assert!(errors(|_| ()).is_empty());
    assert_eq!(errors(|s| s.analysis.frame = Frame::Updated), ["material.glass.fracture.model"]);
    let interval = |s: &mut Scene| s.solver.phase_field_interval = PhaseFieldInterval::Steps(3);
    assert_eq!(errors(interval), ["solver.phase_field_interval"]);
    let wide = |s: &mut Scene| s.bodies[0].cracks[0].kind = CrackKind::Seed(Some(1e-4));
    assert_eq!(errors(wide), ["body.0.crack.0.half_width"]);
    for gamma in [-0.1, f64::NAN, f64::INFINITY] {
        let mut scene = cracking(Split::StarConvex(gamma), 1e6);
        scene.materials.get_mut("glass").unwrap().fracture.as_mut().unwrap().model = CrackModel::At2;
        let keys: Vec<_> = validate(&scene).unwrap_err().into_iter().map(|error| error.key).collect();
        assert_eq!(keys, ["material.glass.fracture.split.star-convex"]);
    }
}
