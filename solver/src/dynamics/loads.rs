//! External loads: tractions carried by surface points, `f_I = factor(time) Σ_s l_s t N_I(x_s)` with the
//! length l of a point and the traction t (E 18). Those that move are in
//! [`updated_frame::loads`](super::updated_frame).
//!
//! Nothing of a traction may be lost on the way to the control points: [`Balance`] holds every load to the
//! force and moment of its edge when it is made.

use std::collections::BTreeMap;

use thiserror::Error;

use crate::dynamics::surface::{SurfacePoint, edge_ends, surface_points};
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::vectors::cofactor;
use crate::particles::follower::nearest_span;
use crate::particles::lattice::Lattice;
use crate::scene::{Analysis, Body, Edge, Kinematics, Load, Shape, Side, TimeFactor, Traction};
use crate::splines::nurbs::locate::Location;
use crate::splines::patch::{BoundaryPoint, Patch, PointFunctions};
use crate::splines::quadrature::Rule;

/// Largest error of the force and moment of nodal loads, of those of their edge.
const TOLERANCE: f64 = 1e-12;
/// Round-off of the terms of a force or a moment, of the sum of their magnitudes.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

/// A sum that keeps what rounding takes from it (Neumaier 1974): its error does not grow with the number of
/// terms.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    rounded: f64,
    lost: f64,
}

impl Sum {
    fn of(terms: impl Iterator<Item = f64>) -> f64 {
        terms.fold(Self::default(), Self::plus).value()
    }

    fn plus(self, term: f64) -> Self {
        let rounded = self.rounded + term;
        let lost = if self.rounded.abs() >= term.abs() {
            (self.rounded - rounded) + term
        } else {
            (term - rounded) + self.rounded
        };
        Self { rounded, lost: self.lost + lost }
    }

    fn value(self) -> f64 {
        self.rounded + self.lost
    }
}

/// Points on a side of the patch, with the layout of the body in every span.
pub fn boundary_points(patch: &Patch, body: &Body, side: Side) -> Vec<BoundaryPoint> {
    patch.boundary(side, &Rule::new(body.layout, body.particles_per_cell[side.along()]))
}

/// A traction of which a part would not act on the body.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LostTraction {
    /// No material carries the edge at a place (m): there is none within one span of it.
    #[error("there is no material point within a cell of ({:.6e}, {:.6e}) m, where the traction acts", .0[0], .0[1])]
    Bare([f64; 2]),
    /// Its stress field is not finite at a place, m.
    #[error("the stress field is not finite at ({}, {}) m", .0[0], .0[1])]
    NotFinite([f64; 2]),
    /// The nodal forces are not those of the edge.
    #[error(
        "the forces on the control points miss the traction by {force:.1e} of its force and {moment:.1e} of its moment"
    )]
    Unbalanced {
        /// Middle of the edge, m.
        place: [f64; 2],
        /// Error of the force, of the force.
        force: f64,
        /// Error of the moment about the middle, of the force times the length.
        moment: f64,
    },
}

impl LostTraction {
    /// Place where the traction is lost, m: the middle of the edge if its total force or moment is wrong.
    pub(crate) fn place(self) -> [f64; 2] {
        let (Self::Bare(place) | Self::NotFinite(place) | Self::Unbalanced { place, .. }) = self;
        place
    }
}

/// What the nodal forces of a uniform traction have to add up to: the length of its edge (m) and the middle
/// of it (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Balance {
    length: f64,
    middle: [f64; 2],
}

impl Balance {
    /// Of an edge of a body.
    pub(crate) fn of_edge(body: &Body, edge: &Edge) -> Self {
        if let Edge::Arc { center, radius, angles } = *edge {
            let (half, bisector) = (0.5 * (angles[1] - angles[0]), (0.5 * (angles[0] + angles[1])).sin_cos());
            let reach = radius * half.sin() / half; // of the centroid from the centre
            let middle = [center[0] + reach * bisector.1, center[1] + reach * bisector.0];
            return Self { length: 2.0 * half * radius, middle };
        }
        let [from, to] = edge_ends(body, edge);
        Self { length: (to[0] - from[0]).hypot(to[1] - from[1]), middle: [0, 1].map(|d| 0.5 * from[d] + 0.5 * to[d]) }
    }

    /// Of a side of a patch, as its points integrate it.
    fn of_points(points: &[BoundaryPoint]) -> Self {
        let length = Sum::of(points.iter().map(|p| p.length));
        let middle = |d: usize| Sum::of(points.iter().map(|p| p.length * p.functions.position[d])) / length;
        Self { length, middle: [0, 1].map(middle) }
    }

