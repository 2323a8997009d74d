//! Lagrange multipliers along edges of a body, and the moments of its motion that they prescribe.
//!
//! A multiplier is a spline μ along the edge, of the degree of the body's splines less one, over parts at
//! least [`PART`] spans long, or as below. The moments of the motion with each of them are those of the
//! prescribed one, at every step and to round-off:
//!
//! ```text
//! ∫ μ_r (v·e − w·e) dΓ = 0,   e = x, y or the normal of the edge as it was at t = 0
//! M a = f_ext − f_int − Bᵀ λ,   B_rI = ∫ μ_r N_I e dΓ
//! (B M⁻¹ Bᵀ) λ = B M⁻¹ (f_ext − f_int) − B a_prescribed
//! ```
//!
//! Along a whole side of a body that lies along the mesh, within a part of a span, μ are all functions that
//! the body has there. Between multipliers that are fewer the side buckles under a pressure, since a
//! multiplier acts in the same direction however the edge turns. Along an oblique edge as many would hold all
//! of the spans that it cuts, and along a part of a side more than that part.
//!
//! The multipliers remove directions from the operator and add no stiffness, so the critical step is never
//! shorter than that of the free body. They do work on what moves only: there is no energy of a penalty.

use std::collections::BTreeMap;

use faer::sparse::{SparseColMat, Triplet};

use crate::dynamics::surface::{SurfacePoint, curve_of, edge_ends};
use crate::linear_algebra::cholesky::LowerFactor;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::extremes::{larger, smaller};
use crate::scene::edges::{BESIDE, steps_along};
use crate::scene::shape::distance_to_segment;
use crate::scene::{Body, EdgeCondition, Hold};
use crate::splines::patch::Patch;
use crate::splines::spline::SplineSpace;

/// Least length of a part of an edge over which multipliers are polynomials, in spans.
const PART: f64 = 2.0;
/// Deviation of an edge from a line along the mesh that counts as none, in spans.
const STRAIGHT: f64 = 0.1;
/// Least length of such an edge between its first and last points, in spans: along a shorter one the
/// functions are nearly the same.
const LEAST: f64 = 0.5;
/// Integral of a function along such an edge from which on it has a multiplier, in spans. A function that
/// only begins to reach the edge nearly follows from the others; with 1e-6 the ledger is open by 1e-11.
const BARE: f64 = 1e-4;
/// Parts by which an edge may be too short for their number.
const ROUND_OFF: f64 = 1e-9;
/// Distance of two places that counts as none, in sizes of what they lie on.
const NEAR: f64 = 1e-9;
/// Yield of a multiplier at control points that can move, of that at all of them, that counts as none.
const YIELDS: f64 = 1e-9;

/// A prescribed direction from the normal of an edge.
type Direction = fn([f64; 2]) -> [f64; 2];

/// A moment of the motion of an edge, and its multiplier.
#[derive(Debug, Clone)]
pub(super) struct Moment {
    /// Number of its condition.
    pub(super) condition: usize,
    /// Control point and component, and its share, m.
    pub(super) shares: Vec<(usize, usize, f64)>,
    /// Shares of the components in all: those of a translation, m.
    pub(super) total: [f64; 2],
}

/// Moments, and the multipliers that prescribe them on a body with a lumped mass.
#[derive(Debug, Clone)]
pub(super) struct Multipliers {
    pub(super) moments: Vec<Moment>,
    /// Inverse mass of the shares of every moment, m/kg; zero where a side of the mesh prescribes.
    pub(super) inverse: Vec<Vec<f64>>,
    factor: LowerFactor,
}

impl Multipliers {
    /// A part of the compliance of every multiplier, its `softness`, is added to it. `None` if the moments
    /// are not independent.
    pub(super) fn new(moments: Vec<Moment>, inverse: Vec<Vec<f64>>, softness: f64) -> Option<Self> {
        let factor = compliance(&moments, &inverse, softness).and_then(|lower| LowerFactor::new(&lower, None))?;
        Some(Self { moments, inverse, factor })
    }

    /// λ of an excess of every moment.
    pub(super) fn of_excess(&self, excess: impl Fn(&Moment) -> f64) -> Vec<f64> {
        let mut multipliers: Vec<f64> = self.moments.iter().map(excess).collect();
        self.factor.solve(&mut multipliers);
        multipliers
    }

