//! `run --vtk`: files for ParaView at every frame, and none without it.

use super::support::{BLOCK, NOTCHED, Place};
use super::vtu;

const FILES: [&str; 6] = ["grid-0.vtu", "grid-1.vtu", "grid.pvd", "points-0.vtu", "points-1.vtu", "points.pvd"];

const RUN: &str = "run scene.toml --out out";
const RUN_VTK: &str = "run scene.toml --out out --vtk";

fn vtk_files(place: &Place) -> Vec<String> {
    place.files("out").into_iter().filter(|name| name.ends_with(".vtu") || name.ends_with(".pvd")).collect()
}

/// Points, cells and names of the fields of a file.
fn parse(place: &Place, name: &str) -> (usize, usize, Vec<String>) {
    let bytes = std::fs::read(place.path(&format!("out/{name}"))).expect("a file");
    let (header, arrays) = vtu::parse(&bytes);
    let number = |name: &str| vtu::value(&header, name).parse().expect("a number");
    let fields = header.split("</PointData>").next().expect("fields").matches("<DataArray ").count();
    let names = arrays.into_iter().take(fields).map(|array| array.0).collect();
    (number("NumberOfPoints"), number("NumberOfCells"), names)
}

#[test]
fn a_cracking_scene_gives_points_and_grid_of_every_frame() {
    for frame in ["total", "updated"] {
        let text = NOTCHED.replace("end_time = \"5 us\"", &format!("end_time = \"5 us\"\nframe = \"{frame}\""));
        let place = Place::with("scene.toml", &text);
        place.succeeds(RUN_VTK).says(&FILES);
        assert_eq!(vtk_files(&place), FILES);
        let particles = place.json("out/summary.json")["particles"].as_u64().unwrap() as usize;
        for number in [0, 1] {
            let (points, cells, names) = parse(&place, &format!("points-{number}.vtu"));
            assert_eq!((points, cells), (particles, particles), "{frame}");
            let fracture = ["phase field", "history energy (J/m^3)"];
            let vectors = ["displacement (m)", "velocity (m/s)"];
            let stresses = ["stress zz (Pa)", "von Mises stress (Pa)"];
            let mut expected = vectors.iter().chain(&fracture).chain(&stresses);
            assert!(expected.all(|name| names.iter().any(|n| n == name)), "{names:?}");
            let (points, cells, names) = parse(&place, &format!("grid-{number}.vtu"));
            assert_eq!((points, cells), (11 * 6, 10 * 5), "{frame}: the body fills the mesh");
            assert_eq!(names, ["velocity (m/s)", "body", "phase field"]);
        }
        for kind in ["points", "grid"] {
            let collection = place.read(&format!("out/{kind}.pvd"));
            assert!(collection.contains(&format!("timestep=\"0e0\" part=\"0\" file=\"{kind}-0.vtu\"")), "{collection}");
            assert!(collection.contains(&format!("file=\"{kind}-1.vtu\"")), "{collection}");
        }
    }
}

#[test]
fn without_vtk_there_are_no_files_for_paraview_and_those_of_the_run_before_go() {
    let place = Place::with("scene.toml", BLOCK);
    place.succeeds(RUN_VTK);
    assert!(parse(&place, "points-0.vtu").2.iter().all(|name| !name.contains("phase")), "an elastic body has none");
    place.write("out/points-mine.vtu", "mine");
    place.succeeds(&format!("{RUN_VTK} --set output.frames=[0]"));
    assert_eq!(vtk_files(&place), ["grid-0.vtu", "grid.pvd", "points-0.vtu", "points-mine.vtu", "points.pvd"]);
    let run = place.succeeds(RUN).complains_of(&["4 files for ParaView of an earlier run in out are removed"]);
    assert_eq!(run.err.lines().count(), 1, "{run:?}");
    assert_eq!(vtk_files(&place), ["points-mine.vtu"]);
    assert_eq!(place.succeeds(RUN).err, "", "there is nothing to tell");
}

#[test]
fn a_file_for_paraview_that_cannot_be_written_costs_nothing_else() {
    let place = Place::with("scene.toml", BLOCK);
    place.succeeds(RUN);
    place.write("out/points-0.vtu/file", "in the way");
    place.refuses(RUN_VTK, &["points-0.vtu cannot be written", "the run continues", "--out"]);
    assert!(place.path("out/history.csv").is_file() && place.path("out/points-1.vtu").is_file());
    assert!(!place.read("out/points.pvd").contains("points-0.vtu"), "what is not there is not listed");
}
