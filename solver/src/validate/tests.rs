//! Checks that a reader of files never lets through, and the exact bounds of the others.

use super::validate;
use crate::example::{notched_plate, rectangle};
use crate::scene::*;
use crate::splines::nurbs::NurbsPatch;

/// A fracturing square, 10 mm by 10 mm.
fn square() -> Scene {
    let mut scene = notched_plate(0.0);
    scene.mesh = Mesh::uniform([2, 2], [0.0; 2], [0.01; 2], [40, 40]);
    scene.analysis.end_time = 1e-6;
    scene.bodies[0].shape = rectangle([0.0; 2], [0.01; 2]);
    scene.bodies[0].tractions.clear();
    scene.bodies[0].cracks = vec![Crack::wide_seed([0.0, 0.005], [0.005, 0.005], Some(0.5e-3))];
    scene
}

fn with(change: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene = square();
    change(&mut scene);
    scene
}

fn glass(scene: &mut Scene) -> &mut Material {
    scene.materials.get_mut("glass").unwrap()
}

fn errors(change: impl FnOnce(&mut Scene)) -> Vec<String> {
    validate(&with(change)).map_or_else(|e| e.into_iter().map(|e| e.key).collect(), |_| Vec::new())
}

fn warnings(change: impl FnOnce(&mut Scene)) -> Vec<String> {
    validate(&with(change)).unwrap().into_iter().map(|w| w.key).collect()
}

#[test]
fn a_sound_scene_passes_in_silence() {
    assert_eq!(validate(&square()), Ok(vec![]));
}

#[test]
fn a_mesh_that_is_none_is_refused() {
    assert_eq!(errors(|s| s.mesh.degree[1] = 5), ["mesh.degree"]);
    assert_eq!(errors(|s| s.mesh.degree[0] = 0), ["mesh.degree"]);
    assert_eq!(errors(|s| s.mesh.knots[1].clear()), ["mesh.knots.1"]);
    assert_eq!(errors(|s| s.mesh.knots[0][5] = f64::NAN), ["mesh.knots.0"]);
    assert_eq!(errors(|s| s.mesh.knots[0][5] = 0.0), ["mesh.knots.0"]);
    assert_eq!(errors(|s| s.mesh.knots[0].insert(0, 0.0)), ["mesh.knots.0"]);
    assert_eq!(errors(|s| s.mesh = Mesh::uniform([2, 2], [0.0; 2], [0.0; 2], [0, 0])).len(), 2);
    let repeated = |times: usize| {
        errors(|s| {
            let (at, knot) = (10, s.mesh.knots[0][10]);
            s.mesh.knots[0].splice(at..at, vec![knot; times - 1]);
        })
    };
    assert!(repeated(2).is_empty());
    assert_eq!(repeated(3), ["mesh.knots.0"]);
}

#[test]
fn the_resolution_counts_only_where_the_body_is() {
    let length_scale = |l0: f64| {
        move |s: &mut Scene| {
            glass(s).fracture.as_mut().unwrap().length_scale = l0;
            s.bodies[0].cracks[0].kind = CrackKind::Seed(Some(0.375e-3));
        }
    };
    assert!(warnings(length_scale(0.25e-3)).is_empty());
    let narrow = |s: &mut Scene| s.bodies[0].cracks[0].kind = CrackKind::Seed(Some(0.37e-3));
    assert_eq!(warnings(narrow), ["body.0.crack.0.half_width"], "less than 1.5 spans of 0.25 mm");
    let key = "material.glass.fracture.length_scale";
    assert_eq!(warnings(length_scale(0.24e-3)), [key]);
    assert_eq!(warnings(length_scale(0.25e-3 / 4.0)), [key]);
    assert_eq!(errors(length_scale(0.24e-3 / 4.0)), [key]);
    let graded = |s: &mut Scene| s.mesh.knots[0].splice(42.., [0.01, 0.05, 0.05, 0.05]).for_each(drop);
    let sound = with(graded);
    assert_eq!(sound.mesh.knots[0].len(), 46);
    assert!(validate(&sound).unwrap().is_empty(), "{:?}", validate(&sound));
}