    /// `field ← field − M⁻¹ Bᵀ λ`.
    pub(super) fn yield_to(&self, multipliers: &[f64], field: &mut VectorField) {
        for ((moment, inverse), multiplier) in self.moments.iter().zip(&self.inverse).zip(multipliers) {
            for (&(at, component, share), inverse) in moment.shares.iter().zip(inverse) {
                field[component][at] -= multiplier * share * inverse;
            }
        }
    }

    /// Takes from accelerations or displacements what the conditions do not allow.
    pub(super) fn project(&self, field: &mut VectorField) {
        let multipliers = self.of_excess(|moment| moment.of(field));
        self.yield_to(&multipliers, field);
    }

    /// Takes the part that the multipliers carry from forces, N/m.
    pub(super) fn project_forces(&self, forces: &mut VectorField) {
        let yielded = |(moment, inverse): (&Moment, &Vec<f64>)| {
            let shares = moment.shares.iter().zip(inverse);
            shares.map(|(&(at, component, share), inverse)| share * inverse * forces[component][at]).sum()
        };
        let mut multipliers: Vec<f64> = self.moments.iter().zip(&self.inverse).map(yielded).collect();
        self.factor.solve(&mut multipliers);
        for (moment, multiplier) in self.moments.iter().zip(multipliers) {
            for &(at, component, share) in &moment.shares {
                forces[component][at] -= multiplier * share;
            }
        }
    }

    /// A moment that nearly follows from the others: what is left of its own compliance beside them,
    /// `1/(S⁻¹)_rr` of `S_rr` for `S = B M⁻¹ Bᵀ`, is less than `least`.
    pub(super) fn dependent(&self, least: f64) -> Option<&Moment> {
        (0..self.moments.len())
            .map(|row| {
                let mut unit = vec![0.0; self.moments.len()];
                unit[row] = 1.0;
                self.factor.solve(&mut unit);
                let shares = self.moments[row].shares.iter().zip(&self.inverse[row]);
                let own: f64 = shares.map(|((.., share), m)| share * share * m).sum();
                (1.0 / (unit[row] * own), &self.moments[row])
            })
            .find_map(|(part, moment)| (part < least).then_some(moment))
    }
}

impl Moment {
    /// Its value for a field.
    pub(super) fn of(&self, field: &VectorField) -> f64 {
        self.shares.iter().map(|&(at, component, share)| share * field[component][at]).sum()
    }

    /// Whether its multiplier can move something: `inverse` (m/kg) is that of its shares, zero where
    /// something else prescribes, `of` the inverse mass of any control point.
    pub(super) fn yields(&self, inverse: &[f64], of: impl Fn(usize) -> f64) -> bool {
        let yielding: f64 = self.shares.iter().zip(inverse).map(|((.., share), m)| share * share * m).sum();
        let all: f64 = self.shares.iter().map(|&(at, _, share)| share * share * of(at)).sum();
        yielding > YIELDS * all
    }

    /// Its value for a translation.
    pub(super) fn translated(&self, value: [f64; 2]) -> f64 {
        self.total[0] * value[0] + self.total[1] * value[1]
    }
}

/// The multipliers of an edge.
#[derive(Clone, Copy)]
pub(super) enum EdgeMultipliers<'a> {
    /// Splines of the distance along it.
    OfParts(&'a SplineSpace),
    /// The functions in a direction of the mesh of control points on a grid, where their integral along the
    /// edge is at least so long (m).
    OfMesh(usize, ControlGrid, f64),
}

impl EdgeMultipliers<'_> {
    /// Numbers and values of the multipliers at a point with the control points and values of the functions
    /// there.
    ///
    /// # Errors
    /// The position (m) of a point that is not on the edge.
    fn at(&self, point: &SurfacePoint, functions: &[(usize, f64)]) -> Result<BTreeMap<usize, f64>, [f64; 2]> {
        match *self {
            Self::OfParts(space) => {
                let span = space.find_span(point.along).ok_or(point.position)?;
                let values = space.shape_functions(span, point.along).value;
                Ok((space.spans()[span].first..).zip(values).take(space.degree() + 1).collect())
            }
            Self::OfMesh(direction, grid, _) => {
                let mut values = BTreeMap::new();
                for &(at, value) in functions {
                    let number = if direction == 0 { grid.column_of(at) } else { grid.row_of(at) };
                    *values.entry(number).or_default() += value;
                }
                Ok(values)
            }
        }
    }
}

