//! Numbers and outlines that a scene keeps in a file beside it.

use std::ffi::OsStr;
use std::path::Path;

use fisura::scene::Shape;
use geojson::{FeatureCollection, GeoJson, Geometry, GeometryValue};

use super::fields::Item;

const OUTLINE: &str = "give a CSV file beside the scene with the corners of a polygon in order, or a GeoJSON file with \
                       polygons; x and y in m";

/// Rows of two numbers of a CSV file; a first line of words is a header.
pub(super) fn rows_of_file(item: &Item<'_>, remedy: &str) -> Option<Vec<[f64; 2]>> {
    read(item, remedy, |_, text| rows(text))
}

/// The polygon of a CSV file, or the polygons of a GeoJSON file.
pub(super) fn outline(item: &Item<'_>) -> Option<Shape> {
    read(item, OUTLINE, |path, text| {
        let is_json = |suffix: &OsStr| ["geojson", "json"].iter().any(|word| suffix.eq_ignore_ascii_case(word));
        if path.extension().is_some_and(is_json) {
            polygons(text)
        } else {
            rows(text).map(|points| Shape::Polygon { points })
        }
    })
}

/// What a file beside the scene contains.
fn read<T>(item: &Item<'_>, remedy: &str, parse: impl FnOnce(&Path, &str) -> Result<T, String>) -> Option<T> {
    let path = item.folder().join(item.words()?);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) => return item.fail(format!("{} cannot be read: {e}", path.display()), remedy),
    };
    match parse(&path, &text) {
        Ok(value) => Some(value),
        Err(message) => item.fail(format!("{}: {message}", path.display()), remedy),
    }
}

/// All polygons of a GeoJSON document, with their holes.
fn polygons(text: &str) -> Result<Shape, String> {
    let mut shapes = Vec::new();
    match text.parse::<GeoJson>().map_err(|e| e.to_string())? {
        GeoJson::Geometry(geometry) => add_polygons(&geometry, &mut shapes)?,
        GeoJson::Feature(feature) => feature.geometry.iter().try_for_each(|g| add_polygons(g, &mut shapes))?,
        GeoJson::FeatureCollection(FeatureCollection { features, .. }) => {
            let mut geometries = features.iter().flat_map(|feature| &feature.geometry);
            geometries.try_for_each(|geometry| add_polygons(geometry, &mut shapes))?;
        }
    }
    match shapes.len() {
        0 => Err("no polygon".to_string()),
        1 => Ok(shapes.remove(0)),
        _ => Ok(Shape::Union(shapes)),
    }
}

fn add_polygons(geometry: &Geometry, shapes: &mut Vec<Shape>) -> Result<(), String> {
    let polygons = match &geometry.value {
        GeometryValue::Polygon { coordinates } => std::slice::from_ref(coordinates),
        GeometryValue::MultiPolygon { coordinates } => coordinates,
        GeometryValue::GeometryCollection { geometries } => {
            return geometries.iter().try_for_each(|geometry| add_polygons(geometry, shapes));
        }
        other => return Err(format!("a {}, where a Polygon or a MultiPolygon is needed", other.type_name())),
    };
    for rings in polygons {
        let mut rings = rings.iter().map(|ring| ring_of(ring));
        let outer = rings.next().ok_or("a Polygon without a ring")??;
        let minus = rings.collect::<Result<Vec<_>, _>>()?;
        shapes.push(if minus.is_empty() { outer } else { Shape::Difference { of: Box::new(outer), minus } });
    }
    Ok(())
}

fn rows(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut rows = Vec::new();
    for (number, record) in reader.records().enumerate() {
        let record = record.map_err(|e| e.to_string())?;
        let numbers: Vec<Option<f64>> =
            record.iter().map(|field| field.parse().ok().filter(|x: &f64| x.is_finite())).collect();
        match numbers[..] {
            [Some(first), Some(second)] => rows.push([first, second]),
            _ if number == 0 && numbers.iter().all(Option::is_none) && is_header(&record) => {}
            _ => {
                let line = record.position().map_or(0, csv::Position::line);
                return Err(format!(
                    "line {line} is not two numbers: {:?}",
                    record.iter().collect::<Vec<_>>().join(",")
                ));
            }
        }
    }
    Ok(rows)
}