#[test]
fn wave_speeds_are_bounded_on_both_sides() {
    let key = "material.glass.density";
    assert_eq!(errors(|s| glass(s).density = 2450e-12), [key]);
    let soft = |modulus: f64| {
        move |s: &mut Scene| *glass(s) = Material { young_modulus: modulus, density: 1000.0, ..glass(s).clone() }
    };
    assert_eq!(warnings(soft(1000.0)), ["analysis.end_time", key], "and it would take a millisecond to cross a cell");
    assert_eq!(errors(soft(1.0)), [key]);
    assert!(warnings(soft(1e9)).is_empty());
}

#[test]
fn poisson_ratio_one_half_is_for_plane_stress() {
    assert_eq!(errors(|s| glass(s).poisson_ratio = 0.5), ["material.glass.poisson_ratio"]);
    let stress = |nu: f64| {
        move |s: &mut Scene| {
            s.analysis.plane = Plane::Stress;
            glass(s).poisson_ratio = nu;
        }
    };
    assert!(errors(stress(0.5)).is_empty());
    for nu in [0.51, -1.0, f64::NAN] {
        assert_eq!(errors(stress(nu)), ["material.glass.poisson_ratio"]);
    }
}

#[test]
fn cracks_lie_in_the_closure_of_their_body() {
    let disk = |from: [f64; 2], to: [f64; 2]| {
        errors(|s| {
            let disk = |radius| Shape::Disk { center: [0.005; 2], radius };
            s.bodies[0].shape = Shape::Difference { of: Box::new(disk(0.005)), minus: vec![disk(0.001)] };
            s.bodies[0].cracks[0] = Crack::seed(from, to);
        })
    };
    assert!(disk([0.0, 0.005], [0.004, 0.005]).is_empty(), "from the rim to the rim of the hole");
    assert_eq!(disk([0.0, 0.005], [0.0045, 0.005]), ["body.0.crack.0.to"]);
    assert_eq!(disk([0.002, 0.005], [0.008, 0.005]), ["body.0.crack.0.from"], "through the hole");
    assert_eq!(disk([0.0, 0.0], [0.002, 0.005]).len(), 1);
    let mut scene = square();
    let triangle = vec![[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]];
    scene.bodies[0].shape = Shape::Polygon { points: triangle };
    assert!(validate(&scene).is_ok(), "an end on the slanted edge");
    scene.bodies[0].cracks[0].points[1] = [0.0051, 0.005];
    assert!(validate(&scene).is_err());
    assert_eq!(errors(|s| glass(s).fracture = None), ["body.0.crack"]);
}

#[test]
fn a_crack_does_not_leap_over_a_hole() {
    let crack = |radius: f64| {
        errors(|s| {
            let hole = Shape::Disk { center: [0.0025, 0.005], radius };
            s.bodies[0].shape = Shape::Difference { of: Box::new(s.bodies[0].shape.clone()), minus: vec![hole] };
            s.bodies[0].cracks[0] = Crack::seed([0.0, 0.005], [0.01, 0.005]);
        })
    };
    assert_eq!(crack(0.3e-3), ["body.0.crack.0.from"], "neither end nor the middle is in the hole");
    assert_eq!(crack(0.07e-3), ["body.0.crack.0.from"], "a hole of about l0/2");
    let endless = |s: &mut Scene| glass(s).fracture.as_mut().unwrap().length_scale = 1e-300;
    assert_eq!(errors(endless), ["material.glass.fracture.length_scale"], "a finite number of positions");
}