/// The moments of a condition, from the points of its edge with the control points and values of the
/// functions there.
///
/// # Errors
/// The position (m) of a point that is not on the edge.
pub(super) fn moments_of(
    condition: usize,
    hold: Hold,
    multipliers: EdgeMultipliers<'_>,
    points: impl Iterator<Item = (SurfacePoint, Vec<(usize, f64)>)>,
) -> Result<Vec<Moment>, [f64; 2]> {
    let directions: &[Direction] = match hold {
        Hold::Components([true, true]) => &[|_| [1.0, 0.0], |_| [0.0, 1.0]],
        Hold::Components([true, false]) => &[|_| [1.0, 0.0]],
        Hold::Components([false, true]) => &[|_| [0.0, 1.0]],
        Hold::Components([false, false]) => &[],
        Hold::Normal => &[|normal| normal],
    };
    let mut sums = BTreeMap::<(usize, usize), (BTreeMap<(usize, usize), f64>, [f64; 2])>::new();
    for (point, functions) in points {
        for (number, multiplier) in multipliers.at(&point, &functions)? {
            for (set, along) in directions.iter().enumerate() {
                let direction = along(point.normal);
                let (shares, total) = sums.entry((set, number)).or_default();
                for component in (0..2).filter(|&d| direction[d] != 0.0) {
                    let weight = multiplier * point.length * direction[component];
                    total[component] += weight;
                    for &(at, value) in &functions {
                        *shares.entry((at, component)).or_default() += weight * value;
                    }
                }
            }
        }
    }
    let moment = |(shares, total): (BTreeMap<(usize, usize), f64>, [f64; 2])| {
        let shares = shares.into_iter().map(|((at, component), share)| (at, component, share)).collect();
        Moment { condition, shares, total }
    };
    let least = if let EdgeMultipliers::OfMesh(.., least) = multipliers { least } else { 0.0 };
    Ok(sums.into_values().filter(|(_, total)| total[0].hypot(total[1]) >= least).map(moment).collect())
}

/// The functions of control points on a grid along an edge through points with the control points and values
/// of the functions there; `None` if it does not lie in a direction of the mesh, is short, or if another
/// condition fixes a component of one of them.
pub(super) fn along_mesh(
    patch: &Patch,
    grid: ControlGrid,
    points: &[(SurfacePoint, Vec<(usize, f64)>)],
    is_fixed: impl Fn(usize, usize) -> bool,
) -> Option<EdgeMultipliers<'static>> {
    let first = points.first()?.0.position;
    let extent = |d: usize| {
        let (space, along) = (&patch.spaces[d], || points.iter().map(|(point, _)| point.position[d]));
        let span = space.spans()[space.find_span(first[d])?].length();
        Some((along().fold(f64::NEG_INFINITY, larger) - along().fold(f64::INFINITY, smaller), span))
    };
    let [x, y] = [extent(0)?, extent(1)?];
    let straight = fault!("edges-along-the-mesh-buckle", STRAIGHT => -1.0);
    let lies_along =
        |(along, span): (f64, f64), (across, other): (f64, f64)| across <= straight * other && along >= LEAST * span;
    let direction = if lies_along(x, y) { 0 } else { 1 };
    let fixed = || points.iter().flat_map(|(_, values)| values).any(|&(at, _)| is_fixed(at, 0) || is_fixed(at, 1));
    let is_one = patch.geometry.is_none() && (direction == 0 || lies_along(y, x)) && !fixed();
    is_one.then_some(EdgeMultipliers::OfMesh(direction, grid, BARE * [x, y][direction].1))
}

/// Whether an edge is a whole side of a body along the mesh, and no other edge of which the same component is
/// prescribed comes within the reach of its functions, but for one beside it. All functions along a part of a
/// side would hold more of it; along two edges that meet they would not be independent.
pub(super) fn is_whole_side(patch: &Patch, body: &Body, conditions: &[EdgeCondition], number: usize) -> bool {
    let own = &conditions[number];
    let Some(across) = across(body, own) else { return false };
    let [a, b] = edge_ends(body, &own.edge);
    let goes_on = |[end, other]: [[f64; 2]; 2]| {
        let beyond = BESIDE * (end[1 - across] - other[1 - across]);
        [-beyond, beyond].into_iter().any(|beside| {
            let mut place = end;
            place[1 - across] += beyond;
            place[across] += beside;
            body.shape.contains(place)
        })
    };
    if goes_on([a, b]) || goes_on([b, a]) {
        return false;
    }
    let reach = |space: &SplineSpace| {
        let longest = space.spans().iter().map(|span| span.length()).fold(0.0, larger);
        (space.degree() + 1) as f64 * longest
    };
    let reach = patch.spaces.iter().map(reach).fold(0.0, larger);
    let is_near = |other: &EdgeCondition| {
        let offset = (edge_ends(body, &other.edge)[0][across] - a[across]).abs();
        let beside = self::across(body, other) == Some(across) && offset > NEAR * reach;
        let part = [curve_of(body, &other.edge)];
        let mut places = steps_along(&part, 0.5 * patch.shortest_span()).map(|[place, _]| place);
        !beside && places.any(|place| distance_to_segment(place, a, b) < reach)
    };
    let held = |condition: &EdgeCondition| match (condition.hold, self::across(body, condition)) {
        (Hold::Normal, Some(d)) => [d == 0, d == 1],
        _ => condition.components(),
    };
    let same = |other: &EdgeCondition| (0..2).any(|d| held(own)[d] && held(other)[d]);
    !conditions.iter().enumerate().any(|(at, other)| at != number && same(other) && is_near(other))
}

