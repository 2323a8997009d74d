//! The static state under the loads and conditions at t = 0, with the phase field held: Newton's method, each
//! step by conjugate gradients in the inner product of the mass.
//!
//! A mode of rigid motion that no condition holds stays zero: the iterates are orthogonal to it in that inner
//! product. Loads that would accelerate it are refused; what is left of them by round-off is taken away.

use super::TotalFrame;
use crate::dynamics::critical_step::{StiffnessOperator, dot};
use crate::dynamics::failure::Failure;
use crate::linear_algebra::extremes::{larger, largest};

/// Largest force out of balance, of the largest nodal force.
const TOLERANCE: f64 = 1e-9;
/// The same of the largest nodal force at the start: where conditions only move a body, all forces vanish.
const ROUND_OFF: f64 = 1e-12;
/// Reduction of the residual by a linear solve, which the next step of Newton's method squares.
const REDUCTION: f64 = 1e-4;
/// Most steps of Newton's method, and lengths of one: it converges in a few, or not at all.
const MOST_STEPS: usize = 50;
const MOST_TRIES: usize = 20;
/// Slope of the potential energy along a step, of that at its start, with which the step ends. Where the
/// split has a kink, the tangent may be several times too stiff or too soft: a longer step follows the
/// secant, a shorter one is found by bisection.
const DESCENT: f64 = 0.5;
/// Least part of the slope by which a step is taken to have reduced it.
const STRETCH: f64 = 0.1;
/// Most iterations of a linear solve, per control point along the longer side of the mesh: their number grows
/// with that of control points across the body; slender ones, and quartics that are cut, need more.
const MOST_ITERATIONS: usize = 60;
/// Resultant of loads that counts as none, of the sum of their magnitudes; and of loads on the edges of a
/// patch with a geometry, which Gauss points integrate to 1e-9 on fine and 3e-6 on coarse meshes.
const BALANCED: f64 = 1e-9;
const BALANCED_ON_CURVES: f64 = 1e-5;

/// What a rigid motion does, in words, and its component at a control point.
type FreeMotion<'a> = (&'static str, &'a dyn Fn(usize, usize) -> f64);

impl TotalFrame {
    /// Displaces the body into equilibrium.
    ///
    /// # Errors
    /// Loads that would accelerate a body that nothing holds; no convergence.
    pub(super) fn find_equilibrium(&mut self) -> Result<(), Failure> {
        self.internal_forces(); // sets the phase field at the points
        let free = self.free_components();
        let (mut residual, mut scale) = self.out_of_balance(&free);
        let least = ROUND_OFF * scale;
        let (directions, motions): (Vec<_>, Vec<_>) = self.free_motions(&free).into_iter().unzip();
        let balanced = if self.patch.geometry.is_some() { BALANCED_ON_CURVES } else { BALANCED };
        refuse_unbalanced(&directions, &motions, &residual, balanced)?;
        self.balance(&free, &motions, &mut residual);
        for _ in 0..MOST_STEPS {
            if largest(residual.iter().map(|r| r.abs())) <= larger(TOLERANCE * scale, least) {
                return Ok(());
            }
            let change = self.solve(&free, &motions, &residual)?;
            let slope = dot(&residual, &change);
            let (mut taken, mut part, mut bounds) = (0.0, 1.0, [0.0, f64::INFINITY]);
            let descends = |_| {
                self.displace(&free, &change, part - taken);
                (residual, scale) = self.out_of_balance(&free);
                self.balance(&free, &motions, &mut residual);
                let left = dot(&residual, &change) / slope;
                taken = part;
                bounds[usize::from(left < 0.0 || left.is_nan())] = part; // turned inside out: too far
                part = if bounds[1].is_finite() {
                    0.5 * (bounds[0] + bounds[1])
                } else {
                    part / larger(1.0 - left, STRETCH)
                };
                left.abs() <= DESCENT
            };
            if !(0..MOST_TRIES).any(descends) {
                break; // another step would be the same
            }
        }
        Err(Failure::NoEquilibrium(largest(residual.iter().map(|r| r.abs())) / scale))
    }

    /// Adds a part of a change of the free components.
    fn displace(&mut self, free: &[(usize, usize)], change: &[f64], part: f64) {
        for (&(at, component), change) in free.iter().zip(change) {
            self.displacement[component][at] += part * change;
        }
        self.lattice.sheets.spread(&mut self.displacement);
    }

