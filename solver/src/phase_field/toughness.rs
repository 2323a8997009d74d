//! Gc at the points, where it is random or is over the cost of a crack on the mesh
//! ([`mesh_toughness`](crate::material::mesh_toughness)).

use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::lane::Lane;
use crate::material::mesh_toughness::slope_in;
use crate::material::random_field::RandomField;
use crate::particles::lattice::Lattice;
use crate::scene::{Body, CrackModel, Fracture};
use crate::splines::patch::Patch;
use crate::splines::spline::ROUND_OFF;

/// Length of a span over the shortest one of its body, from which on it is no span of the crack with AT2.
const LONG: f64 = 1.5;

/// Gc over its mean at the points, 1 where there is none; nothing if it is the same everywhere. kappa has the
/// shorter side of the span. Where a side is longer than 2 l0 the span resolves no crack, and keeps Gc and
/// with it the strength; with AT2 only if the body has much shorter spans in that direction.
pub(super) fn relative_toughness(
    patch: &Patch,
    lattice: &Lattice,
    body: &Body,
    fracture: &Fracture,
) -> Option<Vec<Lane>> {
    let field = fracture.random.map(RandomField::new);
    if field.is_none() && !fracture.mesh_toughness {
        return None;
    }
    let slope = slope_in(fracture, lattice.degree, body).filter(|_| fracture.mesh_toughness);
    let l0 = fracture.length_scale;
    let sides = |place| [[1.0, 0.0], [0.0, 1.0]].map(|along| patch.span_across(place, along).unwrap_or(0.0));
    let mut shortest = if fracture.model == CrackModel::At1 { [0.0; 2] } else { [f64::INFINITY; 2] };
    lattice.for_each_point(|_, _, place, _| {
        let sides = sides(place);
        shortest = [0, 1].map(|d| smaller(shortest[d], sides[d]));
    });
    let longest = shortest.map(|shortest| larger(2.0 * l0, LONG * shortest) * (1.0 + ROUND_OFF));
    let mut relative = vec![Lane::splat(1.0); lattice.batches()];
    lattice.for_each_point(|batch, lane, place, _| {
        let random = field.as_ref().map_or(1.0, |field| field.at(place));
        let sides = sides(place);
        let resolves = sides[0] <= longest[0] && sides[1] <= longest[1];
        let cost = slope.filter(|_| resolves).map(|a| 1.0 + a * smaller(sides[0], sides[1]) / l0);
        relative[batch][lane] = random / fault!("toughness-of-the-mesh-forgotten", cost => None).unwrap_or(1.0);
    });
    Some(relative)
}
