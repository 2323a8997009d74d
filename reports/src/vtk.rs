//! Files for ParaView: material points and the mesh of a run as VTK unstructured grids, and a collection over
//! the frames.
//!
//! A `.vtu` file is XML with its numbers appended as raw little-endian binary, which keeps every bit and is
//! read without parsing: [`vtu`]. Material points are cells of one point each, spans are quadrilaterals. A
//! `.pvd` file names the files of each frame with its time: [`pvd`]. Both are pure functions of numbers.

mod appended;

use std::fmt::Write;

use appended::Appended;

/// Kind of all cells of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cells<'a> {
    /// Every point is a cell: material points.
    Points,
    /// Quadrilaterals, four points each, counter-clockwise: spans.
    Quadrilaterals(&'a [[usize; 4]]),
}

/// Values at the points.
#[derive(Debug, Clone, PartialEq)]
pub struct Field<'a> {
    /// Name, with its unit: `velocity (m/s)`.
    pub name: &'a str,
    /// Numbers per point: 1, or 2 for a vector, which is written with a third component of zero.
    pub components: usize,
    /// `components` numbers per point, point by point.
    pub values: &'a [f64],
}

/// Points, cells and fields.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece<'a> {
    /// Positions `[x, y]` of the points, m.
    pub points: &'a [[f64; 2]],
    /// Cells between the points.
    pub cells: Cells<'a>,
    /// Fields at the points; each has as many values as there are points times its components.
    pub fields: Vec<Field<'a>>,
}

/// VTK's numbers for kinds of cells.
const VERTEX: u8 = 1;
const QUADRILATERAL: u8 = 9;

/// The bytes of a `.vtu` file.
///
/// # Panics
/// If a field has another number of values than its points need.
pub fn vtu(piece: &Piece) -> Vec<u8> {
    let mut data = Appended::default();
    let count = piece.points.len();
    let (connectivity, per_cell, kind): (Vec<i64>, usize, u8) = match piece.cells {
        Cells::Points => ((0..count as i64).collect(), 1, VERTEX),
        Cells::Quadrilaterals(cells) => (cells.iter().flatten().map(|&i| i as i64).collect(), 4, QUADRILATERAL),
    };
    let cells = connectivity.len() / per_cell;
    let offsets: Vec<i64> = (1..=cells).map(|cell| (cell * per_cell) as i64).collect();
    let mut xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{cells}\">\n"
    );
    xml.push_str("<PointData>\n");
    for field in &piece.fields {
        assert_eq!(field.values.len(), field.components * count, "{} has a value for every point", field.name);
        xml.push_str(&data.floats(field.name, field.components, field.values));
    }
    xml.push_str("</PointData>\n<Points>\n");
    xml.push_str(&data.floats("Points", 2, piece.points.as_flattened()));
    xml.push_str("</Points>\n<Cells>\n");
    xml.push_str(&data.integers("connectivity", &connectivity));
    xml.push_str(&data.integers("offsets", &offsets));
    xml.push_str(&data.bytes("types", &vec![kind; cells]));
    xml.push_str("</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
    let mut file = xml.into_bytes();
    file.extend(data.into_bytes());
    file.extend(b"\n</AppendedData>\n</VTKFile>\n");
    file
}

/// The text of a `.pvd` file: files beside it with their times, s, and part numbers.
pub fn pvd(files: &[(f64, usize, String)]) -> String {
    let mut out = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, part, file) in files {
        let file = crate::svg::escape(file);
        let _ = writeln!(out, "<DataSet timestep=\"{time:e}\" part=\"{part}\" file=\"{file}\"/>");
    }
    out + "</Collection>\n</VTKFile>\n"
}
