//! Where slices of a body that hang together meet the same thing in one square, that is one constraint.
//!
//! Next to a seam both slices have a part of the boundary in a square, and both parts move with the same
//! control points. Two constraints on these would ask for nearly the same thing, and the impulses would not
//! converge.

use std::collections::BTreeSet;

use super::encounter::Encounter;
use super::view::BodyView;

/// The encounters with those added up that hang together; the pair with the most segments stands for all.
pub(super) fn pooled(encounters: Vec<Encounter>, bodies: &[BodyView]) -> Vec<Encounter> {
    let mut pooled: Vec<(f64, Encounter)> = Vec::with_capacity(encounters.len());
    for encounter in encounters {
        let place = encounter.position();
        let together = |[a, b]: [usize; 2], [c, d]: [usize; 2]| {
            hang_together(bodies, [a, c], place) && hang_together(bodies, [b, d], place)
        };
        let sign = |other: &Encounter| {
            let [a, b] = encounter.bodies;
            let same_way = together(other.bodies, [a, b]).then_some(1.0);
            same_way.or_else(|| together(other.bodies, [b, a]).then_some(-1.0))
        };
        let same_square = pooled.iter_mut().filter(|(_, other)| other.square == encounter.square);
        let found = same_square.filter_map(|entry| Some((sign(&entry.1)?, entry))).next();
        let Some((sign, (most, sum))) = found else {
            pooled.push((encounter.count, encounter));
            continue;
        };
        if encounter.count > *most {
            *most = encounter.count;
            let [a, b] = encounter.bodies;
            sum.bodies = if sign > 0.0 { [a, b] } else { [b, a] };
        }
        sum.count += encounter.count;
        sum.gap += encounter.gap;
        for d in 0..2 {
            sum.position[d] += encounter.position[d];
            sum.normal[d] += sign * encounter.normal[d];
        }
    }
    pooled.into_iter().map(|(_, encounter)| encounter).collect()
}

/// Whether two bodies are one, or slices that share a control point near a place (m).
fn hang_together(bodies: &[BodyView], [a, b]: [usize; 2], place: [f64; 2]) -> bool {
    let near = |at: usize| bodies.get(at).filter(|body| body.copies.is_some()).map(|body| originals(at, body, place));
    a == b || matches!((near(a), near(b)), (Some(a), Some(b)) if !a.is_disjoint(&b))
}

/// Control points whose support a place (m) is in, as those they are copies of.
fn originals(number: usize, body: &BodyView, place: [f64; 2]) -> BTreeSet<(usize, usize)> {
    let first = |d: usize| body.patch.spaces[d].first_function(place[d]);
    let (Some(column), Some(row)) = (first(0), first(1)) else { return BTreeSet::new() };
    let [columns, rows] = [0, 1].map(|d| body.patch.spaces[d].degree() + 1);
    let all = (0..rows).flat_map(|l| (0..columns).map(move |k| (column + k, row + l)));
    all.map(|(k, l)| body.grid.index(k, l)).map(|at| body.original(at).unwrap_or((number, at))).collect()
}
