//! Conditions on edges of the body that are not sides of the mesh: Lagrange multipliers along them.
//!
//! A multiplier is a spline μ along the edge, of the degree of the body's splines less one, over parts at
//! least [`PART`] spans long. The moments of the motion with each of them are those of the prescribed one,
//! at every step and to round-off:
//!
//! ```text
//! ∫ μ_r (v·e − w·e) dΓ = 0,   e = x, y or the normal of the edge as it was at t = 0
//! M a = f_ext − f_int − Bᵀ λ,   B_rI = ∫ μ_r N_I e dΓ
//! (B M⁻¹ Bᵀ) λ = B M⁻¹ (f_ext − f_int) − B a_prescribed
//! ```
//!
//! The multipliers remove directions from the operator and add no stiffness, so the critical step is never
//! shorter than that of the free body. They do work on what moves only: there is no energy of a penalty.

use std::collections::BTreeMap;

use faer::sparse::{SparseColMat, Triplet};

use super::prescribed::{Reaction, Reactions};
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::constraints::Constraints;
use crate::dynamics::energy::ConditionSample;
use crate::dynamics::failure::Failure;
use crate::dynamics::loads::functions_of_material;
use crate::dynamics::mass::MassMatrix;
use crate::dynamics::surface::{SurfacePoint, smooth_parts};
use crate::linear_algebra::cholesky::LowerFactor;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::larger;
use crate::particles::lattice::Lattice;
use crate::scene::{Body, EdgeCondition, Hold};
use crate::splines::patch::Patch;
use crate::splines::spline::SplineSpace;

/// Least length of a part of an edge over which multipliers are polynomials, in spans.
const PART: f64 = 2.0;
/// Yield of a multiplier at control points that can move, of that at all of them, that counts as none.
const YIELDS: f64 = 1e-9;
/// Least part of the compliance of a multiplier that the others do not have.
const INDEPENDENT: f64 = 1e-9;
/// Part of a rigid motion that a condition may see by round-off.
const ROUND_OFF: f64 = 1e-9;

/// A prescribed direction from the normal of an edge.
type Direction = fn([f64; 2]) -> [f64; 2];

/// A moment of the motion of an edge, and its multiplier.
#[derive(Debug, Clone)]
struct Moment {
    /// Number of its condition.
    condition: usize,
    /// Control point and component, and its share, m.
    shares: Vec<(usize, usize, f64)>,
    /// Shares of the components in all: those of a translation, m.
    total: [f64; 2],
}

/// Conditions on the edges of a body.
#[derive(Debug, Clone)]
pub(super) struct EdgeConditions {
    conditions: Vec<EdgeCondition>,
    moments: Vec<Moment>,
    /// Inverse mass of the shares of every moment, m/kg; zero where a side of the mesh prescribes.
    inverse: Vec<Vec<f64>>,
    /// Shares where a side of the mesh prescribes: moment, number of that condition, component, share (m).
    held: Vec<(usize, usize, usize, f64)>,
    factor: LowerFactor,
    reactions: Vec<Reaction>,
}

