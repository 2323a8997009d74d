//! Jumps of the p-th derivative at the knots: what makes a spline on a few spans the same polynomial as next
//! to them.
//!
//! For the knot between two spans with control values c,
//!
//! ```text
//! J(c) = h^p [dᵖu/dxᵖ],      u = Σ c_i N_i,      h the mean length of the two spans
//! ```
//!
//! It vanishes for polynomials, whatever the knots, and is the binomial difference of order p + 1 on equal
//! spans. The penalty `w Σ J(c)²`, over the lines of control values in x and in y and over the knots whose
//! control points all take part, is the ghost penalty of Burman (2010, *Ghost penalty*, Comptes Rendus
//! Mathématique 348) by control values. It costs an error of order p + 1, and continues a field into spans
//! that hold few points or are cut by the boundary of a body.

use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::stencil::Stencil;
use crate::splines::patch::Patch;
use crate::splines::spline::SplineSpace;

/// The jump at a knot as a combination of control values.
#[derive(Debug, Clone, PartialEq)]
struct Jump {
    /// Index of the first control value.
    first: usize,
    /// Factors of the control values from there on.
    factors: Vec<f64>,
}

/// Jumps at the inner knots of a spline space, from left to right.
fn jumps(space: &SplineSpace) -> Vec<Jump> {
    let (p, spans) = (space.degree(), space.spans());
    let factorial: f64 = (1..=p).map(|i| i as f64).product();
    let at_knot = |left: usize| {
        let right = left + 1;
        let (first, end) = (spans[left].first, spans[right].first + p + 1);
        let mean = 0.5 * (spans[left].length() + spans[right].length());
        let mut factors = vec![0.0; end - first];
        for (span, sign) in [(left, -1.0), (right, 1.0)] {
            let scale = sign * factorial * (mean / spans[span].length()).powi(p as i32);
            for (k, leading) in space.leading_coefficients(span).into_iter().enumerate().take(p + 1) {
                factors[spans[span].first - first + k] += scale * leading;
            }
        }
        Jump { first, factors }
    };
    (0..spans.len() - 1).map(at_knot).collect()
}

/// The penalty on the control points that take part.
#[derive(Debug, Clone)]
pub(crate) struct Penalty {
    jumps: [Vec<Jump>; 2],
    /// Per direction: first control point of a jump, and its number.
    places: [Vec<(usize, usize)>; 2],
    strides: [usize; 2],
}

impl Penalty {
    /// None takes part yet.
    pub(crate) fn new(patch: &Patch) -> Self {
        let strides = [1, patch.control_grid().stride];
        Self { jumps: [0, 1].map(|d| jumps(&patch.spaces[d])), places: [Vec::new(), Vec::new()], strides }
    }

    /// Takes those jumps whose control points are all marked.
    pub(crate) fn restrict(&mut self, grid: ControlGrid, marks: &[bool]) {
        let Self { jumps, places, strides } = self;
        for d in 0..2 {
            places[d].clear();
            let lines = if d == 0 { grid.rows } else { grid.columns };
            for line in 0..lines {
                for (number, jump) in jumps[d].iter().enumerate() {
                    let at = if d == 0 { grid.index(jump.first, line) } else { grid.index(line, jump.first) };
                    if (0..jump.factors.len()).all(|k| marks[at + k * strides[d]]) {
                        places[d].push((at, number));
                    }
                }
            }
        }
    }

    /// Adds `weight Jᵀ J` to a matrix with the pattern of splines one degree higher: inner knots are simple.
    pub(crate) fn add(&self, weight: f64, matrix: &mut Stencil) {
        let (grid, degree, row_length) = (matrix.grid, matrix.degree(), matrix.row_length());
        let coefficients = matrix.coefficients_mut();
        for d in 0..2 {
            for &(at, number) in &self.places[d] {
                let factors = &self.jumps[d][number].factors;
                for (k, a) in factors.iter().enumerate() {
                    let at = at + k * self.strides[d];
                    let row = grid.row_of(at);
                    let start = row * row_length + at - row * grid.stride;
                    for (apart, b) in factors[k..].iter().enumerate() {
                        let [columns, rows] = if d == 0 { [apart, 0] } else { [0, apart] };
                        let coupling = Stencil::offset_index(degree, columns as isize, rows);
                        coefficients[start + coupling * grid.stride] += weight * a * b;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::splines::spline::SplineSpace;

    #[test]
    fn jumps_are_binomial_on_equal_spans_and_vanish_for_polynomials_on_any() {
        let equal: Vec<f64> = [0.0; 3].into_iter().chain((1..8).map(f64::from)).chain([8.0; 3]).collect();
        let jump = &jumps(&SplineSpace::new(2, &equal))[3];
        for (factor, binomial) in jump.factors.iter().zip([-1.0, 3.0, -3.0, 1.0]) {
            assert!((factor - binomial).abs() <= 1e-13, "{:?}", jump.factors);
        }
        for degree in 1..=4 {
            let mut knots = vec![0.0; degree + 1];
            knots.extend([0.1, 0.15, 0.4, 0.6, 0.9]);
            knots.extend(vec![1.0; degree + 1]);
            let space = SplineSpace::new(degree, &knots);
            // The blossom of (x - 1/3)^p: its control values.
            let control = |i: usize| knots[i + 1..=i + degree].iter().map(|k| k - 1.0 / 3.0).product::<f64>();
            for Jump { first, factors } in jumps(&space) {
                let jump: f64 = factors.iter().enumerate().map(|(k, f)| f * control(first + k)).sum();
                assert!(jump.abs() <= 1e-11, "p = {degree}: {jump:e}");
            }
        }
    }
}
