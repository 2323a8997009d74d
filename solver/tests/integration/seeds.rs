//! A crack is there only if its seed reaches the material points all along it: where validation says that it
//! does, the phase field is broken along the crack, and where it does not, validation says what would help.

use crate::common::{notched_plate, rectangle};
use fisura::dynamics::total_frame::TotalFrame;
use fisura::linear_algebra::extremes::larger;
use fisura::scene::*;
use fisura::splines::nurbs::NurbsPatch;
use fisura::validate::validate;

const L0: f64 = 0.25e-3;

/// A square of 10 mm with cells of `h` (m) and one crack.
fn seeded(h: f64, points: [usize; 2], crack: Crack) -> Scene {
    let mut scene = notched_plate(0.0);
    let cells = (0.01 / h).round() as usize;
    scene.mesh = Mesh::uniform([2, 2], [0.0; 2], [0.01; 2], [cells; 2]);
    scene.bodies[0].shape = rectangle([0.0; 2], [0.01; 2]);
    scene.bodies[0].particles_per_cell = points;
    scene.bodies[0].tractions.clear();
    scene.bodies[0].cracks = vec![crack];
    scene
}

/// Surface energy over Gc times the length of the crack.
fn energy(scene: &Scene) -> f64 {
    let [from, to] = scene.bodies[0].cracks[0].points[..] else { panic!("a straight crack") };
    let frame = TotalFrame::new(scene).unwrap();
    let (energy, _) = frame.fracture.as_ref().unwrap().surface_energy(&frame.lattice);
    energy / (3.0 * (to[0] - from[0]).hypot(to[1] - from[1]))
}

/// Largest phase field on the crack.
fn largest_phase(scene: &Scene) -> f64 {
    let [from, to] = scene.bodies[0].cracks[0].points[..] else { panic!("a straight crack") };
    let frame = TotalFrame::new(scene).unwrap();
    let field = frame.fracture.as_ref().unwrap().field.control_values();
    let at = |i: i32| {
        let t = f64::from(i) / 400.0;
        let position = [0, 1].map(|d| (1.0 - t) * from[d] + t * to[d]);
        frame.patch.evaluate(field, position).unwrap().value
    };
    (0..=400).map(at).fold(f64::NEG_INFINITY, larger)
}

fn number_after(text: &str, words: &str) -> f64 {
    let (_, rest) = text.split_once(words).unwrap_or_else(|| panic!("no {words:?} in {text:?}"));
    rest.split_whitespace().next().unwrap().parse().unwrap()
}

/// Cracks at many angles and places, half widths from none to wide, spans from l0/2 to 4 l0.
#[test]
fn a_seed_that_passes_is_a_crack_and_the_remedy_of_one_that_does_not_makes_it_one() {
    let (mut sound, mut bare, mut gaps) = (0, 0, 0);
    for (n, h) in [0.5 * L0, L0, 2.0 * L0, 4.0 * L0].into_iter().enumerate() {
        for (m, slope) in [0.0, 0.02, 0.3, 1.0, -0.7].into_iter().enumerate() {
            for (k, half_width) in [0.02 * h, 0.15 * h, 0.25 * h, 0.5 * h, 2.0 * h].into_iter().enumerate() {
                let foot = 0.0037 + 5e-5 * (n + 2 * m + 3 * k) as f64;
                let crack = Crack::wide_seed([0.0, foot], [0.005, foot + 0.005 * slope], Some(half_width));
                let mut scene = seeded(h, [2, 2], crack);
                let name = format!("h = {h:e}, slope {slope}, half width {half_width:e}");
                if let Err(errors) = validate(&scene) {
                    assert_eq!(errors.len(), 1, "{name}: {errors:?}");
                    assert_eq!(errors[0].key, "body.0.crack.0.half_width");
                    if errors[0].message.contains("there is no crack") {
                        bare += 1;
                        assert!(energy(&scene) < 0.2, "{name}: {}", energy(&scene));
                    } else {
                        gaps += 1;
                    }
                    let least = number_after(&errors[0].remedy, "at least ");
                    assert!(least > half_width);
                    scene.bodies[0].cracks[0].kind = CrackKind::Seed(Some(least));
                    assert!(validate(&scene).is_ok(), "{name}: {:?}", validate(&scene));
                    scene.bodies[0].cracks[0].kind = CrackKind::Seed(Some(0.99 * least));
                    assert!(validate(&scene).is_err(), "{name}: {least} is not the least");
                    scene.bodies[0].cracks[0].kind = CrackKind::Seed(Some(least));
                } else {
                    sound += 1;
                }
                let (energy, phase) = (energy(&scene), largest_phase(&scene));
                assert!(energy > 0.85, "{name}: {energy} of Gc");
                // Coarser splines cannot follow a slanted one.
                assert!(phase < 0.4 || h > L0, "{name}: c = {phase} on the crack");
            }
        }
    }
    assert!(sound >= 30 && bare >= 5 && gaps >= 10, "{sound} {bare} {gaps}");
}