impl EdgeConditions {
    /// Those of a body, if it has any.
    ///
    /// # Errors
    /// If there is no material at an edge, or what two conditions prescribe is not independent.
    pub(super) fn new(
        patch: &Patch,
        lattice: &Lattice,
        body: &Body,
        mass: &MassMatrix,
        constraints: &Constraints,
    ) -> Result<Option<Box<Self>>, Failure> {
        let conditions = body.conditions.clone();
        let mut moments = Vec::new();
        for (number, condition) in conditions.iter().enumerate() {
            moments.extend(moments_of(patch, lattice, body, mass, number, condition)?);
        }
        if moments.is_empty() {
            return Ok(None);
        }
        let prescribed: BTreeMap<_, _> = constraints.iter().map(|(at, c, number)| ((at, c), number)).collect();
        let (mut inverse, mut held) = (Vec::new(), Vec::new());
        for (row, moment) in moments.iter().enumerate() {
            let of = |&(at, component, share): &(usize, usize, f64)| match prescribed.get(&(at, component)) {
                Some(&number) => {
                    held.push((row, number, component, share));
                    0.0
                }
                None => 1.0 / mass.row_sums()[at],
            };
            let inverses: Vec<f64> = moment.shares.iter().map(of).collect();
            let yields = moment.shares.iter().zip(&inverses).map(|((.., share), m)| share * share * m).sum::<f64>();
            let square = |&(at, _, share): &(usize, usize, f64)| share * share / mass.row_sums()[at];
            if yields <= YIELDS * moment.shares.iter().map(square).sum::<f64>() {
                return Err(Failure::HeldTwice(moment.condition));
            }
            inverse.push(inverses);
        }
        let last = moments[moments.len() - 1].condition;
        let factor = compliance(&moments, &inverse).and_then(|lower| LowerFactor::new(&lower, None));
        let reactions = vec![Reaction::default(); conditions.len()];
        let factor = factor.ok_or(Failure::HeldTwice(last))?;
        if let Some(moment) = dependent(&moments, &inverse, &factor) {
            return Err(Failure::HeldTwice(moment.condition));
        }
        Ok(Some(Box::new(Self { conditions, moments, inverse, held, factor, reactions })))
    }

    /// Sets displacements (m) and velocities (m/s) at t = 0, by the least change in the norm of the mass.
    pub(super) fn start(&self, displacement: &mut VectorField, velocity: &mut VectorField) {
        let starts: Vec<_> = self.conditions.iter().map(|condition| condition.prescribed.start()).collect();
        for (derivative, field) in [displacement, velocity].into_iter().enumerate() {
            let skipped =
                |moment: &Moment| derivative == 0 && !self.conditions[moment.condition].prescribed.is_displacement();
            let excess = |moment: &Moment| {
                if skipped(moment) {
                    0.0
                } else {
                    moment.of(field) - moment.translated(starts[moment.condition][derivative])
                }
            };
            let multipliers = self.multipliers(self.moments.iter().map(excess).collect());
            self.yield_to(&multipliers, field);
        }
    }

    /// Makes the accelerations (m/s²) at `time` those of a step of `dt` seconds in which the edges move as
    /// prescribed. The reactions go on to this whole step.
    pub(super) fn enforce(
        &mut self,
        [time, dt]: [f64; 2],
        velocity: &VectorField,
        acceleration: &mut VectorField,
        sides: &mut Reactions,
    ) {
        for (reaction, condition) in self.reactions.iter_mut().zip(&self.conditions) {
            reaction.begin();
            reaction.drive(condition.prescribed.mean_velocity(time, dt));
        }
        let part = if time == 0.0 { 0.5 } else { 1.0 }; // of a step, since the velocity at hand
        let excess = |moment: &Moment| {
            let next = moment.translated(self.reactions[moment.condition].next_velocity());
            let now = fault!("edge-speed-forgotten", moment.of(velocity) => next);
            let prescribed = if dt > 0.0 { (next - now) / (part * dt) } else { 0.0 };
            moment.of(acceleration) - prescribed
        };
        let multipliers = self.multipliers(self.moments.iter().map(excess).collect());
        self.yield_to(&multipliers, acceleration);
        for (moment, multiplier) in self.moments.iter().zip(&multipliers) {
            let force =
                moment.total.map(|total| -fault!("edge-reaction-reversed", multiplier * total => -multiplier * total));
            (0..2).for_each(|d| self.reactions[moment.condition].add(d, force[d]));
        }
        for &(row, number, component, share) in &self.held {
            sides.add(number, component, multipliers[row] * share);
        }
    }

    /// Takes from accelerations or displacements what the conditions do not allow.
    pub(super) fn project(&self, field: &mut VectorField) {
        let multipliers = self.multipliers(self.moments.iter().map(|moment| moment.of(field)).collect());
        self.yield_to(&multipliers, field);
    }

