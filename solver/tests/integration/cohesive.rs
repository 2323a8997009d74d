//! Cohesive cracks: strength, stability at the onset, where damage is the least energy, and what is refused.

use fisura::linear_algebra::extremes::{larger, smaller};
use fisura::linear_algebra::lane::Lane;
use fisura::material::degradation::FractureModel;
use fisura::material::elasticity::ElasticModuli;
use fisura::material::split::driving_energy;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::PhaseField;
use fisura::scene::*;
use fisura::splines::patch::Patch;
use fisura::validate::validate;

use crate::common::{elastic_scene, make_cohesive, notched_plate, run};

const L0: f64 = 0.25e-3;
const SOFTENINGS: [Softening; 3] = [Softening::Linear, Softening::Exponential, Softening::Cornelissen];

fn cracking(softening: Softening, split: Split) -> Scene {
    let mut scene = notched_plate(4e6);
    make_cohesive(&mut scene, 7.5e6, softening, split);
    scene.analysis.end_time = 8e-6;
    scene
}

/// c of a body under the same driving energy everywhere, of its threshold, step by step.
fn uniform_phase(softening: Softening, strength: f64, loads: &[f64]) -> Vec<f64> {
    let mut scene = elastic_scene(2, [4e-3, 1e-3], [8, 2]);
    scene.solver.phase_field_tolerance = 1e-12;
    make_cohesive(&mut scene, strength, softening, Split::Rankine);
    let model = FractureModel::of(&scene.materials["glass"]).unwrap();
    let lattice = Lattice::new(&Patch::new(&scene.mesh), &scene.bodies[0]);
    let mut field = PhaseField::new(&lattice, model, &scene.solver);
    let threshold = model.threshold().unwrap();
    let step = |load: &f64| {
        field.solve(&lattice, &vec![Lane::splat(load * threshold); lattice.batches()]).expect("solved");
        let values = lattice.patch_grid.indices().map(|at| field.control_values()[at]);
        let (low, high) = values.fold((1.0, 0.0), |(low, high), c| (smaller(low, c), larger(high, c)));
        assert!(high - low < 1e-9, "{softening:?} under {load} is not uniform: {low} to {high}");
        low
    };
    loads.iter().map(step).collect()
}

/// The least a1 of a stable onset is where a driving energy of 1.001 times the threshold changes from a small
/// damage to a large one.
#[test]
fn a_uniform_state_jumps_at_its_onset_below_the_least_brittleness() {
    for softening in SOFTENINGS {
        let strength = |a1: f64| (std::f64::consts::FRAC_2_PI * 32e9 * 3.0 / (L0 * a1)).sqrt();
        let law = fisura::material::cohesive::Cohesive::new(softening, 1.0);
        let jump = |a1: f64| 1.0 - uniform_phase(softening, strength(a1), &[0.5, 0.999, 1.001])[2];
        let least = law.stable_from();
        let [below, above] = [0.9, 1.1].map(|factor| jump(factor * least));
        assert!(below > 0.05 && above < 0.005, "{softening:?}: damage {below} below a1 = {least}, {above} above");
        let intact = uniform_phase(softening, strength(1.1 * least), &[0.5, 0.999, 0.3]);
        assert!(intact.iter().all(|c| *c == 1.0), "{intact:?}");
    }
}

