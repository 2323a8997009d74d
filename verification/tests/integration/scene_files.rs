//! Scene files: the example reads as written, broken ones say where and what would help, and nothing panics.

use std::path::Path;

use fisura::scene::*;
use fisura_verification::exact::ExactSolution;
use fisura_verification::exact::kirsch::Kirsch;
use fisura_verification::exact::motion::Derived;
use fisura_verification::scene::{Document, SceneFile, read_scene};

use crate::support::refused_where;

const PLATE: &str = include_str!("../scenes/plate.toml");

fn overrides(list: &[&str]) -> Vec<String> {
    list.iter().map(|s| s.to_string()).collect()
}

/// The plate with `from` replaced by `to`, once.
fn edited(from: &str, to: &str) -> String {
    assert!(PLATE.contains(from), "the plate has no {from:?}");
    PLATE.replacen(from, to, 1)
}

fn plate() -> SceneFile {
    SceneFile::parse("plate.toml", PLATE, &[]).unwrap()
}

#[test]
fn the_example_reads_as_written() {
    let SceneFile { mut scene, source, warnings, .. } = plate();
    assert_eq!(source, PLATE);
    let keys: Vec<&str> = warnings.iter().map(|warning| warning.key.as_str()).collect();
    assert_eq!(keys, ["body.0.crack.0.half_width"], "l0/2 is half a span");
    let mesh = std::mem::replace(&mut scene.mesh, Mesh::uniform([1; 2], [0.0; 2], [1.0; 2], [1; 2]));
    assert_eq!(mesh, Mesh::uniform([2, 2], [0.0, 0.0], [0.1, 0.04], [400, 160]));
    insta::assert_debug_snapshot!("plate", scene);
}

#[test]
fn what_is_left_out_takes_its_default() {
    let text = r#"
        mesh = { degree = [2, 3], origin = ["0 mm", 0], size = ["100 mm", "4 cm"], cells = [400, 160] }
        analysis.end_time = "0.08 ms"
        material.glass = { young_modulus = "32e3 MPa", poisson_ratio = "20 %", density = "2450e-12 t/mm^3" }
        body = [{ name = "plate", material = "glass", shape.rectangle = { min = [0, 0], max = [0.1, 0.04] } }]
    "#;
    let scene = SceneFile::parse("short.toml", text, &[]).unwrap().scene;
    let mut expected = plate().scene;
    expected.title.clear();
    expected.mesh = Mesh::uniform([2, 3], [0.0, 0.0], [0.1, 0.04], [400, 160]);
    expected.materials.get_mut("glass").unwrap().fracture = None;
    expected.bodies[0].particles_per_cell = [2, 3]; // as many as the degree
    expected.bodies[0].tractions.clear();
    expected.bodies[0].cracks.clear();
    expected.boundaries.clear();
    expected.output.frames.clear();
    expected.solver.phase_field_tolerance = 2e-6;
    expected.analysis.transfer = Transfer::Apic;
    assert_eq!(scene, expected);
}

#[test]
fn an_accuracy_chooses_what_a_scene_leaves_out() {
    let left_out = edited("cells  = [400, 160]", "").replace("phase_field_tolerance = 1e-8", "accuracy = \"1 %\"");
    let chosen = |list: &[&str]| {
        let scene = SceneFile::parse("plate.toml", &left_out, &overrides(list)).unwrap().scene;
        let SolverSettings { phase_field_tolerance: tolerance, phase_field_interval: interval, .. } = scene.solver;
        let spans = scene.mesh.knots.each_ref().map(|knots| knots.len() - 5);
        (spans, tolerance, interval, scene.materials["glass"].fracture.as_ref().unwrap().mesh_toughness)
    };
    let steps = PhaseFieldInterval::Steps;
    assert_eq!(chosen(&[]), ([400, 160], 1e-3, steps(2), true));
    assert_eq!(chosen(&["solver.accuracy=\"0.5 %\""]), ([800, 320], 5e-4, steps(1), true));
    let by_direction = ["material.glass.fracture.anisotropy={ tensor = [[1.0, 0.0], [0.0, 4.0]] }"];
    assert_eq!(chosen(&by_direction).0, [1600, 640], "the cost of a crack is not known");
    for without in ["body.0.layout=\"uniform\"", "body.0.particles_per_cell=[3, 3]", "mesh.degree=[2, 3]"] {
        let (spans, .., by_mesh) = chosen(&[without]);
        assert!(spans[0] >= 1600 && !by_mesh, "{without}: {spans:?}");
    }
    assert_eq!(chosen(&["solver.accuracy=\"10 %\""]).1, 1e-3);
    let given = ["mesh.cells=[200, 80]", "solver.phase_field_interval=3", "solver.phase_field_tolerance=1e-6"];
    let kept = [&given[..], &["material.glass.fracture.mesh_toughness=false"]].concat();
    assert_eq!(chosen(&kept), ([200, 80], 1e-6, steps(3), false));
    let refused = |list: &[&str]| SceneFile::parse("plate.toml", &left_out, &overrides(list)).unwrap_err().to_string();
    assert!(refused(&["solver.accuracy=2"]).contains("0.1 %"), "{}", refused(&["solver.accuracy=2"]));
    let [start, end] = ["[material.glass.fracture]", "[[body]]"].map(|part| left_out.find(part).unwrap());
    let elastic = left_out.replace(&left_out[start..end], "");
    let refused = SceneFile::parse("plate.toml", &elastic, &[]).unwrap_err().to_string();
    assert!(refused.contains("nothing to choose"), "{refused}");
}