/// On a line of knots the nearest points of two per span are 0.211 h away.
#[test]
fn the_largest_cells_are_told_too() {
    let crack = Crack::seed([0.0, 0.005], [0.005, 0.005]);
    let coarse = seeded(4.0 * L0, [2, 2], crack.clone());
    let error = &validate(&coarse).unwrap_err()[0];
    let most = number_after(&error.remedy, "cells of at most ");
    assert!(most > 2.0 * L0 && most < 0.5 * L0 / 0.21132487, "{most}");
    assert!(validate(&seeded(2.0 * L0, [2, 2], crack)).is_ok(), "half of {} is below {most}", 4.0 * L0);
}

#[test]
fn a_seed_that_covers_the_body_or_nothing_is_refused() {
    let crack = |half_width| Crack::wide_seed([0.002, 0.005], [0.008, 0.005], Some(half_width));
    let errors = validate(&seeded(L0, [2, 2], crack(0.02))).unwrap_err();
    assert_eq!(errors[0].key, "body.0.crack.0.half_width");
    assert!(errors[0].message.contains("covers all of body"), "{errors:?}");
    assert!(errors[0].remedy.contains("smaller half width"), "{errors:?}");
    assert!(validate(&seeded(L0, [2, 2], crack(0.0045))).is_ok());
    let bare = validate(&seeded(L0, [2, 2], crack(5e-324))).unwrap_err();
    assert!(bare[0].message.contains("there is no crack"), "{bare:?}");
    assert!(bare[0].remedy.contains("half_width of at least "), "{bare:?}");
}

/// A quarter annulus with so many spans, and a crack from within to without.
fn on_ring(spans: usize, half_width: Option<f64>) -> Scene {
    let ring = NurbsPatch::quarter_annulus(0.01, 0.02).unwrap().elevate(0).unwrap().subdivide(spans).unwrap();
    let mut scene = seeded(L0, [2, 2], Crack::wide_seed([0.0072, 0.0072], [0.0105, 0.0105], half_width));
    scene.mesh = Mesh::of(&ring);
    scene.bodies[0].shape = Shape::Patch;
    scene
}

/// Points on a patch with a geometry are looked at where it maps them.
#[test]
fn seeds_on_a_patch_are_judged_in_metres() {
    let with = |half_width| on_ring(40, half_width);
    let errors = validate(&with(Some(1e-6))).unwrap_err();
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0].key, "body.0.crack.0.half_width");
    let least = number_after(&errors[0].remedy, "at least ");
    assert!(least > 1e-6 && least < 0.5 * 0.4e-3, "{least}");
    assert!(validate(&with(Some(least))).is_ok() && validate(&with(Some(L0))).is_ok());
}

/// A bar one point thick: no neighbour across says how long a span is there.
#[test]
fn bodies_one_point_thick_can_be_cracked() {
    for [along, across] in [[0, 1], [1, 0]] {
        let place = |x: f64, y: f64| if along == 0 { [x, y] } else { [y, x] };
        for (from, to) in [(place(0.0, 0.5 * L0), place(0.005, 0.5 * L0)), (place(0.005, 0.0), place(0.005, L0))] {
            let mut scene = seeded(L0, [2, 2], Crack::seed(from, to));
            let mut cells = [1; 2];
            cells[along] = 40;
            (scene.bodies[0].particles_per_cell[along], scene.bodies[0].particles_per_cell[across]) = (2, 1);
            scene.mesh = Mesh::uniform([2, 2], [0.0; 2], place(0.01, L0), cells);
            scene.bodies[0].shape = rectangle([0.0; 2], place(0.01, L0));
            assert!(validate(&scene).is_ok(), "{from:?} to {to:?}: {:?}", validate(&scene));
            assert!(largest_phase(&scene) < 0.4, "{from:?} to {to:?}: c = {} on the crack", largest_phase(&scene));
        }
    }
}

#[test]
fn a_seed_that_nobody_looked_at_is_told() {
    let mut scene = on_ring(100, Some(1e-9));
    let told = |scene: &Scene| {
        let warnings = validate(scene).unwrap();
        warnings.iter().any(|w| w.key == "body.0.crack.0" && w.message.starts_with("it was not checked"))
    };
    scene.bodies[0].particles_per_cell = [16, 16];
    assert!(told(&scene), "2.6 million points");
    scene.bodies[0].particles_per_cell = [2, 2];
    scene.bodies[0].cracks[0].kind = CrackKind::Seed(None);
    assert!(!told(&scene));
}