    /// Takes the part that the multipliers carry from forces, N/m.
    pub(super) fn project_forces(&self, forces: &mut VectorField) {
        let yielded = |(moment, inverse): (&Moment, &Vec<f64>)| {
            let shares = moment.shares.iter().zip(inverse);
            shares.map(|(&(at, component, share), inverse)| share * inverse * forces[component][at]).sum()
        };
        let multipliers = self.multipliers(self.moments.iter().zip(&self.inverse).map(yielded).collect());
        for (moment, multiplier) in self.moments.iter().zip(multipliers) {
            for &(at, component, share) in &moment.shares {
                forces[component][at] -= multiplier * share;
            }
        }
    }

    /// Whether they prescribe a part of a motion: its components at control points.
    pub(super) fn restrain(&self, motion: impl Fn(usize, usize) -> f64) -> bool {
        self.moments.iter().any(|moment| {
            let terms = moment.shares.iter().map(|&(at, component, share)| share * motion(at, component));
            let (sum, magnitude) = terms.fold((0.0, 0.0), |(sum, all), term: f64| (sum + term, all + term.abs()));
            f64::abs(sum) > ROUND_OFF * magnitude
        })
    }

    /// Work (J/m) of the prescribed motion over the last step of `dt` seconds.
    pub(super) fn work(&mut self, dt: f64) -> f64 {
        self.reactions.iter_mut().map(|reaction| reaction.book(dt)).sum()
    }

    /// Reaction and work of every condition with a name, for a thickness of a metre.
    pub(super) fn samples(&self) -> impl Iterator<Item = ConditionSample> + '_ {
        let named = self.reactions.iter().zip(&self.conditions);
        named.filter_map(|(reaction, condition)| {
            Some(reaction.sample(condition.name.as_deref()?, condition.components()))
        })
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        self.reactions.iter_mut().try_for_each(|reaction| archive.value(reaction))
    }

    /// λ of an excess of the moments.
    fn multipliers(&self, mut excess: Vec<f64>) -> Vec<f64> {
        self.factor.solve(&mut excess);
        excess
    }

    /// `field ← field − M⁻¹ Bᵀ λ`.
    fn yield_to(&self, multipliers: &[f64], field: &mut VectorField) {
        for ((moment, inverse), multiplier) in self.moments.iter().zip(&self.inverse).zip(multipliers) {
            for (&(at, component, share), inverse) in moment.shares.iter().zip(inverse) {
                field[component][at] -= multiplier * share * inverse;
            }
        }
    }
}

impl Moment {
    /// Its value for a field.
    fn of(&self, field: &VectorField) -> f64 {
        self.shares.iter().map(|&(at, component, share)| share * field[component][at]).sum()
    }

    /// Its value for a translation.
    fn translated(&self, value: [f64; 2]) -> f64 {
        self.total[0] * value[0] + self.total[1] * value[1]
    }
}

