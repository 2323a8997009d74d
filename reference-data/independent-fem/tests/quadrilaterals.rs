//! Quadrilaterals against closed forms and against the one-dimensional ring.

use independent_fem::mapped::{Mapped, Problem};
use independent_fem::material::{Material, Surface};
use independent_fem::quad_body::{QuadBody, Split};
use independent_fem::quads::{Hole, Quads, gauss_points};
use independent_fem::random::Toughness;

fn lines(count: usize, end: f64) -> Vec<f64> {
    (0..=count).map(|k| end * k as f64 / count as f64).collect()
}

/// A square with a hole, sides of 4 m.
fn with_hole() -> Quads {
    let x = lines(16, 4.0);
    let mut mesh = Quads::between(&x, &x);
    mesh.cut(&x, &x, Hole { centre: [2.0, 2.0], radius: 0.6, half: 1.0, layers: 4 });
    mesh.without(|_| false)
}

fn at1() -> Material {
    Material {
        surface: Surface::At1,
        toughness: 2.0,
        length_scale: 0.25,
        density: 1.0,
        ..Material::new(1.0, 0.3, true)
    }
}

#[test]
fn a_square_with_a_hole_has_its_area_and_two_boundaries() {
    let mesh = with_hole();
    let area: f64 =
        mesh.elements.iter().flat_map(|e| gauss_points(e.map(|n| mesh.nodes[n]))).map(|point| point.area).sum();
    // the hole is a polygon of 32 sides, of which eight each see a side of the square
    let polygon: f64 = (0..8)
        .map(|k| {
            let angle = |k: usize| (k as f64 / 4.0 - 1.0).atan();
            4.0 * 0.5 * 0.36 * (angle(k + 1) - angle(k)).sin()
        })
        .sum();
    assert!((area - (16.0 - polygon)).abs() < 1e-12, "{area}");
    assert_eq!(mesh.boundary().len(), 4 * 16 + 32);
}

#[test]
fn a_uniform_strain_leaves_inner_nodes_in_balance() {
    let mesh = with_hole();
    let mut body = QuadBody::new(mesh, at1(), Split::Rankine, |_| 1.0);
    for (u, [x, y]) in body.displacement.iter_mut().zip(&body.mesh.nodes) {
        *u = [1e-3 * x + 2e-3 * y, -4e-4 * x + 5e-4 * y];
    }
    body.deform();
    body.evaluate();
    let edge: Vec<usize> = body.mesh.boundary().into_iter().flatten().collect();
    let inner = (0..body.mass.len()).filter(|n| !edge.contains(n));
    assert!(inner.flat_map(|n| body.force[n]).all(|force| force.abs() < 1e-15));
    let total: f64 = body.force.iter().flatten().sum();
    assert!(total.abs() < 1e-14);
}

#[test]
fn the_bound_of_frequencies_is_that_of_a_square() {
    let body = QuadBody::new(Quads::between(&lines(4, 1.0), &lines(4, 1.0)), at1(), Split::Spectral, |_| 1.0);
    let critical = 2.0 / body.largest_frequency();
    assert!((critical / at1().critical_step(0.25) - 1.0).abs() < 1e-9, "{critical}");
}

#[test]
fn a_seeded_crack_costs_what_linear_elements_cost() {
    // 3 h/(8 b) more than Gc in a half model, of which half the crack is in the body
    let (h, b) = (0.0625, 0.5);
    let mesh = Quads::between(&lines(2, 0.125), &lines(48, 48.0 * h));
    let mut body = QuadBody::new(mesh, at1(), Split::Spectral, |_| 1.0);
    for (c, [_, y]) in body.c.iter_mut().zip(&body.mesh.nodes) {
        *c = if *y == 0.0 { 0.0 } else { 1.0 };
    }
    body.deform();
    (0..60).for_each(|_| body.crack());
    let cost = body.energies(0.0)[2] / (0.125 * 0.5 * 2.0);
    assert!((cost - 1.0).abs() < 0.5 * (h / b) * (h / b), "{cost}");
}

#[test]
fn random_toughness_is_that_of_the_derivation() {
    // reference-data/derivations/random_toughness.py
    let expected = [
        ([0.0, 0.0], 1, 1.109_073_262_561_879_3),
        ([0.0831, -0.012], 1, 1.096_116_195_244_948),
        ([-0.1, 0.077], 2, 1.058_536_287_400_876_1),
    ];
    for (place, seed, value) in expected {
        let found = Toughness { modulus: 10.0, correlation: 5e-3, seed }.at(place);
        assert!((found - value).abs() < 1e-7, "{found} {value}");
    }
}

#[test]
fn a_ring_takes_up_what_it_does_in_one_dimension() {
    let run = Mapped {
        problem: Problem::Ring,
        h: 3.5e-3,
        b: 1.5e-3,
        cracks: false,
        mesh_toughness: false,
        seed: None,
        end: 30e-6,
        interval: 30e-6,
    };
    let mut last = [0.0; 7];
    run.run(|row| last = row);
    // reference-data/derivations/pressurised_ring.py
    for (found, expected) in last[1..4].iter().zip([33435.5, 19929.4, 13506.1]) {
        assert!((found / expected - 1.0).abs() < 4e-3, "{found} {expected}");
    }
}