    /// Holds `shares` of the length (m) at positions (m) to the edge. Force and moment of any uniform
    /// traction are then its own.
    ///
    /// # Errors
    /// If they are not, to 1e-12.
    pub(crate) fn check(self, shares: impl Iterator<Item = ([f64; 2], f64)>) -> Result<(), LostTraction> {
        let Self { length, middle } = self;
        let (mut sum, mut moments) = (Sum::default().plus(-length), [Sum::default(); 2]);
        let (mut arms, mut magnitudes, mut lengths) = (0.0, 0.0, 0.0);
        for (position, share) in shares {
            let arm = [0, 1].map(|d| position[d] - middle[d]);
            sum = sum.plus(share);
            moments = [0, 1].map(|d| moments[d].plus(share * arm[d]));
            lengths += share.abs();
            arms += share.abs() * arm[0].hypot(arm[1]);
            magnitudes += share.abs() * position[0].hypot(position[1]);
        }
        let [sum, x, y] = [sum, moments[0], moments[1]].map(Sum::value);
        let moment = x.hypot(y);
        let balanced = length > 0.0
            && sum.abs() <= TOLERANCE * length + ROUND_OFF * lengths
            && moment <= TOLERANCE * arms.max(length * length) + ROUND_OFF * magnitudes;
        if balanced {
            return Ok(());
        }
        Err(LostTraction::Unbalanced { place: middle, force: sum / length, moment: moment / (length * length) })
    }
}

/// Factor of a load, constant over a kick: its mean from half a step before a time to half a step after it,
/// so that the impulse of the load is exact however short it is.
#[derive(Debug, Clone)]
pub struct KickFactor {
    time: TimeFactor,
    step: f64,
}

impl KickFactor {
    /// Before any step: the factor itself.
    pub(crate) fn new(time: TimeFactor) -> Self {
        Self { time, step: 0.0 }
    }

    /// From now on for steps of `dt` seconds.
    pub(crate) fn prepare(&mut self, dt: f64) {
        self.step = dt;
    }

    /// The factor in the kick at a time, s.
    pub fn at(&self, time: f64) -> f64 {
        let half = 0.5 * self.step;
        if half == 0.0 { self.time.value(time) } else { self.time.mean([larger(time - half, 0.0), time + half]) }
    }
}

/// Gravity that may vary over time.
#[derive(Debug, Clone)]
pub(crate) struct Gravity {
    /// At full strength, m/s².
    full: [f64; 2],
    /// Factor over time by which the full strength is multiplied.
    pub factor: KickFactor,
}

impl Gravity {
    /// The gravity of a scene, with its factor over time.
    pub(crate) fn new(analysis: &Analysis) -> Self {
        Self { full: analysis.gravity, factor: KickFactor::new(analysis.gravity_time.clone()) }
    }

    /// Whether it changes over time.
    pub(crate) fn varies(&self) -> bool {
        !self.factor.time.is_constant()
    }

    /// At a time (s), m/s².
    pub(crate) fn at(&self, time: f64) -> [f64; 2] {
        let factor = self.factor.at(time);
        self.full.map(|full| factor * full)
    }

    /// Mean of the weights at both ends of a step of `dt` seconds that ends at a time (s), m/s².
    pub(crate) fn mean(&self, time: f64, dt: f64) -> [f64; 2] {
        let factor = 0.5 * (self.factor.at(time - dt) + self.factor.at(time));
        self.full.map(|full| factor * full)
    }
}

/// A traction as nodal forces that share one factor in time.
#[derive(Debug, Clone)]
pub struct NodalLoad {
    /// Control point and force at full strength per unit thickness, N/m.
    pub forces: Vec<(usize, [f64; 2])>,
    /// Factor over time by which the full strength is multiplied.
    pub factor: KickFactor,
    /// If it follows the body.
    following: Option<Box<FollowingForces>>,
}

/// Forces on the boundary that turn and stretch with it.
#[derive(Debug, Clone)]
struct FollowingForces {
    /// Shape functions, and the force at full strength on the boundary as it is at t = 0, N/m.
    points: Vec<(PointFunctions, [f64; 2])>,
    /// The nodal forces of the last step.
    before: Vec<(usize, [f64; 2])>,
}