/// Where c is free its equation holds; where it rests on what it was, the residual holds it there.
#[test]
fn damage_is_stationary_between_its_bounds() {
    for (softening, split, degree) in [
        (Softening::Linear, Split::Rankine, 2),
        (Softening::Exponential, Split::Spectral, 3),
        (Softening::Cornelissen, Split::StarConvex(2.0), 2),
    ] {
        let mut scene = cracking(softening, split);
        scene.mesh = Mesh::uniform([degree; 2], [0.0; 2], [0.01, 0.005], [48, 24]);
        let (simulation, samples) = run(&scene);
        let frame = simulation.total_frame().unwrap();
        let (fracture, lattice) = (frame.fracture.as_ref().unwrap(), &frame.lattice);
        let model = fracture.model;
        let c = fracture.field.control_values();
        let mut residual = vec![0.0; lattice.patch_grid.zeros().len()];
        let moduli = ElasticModuli::new(&scene.materials["glass"], Plane::Strain);
        let b = 2.0 * L0;
        lattice.for_each_point(|batch, lane, _, weight| {
            let [x, y] = frame.displacement.each_ref().map(|u| lattice.interpolate(batch, u).1);
            let strain = [x[0], y[1], (x[1] + y[0]) * 0.5];
            let drive = driving_energy(&moduli, split, strain).at_least(Lane::ZERO)[lane];
            let (phase, slope) = lattice.interpolate(batch, c);
            let step = 1e-6;
            let g = |c: f64| model.degradation(Lane::splat(c))[0];
            let d_g = (g(phase[lane] + step) - g(phase[lane] - step)) / (2.0 * step);
            let surface = 3.0 / std::f64::consts::PI; // Gc/π
            let functions = frame.lattice.shape_functions(batch);
            let grid = lattice.patch_grid;
            let first = c_index(lattice, batch, lane);
            for n in 0..(degree + 1) * (degree + 1) {
                let at = grid.index(first[0] + n % (degree + 1), first[1] + n / (degree + 1));
                let gradient = functions.gradient[n];
                residual[at] += weight
                    * (functions.value[n][lane] * (d_g * drive - 2.0 * surface * phase[lane] / b)
                        + 2.0
                            * surface
                            * b
                            * (gradient[0][lane] * slope[0][lane] + gradient[1][lane] * slope[1][lane]));
            }
        });
        let volume = (0.01 / 48.0) * (0.005 / 24.0) * 3.0 / b; // of a function, in the unit of the residual
        let (mut damaged, mut free, mut between) = (0, 0, 0);
        for at in lattice.patch_grid.indices() {
            let r = residual[at] / volume;
            assert!((0.0..=1.0).contains(&c[at]), "c = {}", c[at]);
            assert!(r < 1e-5 || c[at] == 0.0, "{softening:?}: residual {r:e} where c = {}", c[at]);
            damaged += usize::from(c[at] < 1.0);
            free += usize::from(r.abs() < 1e-5);
            between += usize::from(c[at] < 0.98 && c[at] > 0.02 && r.abs() < 1e-5);
        }
        assert!(damaged > 100 && free > 20 && between > 3, "{softening:?}: {damaged} damaged, {free} free, {between}");
        let energy = |at: usize| samples[at].fracture.as_ref().unwrap().energy;
        assert!(energy(samples.len() - 1) > 1.2 * energy(0), "{softening:?}: it cracks");
    }
}

/// Column and row of the first function at a point.
fn c_index(lattice: &Lattice, batch: usize, lane: usize) -> [usize; 2] {
    let (row, tile, ..) = lattice.unbatch(batch);
    [lattice.tiles[tile].first + lane, lattice.rows[row].first]
}

#[test]
fn what_does_not_combine_is_refused() {
    let found = |strength: f64, change: fn(&mut Scene)| {
        let mut scene = cracking(Softening::Linear, Split::Rankine);
        make_cohesive(&mut scene, strength, Softening::Linear, Split::Rankine);
        change(&mut scene);
        let checked = validate(&scene);
        let warned = checked.as_ref().map(|warnings| warnings.iter().any(|w| w.message.contains("jumps")));
        (
            checked.as_ref().err().map_or_else(Vec::new, |e| e.iter().map(|e| e.key.clone()).collect()),
            warned.unwrap_or(false),
        )
    };
    assert_eq!(found(7.5e6, |_| ()), (vec![], false));
    assert_eq!(found(12e6, |_| ()), (vec![], true), "a1 = 1.70");
    assert_eq!(found(13e6, |_| ()).0, ["material.glass.fracture.length_scale"], "a1 = 1.45");
    assert_eq!(found(3.0, |_| ()).0, ["material.glass.fracture.tensile_strength"], "a unit forgotten");
    assert_eq!(found(1e-170, |_| ()).0, ["material.glass.fracture.tensile_strength"]);
    assert_eq!(found(1e170, |_| ()).0, ["material.glass.fracture.length_scale"]);
    assert_eq!(found(f64::NAN, |_| ()).0, ["material.glass.fracture.tensile_strength"]);
    assert_eq!(found(-1.0, |_| ()).0, ["material.glass.fracture.tensile_strength"]);
    let updated = |scene: &mut Scene| scene.analysis.frame = Frame::Updated;
    assert_eq!(found(7.5e6, updated).0, ["material.glass.fracture.model"]);
    let interval = |s: &mut Scene| s.solver.phase_field_interval = PhaseFieldInterval::Steps(3);
    assert_eq!(found(7.5e6, interval).0, ["solver.phase_field_interval"]);
    let wide = |s: &mut Scene| s.bodies[0].cracks[0].kind = CrackKind::Seed(Some(1e-4));
    assert_eq!(found(7.5e6, wide).0, ["body.0.crack.0.half_width"]);
}