#[test]
fn tractions_act_on_segments_of_their_body() {
    let segment = |ends: [[f64; 2]; 2]| {
        errors(|s| {
            s.bodies[0].shape = rectangle([0.0; 2], [0.008, 0.01]);
            s.bodies[0].tractions = vec![Traction {
                edge: Edge::Segment(ends),
                load: Load::Stress([1e6, 0.0]),
                time: TimeFactor::default(),
            }];
        })
    };
    assert!(segment([[0.008, 0.0], [0.008, 0.01]]).is_empty(), "on the boundary");
    assert!(segment([[0.004, 0.002], [0.004, 0.003]]).is_empty(), "inside");
    assert_eq!(segment([[0.009, 0.0], [0.009, 0.01]]), ["body.0.traction.0.segment"], "in the mesh beside the body");
    assert_eq!(segment([[0.0, 0.01], [0.0081, 0.01]]), ["body.0.traction.0.segment"], "longer than the side");
    for beginning in [-0.001, 0.0] {
        let notched = errors(|s| {
            let notch = rectangle([0.004, beginning], [0.005, 0.002]);
            s.bodies[0].shape = Shape::Difference { of: Box::new(s.bodies[0].shape.clone()), minus: vec![notch] };
            let edge = Edge::Segment([[0.0, 0.0], [0.01, 0.0]]);
            let load = Load::Stress([0.0, 1e6]);
            s.bodies[0].tractions = vec![Traction { edge, load, time: TimeFactor::default() }];
        });
        assert_eq!(notched, ["body.0.traction.0.segment"], "over the mouth of a notch");
    }
}

#[test]
fn the_number_of_steps_is_bounded() {
    let messages = |change: &dyn Fn(&mut Scene)| {
        validate(&with(change)).map_or_else(|e| e.iter().map(ToString::to_string).collect(), |_| Vec::new())
    };
    assert_eq!(errors(|s| s.analysis.end_time = 1e30), ["analysis.end_time"]);
    assert_eq!(errors(|s| s.analysis.end_time = f64::MAX), ["analysis.end_time"]);
    // 3809.5 m/s over 0.25 mm
    assert!(errors(|s| s.analysis.end_time = 65.0).is_empty());
    let long: Vec<String> = messages(&|s| s.analysis.end_time = 66.0);
    assert!(long.len() == 1 && long[0].contains("1.0e9 steps"), "{long:?}");
    let thin_beside = |s: &mut Scene| {
        s.analysis.end_time = 65.0;
        s.mesh.knots[0].splice(42.., [0.01, 0.010001, 0.010001, 0.010001]).for_each(drop);
    };
    assert!(errors(thin_beside).is_empty(), "cells without a body do not count");
    let fixed = |step| move |s: &mut Scene| s.analysis.time_step = TimeStep::Fixed(step);
    assert!(errors(fixed(1.1e-15)).is_empty());
    assert_eq!(errors(fixed(0.9e-15)), ["analysis.time_step"]);
    assert_eq!(errors(fixed(1e-320)), ["analysis.time_step"]);
}

#[test]
fn a_boundary_holds_a_body() {
    let held = |side, min: [f64; 2], max: [f64; 2]| {
        warnings(|s| {
            s.bodies[0].shape = Shape::Rectangle { min, max };
            s.bodies[0].cracks.clear();
            s.boundaries = vec![Boundary::driven(side, [true, true], [0.0; 2])];
        })
    };
    for side in [Side::Left, Side::Right, Side::Bottom, Side::Top] {
        assert!(held(side, [1e-12; 2], [0.01 - 1e-12; 2]).is_empty(), "{side:?}");
        assert_eq!(held(side, [0.001; 2], [0.009; 2]), ["boundary.0.side"], "{side:?}");
    }
    assert!(held(Side::Top, [0.001; 2], [0.009, 0.01]).is_empty());
    assert_eq!(held(Side::Bottom, [0.001; 2], [0.009, 0.01]), ["boundary.0.side"]);
}

#[test]
fn points_and_layouts_have_bounds() {
    let points = |counts, layout| {
        move |s: &mut Scene| {
            s.bodies[0].particles_per_cell = counts;
            s.bodies[0].layout = layout;
        }
    };
    for counts in [[0, 2], [2, 17]] {
        assert_eq!(errors(points(counts, Layout::Gauss)), ["body.0.particles_per_cell"]);
    }
    assert_eq!(warnings(points([1, 2], Layout::Gauss)), ["body.0.particles_per_cell"]);
    assert!(warnings(points([5, 2], Layout::Maclaurin)).is_empty());
    assert_eq!(errors(points([6, 2], Layout::Maclaurin)), ["body.0.layout"]);
}

