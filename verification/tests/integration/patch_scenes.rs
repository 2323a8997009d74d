//! Scene files with general patches: good ones give the patch they describe, bad ones say where and what
//! would help.

use fisura::scene::*;
use fisura::splines::nurbs::NurbsPatch;
use fisura_verification::scene::SceneFile;

use crate::support::refused_where;

const PATCH: &str = include_str!("../scenes/patch.toml");
/// First and last line of the mesh in [`PATCH`], without its heading.
const MESH: std::ops::Range<usize> = 3..15;

/// The scene with `from` replaced by `to`, once.
fn edited(from: &str, to: &str) -> String {
    assert!(PATCH.contains(from), "the patch has no {from:?}");
    PATCH.replacen(from, to, 1)
}

/// The scene with another mesh, without fracture.
fn with_mesh(mesh: &str) -> String {
    let lines: Vec<&str> = PATCH.lines().collect();
    let rest = lines[MESH.end..].join("\n");
    let cut = |key: &str| rest.find(key).unwrap();
    let (elastic, body) = (&rest[..cut("[material.glass.fracture]")], &rest[cut("[[body]]")..cut("[[body.crack]]")]);
    format!("{}\n{mesh}\n{elastic}{body}", lines[..MESH.start].join("\n"))
}

fn scene(text: &str) -> Scene {
    SceneFile::parse("patch.toml", text, &[]).unwrap_or_else(|e| panic!("{e}")).scene
}

/// Where a patch has given parameters, m.
fn position(mesh: &Mesh, parameters: [f64; 2]) -> [f64; 2] {
    let patch = mesh.nurbs().unwrap().unwrap();
    patch.map(&patch.shape_functions(patch.find_span(parameters).unwrap(), parameters)).position
}

