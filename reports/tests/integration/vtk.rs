//! Files for ParaView: read back with meshio where Python has it, and by their structure everywhere.

use std::path::Path;
use std::process::Command;

use fisura_reports::vtk::{Cells, Field, Piece, pvd, vtu};

use crate::vtu::parse;

/// Not-a-number and the last bit must survive.
const PHASE: [f64; 6] = [1.0, 0.1 + 0.2, 0.0, -0.011, f64::NAN, 1e-300];
const POINTS: [[f64; 2]; 6] = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.0, 0.25], [0.5, 0.25], [1.0, 0.25]];
const VELOCITY: [f64; 12] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0];
const SPANS: [[usize; 4]; 2] = [[0, 1, 4, 3], [1, 2, 5, 4]];

fn piece(cells: Cells) -> Piece {
    let phase = Field { name: "phase field", components: 1, values: &PHASE };
    let velocity = Field { name: "velocity (m/s)", components: 2, values: &VELOCITY };
    Piece { points: &POINTS, cells, fields: vec![phase, velocity] }
}

fn floats(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

#[test]
fn every_bit_is_where_the_header_says() {
    for (cells, count, kind, first) in
        [(Cells::Points, 6, 1, vec![0_i64]), (Cells::Quadrilaterals(&SPANS), 2, 9, vec![0, 1, 4, 3])]
    {
        let (header, arrays) = parse(&vtu(&piece(cells)));
        assert!(header.contains(&format!("NumberOfPoints=\"6\" NumberOfCells=\"{count}\"")), "{header}");
        let array = |name: &str| &arrays.iter().find(|array| array.0 == name).unwrap().1[..];
        let phase = floats(array("phase field"));
        assert_eq!(phase.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), PHASE.map(f64::to_bits));
        assert_eq!(floats(array("velocity (m/s)"))[..6], [1.0, 2.0, 0.0, 3.0, 4.0, 0.0]);
        assert_eq!(floats(array("Points"))[3..6], [0.5, 0.0, 0.0]);
        let connectivity: Vec<u8> = first.iter().flat_map(|point| point.to_le_bytes()).collect();
        assert!(array("connectivity").starts_with(&connectivity));
        assert_eq!(array("types"), vec![kind; count]);
        assert_eq!(array("offsets").len(), 8 * count);
    }
}

#[test]
fn a_collection_names_every_frame() {
    let text = pvd(&[(0.0, 0, "points-0us.vtu".into()), (4.5e-5, 1, "grid-45us.vtu".into())]);
    assert!(text.contains("timestep=\"4.5e-5\" part=\"1\" file=\"grid-45us.vtu\""), "{text}");
}

/// Reads both files with meshio and prints what it found.
const READER: &str = r#"
import sys, meshio
for name in sys.argv[1:]:
    mesh = meshio.read(name)
    cells = [(block.type, block.data.tolist()) for block in mesh.cells]
    print(mesh.points[:, :2].tolist() == [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.0, 0.25], [0.5, 0.25], [1.0, 0.25]])
    print(cells[0][0], len(cells[0][1]), cells[0][1][-1])
    print([float(v).hex() for v in mesh.point_data["phase field"].ravel()])
    print(mesh.point_data["velocity (m/s)"].tolist()[5])
"#;

#[test]
fn an_independent_reader_finds_the_same() {
    let available = |code: &str| Command::new("python3").args(["-c", code]).output().is_ok_and(|o| o.status.success());
    if !available("import meshio") {
        eprintln!("python3 with meshio is not installed: the files are checked by their structure only");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, cells| {
        let path = folder.path().join(name);
        std::fs::write(&path, vtu(&piece(cells))).unwrap();
        path
    };
    let paths = [file("points.vtu", Cells::Points), file("grid.vtu", Cells::Quadrilaterals(&SPANS))];
    let output =
        Command::new("python3").args(["-c", READER]).args(paths.each_ref().map(|p| p as &Path)).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    let phase = "['0x1.0000000000000p+0', '0x1.3333333333334p-2', '0x0.0p+0', '-0x1.6872b020c49bap-7', 'nan', '0x1.56e1fc2f8f359p-997']";
    let velocity = "[11.0, 12.0, 0.0]";
    let expected = format!("True\nvertex 6 [5]\n{phase}\n{velocity}\nTrue\nquad 2 [1, 2, 5, 4]\n{phase}\n{velocity}\n");
    assert_eq!(text, expected, "{}", String::from_utf8_lossy(&output.stderr));
}
