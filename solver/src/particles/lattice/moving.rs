//! Points of a body of the updated frame as they begin to move.

use std::collections::BTreeMap;

use super::cut::{EdgesInSpans, PointBox, Rules, cut_spans, edges_in_spans};
use super::{directions, fills_lattice};
use crate::scene::Body;
use crate::splines::patch::Patch;

/// The points of `body`, with their boxes. In a span that its boundary cuts there are fewer than the degree
/// needs, since they do not stay there.
pub(crate) fn moving_points(patch: &Patch, body: &Body) -> Vec<PointBox> {
    let (shape, spaces) = (&body.shape, &patch.spaces);
    let fills = fills_lattice(false, shape);
    let edges = if fills { EdgesInSpans::new() } else { edges_in_spans(shape.edges(), spaces) };
    let rules = Rules::Boxes(body.particles_per_cell);
    let cut: BTreeMap<_, _> = cut_spans(shape, [&edges, &EdgesInSpans::new()], spaces, rules).collect();
    let [columns, rows] = directions(body, spaces, false).map(|along| {
        let points_of = |(span, ends)| (span, along.points(ends).collect::<Vec<_>>());
        along.spans().map(points_of).collect::<Vec<_>>()
    });
    let mut points = Vec::new();
    for ((j, rows), (i, columns)) in rows.iter().flat_map(|row| columns.iter().map(move |column| (row, column))) {
        if let Some(cut) = cut.get(&[*i, *j]) {
            points.extend(cut);
        } else {
            let all = rows.iter().flat_map(|(y, v)| columns.iter().map(move |(x, w)| ([*x, *y], [*w, *v])));
            points.extend(all.filter(|(position, _)| fills || shape.contains(*position)));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Layout, Mesh, Shape};

    #[test]
    fn boxes_stay_in_their_spans_do_not_overlap_and_have_the_area_of_the_body() {
        let patch = Patch::new(&Mesh::uniform([2; 2], [0.0; 2], [1.0; 2], [10; 2]));
        let disc = Shape::Disk { center: [0.51, 0.47], radius: 0.33 };
        let bar = Shape::Polygon { points: vec![[0.13, 0.21], [0.85, 0.47], [0.81, 0.64], [0.07, 0.38]] };
        for (shape, area, tolerance) in [
            (Shape::Rectangle { min: [0.13, 0.21], max: [0.68, 0.74] }, 0.55 * 0.53, 1e-14),
            (bar, 0.1371, 1e-12),
            (disc, std::f64::consts::PI * 0.33 * 0.33, 2e-3),
        ] {
            let body =
                Body { particles_per_cell: [2, 3], layout: Layout::Uniform, ..Body::at_rest("body", "soft", shape) };
            let boxes = moving_points(&patch, &body);
            let sum: f64 = boxes.iter().map(|(_, [width, height])| width * height).sum();
            assert!((sum / area - 1.0).abs() < tolerance, "{:?}: {sum} for {area}", body.shape);
            let ends = |(x, size): &PointBox, d: usize| [x[d] - 0.5 * size[d], x[d] + 0.5 * size[d]];
            for (n, one) in boxes.iter().enumerate() {
                for d in 0..2 {
                    let [left, right] = ends(one, d);
                    let span = (one.0[d] * 10.0).floor();
                    assert!(left > 0.1 * span - 1e-12 && right < 0.1 * (span + 1.0) + 1e-12, "{one:?}");
                }
                let apart = |other: &PointBox| {
                    (0..2).any(|d| {
                        let ([a, b], [left, right]) = (ends(one, d), ends(other, d));
                        b < left + 1e-12 || right < a + 1e-12
                    })
                };
                assert!(boxes[..n].iter().all(apart), "{one:?} overlaps another one");
            }
        }
    }
}
