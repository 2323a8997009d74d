//! Scene files: the example reads as written, broken ones say where and what would help, and nothing panics.

use fisura::scene::*;
use fisura_verification::scene::{Document, SceneFile, read_scene};

const PLATE: &str = include_str!("../scenes/plate.toml");

fn plate() -> Scene {
    let glass = Material {
        young_modulus: 32e9,
        poisson_ratio: 0.2,
        density: 2450.0,
        fracture: Some(Fracture {
            critical_energy_release_rate: 3.0,
            length_scale: 0.25e-3,
            residual_stiffness: 0.0,
            split: Split::Spectral,
        }),
    };
    let traction = |side, y| Traction::on(side, [0.0, y], TimeFactor::default());
    Scene {
        title: "Plate under impact loading".into(),
        mesh: Mesh::uniform([2, 2], [0.0, 0.0], [0.1, 0.04], [400, 160]),
        analysis: Analysis {
            plane: Plane::Strain,
            thickness: 1.0,
            frame: Frame::Total,
            kinematics: Kinematics::Small,
            end_time: 80e-6,
            time_step: TimeStep::Auto,
            safety: 0.8,
            transfer: Transfer::Flip,
            quadrature: Quadrature::Points,
            mass: Mass::Lumped,
            gravity: [0.0, 0.0],
        },
        solver: SolverSettings {
            phase_field_tolerance: 1e-8,
            phase_field_solver: PhaseFieldSolver::ConjugateGradients,
            phase_field_interval: PhaseFieldInterval::Steps(1),
        },
        materials: [("glass".to_string(), glass)].into(),
        bodies: vec![Body {
            tractions: vec![traction(Side::Top, 1e6), traction(Side::Bottom, -1e6)],
            cracks: vec![Crack::wide_seed([0.0, 0.02], [0.05, 0.02], Some(0.125e-3))],
            ..Body::at_rest("plate", "glass", Shape::Rectangle { min: [0.0, 0.0], max: [0.1, 0.04] })
        }],
        contact: None,
        boundaries: vec![Boundary::driven(Side::Left, [true, false], [0.0, 0.0])],
        equilibrium: false,
        output: Output { frames: vec![0.0, 45e-6, 80e-6], ..Output::rows(320) },
    }
}

fn overrides(list: &[&str]) -> Vec<String> {
    list.iter().map(|s| s.to_string()).collect()
}

/// The plate with `from` replaced by `to`, once.
fn edited(from: &str, to: &str) -> String {
    assert!(PLATE.contains(from), "the plate has no {from:?}");
    PLATE.replacen(from, to, 1)
}