impl NodalLoad {
    /// Nodal forces of `traction` with the shape functions at the reference positions, on control points that
    /// can move: `moves` says which have mass. Where an edge crosses a span with others, the polynomials of
    /// the nearest span without carry it. With finite `kinematics` a pressure follows the body.
    ///
    /// # Errors
    /// If a part of the traction would be lost.
    pub fn new(
        (patch, lattice): (&Patch, &Lattice),
        body: &Body,
        traction: &Traction,
        kinematics: Kinematics,
        moves: impl Fn(usize) -> bool,
    ) -> Result<Self, LostTraction> {
        let follows = matches!(traction.load, Load::Pressure(_)) && kinematics == Kinematics::Finite;
        let mut sums = BTreeMap::<usize, [Sum; 3]>::new(); // of the length, and of the force
        let (mut undefined, mut points) = (None, Vec::new());
        let mut add = |functions: PointFunctions, length: f64, normal: [f64; 2]| {
            let [x, y] = traction.load.traction(functions.position, normal);
            if !(x.is_finite() && y.is_finite()) {
                undefined = Some(functions.position);
            }
            for &(at, value) in &functions.values {
                let sums = sums.entry(at).or_default();
                for (sum, density) in sums.iter_mut().zip([1.0, x, y]) {
                    *sum = sum.plus(density * (value * length));
                }
            }
            if follows {
                points.push((functions, [length * x, length * y]));
            }
        };
        let balance = match (&traction.edge, &body.shape) {
            (Edge::Side(side), Shape::Patch) => {
                let points = boundary_points(patch, body, *side);
                let balance = Balance::of_points(&points);
                for BoundaryPoint { mut functions, length, normal } in points {
                    let place = functions.position;
                    take_side(lattice, &mut functions, place);
                    add(functions, length, normal);
                }
                balance
            }
            _ => {
                for point in surface_points(patch, body, &traction.edge) {
                    let functions = material_at(patch, lattice, &point, &moves);
                    add(functions.ok_or(LostTraction::Bare(point.position))?, point.length, point.normal);
                }
                Balance::of_edge(body, &traction.edge)
            }
        };
        if let Some(place) = undefined {
            return Err(LostTraction::NotFinite(place));
        }
        let [x, y] = lattice.control_positions(patch);
        balance.check(sums.iter().filter(|(at, _)| moves(**at)).map(|(&at, sum)| ([x[at], y[at]], sum[0].value())))?;
        let force = |[length, x, y]: [Sum; 3]| match traction.load {
            Load::Stress(stress) => stress.map(|s| s * length.value()),
            Load::Pressure(_) | Load::Field(_) => [x.value(), y.value()],
        };
        let forces: Vec<_> = sums.into_iter().map(|(at, sums)| (at, force(sums))).collect();
        let following = follows.then(|| Box::new(FollowingForces { points, before: forces.clone() }));
        Ok(Self { forces, factor: KickFactor::new(traction.time.clone()), following })
    }

    /// Goes on to another displacement, m.
    pub(crate) fn follow(&mut self, displacement: &VectorField) {
        let Self { forces, following: Some(following), .. } = self else { return };
        std::mem::swap(forces, &mut following.before);
        let mut sums: BTreeMap<usize, [f64; 2]> = forces.iter().map(|(at, _)| (*at, [0.0; 2])).collect();
        for (functions, force) in &following.points {
            let turned = turned(functions, *force, displacement);
            for (at, value) in &functions.values {
                let sum = sums.entry(*at).or_default();
                (0..2).for_each(|d| sum[d] += value * (force[d] + turned[d]));
            }
        }
        forces.clear();
        forces.extend(sums);
    }

    /// Adds to nodal forces their change with a displacement (m), times a factor.
    pub(crate) fn add_change(&self, factor: f64, displacement: &VectorField, forces: &mut VectorField) {
        for (functions, force) in self.following.iter().flat_map(|following| &following.points) {
            let turned = turned(functions, *force, displacement);
            for &(at, value) in &functions.values {
                (0..2).for_each(|d| forces[d][at] += factor * value * turned[d]);
            }
        }
    }

    /// Power of the full strength (W/m), times a factor of the last step and one of the present one, with
    /// their forces.
    pub(crate) fn power(&self, [before, now]: [f64; 2], velocity: &VectorField) -> f64 {
        let with = |forces: &[(usize, [f64; 2])]| {
            forces.iter().map(|&(at, f)| f[0] * velocity[0][at] + f[1] * velocity[1][at]).sum::<f64>()
        };
        match &self.following {
            None => (before + now) * with(&self.forces),
            Some(following) => before * with(&following.before) + now * with(&self.forces),
        }
    }
}

/// What a displacement (m) adds to a force on the boundary that follows it.
fn turned(functions: &PointFunctions, force: [f64; 2], displacement: &VectorField) -> [f64; 2] {
    let gradient = displacement.each_ref().map(|component| functions.interpolate(component).gradient);
    fault!("pressure-that-keeps-its-direction", cofactor(gradient, force) => [0.0; 2])
}

/// Takes the control points on the side of the slits of a place, m.
pub(super) fn take_side(lattice: &Lattice, functions: &mut PointFunctions, place: [f64; 2]) {
    let first = functions.values[0].0;
    functions.values.iter_mut().for_each(|(at, _)| *at = lattice.control_point(*at, first, place));
}

/// Functions of the material at a surface point; `None` if there is no material within a span of it.
pub(crate) fn material_at(
    patch: &Patch,
    lattice: &Lattice,
    point: &SurfacePoint,
    moves: impl Fn(usize) -> bool,
) -> Option<PointFunctions> {
    let carries =
        |first, at| lattice.has_side(first, point.inner) && moves(lattice.control_point(at, first, point.inner));
    let mut functions = patch.functions(carrier(patch, point.position, carries)?);
    take_side(lattice, &mut functions, point.inner);
    Some(functions)
}

/// Where to evaluate the shape functions of a position (m) on a straight edge, so that all of them belong to
/// control points that can move.
pub(crate) fn carrier(patch: &Patch, position: [f64; 2], moves: impl Fn(usize, usize) -> bool) -> Option<Location> {
    let carries = |span| patch.all_functions(span, |at| moves(patch.first_function(span), at));
    nearest_span(&patch.spaces, position, carries).map(|span| Location { span, parameters: position })
}
