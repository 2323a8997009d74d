//! The control points of a condition on a side, or on a part of one.

use std::collections::BTreeMap;

use crate::dynamics::surface::mouths;
use crate::particles::lattice::Lattice;
use crate::scene::{Body, Boundary, Layout};
use crate::splines::patch::{Patch, control_points_on};
use crate::splines::quadrature::Rule;

/// Part of the integral of a function along a side that has to lie on the part that is held, up to round-off.
const HELD: f64 = 0.5 - 1e-9;

/// Values of functions that vanish on the side, to round-off.
const ROUND_OFF: f64 = 1e-12;

/// Control points of the side; of a part of it, or where a slit ends on it, those whose functions have at
/// least half of their integral along the side on the part.
pub(super) fn held_points(patch: &Patch, lattice: &Lattice, body: &Body, boundary: &Boundary) -> Vec<usize> {
    if boundary.part.is_none() && lattice.sheets().is_none() {
        return control_points_on(boundary.side, lattice.grid);
    }
    let along = boundary.side.along();
    let part = boundary.part.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let rule = Rule::new(Layout::Gauss, patch.spaces[along].degree() + 1);
    let mut integrals = BTreeMap::<usize, [f64; 2]>::new(); // on the part, and in all
    let mut cuts: Vec<f64> = mouths(body).into_iter().map(|mouth| mouth[along]).chain(part).collect();
    cuts.sort_by(f64::total_cmp);
    for point in patch.boundary_cut(boundary.side, &rule, &cuts) {
        let on_it = (part[0]..=part[1]).contains(&point.functions.position[along]);
        let inside = fault!("part-of-a-side-is-all-of-it", on_it => true);
        for &(at, value) in point.functions.values.iter().filter(|(_, value)| *value > ROUND_OFF) {
            let at = lattice.control_point(at, point.functions.values[0].0, point.functions.position);
            let [on_part, all] = integrals.entry(at).or_default();
            *all += value * point.length;
            if inside {
                *on_part += value * point.length;
            }
        }
    }
    integrals.into_iter().filter(|(_, [on_part, all])| *on_part >= HELD * all).map(|(at, _)| at).collect()
}
