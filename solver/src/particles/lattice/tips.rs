//! Where slits end on the mesh.
//!
//! A slit parts the functions whose points it parts, so that it acts as if it were shorter than it is drawn:
//! by rounding to whole functions, half a span in the mean, and by `(p + 1)/3 − 1/2` spans more, judged by
//! the static energy of plates under tension (0.23, 0.52, 0.83 and 1.2 spans for p = 1 to 4). Its free ends
//! are moved on by both, so that it acts where it is drawn to half a span. The force and the energy that a
//! body takes up are wrong by as much as its slit is short, which is an error of order 1 in h.

use crate::scene::shape::{Segment, cross, distance_to_segment};
use crate::scene::{Body, Crack};
use crate::splines::patch::Patch;
use crate::splines::quadrature::Rule;

/// Part of a span by which ends are moved on less: one on a knot keeps its functions for p = 1 and 2.
const ON_A_KNOT: f64 = 0.03;
/// Distance from the end of a slit to what it ends on, of the way that its end is moved on.
const NEAR: f64 = 1e-3;
/// Part of that way that has to be free of other slits and of the boundary: slits may come from two sides.
const CLEAR: f64 = 2.0;
/// Distance from an end at which the span ahead of it is measured, of the length of the segment.
const AHEAD: f64 = 1e-6;

/// The straight parts of the slits of a body (m), with their free ends moved on.
pub(super) fn lengthened(patch: &Patch, body: &Body) -> Vec<Segment> {
    let drawn: Vec<Segment> = body.slits().flat_map(Crack::segments).collect();
    let end = |number: usize, [from, to]: Segment| {
        let others = drawn.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, other)| other);
        let beyond = moved_on(patch, body, [from, to]);
        let beyond = beyond.filter(|beyond| is_free(patch, body, [to, *beyond], others));
        fault!("slits-end-where-drawn", beyond => None).unwrap_or(to)
    };
    let both = |(number, &[from, to]): (usize, &Segment)| [end(number, [to, from]), end(number, [from, to])];
    drawn.iter().enumerate().map(both).collect()
}

/// Whether there is nothing but material on the way of an end, and as far again.
fn is_free<'a>(
    patch: &Patch,
    body: &Body,
    [end, beyond]: Segment,
    mut others: impl Iterator<Item = &'a Segment>,
) -> bool {
    let way = [0, 1].map(|d| beyond[d] - end[d]);
    let at = |part: f64| [0, 1].map(|d| end[d] + part * way[d]);
    let (ahead, near) = ([at(NEAR), at(CLEAR)], NEAR * way[0].hypot(way[1]));
    let holds = |at: &[f64; 2]| body.shape.contains(*at) && patch.locate(*at).is_some();
    let touches = |other: &Segment| other.iter().any(|at| distance_to_segment(*at, end, ahead[1]) <= near);
    let meets = |other: &Segment| cross([at(-NEAR), ahead[1]], *other) || touches(other);
    ahead.iter().all(holds) && !body.shape.is_left_on(ahead) && !others.any(meets)
}

/// Where the end `to` of a segment is moved on to; `None` outside the patch.
fn moved_on(patch: &Patch, body: &Body, [from, to]: Segment) -> Option<[f64; 2]> {
    let along = [0, 1].map(|d| to[d] - from[d]);
    let length = along[0].hypot(along[1]);
    let ahead = [0, 1].map(|d| to[d] + AHEAD * along[d]);
    let [x, y] = [[1.0, 0.0], [0.0, 1.0]].map(|axis| patch.span_across(ahead, axis));
    let per_span = [along[0] / (length * x?), along[1] / (length * y?)]; // spans per m
    let d = usize::from(per_span[1].abs() > per_span[0].abs());
    let last = *Rule::new(body.layout, body.particles_per_cell[d]).points.last()?; // parted from here on
    let spans = (patch.spaces[d].degree() + 1) as f64 / 3.0 - (1.0 - last) - ON_A_KNOT;
    let distance = spans / per_span[0].hypot(per_span[1]);
    Some([0, 1].map(|d| to[d] + distance / length * along[d]))
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::scene::{CrackKind, Layout, Mesh, Shape};

    #[test]
    fn free_ends_are_moved_on_and_others_stay() {
        let patch = Patch::new(&Mesh::uniform([2; 2], [0.0; 2], [1.0; 2], [10; 2]));
        let hole = Shape::Disk { center: [0.8, 0.5], radius: 0.1 };
        let square = Shape::Rectangle { min: [0.0; 2], max: [1.0; 2] };
        let shape = Shape::Difference { of: Box::new(square), minus: vec![hole] };
        let slit = |points: &[[f64; 2]]| Crack { points: points.to_vec(), kind: CrackKind::Slit };
        let ends = |slits: Vec<Crack>| {
            let body = Body { cracks: slits, ..Body::at_rest("plate", "glass", shape.clone()) };
            lengthened(&patch, &body)
        };
        let way = 0.1 * (Rule::new(Layout::Gauss, 2).points[1] - ON_A_KNOT);
        // a free end along the mesh, and one at an angle behind a corner
        assert_relative_eq!(ends(vec![slit(&[[0.0, 0.5], [0.35, 0.5]])])[0][1][0], 0.35 + way);
        let [_, [x, y]] = ends(vec![slit(&[[0.0, 0.2], [0.1, 0.2], [0.4, 0.6]])])[1];
        assert_relative_eq!((x - 0.4).hypot(y - 0.6), way, epsilon = 1e-12);
        let fixed = [
            slit(&[[0.0, 0.5], [0.7, 0.5]]),             // from the edge to the hole
            slit(&[[0.0, 0.1], [0.95, 0.1]]),            // near the edge
            slit(&[[0.0, 0.8], [0.3, 0.8], [0.3, 1.0]]), // with a corner
            slit(&[[0.0, 0.3], [0.68, 0.45]]),           // near the hole
        ];
        for drawn in fixed {
            let segments: Vec<Segment> = drawn.segments().collect();
            assert_eq!(ends(vec![drawn]), segments);
        }
        let near_the_end_of_the_mesh = slit(&[[0.0, 0.1], [0.91, 0.1]]);
        let all = Body { cracks: vec![near_the_end_of_the_mesh], ..Body::at_rest("plate", "glass", Shape::Patch) };
        assert_eq!(lengthened(&patch, &all), [[[0.0, 0.1], [0.91, 0.1]]]);
        let opposite = [slit(&[[0.0, 0.2], [0.45, 0.2]]), slit(&[[0.5, 0.2], [1.0, 0.2]])];
        assert_eq!(ends(opposite.to_vec()), [[[0.0, 0.2], [0.45, 0.2]], [[0.5, 0.2], [1.0, 0.2]]]);
    }
}