/// A ring, whose last position repeats the first.
fn ring_of(ring: &[geojson::Position]) -> Result<Shape, String> {
    let corner = |position: &geojson::Position| match position.as_slice() {
        [x, y, ..] => Ok([*x, *y]),
        _ => Err("a position of fewer than two numbers".to_string()),
    };
    let mut points = ring.iter().map(corner).collect::<Result<Vec<_>, _>>()?;
    if points.len() < 2 || points.first() != points.last() {
        return Err("a ring that is not closed: its last position has to repeat the first".to_string());
    }
    points.pop();
    Ok(Shape::Polygon { points })
}

/// Whether all fields are words: they begin with a letter, have no decimal point and are not "nan" or "inf".
fn is_header(record: &csv::StringRecord) -> bool {
    let is_word = |field: &str| field.starts_with(char::is_alphabetic) && !field.contains('.');
    record.iter().all(|field| is_word(field) && field.parse::<f64>().is_err())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_of_geojson_keep_their_holes() {
        let square = |x: f64, size: f64| {
            let corner = |dx: f64, dy: f64| format!("[{}, {}]", x + dx * size, dy * size);
            format!("[{}]", [[0., 0.], [1., 0.], [1., 1.], [0., 1.], [0., 0.]].map(|[x, y]| corner(x, y)).join(", "))
        };
        let polygon = |rings: &str| format!(r#"{{"type": "Polygon", "coordinates": [{rings}]}}"#);
        let feature = |geometry: &str| format!(r#"{{"type": "Feature", "properties": null, "geometry": {geometry}}}"#);
        let simple = polygons(&polygon(&square(0.0, 1.0))).unwrap();
        assert_eq!(simple, Shape::Polygon { points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] });
        let holed = polygon(&[square(0.0, 1.0), square(0.1, 0.5)].join(", "));
        let Shape::Difference { of, minus } = polygons(&feature(&holed)).unwrap() else { panic!("a hole is cut out") };
        assert!(*of == simple && minus.len() == 1);
        let two = [feature(&holed), feature(&polygon(&square(2.0, 1.0)))].join(", ");
        let collection = format!(r#"{{"type": "FeatureCollection", "features": [{two}]}}"#);
        assert!(matches!(polygons(&collection).unwrap(), Shape::Union(shapes) if shapes.len() == 2));
        for (text, message) in [
            (r#"{"type": "Point", "coordinates": [0, 0]}"#, "a Point, where"),
            (r#"{"type": "FeatureCollection", "features": []}"#, "no polygon"),
            (r#"{"type": "Polygon", "coordinates": []}"#, "without a ring"),
            (r#"{"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1]]]}"#, "not closed"),
            (r#"{"type": "Polygon", "coordinates": [[[0, 0], [1], [1, 1], [0, 0]]]}"#, "fewer than two numbers"),
            ("0, 1", ""),
        ] {
            assert!(polygons(text).unwrap_err().contains(message), "{text}");
        }
    }

    #[test]
    fn a_header_is_a_first_line_without_a_number() {
        let expected = Ok(vec![[0.0, 1.0], [1e-6, 2.5]]);
        assert_eq!(rows("0, 1\n1e-6, 2.5\n"), expected);
        assert_eq!(rows("time_s,factor\n\n0,1\n1e-6,2.5"), expected);
        assert_eq!(rows("time_s\n0,1\n1e-6,2.5"), expected, "a header of one column");
        for (text, line) in [
            ("0.2m,1\n", 1),
            ("O.2,O.1\n0,1\n", 1),
            ("0,nan\n", 1),
            ("nan,inf\n0,1\n", 1),
            ("0;1\n0;2\n", 1),
            ("0,1,2\n", 1),
            ("0,x\n", 1),
            ("t,f\n\n0,1\n1\n", 4),
            ("t,f\n0,1\n1,\n", 3),
        ] {
            assert!(rows(text).unwrap_err().starts_with(&format!("line {line} ")), "{text:?}: {:?}", rows(text));
        }
    }
}