/// The moments of a condition.
fn moments_of(
    patch: &Patch,
    lattice: &Lattice,
    body: &Body,
    mass: &MassMatrix,
    number: usize,
    condition: &EdgeCondition,
) -> Result<Vec<Moment>, Failure> {
    let parts = smooth_parts(patch, body, &condition.edge);
    let space = multiplier_space(patch, &parts);
    let directions: &[Direction] = match condition.hold {
        Hold::Components([true, true]) => &[|_| [1.0, 0.0], |_| [0.0, 1.0]],
        Hold::Components([true, false]) => &[|_| [1.0, 0.0]],
        Hold::Components([false, true]) => &[|_| [0.0, 1.0]],
        Hold::Components([false, false]) => &[],
        Hold::Normal => &[|normal| normal],
    };
    let mut shares = vec![BTreeMap::<(usize, usize), f64>::new(); directions.len() * space.dimension()];
    let mut totals = vec![[0.0; 2]; shares.len()];
    for point in parts.iter().flatten() {
        let moves = |at| mass.moves(at);
        let lost = Failure::LostCondition { condition: number, place: point.position };
        let functions = functions_of_material(patch, lattice, point, moves).ok_or(lost)?;
        let span = space.find_span(point.along).ok_or(lost)?;
        let multipliers = space.shape_functions(span, point.along).value;
        for (k, multiplier) in multipliers[..=space.degree()].iter().enumerate() {
            let row = space.spans()[span].first + k;
            for (set, along) in directions.iter().enumerate() {
                let (row, direction) = (set * space.dimension() + row, along(point.normal));
                for component in (0..2).filter(|&d| direction[d] != 0.0) {
                    let weight = multiplier * point.length * direction[component];
                    totals[row][component] += weight;
                    for &(at, value) in &functions {
                        *shares[row].entry((at, component)).or_default() += weight * value;
                    }
                }
            }
        }
    }
    let moment = |(shares, total): (BTreeMap<(usize, usize), f64>, [f64; 2])| {
        let shares = shares.into_iter().map(|((at, component), share)| (at, component, share)).collect();
        Moment { condition: number, shares, total }
    };
    Ok(shares.into_iter().zip(totals).map(moment).collect())
}

/// Splines along an edge for multipliers; linear on an edge that is shorter than a part.
fn multiplier_space(patch: &Patch, parts: &[Vec<SurfacePoint>]) -> SplineSpace {
    let degree = patch.spaces.iter().map(|space| space.degree()).max().unwrap_or(1);
    let length = |part: &Vec<SurfacePoint>| part.iter().map(|point| point.length).sum::<f64>();
    let size = |part: &Vec<SurfacePoint>| {
        let span = |d: usize| {
            let space = &patch.spaces[d];
            space.find_span(part[0].position[d]).map_or(0.0, |span| space.spans()[span].length())
        };
        larger(span(0), span(1))
    };
    let wanted_spans = fault!("edge-multipliers-too-few", PART => 40.0);
    let (mut knots, mut end, mut since, mut wanted) = (Vec::new(), 0.0, 0.0, 0.0);
    let total: f64 = parts.iter().map(length).sum();
    for part in parts.iter().filter(|part| !part.is_empty()) {
        (end, since, wanted) = (end + length(part), since + length(part), larger(wanted, wanted_spans * size(part)));
        if since >= wanted && total - end >= wanted {
            knots.push(end);
            (since, wanted) = (0.0, 0.0);
        }
    }
    let is_short = total < PART * parts.iter().filter(|part| !part.is_empty()).map(size).fold(0.0, larger);
    let degree = if is_short { 1 } else { (degree - 1).max(1) };
    SplineSpace::new(degree, &[vec![0.0; degree + 1], knots, vec![total; degree + 1]].concat())
}

/// A moment that nearly follows from the others: what is left of its own compliance beside them, `1/(S⁻¹)_rr`
/// of `S_rr` for `S = B M⁻¹ Bᵀ`, is less than [`INDEPENDENT`].
fn dependent<'a>(moments: &'a [Moment], inverse: &[Vec<f64>], factor: &LowerFactor) -> Option<&'a Moment> {
    (0..moments.len())
        .map(|row| {
            let mut unit = vec![0.0; moments.len()];
            unit[row] = 1.0;
            factor.solve(&mut unit);
            let own: f64 =
                moments[row].shares.iter().zip(&inverse[row]).map(|((.., share), m)| share * share * m).sum();
            (1.0 / (unit[row] * own), &moments[row])
        })
        .find_map(|(part, moment)| (part < INDEPENDENT).then_some(moment))
}

/// The lower triangle of `B M⁻¹ Bᵀ`.
fn compliance(moments: &[Moment], inverse: &[Vec<f64>]) -> Option<SparseColMat<usize, f64>> {
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
    let triplets: Vec<_> = entries.into_iter().map(|((column, row), value)| Triplet::new(row, column, value)).collect();
    SparseColMat::try_new_from_triplets(moments.len(), moments.len(), &triplets).ok()
}