    /// External minus internal force at the free components, and the largest internal or external one, N/m.
    fn out_of_balance(&mut self, free: &[(usize, usize)]) -> (Vec<f64>, f64) {
        self.follow_with_loads();
        self.internal = self.forces_now();
        self.external_minus_internal();
        if let Some(edges) = &self.edges {
            edges.multipliers.project_forces(&mut self.acceleration);
        }
        let residual = free.iter().map(|&(at, component)| self.acceleration[component][at]).collect();
        let inner = self.internal.iter().flatten().map(|f| f.abs());
        let outer = self.acceleration.iter().zip(&self.internal).flat_map(|(net, f)| net.iter().zip(f));
        (residual, largest(inner.chain(outer.map(|(net, f)| (net + f).abs()))))
    }

    /// Rigid motions that no condition holds, in words and at the free components.
    fn free_motions(&self, free: &[(usize, usize)]) -> Vec<(&'static str, Vec<f64>)> {
        let [x, y] = self.control_positions();
        let held: Vec<_> = self.constraints.iter().map(|(at, component, _)| (at, component)).collect();
        let mass = &self.mass.row_sums;
        let total: f64 = mass.iter().sum();
        let center = [&x, &y].map(|x| mass.iter().zip(x).map(|(m, x)| m * x).sum::<f64>() / total);
        let turning = |at: usize, component: usize| [center[1] - y[at], x[at] - center[0]][component];
        let modes: [FreeMotion<'_>; 3] = [
            ("move it along x", &|_, component| if component == 0 { 1.0 } else { 0.0 }),
            ("move it along y", &|_, component| if component == 1 { 1.0 } else { 0.0 }),
            ("turn it", &turning),
        ];
        let is_free = |(_, mode): &FreeMotion<'_>| {
            let by_sides = held.iter().any(|&(at, component)| mode(at, component) != 0.0);
            !by_sides && !self.edges.as_ref().is_some_and(|edges| edges.restrain(mode))
        };
        let values = |mode: &dyn Fn(usize, usize) -> f64| free.iter().map(|&(at, d)| mode(at, d)).collect();
        modes.into_iter().filter(is_free).map(|(direction, mode)| (direction, values(mode))).collect()
    }

    /// Takes the forces away that would accelerate these motions.
    fn balance(&self, free: &[(usize, usize)], motions: &[Vec<f64>], residual: &mut [f64]) {
        let mass = &self.mass.row_sums;
        for motion in motions {
            let inertia: f64 = free.iter().zip(motion).map(|(&(at, _), v)| mass[at] * v * v).sum();
            let acceleration = dot(motion, residual) / inertia;
            for ((&(at, _), v), force) in free.iter().zip(motion).zip(&mut *residual) {
                *force -= acceleration * mass[at] * v;
            }
        }
    }

    /// Solves `K x = right` for the free components, to [`REDUCTION`] of the residual, without these motions:
    /// what round-off leaves of them would grow, since they have no stiffness.
    fn solve(&self, free: &[(usize, usize)], motions: &[Vec<f64>], right: &[f64]) -> Result<Vec<f64>, Failure> {
        let (mut operator, n) = (self.tangent(), right.len());
        let (mut x, mut r, mut image) = (vec![0.0; n], right.to_vec(), vec![0.0; n]);
        let mut z = vec![0.0; n];
        operator.divide_by_mass(&r, &mut z);
        let (mut p, mut square) = (z.clone(), dot(&r, &z));
        let target = REDUCTION * REDUCTION * square;
        for _ in 0..MOST_ITERATIONS * (self.grid.columns.max(self.grid.rows) + 100) {
            if square <= target {
                return Ok(x);
            }
            operator.stiffness(&p, &mut image);
            let curvature = dot(&p, &image);
            if curvature <= 0.0 || curvature.is_nan() {
                break; // round-off along a rigid motion, or a body that has lost its stiffness
            }
            let step = square / curvature;
            for i in 0..n {
                x[i] += step * p[i];
                r[i] -= step * image[i];
            }
            self.balance(free, motions, &mut r);
            operator.divide_by_mass(&r, &mut z);
            let next = dot(&r, &z);
            for i in 0..n {
                p[i] = z[i] + next / square * p[i];
            }
            square = next;
        }
        if square.is_finite() { Ok(x) } else { Err(Failure::NoEquilibrium(f64::NAN)) }
    }
}

/// Refuses forces along rigid motions that no condition holds, beyond a part of the sum of their magnitudes.
fn refuse_unbalanced(
    directions: &[&'static str],
    motions: &[Vec<f64>],
    residual: &[f64],
    balanced: f64,
) -> Result<(), Failure> {
    for (direction, motion) in directions.iter().zip(motions) {
        let works = || motion.iter().zip(residual).map(|(v, r)| v * r);
        let (sum, magnitude) = (works().sum::<f64>(), works().map(f64::abs).sum::<f64>());
        if sum.abs() > balanced * magnitude {
            return Err(Failure::Unbalanced(direction));
        }
    }
    Ok(())
}