#[test]
fn bodies_too_small_for_their_cells_are_told() {
    let alone = |points: usize, degree: usize, cells: usize| {
        warnings(|s| {
            s.mesh = Mesh::uniform([degree; 2], [0.0; 2], [0.01; 2], [cells, 1]);
            s.bodies[0].cracks.clear();
            s.materials.get_mut("glass").unwrap().fracture = None;
            s.bodies[0].particles_per_cell = [points; 2];
            s.analysis.end_time = 1e-3;
        })
    };
    assert_eq!(alone(2, 2, 1), ["body.0.particles_per_cell"]);
    assert!(alone(3, 2, 1).is_empty() && alone(2, 2, 2).is_empty() && alone(2, 1, 1).is_empty());
    let rigid = |radius: f64| {
        warnings(|s| {
            let shape = Shape::Disk { center: [0.007, 0.005], radius };
            s.bodies[0].shape = rectangle([0.0; 2], [0.005, 0.01]);
            s.bodies[0].cracks.clear();
            s.bodies.push(Body { rigid: true, ..Body::at_rest("pin", "glass", shape) });
            s.contact = Some(Contact::default());
            s.analysis.kinematics = Kinematics::Finite;
        })
    };
    assert_eq!(rigid(1e-4), ["body.1.shape"]);
    assert!(rigid(5e-4).is_empty(), "{:?}", rigid(5e-4));
}

#[test]
fn shapes_without_area_are_refused() {
    let square = |points: &[[f64; 2]]| Shape::Polygon { points: points.to_vec() };
    for shape in [
        rectangle([0.0; 2], [0.01, 0.0]),
        rectangle([0.0; 2], [0.01, f64::NAN]),
        Shape::Disk { center: [0.005; 2], radius: 0.0 },
        Shape::Annulus { center: [0.005; 2], inner_radius: 0.002, outer_radius: 0.001 },
        square(&[[0.0, 0.0], [0.01, 0.0]]),
        square(&[[0.0, 0.0], [0.01, 0.0], [0.002, 0.0]]),
        square(&[]),
    ] {
        assert_eq!(errors(|s| s.bodies[0].shape = shape.clone()), ["body.0.shape"], "{shape:?}");
    }
}

#[test]
fn what_the_solver_cannot_do_is_refused_by_key() {
    assert_eq!(warnings(|s| s.analysis.transfer = Transfer::Tpic), ["analysis.transfer"]);
    assert!(warnings(|s| s.analysis.transfer = Transfer::Flip).is_empty(), "scenes of the total frame say so");
    let updated = |transfer| {
        move |s: &mut Scene| {
            s.analysis.frame = Frame::Updated;
            s.analysis.transfer = transfer;
        }
    };
    for transfer in [Transfer::Flip, Transfer::Pic, Transfer::Apic, Transfer::Tpic, Transfer::Xpic(5)] {
        assert!(errors(updated(transfer)).is_empty(), "{transfer:?}");
    }
    assert_eq!(errors(updated(Transfer::Xpic(0))), ["analysis.transfer"]);
    assert!(errors(|s| s.analysis.kinematics = Kinematics::Finite).is_empty());
    let finite = |s: &mut Scene| {
        updated(Transfer::Apic)(s);
        s.analysis.kinematics = Kinematics::Finite;
    };
    assert!(errors(finite).is_empty());
    assert_eq!(errors(|s| s.bodies.clear()), ["body"]);
}