#[test]
fn a_patch_reads_as_written() {
    let coarse = scene(&edited("subdivide = 16\n", "").replace("\"10 cm\"", "\"40 cm\""));
    let geometry = coarse.mesh.geometry.as_ref().unwrap();
    assert_eq!(coarse.mesh.degree, [2, 2]);
    assert_eq!(coarse.mesh.knots, [(); 2].map(|()| vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]));
    assert_eq!(geometry.control_points[3..5], [[-0.1, 0.4], [0.55, 0.45]]);
    assert_eq!(geometry.weights, [1.0, 1.0, 1.0, 1.0, 0.8, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(coarse.bodies[0].shape, Shape::Patch);
    assert_eq!(coarse.bodies[0].tractions[0].edge, Edge::Side(Side::Right));

    let fine = scene(PATCH);
    assert_eq!(fine.mesh.knots[0].len(), 2 * 3 + 15);
    assert_eq!(fine.mesh.geometry.as_ref().unwrap().control_points.len(), 18 * 18);
    for parameters in [[0.0, 0.0], [0.3, 0.7], [0.5, 0.5], [1.0, 0.2]] {
        let (a, b) = (position(&coarse.mesh, parameters), position(&fine.mesh, parameters));
        for d in 0..2 {
            approx::assert_abs_diff_eq!(a[d], b[d], epsilon = 1e-14);
        }
    }

    let plain = scene(&edited("weights = [1, 1, 1, 1, 0.8, 1, 1, 1, 1]\n", ""));
    assert!(plain.mesh.geometry.unwrap().weights.iter().all(|w| *w == 1.0), "weights default to 1");
}

/// The table and the control points of the quarter circle give one mesh, but for round-off.
#[test]
fn a_quarter_annulus_both_ways_is_one_mesh() {
    let table = "degree = [1, 2]\ncells = [6, 6]\nannulus = { inner_radius = 1.0, outer_radius = \"2000 mm\" }";
    let points = "degree = [1, 2]\nknots = [[0, 0, 1, 1], [0, 0, 0, 1, 1, 1]]\nsubdivide = 6\n\
                  control_points = [[1, 0], [2, 0], [1, 1], [2, 2], [0, 1], [0, 2]]\n\
                  weights = [1, 1, 0.70710678118654752, 0.70710678118654752, 1, 1]";
    let [table, points] = [table, points].map(|mesh| scene(&with_mesh(mesh)).mesh);
    let close = |a: &[f64], b: &[f64]| {
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(b) {
            approx::assert_abs_diff_eq!(*a, *b, epsilon = 1e-14);
        }
    };
    assert_eq!(table.degree, points.degree);
    for d in 0..2 {
        close(&table.knots[d], &points.knots[d]);
    }
    let [a, b] = [&table, &points].map(|mesh| mesh.geometry.clone().unwrap());
    close(a.control_points.as_flattened(), b.control_points.as_flattened());
    close(&a.weights, &b.weights);
}

#[test]
fn an_annulus_has_its_centre_angles_degrees_and_cells() {
    let mesh = "degree = [2, 3]\ncells = [4, 6]\n\
                annulus = { center = [5.0, -1.0], inner_radius = 1.0, outer_radius = 3.0, angles = [0.5, 3.5] }";
    let mesh = scene(&with_mesh(mesh)).mesh;
    assert_eq!(mesh.degree, [2, 3]);
    let patch = mesh.nurbs().unwrap().unwrap();
    assert_eq!(patch.spaces().each_ref().map(|s| s.spans().len()), [4, 6]);
    for v in [0.0, 0.2, 0.5, 0.77, 1.0] {
        for (u, radius) in [(0.0, 1.0), (0.5, 2.0), (1.0, 3.0)] {
            let [x, y] = position(&mesh, [u, v]);
            approx::assert_abs_diff_eq!((x - 5.0).hypot(y + 1.0), radius, epsilon = 1e-13);
        }
    }
    for (v, angle) in [(0.0, 0.5_f64), (1.0, 3.5)] {
        let [x, y] = position(&mesh, [1.0, v]);
        approx::assert_abs_diff_eq!(x, 5.0 + 3.0 * angle.cos(), epsilon = 1e-13);
        approx::assert_abs_diff_eq!(y, -1.0 + 3.0 * angle.sin(), epsilon = 1e-13);
    }
    assert!(NurbsPatch::annular_sector(1.0, 3.0, [0.5, 3.5]).is_ok());
}

#[test]
fn an_annulus_has_long_ends() {
    let mesh =
        "degree = 2\nlong_ends = [\"left\", \"top\"]\ncells = [4, 6]\nannulus = { inner_radius = 1, outer_radius = 2 }";
    let mesh = scene(&with_mesh(mesh)).mesh;
    assert_eq!(mesh.knots[0], [0.0, 0.0, 0.0, 0.5, 0.75, 1.0, 1.0, 1.0]);
    assert_eq!(mesh.knots[1].len(), 3 + 4 + 3, "five spans");
    let [x, y] = position(&mesh, [0.5, 0.5]);
    approx::assert_abs_diff_eq!(x.hypot(y), 1.5, epsilon = 1e-13);
}

#[test]
fn a_patch_on_a_rectangle_is_the_rectangle() {
    let scene = scene(&with_mesh("degree = 2\norigin = [0.1, 0.2]\nsize = [1.0, 0.8]\ncells = [16, 8]"));
    assert_eq!(scene.mesh, Mesh::uniform([2; 2], [0.1, 0.2], [1.0, 0.8], [16, 8]));
    let Shape::Rectangle { min, max } = scene.bodies[0].shape else { panic!("{:?}", scene.bodies[0].shape) };
    assert_eq!((min, max), (scene.mesh.origin(), scene.mesh.end()));
}

#[test]
fn a_broken_patch_says_where_and_what_would_help() {
    refused_where("patch", |row| edited(&row.from, &row.to));
    refused_where("mesh", |row| with_mesh(&row.to));
}

/// Its outline lies on the ring everywhere.
#[test]
fn a_disk_over_the_hole_of_a_ring_is_refused() {
    let ring = "degree = 2\ncells = [4, 8]\nannulus = { inner_radius = 1, outer_radius = 2, angles = [0, 6.28] }";
    let disk = "shape = { disk = { center = [0.0, 0.0], radius = 1.5 } }";
    let error = SceneFile::parse("ring.toml", &with_mesh(ring).replace("shape = \"patch\"", disk), &[]).unwrap_err();
    assert!(error.to_string().contains("body.0.shape: the body covers the side of the patch"), "{error}");
}