#[test]
fn every_form_of_a_key_is_read() {
    let text = edited("cells  = [400, 160]", "knots = [[0, 0, 0, 1, 3, 4, 4, 4], [0, 0, 0, 1, 1, 1]]")
        .replace("transfer   = \"flip\"", "transfer = { xpic = 5 }")
        .replace("edge   = \"bottom\"", "segment = [[0, 0], [\"50 mm\", 0]]\nramp = \"1 us\"")
        + "[contact]\nfriction = 0.65\n";
    let scene = read_scene(&Document::parse("forms.toml", &text).unwrap().root, "", Path::new("")).unwrap();
    assert_eq!(scene.mesh.knots[0], [0.0, 0.0, 0.0, 0.025, 0.1 * 0.75, 0.1, 0.1, 0.1]);
    let cut = text.replace("knots =", "subdivide = 2\nknots =");
    let cut = read_scene(&Document::parse("cut.toml", &cut).unwrap().root, "", Path::new("")).unwrap().mesh.knots;
    assert_eq!(cut[0], [0.0, 0.0, 0.0, 0.0125, 0.025, 0.05, 0.1 * 0.75, 0.1 * 0.875, 0.1, 0.1, 0.1]);
    assert_eq!(cut[1], [0.0, 0.0, 0.0, 0.02, 0.04, 0.04, 0.04]);
    let long = text.replace("knots =", "long_ends = [\"right\"]\nknots =");
    let long = read_scene(&Document::parse("long.toml", &long).unwrap().root, "", Path::new("")).unwrap().mesh.knots;
    assert_eq!(long[0], [0.0, 0.0, 0.0, 0.025, 0.1, 0.1, 0.1]);
    assert_eq!(scene.analysis.transfer, Transfer::Xpic(5));
    assert_eq!(scene.contact, Some(Contact { friction: 0.65, ..Contact::default() }));
    assert_eq!(scene.bodies[0].tractions[1].edge, Edge::Segment([[0.0, 0.0], [0.05, 0.0]]));
    assert_eq!(scene.bodies[0].tractions[1].time, TimeFactor::ramp(1e-6));
    let shapes = "{ difference = { of = { disk = { center = [0.05, 0.02], radius = 0.02 } }, minus = [
        { annulus = { center = [0.05, 0.02], inner_radius = 0.001, outer_radius = 0.002 } },
        { polygon = { points = [[0.04, 0.02], [0.045, 0.02], [0.04, 0.025]] } }] } }";
    let text = edited("{ rectangle = { min = [0.0, 0.0], max = [0.1, 0.04] } }", shapes);
    let scene = read_scene(&Document::parse("shapes.toml", &text).unwrap().root, "", Path::new("")).unwrap();
    assert!(matches!(&scene.bodies[0].shape, Shape::Difference { minus, .. } if minus.len() == 2));
}

#[test]
fn the_field_of_kirsch_is_that_of_the_exact_solution() {
    let field = "stress_field = { kirsch = { stress = \"2 MPa\", radius = \"5 mm\", center = [0.03, 0.01] } }";
    let text = edited("edge   = \"bottom\"\nstress", &format!("edge = \"bottom\"\n{field}\n# stress"));
    let scene = SceneFile::parse("field.toml", &text, &[]).unwrap().scene;
    let Load::Field(field) = &scene.bodies[0].tractions[1].load else { panic!("a stress field") };
    let exact = Derived { motion: Kirsch, plane: Plane::Stress };
    for at in [[0.035, 0.01], [0.03, 0.015], [0.02, 0.017], [0.041, -0.003]] {
        let [[xx, xy], [_, yy]] = exact.stress([(at[0] - 0.03) / 0.005, (at[1] - 0.01) / 0.005], 0.0);
        for (found, exact) in field.value(at).into_iter().zip([xx, yy, xy]) {
            approx::assert_relative_eq!(found, 2e6 * exact, epsilon = 1e-6, max_relative = 1e-12);
        }
    }
}