#[test]
fn several_bodies_need_room_and_in_the_total_frame_finite_strains() {
    let two = |gap: f64| {
        move |s: &mut Scene| {
            s.analysis.frame = Frame::Updated;
            s.contact = Some(Contact { friction: 0.3, ..Contact::default() });
            let block = |name: &str, left: f64, right: f64| Body {
                name: name.into(),
                shape: rectangle([left, 0.0], [right, 0.01]),
                tractions: vec![],
                cracks: vec![],
                ..s.bodies[0].clone()
            };
            s.bodies = vec![block("left", 0.0, 0.005), block("right", 0.005 + gap, 0.01)];
        }
    };
    assert!(errors(two(0.0)).is_empty());
    assert_eq!(errors(two(-1e-4)), ["body.1.shape"]);
    let changed = |change: fn(&mut Scene)| {
        errors(move |s| {
            two(0.0)(s);
            change(s);
        })
    };
    assert_eq!(changed(|s| s.analysis.frame = Frame::Total), ["analysis.kinematics"]);
    assert_eq!(changed(|s| s.contact = Some(Contact { friction: -0.1, ..Contact::default() })), ["contact.friction"]);
    for stiffness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let soft = move |s: &mut Scene| {
            two(0.0)(s);
            s.contact = Some(Contact { stiffness: Some(stiffness), ..Contact::default() });
        };
        assert_eq!(errors(soft), ["contact.stiffness"]);
    }
    let whole = changed(|s| {
        s.contact = Some(Contact { friction: 0.1, fragments: true, ..Contact::default() });
        s.materials.values_mut().for_each(|material| material.fracture = None);
    });
    assert_eq!(whole, ["contact.fragments"]);
    let itself = |s: &mut Scene| {
        s.contact = Some(Contact { friction: 0.1, self_contact: true, ..Contact::default() });
    };
    assert_eq!(changed(itself), ["contact.self_contact"]);
    let pulled = changed(|s| {
        s.contact = Some(Contact { friction: 0.1, fragments: true, ..Contact::default() });
        s.bodies[1].tractions = vec![Traction::on(Side::Right, [1e3, 0.0], TimeFactor::default())];
    });
    assert_eq!(pulled, ["body.1.traction"]);
    assert_eq!(changed(|s| s.bodies[1].name = "left".into()), ["body.1.name"]);
    assert!(changed(|s| s.bodies[1].rigid = true).is_empty());
    assert!(changed(|s| s.contact = None).is_empty(), "bodies that do not meet");
    let silent = warnings(|s| {
        two(0.0)(s);
        s.contact = None;
    });
    assert_eq!(silent, ["contact"], "bodies that pass through each other");
    assert!(warnings(two(0.0)).is_empty());
    assert_eq!(changed(|s| s.bodies[1].velocity = [-1e300, 0.0]), ["contact"]);
    assert!(changed(|s| s.bodies[1].velocity = [1e300, 0.0]).is_empty(), "it flies away from the other");
    assert_eq!(changed(|s| s.bodies.iter_mut().for_each(|b| b.rigid = true)), ["body"]);
    let alone = |s: &mut Scene| {
        s.bodies[1].rigid = true;
        s.contact = None;
    };
    assert_eq!(changed(alone), ["body.1.rigid"]);
    let within = |s: &mut Scene| {
        s.bodies[1].shape = Shape::Disk { center: [0.0025, 0.005], radius: 0.001 };
    };
    assert_eq!(changed(within), ["body.1.shape"], "one body inside the other");
    assert_eq!(changed(|s| s.bodies[1].shape = s.bodies[0].shape.clone()), ["body.1.shape"], "one body twice");
}

/// The corner of two sides has what either prescribes, whatever their order; they may not contradict each
/// other.
#[test]
fn sides_that_meet_agree_in_their_corner() {
    let side = |side, fix, velocity| Boundary::driven(side, fix, velocity);
    let both = |a: &Boundary, b: &Boundary| {
        let keys = errors(|s| s.boundaries = vec![a.clone(), b.clone()]);
        assert_eq!(keys, errors(|s| s.boundaries = vec![b.clone(), a.clone()]), "in the other order");
        keys
    };
    let driven = side(Side::Left, [true, true], [2.0, 0.0]);
    assert_eq!(both(&driven, &side(Side::Top, [true, false], [1.0, 0.0])), ["boundary.1.fix"]);
    assert_eq!(both(&driven, &side(Side::Bottom, [true, true], [0.0; 2])), ["boundary.1.fix"]);
    assert!(both(&driven, &side(Side::Top, [true, false], [2.0, 0.0])).is_empty(), "the same velocity");
    assert!(both(&driven, &side(Side::Top, [false, true], [0.0; 2])).is_empty(), "x is prescribed once");
    assert!(both(&driven, &side(Side::Right, [true, true], [-2.0, 0.0])).is_empty(), "these do not meet");
}

