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
fn a_patch_on_a_rectangle_is_the_rectangle() {
    let scene = scene(&with_mesh("degree = 2\norigin = [0.1, 0.2]\nsize = [1.0, 0.8]\ncells = [16, 8]"));
    assert_eq!(scene.mesh, Mesh::uniform([2; 2], [0.1, 0.2], [1.0, 0.8], [16, 8]));
    let Shape::Rectangle { min, max } = scene.bodies[0].shape else { panic!("{:?}", scene.bodies[0].shape) };
    assert_eq!((min, max), (scene.mesh.origin(), scene.mesh.end()));
}

/// Edit, replacement, line, key, words of message and remedy.
type Broken = (&'static str, &'static str, usize, &'static str, &'static [&'static str]);

#[rustfmt::skip]
const BROKEN: &[Broken] = &[
    ("  [0, 0, 0, 1, 1, 1],\n  [0, 0, 0, 1, 1, 1],", "  [0, 0, 0, 1, 1, 1],\n  [0, 0, 0, 0.6, 0.4, 1, 1, 1],", 7, "mesh.knots.1", &["knot 4 is smaller", "sort"]),
    ("  [0, 0, 0, 1, 1, 1],", "  [0, 0, 1, 1, 1],", 6, "mesh.knots.0", &["5 knots are too few", "at least 6"]),
    ("  [0, 0, 0, 1, 1, 1],", "  [0, 0, 0.5, 1, 1, 1],", 6, "mesh.knots.0", &["not open for degree 2", "3 times"]),
    ("  [0, 0, 0, 1, 1, 1],", "  [0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1],", 6, "mesh.knots.0", &["stands 3 times", "at most 2 times"]),
    ("  [0.1, 0.8], [0.5, 0.7], [1.0, 0.9],", "  [0.1, 0.8], [0.5, 0.7],", 9, "mesh.control_points", &["8 control points", "3 x 3", "give 9 points", "first direction fastest"]),
    ("[0.55, 0.45]", "[0.55, 0.45, 0.0]", 11, "mesh.control_points.4", &["found 3", "array of two"]),
    ("[0.55, 0.45]", "[nan, 0.45]", 11, "mesh.control_points.4.0", &["not a finite number"]),
    ("[0.55, 0.45]", "[0.55, \"45 MPa\"]", 11, "mesh.control_points.4.1", &["expected a length"]),
    ("[0.55, 0.45]", "[3.0, 0.45]", 9, "mesh.control_points", &["folded in span (0, 0)", "determinant", "the next row lies to its left"]),
    ("weights = [1, 1, 1, 1, 0.8, 1, 1, 1, 1]", "weights = [1, 1]", 14, "mesh.weights", &["2 weights for 9 control points", "give 9 weights"]),
    ("weights = [1, 1, 1, 1, 0.8, 1, 1, 1, 1]", "weights = [1, 1, 1, 1, -0.8, 1, 1, 1, 1]", 14, "mesh.weights.4", &["is -0.8", "above zero"]),
    ("weights = [1, 1, 1, 1, 0.8, 1, 1, 1, 1]", "weights = [1, 1, 1, 1, 1, 1, 1, 1, 0]", 14, "mesh.weights.8", &["is 0", "above zero"]),
    ("subdivide = 16", "subdivide = 0", 15, "mesh.subdivide", &["0 is out of range"]),
    ("subdivide = 16", "cells = [4, 4]", 15, "mesh.cells", &["cannot be used with a mesh with control_points", "subdivide"]),
    ("subdivide = 16", "size = [1, 1]", 15, "mesh.size", &["cannot be used with", "remove it"]),
    ("subdivide = 16", "annulus = { inner_radius = 1, outer_radius = 2 }", 15, "mesh.annulus", &["cannot be used with a mesh with control_points"]),
    ("end_time = \"10 us\"", "end_time = \"10 us\"\nframe = \"updated\"", 19, "analysis.frame", &["updated frame is not supported yet", "use frame = \"total\""]),
    ("degree = 2", "degree = [2, 3]", 7, "mesh.knots.1", &["too few", "at least 8"]),
    ("length_scale = \"10 cm\"", "length_scale = \"1 cm\"", 26, "material.glass.fracture.length_scale", &["cannot resolve", "subdivide"]),
    ("shape = \"patch\"", "shape = { disk = { center = [0.9, 0.8], radius = 0.2 } }", 31, "body.0.shape", &["lies outside the patch", "shape = \"patch\""]),
    ("edge = \"right\"", "segment = [[1.0, 0.0], [1.0, 0.9]]", 34, "body.0.traction.0.segment", &["only its sides can be loaded", "edge = \"left\""]),
    ("shape = \"patch\"", "shape = { disk = { center = [0.5, 0.4], radius = 0.2 } }", 34, "body.0.traction.0.edge", &["only its sides can be loaded", "shape = \"patch\""]),
    ("from = [0.2, 0.4]", "from = [-0.2, 0.4]", 37, "body.0.crack.0.from", &["lies outside body \"all\"", "give ends inside"]),
    ("to = [0.5, 0.4]", "to = [1.2, 0.4]", 38, "body.0.crack.0.to", &["lies outside body"]),
    ("from = [0.2, 0.4]\nto = [0.5, 0.4]", "from = [0.0, 0.01]\nto = [1.0, 0.01]", 37, "body.0.crack.0.from", &["the crack leaves body", "one crack for each part"]),
];

/// Meshes in place of the one of the scene; line 4 is their first.
#[rustfmt::skip]
const BROKEN_MESHES: &[(&str, usize, &str, &[&str])] = &[
    ("degree = 1\ncells = [4, 4]\nannulus = { inner_radius = 1, outer_radius = 2 }", 4, "mesh.degree", &["rational curve of degree 2", "degree = [1, 2]"]),
    ("degree = 2\ncells = [4, 4]\nannulus = { inner_radius = 2, outer_radius = 1 }", 6, "mesh.annulus", &["inner_radius < outer_radius"]),
    ("degree = 2\ncells = [4, 4]\nannulus = { inner_radius = 0, outer_radius = 2 }", 6, "mesh.annulus.inner_radius", &["shrink to a point", "positive inner_radius"]),
    ("degree = 2\ncells = [4, 4]\nannulus = { inner_radius = 1, outer_radius = 2, angles = [1, 0] }", 6, "mesh.annulus", &["growing angles"]),
    ("degree = 2\ncells = [4, 5]\nannulus = { inner_radius = 1, outer_radius = 2, angles = [0, 3.0] }", 5, "mesh.cells", &["2 rational pieces", "multiple of 2"]),
    ("degree = 2\ncells = [4000, 5000]\nannulus = { inner_radius = 1, outer_radius = 2 }", 5, "mesh.cells", &["20000000 spans", "277777"]),
    ("degree = 2\nannulus = { inner_radius = 1, outer_radius = 2 }", 3, "mesh.cells", &["missing", "along the arc"]),
    ("degree = 2\ncells = [4, 4]\nannulus = { inner_radius = 1, outer = 2 }", 6, "mesh.annulus.outer", &["unknown key", "outer_radius"]),
    ("degree = 2\nknots = [[0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1]]\ncells = [4, 4]\nannulus = { inner_radius = 1, outer_radius = 2 }", 5, "mesh.knots", &["cannot be used with a mesh with annulus"]),
    ("degree = 2\ncontrol_points = [[0, 0]]", 3, "mesh.knots", &["missing", "one vector per direction"]),
    ("degree = 2\norigin = [0, 0]\nsize = [1, 1]\ncells = [8, 8]\nweights = [1]", 8, "mesh.weights", &["cannot be used with a rectangle"]),
];

#[test]
fn a_broken_patch_says_where_and_what_would_help() {
    refused_where(BROKEN.iter().map(|(from, to, line, key, words)| (edited(from, to), *line, *key, *words)));
    refused_where(BROKEN_MESHES.iter().map(|(mesh, line, key, words)| (with_mesh(mesh), *line, *key, *words)));
}

/// Its outline lies on the ring everywhere.
#[test]
fn a_disk_over_the_hole_of_a_ring_is_refused() {
    let ring = "degree = 2\ncells = [4, 8]\nannulus = { inner_radius = 1, outer_radius = 2, angles = [0, 6.28] }";
    let disk = "shape = { disk = { center = [0.0, 0.0], radius = 1.5 } }";
    let error = SceneFile::parse("ring.toml", &with_mesh(ring).replace("shape = \"patch\"", disk), &[]).unwrap_err();
    assert!(error.to_string().contains("body.0.shape: the body covers the side of the patch"), "{error}");
}