#[test]
fn a_broken_scene_says_where_and_what_would_help() {
    refused_where("scene", |row| edited(&row.from, &row.to));
}

#[test]
fn everything_wrong_is_reported_at_once() {
    let text = edited("degree = 2 ", "degree = 9 ").replace("\"32 GPa\"", "\"32 mm\"").replace("samples", "sample");
    let error = SceneFile::parse("many.toml", &text, &[]).unwrap_err();
    let keys: Vec<&str> = error.diagnostics.iter().map(|d| d.key.as_str()).collect();
    assert_eq!(keys, ["mesh.degree", "material.glass.young_modulus", "output.sample"]);
    let second = &error.diagnostics[1];
    assert_eq!((second.line, second.column, &text[second.span.clone()]), (25, 17, "\"32 mm\""));
}

#[test]
fn files_that_are_no_scene_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let message = || SceneFile::load(&path, &[]).unwrap_err().to_string();
    assert!(message().contains("scene.toml:1:1: cannot be read"), "{}", message());
    for (bytes, expected) in [
        (&b""[..], "scene.toml:1:1: the file is empty; a scene needs"),
        (b"# nothing\n", "scene.toml:1:1: the file declares nothing"),
        (b"title = \"a\"\nx = \"\xff\"\n", "scene.toml:2:6: not UTF-8 text; save the file"),
        (b"\x7fELF\x00\x01\x02", "not valid TOML"),
        (b"# Plate\n\nThis is a text.\n", "scene.toml:3:"),
        (b"time_s,kinetic_j\n0,1\n", "scene.toml:1:"),
    ] {
        std::fs::write(&path, bytes).unwrap();
        assert!(message().contains(expected), "{}", message());
    }
    let deep = format!("title = {}", "[".repeat(100_000));
    assert!(SceneFile::parse("deep.toml", &deep, &[]).is_err());
}

#[test]
fn warnings_have_places_and_do_not_stop() {
    let coarse = edited("size   = [0.1, 0.04]", "size = [0.156, 0.04]").replace("[400, 160]", "[400, 256]");
    let file = SceneFile::parse("coarse.toml", &coarse, &[]).unwrap();
    let lines: Vec<String> = file.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines[0].starts_with("coarse.toml:30:32: material.glass.fracture.length_scale: "), "{lines:?}");
    assert!(lines[0].contains("h = 0.3900 mm") && lines[0].contains("l0 = 0.2500 mm"), "{lines:?}");
}

#[test]
fn overrides_replace_and_add_values() {
    let list = overrides(&[
        "mesh.degree=3",
        "body.0.crack.0.half_width=0.25 mm",
        "body.0.crack.0.to = [0.06, 0.02]",
        "analysis.plane=stress",
        "analysis.end_time=90 us",
        "output.frames=[\"1 us\", 2e-6]",
        "body.0.traction.1.ramp=\"1 us\"",
        "solver.phase_field_solver=cholesky",
        "boundary.0.velocity.0=-1",
        "title=",
    ]);
    let scene = SceneFile::parse("plate.toml", PLATE, &list).unwrap().scene;
    assert_eq!(scene.mesh.degree, [3, 3]);
    assert_eq!(scene.bodies[0].cracks[0].kind, CrackKind::Seed(Some(0.25e-3)));
    assert_eq!(scene.bodies[0].cracks[0].points[1], [0.06, 0.02]);
    assert_eq!(scene.analysis.plane, Plane::Stress);
    assert_eq!(scene.analysis.end_time, 90e-6);
    assert_eq!(scene.output.frames, [1e-6, 2e-6]);
    assert_eq!(scene.bodies[0].tractions[1].time, TimeFactor::ramp(1e-6));
    assert_eq!(scene.solver.phase_field_solver, PhaseFieldSolver::Cholesky);
    assert_eq!(scene.boundaries[0].prescribed.motion, Motion::Velocity([-1.0, 0.0]));
    assert_eq!(scene.title, "");
    let text = PLATE.replace("[output]", "[elsewhere]").replace("samples = 320", "").replace("frames  = ", "x = ");
    let list = overrides(&["output.samples=7", "elsewhere=0"]);
    assert!(SceneFile::parse("a", &text, &list).unwrap_err().to_string().contains("--set:1:1: elsewhere: unknown key"));
    let text = &text[..text.find("[elsewhere]").unwrap()];
    assert_eq!(SceneFile::parse("a", text, &list[..1]).unwrap().scene.output.samples, 7);
}