#[test]
fn the_example_reads_as_written() {
    let file = SceneFile::parse("plate.toml", PLATE, &[]).unwrap();
    assert_eq!(file.scene, plate());
    assert_eq!(file.source, PLATE);
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
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
    let mut expected = plate();
    expected.title.clear();
    expected.mesh = Mesh::uniform([2, 3], [0.0, 0.0], [0.1, 0.04], [400, 160]);
    expected.materials.get_mut("glass").unwrap().fracture = None;
    expected.bodies[0].tractions.clear();
    expected.bodies[0].cracks.clear();
    expected.boundaries.clear();
    expected.output.frames.clear();
    expected.solver.phase_field_tolerance = 2e-6;
    assert_eq!(scene, expected);
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

/// Edit, replacement, line, key, words of message and remedy.
type Broken = (&'static str, &'static str, usize, &'static str, &'static [&'static str]);

#[rustfmt::skip]
const BROKEN: &[Broken] = &[
    // reading
    ("degree = 2 ", "degre = 2 ", 4, "mesh.degre", &["unknown key", "did you mean \"degree\"", "origin"]),
    ("degree = 2 ", "degre = 2 ", 3, "mesh.degree", &["missing", "degree = 2"]),
    ("degree = 2 ", "degree = 5 ", 4, "mesh.degree", &["5 is out of range", "between 1 and 4"]),
    ("degree = 2 ", "degree = 2.0 ", 4, "mesh.degree", &["found a float", "whole number"]),
    ("degree = 2 ", "degree = [2, 3, 4] ", 4, "mesh.degree", &["found 3", "array of two"]),
    ("size   = [0.1, 0.04]", "size = [0.1, -0.04]", 6, "mesh.size.1", &["positive"]),
    ("cells  = [400, 160]", "cells = [400, 0]", 7, "mesh.cells.1", &["0 is out of range", "100000"]),
    ("cells  = [400, 160]", "", 3, "mesh.cells", &["missing", "cells = [100, 40]"]),
    ("cells  = [400, 160]", "weights = [1]", 7, "mesh.weights", &["cannot be used with a rectangle", "origin, size, cells, knots"]),
    ("cells  = [400, 160]", "cells = [4, 4]\nknots = [[0, 0, 1, 1], [0, 1]]", 7, "mesh.cells", &["remove one"]),
    ("cells  = [400, 160]", "knots = [[1, 1, 0, 0], [0, 1]]", 7, "mesh.knots", &["increasing"]),
    ("cells  = [400, 160]", "cells = [4, 4]\nsubdivide = 2", 8, "mesh.subdivide", &["without knots", "more cells"]),
    ("cells  = [400, 160]", "knots = [[0, 0, 0, 1, 2, 2, 2], [0, 0, 0, 1, 1, 1]]\nsubdivide = 60000", 8, "mesh.subdivide", &["120000 x 60000", "at most 100000"]),
    ("plane      = \"strain\"", "plane = \"strian\"", 10, "analysis.plane", &["did you mean \"strain\"", "\"stress\""]),
    ("\"80 us\"", "\"80 mm\"", 14, "analysis.end_time", &["is a length, expected a time", "\"80 us\""]),
    ("\"80 us\"", "\"80 usec\"", 14, "analysis.end_time", &["unknown unit \"usec\"", "\"80 us\""]),
    ("\"80 us\"", "nan", 14, "analysis.end_time", &["not a finite number"]),
    ("\"80 us\"", "1e30", 14, "analysis.end_time", &["e37 steps", "shorter end_time"]),
    ("\"80 us\"", "true", 14, "analysis.end_time", &["found a boolean", "\"80 us\""]),
    ("transfer   = \"flip\"", "transfer = \"xpic\"", 17, "analysis.transfer", &["{ xpic = 5 }"]),
    ("\"32 GPa\"", "\"32 Gpa\"", 25, "material.glass.young_modulus", &["unknown unit", "did you mean \"GPa\""]),
    ("\"32 GPa\"", "\"32\"", 25, "material.glass.young_modulus", &["a plain number, expected a stress", "bare number"]),
    ("\"0.25 mm\"", "\"0.25 mm^2\"", 30, "material.glass.fracture.length_scale", &["is an area", "\"0.25 mm\""]),
    ("[[body]]", "[body]", 34, "body", &["found one table", "write [[body]] instead of [body]"]),
    ("name     = \"plate\"", "", 34, "body.0.name", &["missing"]),
    ("{ rectangle = {", "{ square = {", 37, "body.0.shape.square", &["unknown key", "rectangle, disk"]),
    ("particles_per_cell = [2, 2]", "particles_per_cell = 0", 38, "body.0.particles_per_cell", &["between 1 and 16"]),
    ("rigid    = false", "rigid = \"no\"", 42, "body.0.rigid", &["found a string", "true or false"]),
    ("edge   = \"bottom\"", "edge = \"below\"", 47, "body.0.traction.1.edge", &["unknown value", "\"bottom\""]),
    ("half_width = 0.125e-3", "halfwidth = 0.125e-3", 52, "body.0.crack.0.halfwidth", &["did you mean \"half_width\""]),
    ("fix  = [\"x\"]", "fix = \"x\"", 58, "boundary.0.fix", &["expected an array"]),
    ("samples = 320", "samples = -1", 62, "output.samples", &["-1 is out of range"]),
    ("safety     = 0.8", "plane = \"stress\"", 16, "analysis.plane", &["duplicate key", "remove one"]),
    ("to   = [0.05, 0.02]", "from = [0.05, 0.02]", 51, "body.0.crack.0.from", &["duplicate key", "remove one"]),
    ("max = [0.1, 0.04]", "min = [0.1, 0.04]", 37, "body.0.shape.rectangle.min", &["duplicate key", "remove one"]),
    ("[output]", "[output", 61, "", &["not valid TOML", "correct the syntax"]),
    // sense
    ("cells  = [400, 160]", "knots = [[0, 0, 1, 1], [0, 0, 0, 1, 1, 1]]", 7, "mesh.knots.0", &["too few", "at least 6"]),
    ("cells  = [400, 160]", "knots = [[0, 0, 0.5, 0.6, 1, 1, 1], [0, 0, 0, 1, 1, 1]]", 7, "mesh.knots.0", &["not open for degree 2", "3 times"]),
    ("cells  = [400, 160]", "knots = [[0, 0, 0, 0.7, 0.6, 1, 1, 1], [0, 0, 0, 1, 1, 1]]", 7, "mesh.knots.0", &["smaller than", "sort"]),
    ("safety     = 0.8", "safety = 1.5", 16, "analysis.safety", &["critical step", "at most 1"]),
    ("\"80 us\"", "0", 14, "analysis.end_time", &["not positive", "\"80 us\""]),
    ("1e-8 ", "1e-1 ", 22, "solver.phase_field_tolerance", &["1e-15", "1e-8"]),
    ("\"32 GPa\"", "\"-32 GPa\"", 25, "material.glass.young_modulus", &["not positive", "\"32 GPa\""]),
    ("poisson_ratio = 0.2", "poisson_ratio = 0.5", 26, "material.glass.poisson_ratio", &["plane strain needs a value below 0.5"]),
    ("poisson_ratio = 0.2", "poisson_ratio = 0.7", 26, "material.glass.poisson_ratio", &["outside (-1, 0.5)"]),
    ("\"2450 kg/m^3\"", "2450e-12", 27, "material.glass.density", &["m/s", "density = 2.45e-9 like t/mm^3 (2450 kg/m^3)", "\"2.45e-9 t/mm^3\""]),
    ("\"2450 kg/m^3\"", "2.45", 27, "material.glass.density", &["m/s", "density = 2.45e0 like g/cm^3 (2450 kg/m^3)"]),
    ("\"2450 kg/m^3\"", "2450e-9", 27, "material.glass.density", &["m/s", "density = 2.45e-6 like kg/mm^3 (2450 kg/m^3)"]),
    ("\"0.25 mm\"", "\"0.05 mm\"", 30, "material.glass.fracture.length_scale", &["cannot resolve", "h = 0.2500 mm", "l0 = 0.0500 mm", "5 times"]),
    ("residual_stiffness           = 0.0", "residual_stiffness = 1", 31, "material.glass.fracture.residual_stiffness", &["[0, 1)"]),
    ("\"glass\"", "\"glas\"", 36, "body.0.material", &["unknown material", "known materials: glass"]),
    ("max = [0.1, 0.04]", "max = [0.2, 0.04]", 37, "body.0.shape", &["outside the mesh", "enlarge mesh.size"]),
    ("max = [0.1, 0.04]", "max = [0.0, 0.04]", 37, "body.0.shape", &["empty rectangle", "min below max"]),
    ("{ rectangle = { min = [0.0, 0.0], max = [0.1, 0.04] } }", "{ disk = { center = [0.05, 0.02], radius = 0.02 } }", 44, "body.0.traction.0.edge", &["only a rectangle has a top side", "segment ="]),
    ("[[body.traction]]\nedge   = \"top\"", "[[body.traction]]\nsegment = [[0, 0], [1, 0]]", 44, "body.0.traction.0.segment", &["leaves body \"plate\"", "boundary"]),
    ("\"gauss\"", "\"maclaurin\"\nparticles_per_cell = [6, 6]", 0, "body.0.particles_per_cell", &["duplicate key"]),
    ("from = [0.0, 0.02]", "from = [-0.01, 0.02]", 50, "body.0.crack.0.from", &["lies outside body \"plate\"", "boundary"]),
    ("to   = [0.05, 0.02]", "to = [0.0, 0.02]", 51, "body.0.crack.0.to", &["zero length"]),
    ("half_width = 0.125e-3", "half_width = 0", 52, "body.0.crack.0.half_width", &["not positive", "l0/2"]),
    ("fix  = [\"x\"]", "fix = []", 58, "boundary.0.fix", &["nothing is fixed", "free side"]),
    ("[output]", "[[boundary]]\nside = \"left\"\nfix = [\"y\", \"x\"]\n[output]", 63, "boundary.1.fix", &["already fixed on the left side", "remove one"]),
    ("80e-6]", "90e-6]", 63, "output.frames.2", &["outside the simulated time", "end_time"]),
    ("samples = 320", "samples = 0", 62, "output.samples", &["between 1"]),
    ("time_step  = \"auto\"", "time_step = 1e-20", 15, "analysis.time_step", &["8.0e15 steps", "longer time_step"]),
    ("from = [0.0, 0.02]\nto   = [0.05, 0.02]", "from = [0.0, 0.02]\nto = [0.11, 0.02]", 51, "body.0.crack.0.to", &["lies outside body \"plate\""]),
    ("# [contact] with friction = 0.65 stands here for bodies that meet", "[contact]\nfriction = 0.65", 12, "analysis.frame", &["contact", "\"updated\""]),
    ("rigid    = false", "rigid = true", 42, "body.0.rigid", &["nothing without contact", "[contact] table"]),
];

#[test]
fn a_broken_scene_says_where_and_what_would_help() {
    let mut missed = Vec::new();
    for (from, to, line, key, words) in BROKEN {
        let error = SceneFile::parse("broken.toml", &edited(from, to), &[]).expect_err(to);
        let text = error.to_string();
        let place = if *line == 0 { "broken.toml:".to_string() } else { format!("broken.toml:{line}:") };
        let subject = if key.is_empty() { String::new() } else { format!(" {key}: ") };
        let found =
            text.lines().any(|l| l.starts_with(&place) && l.contains(&subject) && words.iter().all(|w| l.contains(w)));
        if !found {
            missed.push(format!("{from:?} -> {to:?}: expected {place} {key} {words:?}, found\n{text}"));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

#[test]
fn the_consistent_mass_is_refused_where_it_cannot_be() {
    let consistent = edited("mass       = \"lumped\"", "mass = \"consistent\"");
    assert!(SceneFile::parse("plate.toml", &consistent, &[]).is_ok());
    for (change, words) in [
        ("analysis.frame=updated", ["frame = \"updated\"", "frame = \"total\""]),
        ("body.0.particles_per_cell=1", ["1 points per cell", "give 3 particles_per_cell"]),
        ("body.0.shape.rectangle.max.1=0.0399", ["cuts spans", "end at knots of the mesh"]),
    ] {
        // What else the change breaks stands on lines of its own.
        let error = SceneFile::parse("plate.toml", &consistent, &overrides(&[change])).unwrap_err().to_string();
        let found = error.lines().any(|l| {
            l.starts_with("plate.toml:18:") && l.contains(" analysis.mass: ") && words.iter().all(|w| l.contains(w))
        });
        assert!(found, "{change}: {error}");
    }
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
    assert_eq!(lines.len(), 1, "{lines:?}");
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
    assert_eq!(scene.bodies[0].cracks[0].half_width, Some(0.25e-3));
    assert_eq!(scene.bodies[0].cracks[0].points[1], [0.06, 0.02]);
    assert_eq!(scene.analysis.plane, Plane::Stress);
    assert_eq!(scene.analysis.end_time, 90e-6);
    assert_eq!(scene.output.frames, [1e-6, 2e-6]);
    assert_eq!(scene.bodies[0].tractions[1].time, TimeFactor::ramp(1e-6));
    assert_eq!(scene.solver.phase_field_solver, PhaseFieldSolver::Cholesky);
    assert_eq!(scene.boundaries[0].velocity, [-1.0, 0.0]);
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
            "analysis.frame: several bodies, and contact, need shape functions at the moved positions",
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
            assert!(!error.diagnostics.is_empty());
            assert!(error.to_string().starts_with("any.toml:"));
        }
    };
    let small = PLATE.replace("[400, 160]", "[8, 4]").replace("\"0.25 mm\"", "\"25 mm\"");
    for end in (0..=small.len()).filter(|i| small.is_char_boundary(*i)) {
        parse(&small[..end]);
    }
    let letters = ["", "\"", "[", "}", "=", "\n", "-", "9", ".", "é", "\u{0}", "e999", "#"];
    for at in (0..small.len()).filter(|i| small.is_char_boundary(*i) && small.is_char_boundary(i + 1)) {
        let letter = letters[at % letters.len()];
        parse(&format!("{}{letter}{}", &small[..at], &small[at + 1..]));
    }
}

#[test]
fn a_diagnostic_carries_its_place_and_remedy() {
    let error = SceneFile::parse("plate.toml", &edited("\"80 us\"", "\"80 mm\""), &[]).unwrap_err();
    let diagnostic = &error.diagnostics[0];
    assert_eq!(diagnostic.file, "plate.toml");
    assert!(diagnostic.text()[diagnostic.span.clone()].contains("80 mm"));
    assert!(diagnostic.remedy.contains("\"80 us\""));
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