/// Cells of 0.25 mm to x = 6 mm, and of 2 mm beyond: eight times l0.
#[test]
fn long_cells_are_refused_where_a_seed_lies_and_named_elsewhere() {
    let key = "material.glass.fracture.length_scale";
    let graded = |crack: Option<[f64; 2]>| {
        let mut scene = seeded(L0, [2, 2], Crack::seed([0.0, 0.005], [0.004, 0.005]));
        let ([from, to], fine) = (crack.unwrap_or_default(), (0..24).map(|i| f64::from(i) * L0));
        let knots = [0.0; 2].into_iter().chain(fine).chain([0.006, 0.008]).chain([0.01; 3]);
        scene.mesh.knots[0] = knots.collect();
        let crack = Crack::wide_seed([from, 0.0051], [to, 0.0051], Some(2.0 * L0));
        scene.bodies[0].cracks = if from < to { vec![crack] } else { vec![] };
        scene
    };
    for crack in [None, Some([0.0, 0.004]), Some([0.001, 0.005])] {
        let warnings = validate(&graded(crack)).unwrap_or_else(|errors| panic!("{crack:?}: {errors:?}"));
        assert_eq!(warnings.iter().map(|w| w.key.as_str()).collect::<Vec<_>>(), [key], "{crack:?}: {warnings:?}");
        assert!(warnings[0].message.contains("h = 2.0000 mm"), "{crack:?}: {warnings:?}");
    }
    let mut coarse = graded(None);
    coarse.mesh = Mesh::uniform([2, 2], [0.0; 2], [0.01; 2], [9; 2]);
    for scene in [graded(Some([0.0, 0.007])), graded(Some([0.007, 0.009])), coarse] {
        let errors = validate(&scene).unwrap_err();
        assert_eq!(errors[0].key, key, "{errors:?}");
    }
}

/// On equal cells `mesh_toughness` is Gc over the cost of a crack, where that is known, and else said to be
/// nothing.
#[test]
fn the_toughness_of_the_mesh_is_gc_over_the_cost_of_a_crack() {
    let run = |rows: &dyn Fn(&mut Vec<f64>), change: &dyn Fn(&mut Fracture)| {
        let mut scene = notched_plate(3e6);
        scene.analysis.end_time = 5e-6;
        rows(&mut scene.mesh.knots[1]);
        change(scene.materials.get_mut("glass").unwrap().fracture.as_mut().unwrap());
        crate::common::run(&scene).1.last().unwrap().kinetic
    };
    let mesh = notched_plate(3e6).mesh;
    let h = mesh.knots[0].windows(2).map(|k| k[1] - k[0]).fold(0.0, larger);
    for (model, a) in [(CrackModel::At2, 0.12), (CrackModel::At1, 0.15)] {
        let with = |length: f64, key: bool, cost: f64| {
            run(&|_| {}, &|fracture| {
                (fracture.model, fracture.length_scale, fracture.mesh_toughness) = (model, length, key);
                fracture.critical_energy_release_rate /= cost;
            })
        };
        let by_key = with(L0, true, 1.0);
        approx::assert_relative_eq!(by_key, with(L0, false, 1.0 + a * h / L0), max_relative = 1e-6);
        assert!((with(L0, false, 1.0) / by_key - 1.0).abs() > 1e-4, "{model:?}: it makes a difference");
        let keeps_gc = with(h / 2.5, true, 1.0) == with(h / 2.5, false, 1.0);
        assert_eq!(keeps_gc, model == CrackModel::At1, "spans of 2.5 l0");
    }
    let effect_on_spans = |rows: &dyn Fn(&mut Vec<f64>)| {
        let run = |key| run(rows, &|fracture| (fracture.length_scale, fracture.mesh_toughness) = (h / 2.5, key));
        (run(true) / run(false) - 1.0).abs()
    };
    // one row of short spans beside rows of long ones, which keep Gc; all rows half as high
    let a_short_one = |knots: &mut Vec<f64>| knots.insert(knots.len() - 3, knots[knots.len() - 1] - 0.3 * h);
    let half_as_high = |knots: &mut Vec<f64>| {
        let rows: Vec<_> = knots.windows(2).filter(|k| k[1] > k[0]).map(|k| 0.5 * (k[0] + k[1])).collect();
        knots.extend(rows);
        knots.sort_by(f64::total_cmp);
    };
    let [equal, short] = [effect_on_spans(&|_| {}), effect_on_spans(&a_short_one)];
    assert!(short < 0.1 * equal, "only the short row has a lower Gc: {short} of {equal}");
    assert!(effect_on_spans(&half_as_high) > 1e-4, "all rows are as high");
    let warnings = |change: &dyn Fn(&mut Scene)| {
        let mut scene = seeded(L0, [2, 2], Crack::seed([0.0, 5e-3], [5e-3, 5e-3]));
        scene.materials.get_mut("glass").unwrap().fracture.as_mut().unwrap().mesh_toughness = true;
        change(&mut scene);
        let found = validate(&scene).unwrap_or_default();
        found.iter().filter(|warning| warning.key.ends_with("mesh_toughness")).count()
    };
    assert_eq!(warnings(&|_| {}), 0);
    assert_eq!(warnings(&|scene| scene.bodies[0].particles_per_cell = [3, 3]), 1);
    assert_eq!(warnings(&|scene| scene.bodies[0].layout = Layout::Uniform), 1);
}
