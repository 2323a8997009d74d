//! Impulses from the equations of the constraints, where iterations over the constraints converge too slowly.
//!
//! Impulses P change the relative velocities at the constraints to `r + A P`. If it is known which
//! constraints are open, stick or slide, P solves linear equations: no impulse where it is open, no approach
//! where it is not, no sliding where it sticks, and `± mu` times the normal impulse along where it slides.
//! The states are those the iterations ended with, changed until they agree with the impulses (a Newton
//! method for the complementarity problem). Nothing is taken on trust: iterations that follow have to find
//! the impulses converged.

use nalgebra::{DMatrix, DVector};

use super::{Acting, Impulse, Problem};
use crate::linear_algebra::vectors::dot;

/// Most times the states are changed: all that do not agree at once, which may go round in circles, then the
/// first of them, which does not where there is no friction (Murty 1974).
const MOST_CHANGES: usize = 100;
const MOST_AT_ONCE: usize = 10;
/// Least singular value relative to the largest: more constraints than control points can tell apart share
/// their impulses.
const SINGULAR: f64 = 1e-13;
/// Least pivot relative to the largest of equations that are far from that, and are solved without singular
/// values.
const REGULAR: f64 = 1e-8;
/// Error of velocities and impulses that changes no state, relative to the largest.
const ROUND_OFF: f64 = 1e-11;

#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    Open,
    Sticks,
    /// With the sign of the tangential impulse; 0 without friction.
    Slides(f64),
}

/// Normal and tangential velocities in the order of the constraints.
struct Equations {
    /// Matrix A: change of each velocity per impulse, m/kg.
    responses: DMatrix<f64>,
    /// Velocities without impulses, the normal ones less those allowed, m/s.
    free: DVector<f64>,
    friction: f64,
}

impl Problem<'_> {
    /// Replaces the impulses by those that solve the equations; false if no states are found that agree with
    /// them.
    pub(super) fn solve_directly(&mut self, friction: f64, step: f64) -> bool {
        let equations = Equations::of(self, friction, step);
        let mut states: Vec<State> = self.constraints.iter().map(|acting| equations.state_of(acting.impulse)).collect();
        for change in 0..MOST_CHANGES {
            let Some(impulses) = equations.solve(&states) else { return false };
            let next = equations.next(&states, &impulses);
            let Some(first) = (0..states.len()).find(|&i| next[i] != states[i]) else {
                self.replace(&impulses);
                return true;
            };
            if change < MOST_AT_ONCE {
                states = next;
            } else {
                states[first] = next[first];
            }
        }
        false
    }

    fn replace(&mut self, impulses: &DVector<f64>) {
        let Self { nodes, constraints, .. } = self;
        nodes.iter_mut().for_each(|node| node.after = node.free);
        for (i, acting) in constraints.iter_mut().enumerate() {
            acting.impulse = Impulse { normal: impulses[2 * i], tangent: impulses[2 * i + 1] };
            acting.give(nodes, acting.impulse);
        }
    }
}

impl Equations {
    fn of(problem: &Problem, friction: f64, step: f64) -> Self {
        let Problem { nodes, constraints, .. } = problem;
        let size = 2 * constraints.len();
        let directions = |acting: &Acting| [acting.constraint.normal, acting.tangent()];
        let mut free = DVector::zeros(size);
        let mut at_nodes = vec![Vec::new(); nodes.len()];
        for (i, acting) in constraints.iter().enumerate() {
            let relative = acting.relative(nodes, |node| node.free);
            let [normal, tangent] = directions(acting).map(|direction| dot(relative, direction));
            free[2 * i] = normal + acting.constraint.gap.max(0.0) / step;
            free[2 * i + 1] = tangent;
            for &(node, weight) in &acting.weights {
                at_nodes[node].push((i, weight));
            }
        }
        let mut responses = DMatrix::zeros(size, size);
        for (node, sharing) in nodes.iter().zip(&at_nodes) {
            for &(i, own) in sharing {
                for &(j, other) in sharing {
                    for (a, d) in directions(&constraints[i]).into_iter().enumerate() {
                        for (b, e) in directions(&constraints[j]).into_iter().enumerate() {
                            let along = d[0] * node.mobility[0] * e[0] + d[1] * node.mobility[1] * e[1];
                            responses[(2 * i + a, 2 * j + b)] += own * other * along;
                        }
                    }
                }
            }
        }
        Self { responses, free, friction }
    }

    fn state_of(&self, Impulse { normal, tangent }: Impulse) -> State {
        if normal <= 0.0 {
            State::Open
        } else if self.friction == 0.0 {
            State::Slides(0.0)
        } else if tangent.abs() < self.friction * normal {
            State::Sticks
        } else {
            State::Slides(tangent.signum())
        }
    }

    /// Impulses of given states; `None` if they are no numbers.
    fn solve(&self, states: &[State]) -> Option<DVector<f64>> {
        let (mut matrix, mut right) = (self.responses.clone(), -&self.free);
        let mut prescribe = |row: usize, normal: Option<f64>| {
            let scale = self.responses[(row, row)].max(f64::MIN_POSITIVE);
            matrix.row_mut(row).fill(0.0);
            matrix[(row, row)] = scale;
            right[row] = 0.0;
            if let Some(factor) = normal {
                matrix[(row, row - 1)] = -factor * scale;
            }
        };
        for (i, state) in states.iter().enumerate() {
            match state {
                State::Open => {
                    prescribe(2 * i, None);
                    prescribe(2 * i + 1, None);
                }
                State::Sticks => (),
                State::Slides(sign) => prescribe(2 * i + 1, Some(sign * self.friction)),
            }
        }
        if !matrix.iter().chain(&right).all(|entry| entry.is_finite()) {
            return None;
        }
        let factors = matrix.clone().lu();
        let pivots = factors.u().diagonal().abs();
        let impulses = if pivots.min() > REGULAR * pivots.max() {
            factors.solve(&right)?
        } else {
            let decomposed = matrix.try_svd(true, true, f64::EPSILON, 0)?;
            let least = SINGULAR * decomposed.singular_values.max();
            decomposed.solve(&right, least).ok()?
        };
        impulses.iter().all(|impulse| impulse.is_finite()).then_some(impulses)
    }

    /// The states that impulses call for.
    fn next(&self, states: &[State], impulses: &DVector<f64>) -> Vec<State> {
        let velocities = &self.responses * impulses + &self.free;
        let (slow, small) = (ROUND_OFF * self.free.amax(), ROUND_OFF * impulses.amax());
        let closed = if self.friction == 0.0 { State::Slides(0.0) } else { State::Sticks };
        let next = |(i, state): (usize, &State)| {
            let (normal, tangent) = (impulses[2 * i], impulses[2 * i + 1]);
            match *state {
                State::Open if velocities[2 * i] < -slow => closed,
                State::Open => State::Open,
                _ if normal < -small => State::Open,
                State::Sticks if tangent.abs() > self.friction * normal.max(0.0) + small => {
                    State::Slides(tangent.signum())
                }
                State::Slides(sign) if sign * velocities[2 * i + 1] > slow => State::Sticks,
                same => same,
            }
        };
        states.iter().enumerate().map(next).collect()
    }
}