#[test]
fn weights_and_knots_beyond_what_sums_can_hold_are_refused() {
    let general = |weight: f64, knot: f64, scale: f64| {
        errors(|s| {
            let mut mesh = Mesh::of(&NurbsPatch::quarter_annulus(1.0, 2.0).unwrap().subdivide(2).unwrap());
            mesh.knots[0].iter_mut().filter(|k| **k == 1.0).for_each(|k| *k = knot);
            let geometry = mesh.geometry.as_mut().unwrap();
            geometry.weights[0] = weight;
            geometry.control_points.iter_mut().flatten().for_each(|x| *x *= scale);
            s.mesh = mesh;
            s.materials.get_mut("glass").unwrap().fracture = None;
            s.bodies[0].cracks.clear();
            s.bodies[0].shape = Shape::Patch;
        })
    };
    assert!(general(1.0, 1.0, 1.0).is_empty() && general(100.0, 1.0, 1.0).is_empty());
    assert_eq!(general(1e-300, 1.0, 1.0), ["mesh.weights"]);
    assert_eq!(general(1e8, 1.0, 1.0), ["mesh.weights"]);
    assert_eq!(general(1.0, 1e300, 1.0), ["mesh.knots.0"]);
    assert_eq!(general(1.0, 1e11, 1.0), ["mesh.knots.0"], "a span of 0.5 in 1e11");
    assert_eq!(general(1.0, 1.0, 1e14), ["mesh.control_points"]);
    let stretched = |end: f64| {
        errors(|s| {
            s.mesh = Mesh::uniform([2, 2], [0.0; 2], [end, 0.01], [40, 40]);
            s.bodies[0].cracks.clear();
        })
    };
    assert_eq!(stretched(1e300), ["mesh.knots.0"]);
    assert_eq!(stretched(1e-300), ["mesh.knots.0"]);
}

#[test]
fn toughness_varies_in_the_total_frame_with_models_that_know_it() {
    let random = |modulus: f64| RandomToughness { modulus, correlation: 1e-3, seed: 1 };
    let with = |change: &dyn Fn(&mut Fracture)| errors(|s| change(glass(s).fracture.as_mut().unwrap()));
    let tensor = |tensor: [[f64; 2]; 2]| Some(Anisotropy { tensor, angle: 0.3 });
    assert!(with(&|f| f.random = Some(random(2.0))).is_empty());
    assert!(with(&|f| f.anisotropy = tensor([[1.0, 0.0], [0.0, 4.0]])).is_empty());
    let key = |name: &str| [format!("material.glass.fracture.{name}")];
    assert_eq!(with(&|f| f.random = Some(random(f64::NAN))), key("random.modulus"));
    assert_eq!(with(&|f| f.anisotropy = tensor([[1.0, f64::NAN], [f64::NAN, 1.0]])), key("anisotropy.tensor"));
    assert_eq!(with(&|f| f.anisotropy = tensor([[0.01, 0.0], [0.0, 1.0]])), key("length_scale"), "l0/10 for h = l0");
    let cohesive = CrackModel::PfCzm { tensile_strength: 3e6, softening: Softening::Linear };
    let with_cohesive = errors(|s| {
        let fracture = glass(s).fracture.as_mut().unwrap();
        (fracture.model, fracture.random) = (cohesive, Some(random(2.0)));
        s.bodies[0].cracks[0].kind = CrackKind::Seed(None);
    });
    assert_eq!(with_cohesive, key("random.field"));
    let moving = errors(|s| {
        (s.analysis.frame, s.analysis.kinematics) = (Frame::Updated, Kinematics::Finite);
        glass(s).fracture.as_mut().unwrap().random = Some(random(2.0));
    });
    assert_eq!(moving, key("random"));
    assert_eq!(
        errors(|s| (glass(s).fracture, s.bodies[0].cracks, s.output.fragments) = (None, vec![], true)),
        ["output.fragments"]
    );
}