/// The direction across an edge that lies along the mesh; `None` for any other edge.
fn across(body: &Body, condition: &EdgeCondition) -> Option<usize> {
    let [a, b] = edge_ends(body, &condition.edge);
    let size = (b[0] - a[0]).hypot(b[1] - a[1]);
    (0..2).find(|&d| size > 0.0 && (b[d] - a[d]).abs() <= NEAR * size)
}

/// Splines along an edge for multipliers; linear on an edge that is shorter than a part.
pub(super) fn multiplier_space(patch: &Patch, parts: &[Vec<SurfacePoint>]) -> SplineSpace {
    let degree = patch.spaces.iter().map(|space| space.degree()).max().unwrap_or(1);
    let length = |part: &Vec<SurfacePoint>| part.iter().map(|point| point.length).sum::<f64>();
    let size = |part: &Vec<SurfacePoint>| {
        let span = |d: usize| {
            let space = &patch.spaces[d];
            space.find_span(part[0].position[d]).map_or(0.0, |span| space.spans()[span].length())
        };
        larger(span(0), span(1))
    };
    let wanted = fault!("edge-multipliers-too-few", PART => 40.0);
    // Length along the edge, and the same in parts of the least length.
    let mut ends = vec![[0.0; 2]];
    for part in parts.iter().filter(|part| !part.is_empty()) {
        let ([along, number], size) = (ends[ends.len() - 1], size(part));
        let more = if size > 0.0 { length(part) / (wanted * size) } else { 0.0 }; // it has left the mesh
        ends.push([along + length(part), number + more]);
    }
    let [total, all] = ends[ends.len() - 1];
    let number = (all + ROUND_OFF).floor();
    let end_of = |part: usize| {
        let place = part as f64 / number * all;
        let next = ends.partition_point(|end| end[1] < place).clamp(1, ends.len() - 1);
        let [from, to] = [ends[next - 1], ends[next]];
        from[0] + (place - from[1]) / (to[1] - from[1]) * (to[0] - from[0])
    };
    let knots: Vec<f64> = (1..number as usize).map(end_of).collect();
    let degree = if number < 1.0 { 1 } else { (degree - 1).max(1) };
    SplineSpace::new(degree, &[vec![0.0; degree + 1], knots, vec![total; degree + 1]].concat())
}

/// The lower triangle of `B M⁻¹ Bᵀ`.
fn compliance(moments: &[Moment], inverse: &[Vec<f64>], softness: f64) -> Option<SparseColMat<usize, f64>> {
    let mut touching = BTreeMap::<(usize, usize), Vec<(usize, f64, f64)>>::new();
    for (row, (moment, inverse)) in moments.iter().zip(inverse).enumerate() {
        for (&(at, component, share), inverse) in moment.shares.iter().zip(inverse) {
            touching.entry((at, component)).or_default().push((row, share, share * inverse));
        }
    }
    let mut entries = BTreeMap::<(usize, usize), f64>::new();
    for rows in touching.values() {
        for &(column, share, _) in rows {
            for &(row, _, yielded) in rows.iter().filter(|(row, ..)| *row >= column) {
                *entries.entry((column, row)).or_default() += share * yielded;
            }
        }
    }
    for row in 0..moments.len() {
        entries.entry((row, row)).and_modify(|own| *own *= 1.0 + softness);
    }
    let triplets: Vec<_> = entries.into_iter().map(|((column, row), value)| Triplet::new(row, column, value)).collect();
    SparseColMat::try_new_from_triplets(moments.len(), moments.len(), &triplets).ok()
}
