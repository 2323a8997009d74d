//! Lengths of the spans of a mesh, m: differences of knots over a rectangle; on a patch with a geometry,
//! whose knots are parameters, the chords between neighbouring knots through the middles of the spans.

use crate::linear_algebra::extremes::{larger, smaller};
use crate::scene::{Mesh, Shape, Side};
use crate::splines::nurbs::NurbsPatch;

/// Largest span in either direction, m.
pub fn largest_spans(mesh: &Mesh) -> [f64; 2] {
    if let Some(Ok(patch)) = mesh.nurbs() {
        return chords(&patch).fold([0.0; 2], |[x, y], [a, b]| [larger(a, x), larger(b, y)]);
    }
    [0, 1].map(|d| mesh.knots[d].windows(2).map(|k| k[1] - k[0]).fold(0.0, larger))
}

/// Smallest span in either direction, m.
pub fn smallest_span(mesh: &Mesh) -> f64 {
    let [smallest, _] = match mesh.nurbs() {
        Some(Ok(patch)) => lengths_of_chords(&patch),
        _ => lengths_of_spans(mesh, &Shape::Patch),
    };
    smallest
}

/// Smallest and largest length (m) of the chords between neighbouring knots through the middles of all spans.
pub(crate) fn lengths_of_chords(patch: &NurbsPatch) -> [f64; 2] {
    extremes(chords(patch).flatten())
}

/// Smallest and largest length (m) of the spans of a rectangle under the box around a shape.
pub(crate) fn lengths_of_spans(mesh: &Mesh, shape: &Shape) -> [f64; 2] {
    extremes(lengths_along(mesh, shape).into_iter().flatten())
}

/// Largest length (m) of the spans of a rectangle under the box around a shape. A span at a side of the mesh,
/// which may be a long end, counts as half as long where there are others inside.
pub(crate) fn longest_span(mesh: &Mesh, shape: &Shape) -> f64 {
    let longest = |mut lengths: Vec<f64>, sides: [Side; 2]| {
        let [first, last] = sides.map(|side| mesh.is_reached(side, shape));
        if lengths.len() > usize::from(first) + usize::from(last) {
            lengths.first_mut().filter(|_| first).into_iter().for_each(|length| *length *= 0.5);
            lengths.last_mut().filter(|_| last).into_iter().for_each(|length| *length *= 0.5);
        }
        extremes(lengths.into_iter())[1]
    };
    let [x, y] = lengths_along(mesh, shape);
    larger(longest(x, [Side::Left, Side::Right]), longest(y, [Side::Bottom, Side::Top]))
}

/// Length (m) of the spans of the finest cell of a rectangle under the box around a shape: the longer one.
pub(crate) fn finest_cell(mesh: &Mesh, shape: &Shape) -> f64 {
    let [x, y] = lengths_along(mesh, shape).map(|lengths| extremes(lengths.into_iter())[0]);
    larger(x, y)
}

/// Lengths (m) of the spans of a rectangle under the box around a shape, in both directions.
fn lengths_along(mesh: &Mesh, shape: &Shape) -> [Vec<f64>; 2] {
    let (from, to) = mesh.extent(shape);
    [0, 1].map(|d| {
        let tolerance = 1e-9 * (to[d] - from[d]);
        let overlaps = |k: &&[f64]| k[1] > k[0] && k[1] > from[d] + tolerance && k[0] < to[d] - tolerance;
        mesh.knots[d].windows(2).filter(overlaps).map(|k| k[1] - k[0]).collect()
    })
}

fn extremes(lengths: impl Iterator<Item = f64>) -> [f64; 2] {
    lengths.fold([f64::INFINITY, 0.0], |[least, most], length| [smaller(least, length), larger(most, length)])
}

/// Both chords of every span.
fn chords(patch: &NurbsPatch) -> impl Iterator<Item = [f64; 2]> {
    let [x, y] = patch.spaces().each_ref().map(|space| space.spans().iter().enumerate());
    let spans = y.flat_map(move |(j, t)| x.clone().map(move |(i, s)| ([i, j], [[s.left, s.right], [t.left, t.right]])));
    spans.map(move |(span, ends)| {
        [0, 1].map(|d| {
            let middle = ends.map(|[left, right]| 0.5 * (left + right));
            let at = |end: f64| {
                let mut parameters = middle;
                parameters[d] = end;
                patch.map(&patch.shape_functions(span, parameters)).position
            };
            let [a, b] = ends[d].map(at);
            (b[0] - a[0]).hypot(b[1] - a[1])
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of 4 by 4 spans between the radii 1 and 2 m: chords of a sixteenth of a turn at the largest
    /// middle radius.
    #[test]
    fn long_ends_count_as_the_two_spans_that_they_join() {
        let mut mesh = Mesh::uniform([2; 2], [0.0; 2], [1.0, 0.5], [10, 5]);
        assert!([Side::Left, Side::Right, Side::Top].into_iter().all(|side| mesh.lengthen_end(side)));
        let longest = |max: [f64; 2]| longest_span(&mesh, &Shape::Rectangle { min: [0.0; 2], max });
        approx::assert_relative_eq!(longest([1.0, 0.5]), 0.1, max_relative = 1e-13);
        approx::assert_relative_eq!(longest([0.15, 0.2]), 0.2, max_relative = 1e-13);
        mesh.knots[0] = vec![0.0, 0.0, 0.0, 0.1, 0.2, 1.0, 1.0, 1.0];
        assert_eq!(longest_span(&mesh, &Shape::Patch), 0.4, "a coarse end is no long end");
    }

    #[test]
    fn spans_of_a_patch_are_measured_in_metres() {
        let ring = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap().elevate(0).unwrap().subdivide(4).unwrap();
        let [along_radius, along_arc] = largest_spans(&Mesh::of(&ring));
        approx::assert_relative_eq!(along_radius, 0.25, max_relative = 1e-13);
        let sixteenth = std::f64::consts::FRAC_PI_8;
        // The pieces of a rational arc are not equal: the middle ones are longer.
        let chord = 2.0 * 1.875 * (0.5 * sixteenth).sin();
        assert!(along_arc > chord && along_arc < 1.1 * chord, "{along_arc} against {chord}");
        assert_eq!(largest_spans(&Mesh::uniform([2; 2], [0.0; 2], [1.0, 0.5], [4, 4])), [0.25, 0.125]);
    }
}