#[test]
fn a_wrong_override_is_named() {
    for (set, expected) in [
        ("mesh.degree", "--set:1:1: \"mesh.degree\" has no '='; write --set key.path=value"),
        ("mesh..degree=2", "--set:1:1: mesh..degree: an empty key"),
        ("=2", "--set:1:1: an empty key"),
        ("body.3.name=x", "--set:1:1: body.3.name: body is an array with 1 entries"),
        ("body.plate.name=x", "entries count from 0: the only one is 0"),
        ("body.0.crack.1.to=[0, 0]", "body.0.crack is an array with 1 entries and has no entry \"1\""),
        ("boundary.0.fix.x=1", "has no entry \"x\""),
        ("title.sub=1", "--set:1:1: title.sub: title is a string, so it has no key \"sub\"; set title itself"),
        ("mesh.weight.0=1", "mesh.weight is not in the file, so it has no entry 0"),
        ("mesh.degree=9", "--set:1:13: mesh.degree: 9 is out of range"),
        ("mesh.degree=two", "--set:1:13: mesh.degree: expected a whole number between 1 and 4, found a string"),
        ("mesh.degre=2", "--set:1:1: mesh.degre: unknown key \"degre\"; did you mean \"degree\""),
        ("analysis.end_time=80 mm", "--set:1:19: analysis.end_time: \"80 mm\" is a length"),
        (
            "contact.friction=0.3",
            "analysis.kinematics: several bodies, and contact, in the total frame need finite strains",
        ),
        ("material.glass.density= 2450e-12", "--set:1:25: material.glass.density: with this density"),
        ("body.0.shape.rectangle.min=[0,0", "body.0.shape.rectangle.min: not valid TOML: unclosed array"),
        ("mesh={degree=2", "mesh: not valid TOML: "),
        ("title= \"half", "title: not valid TOML: "),
        ("title='half", "title: not valid TOML: "),
        ("mesh=3", "--set:1:6: mesh: expected a table, found an integer"),
    ] {
        let text = SceneFile::parse("plate.toml", PLATE, &overrides(&[set])).expect_err(set).to_string();
        assert!(text.lines().any(|l| l.contains(expected)), "{set}: expected {expected:?}, found\n{text}");
    }
}

#[test]
fn no_prefix_or_change_of_a_file_panics() {
    let parse = |text: &str| {
        if let Err(error) = SceneFile::parse("any.toml", text, &[]) {
            assert!(!error.diagnostics.is_empty() && error.to_string().starts_with("any.toml:"), "{error}");
        }
    };
    let small = PLATE.replace("[400, 160]", "[8, 4]").replace("\"0.25 mm\"", "\"25 mm\"");
    (0..=small.len()).for_each(|end| parse(&small[..end]));
    let letters = ["", "\"", "[", "}", "=", "\n", "-", "9", ".", "é", "\u{0}", "e999", "#"];
    for (at, letter) in letters.iter().cycle().take(small.len()).enumerate() {
        parse(&format!("{}{letter}{}", &small[..at], &small[at + 1..]));
    }
}

#[test]
fn a_value_can_be_put_into_a_tree() {
    use fisura_verification::scene::{Node, Value};
    let mut document = Document::parse("plate.toml", PLATE).unwrap();
    document.root.set("mesh.degree", Node::new(Value::Integer(4), None)).unwrap();
    assert_eq!(read_scene(&document.root, "", Path::new("")).unwrap().mesh.degree, [4, 4]);
    assert!(document.root.set("title.x", Node::new(Value::Integer(4), None)).is_err());
    assert!(document.root.set("", Node::new(Value::Integer(4), None)).is_err());
}

#[test]
fn a_scene_inside_a_case_file_keeps_its_prefix() {
    let text = "claim = \"x\"\n[scene.mesh]\ndegree = 9\n";
    let document = Document::parse("case.toml", text).unwrap();
    let problems = read_scene(document.root.at("scene").unwrap(), "scene", Path::new("")).unwrap_err();
    let error = document.error(&problems).to_string();
    assert!(error.contains("case.toml:3:10: scene.mesh.degree: 9 is out of range"), "{error}");
    assert!(error.contains("scene.analysis: missing"), "{error}");
}
