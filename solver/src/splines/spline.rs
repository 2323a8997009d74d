//! One-dimensional B-spline spaces on open knot vectors (E 13).
//!
//! On every non-empty knot span the `p + 1` basis functions that live there are kept as polynomials in the
//! local coordinate `t = (x − left)/(right − left)`, computed once by the Cox–de Boor recursion. An
//! evaluation is then one Horner scheme per function for any knots, uniform or not.

use std::ops::Range;

pub(crate) use crate::linear_algebra::control_grid::MAX_DEGREE;

/// Positions beyond an end of a patch by up to this fraction of its length are on it: an end at `0.1 + 0.7`
/// lies short of 0.8.
pub const ROUND_OFF: f64 = 1e-9;
/// Most basis functions on a span, `MAX_DEGREE + 1`.
pub(crate) const MAX_ORDER: usize = MAX_DEGREE + 1;
/// Most basis functions that do not vanish on an interval with one knot within it.
pub(crate) const MAX_REACH: usize = MAX_ORDER + 1;
/// Most shape functions at a point of a patch.
pub(crate) const MAX_FUNCTIONS: usize = MAX_ORDER * MAX_ORDER;

/// A non-empty knot span.
#[derive(Debug, Clone)]
pub struct Span {
    /// Left knot, m or unit of the knots.
    pub left: f64,
    /// Right knot, m or unit of the knots.
    pub right: f64,
    /// Index of the first of the `p + 1` basis functions on the span.
    pub first: usize,
    /// `polynomials[m][k + 1]`: coefficient of `t^m` of the basis function `first + k`; zeros around them.
    polynomials: [[f64; MAX_REACH + 1]; MAX_ORDER],
    /// What lies beyond either end.
    neighbours: [Neighbour; 2],
}

/// The span beyond an end of a span.
#[derive(Debug, Clone, Copy, Default)]
struct Neighbour {
    /// Its length, m or unit of the knots: zero beyond the ends of the space and beyond repeated knots.
    length: f64,
    /// How each basis function of both spans departs there from its polynomial in this span: by
    /// `kink |x − knot|^p` on the right, and by minus that on the left, so that slopes grow by
    /// `kink p |x − knot|^(p − 1)` on either side.
    kink: [f64; MAX_REACH],
}

impl Span {
    /// Length of the span, m or unit of the knots.
    pub fn length(&self) -> f64 {
        self.right - self.left
    }
}

/// Values and derivatives of the basis functions at a point; entries past the order are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeFunctions {
    /// Values of the functions.
    pub value: [f64; MAX_ORDER],
    /// Derivatives with respect to x, 1/m or 1/unit of the knots.
    pub derivative: [f64; MAX_ORDER],
}

/// Means of basis functions and of their derivatives over an interval; entries past the functions are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanFunctions {
    /// The first function: 0 is the one before the first of the span.
    pub start: usize,
    /// Means of the values.
    pub value: [f64; MAX_REACH],
    /// Means of the derivatives, 1/m or 1/unit of the knots, over the interval with its offset.
    pub derivative: [f64; MAX_REACH],
    /// Averages of the values at both ends, less the means, if they are asked for.
    pub ends_less_mean: [f64; MAX_REACH],
}

/// B-spline space of one direction.
#[derive(Debug, Clone)]
pub struct SplineSpace {
    degree: usize,
    knots: Vec<f64>,
    spans: Vec<Span>,
}

impl SplineSpace {
    /// Space of `degree` on an open knot vector (non-decreasing, end knots repeated `degree + 1` times), in
    /// metres.
    pub fn new(degree: usize, knots: &[f64]) -> Self {
        assert!((1..=MAX_DEGREE).contains(&degree), "degree 1 to {MAX_DEGREE}");
        assert!(knots.len() >= 2 * (degree + 1), "an open knot vector has at least 2 (p + 1) knots");
        let mut spans: Vec<Span> = (degree..knots.len() - degree - 1)
            .filter(|&i| knots[i + 1] > knots[i])
            .map(|i| Span {
                left: knots[i],
                right: knots[i + 1],
                first: i - degree,
                polynomials: span_polynomials(degree, knots, i),
                neighbours: [Neighbour::default(); 2],
            })
            .collect();
        for right in 1..spans.len() {
            let pair = [&spans[right - 1], &spans[right]];
            if pair[1].first == pair[0].first + 1 {
                let [beyond, before] = neighbours(degree, pair);
                spans[right - 1].neighbours[1] = beyond;
                spans[right].neighbours[0] = before;
            }
        }
        Self { degree, knots: knots.to_vec(), spans }
    }

    /// The space on some neighbouring spans alone: the same basis functions there, numbered from the first
    /// that lives on them.
    pub fn part(&self, spans: Range<usize>) -> Self {
        let (first, last) = (self.spans[spans.start].first, self.spans[spans.end - 1].first + self.degree);
        let shifted = self.spans[spans].iter().map(|span| Span { first: span.first - first, ..span.clone() });
        Self {
            degree: self.degree,
            knots: self.knots[first..=last + self.degree + 1].to_vec(),
            spans: shifted.collect(),
        }
    }

    /// Polynomial degree p.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Knot vector, m or unit of its own.
    pub fn knot_vector(&self) -> &[f64] {
        &self.knots
    }

    /// Number of basis functions.
    pub fn dimension(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Non-empty spans from left to right.
    pub fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// Number of the first function whose support holds `x`; `None` outside.
    pub(crate) fn first_function(&self, x: f64) -> Option<usize> {
        self.find_span(x).map(|span| self.spans[span].first)
    }

    /// Index of the span that holds `x`; the ends of the patch, and what lies beyond them by [`ROUND_OFF`],
    /// belong to the end spans. `None` outside.
    pub fn find_span(&self, x: f64) -> Option<usize> {
        let (left, right) = (self.spans.first()?.left, self.spans.last()?.right);
        let reach = ROUND_OFF * (right - left);
        if !(left - reach..=right + reach).contains(&x) {
            return None;
        }
        let index = self.spans.partition_point(|span| span.right <= x);
        Some(fault!("knot-span-off-by-one", index => index + 1).min(self.spans.len() - 1))
    }

    /// Shape functions at `x` (m), which should lie in `span`.
    #[inline]
    pub fn shape_functions(&self, span: usize, x: f64) -> ShapeFunctions {
        let span = &self.spans[span];
        let scale = 1.0 / span.length();
        let t = (x - span.left) * scale;
        let mut shape = ShapeFunctions { value: [0.0; MAX_ORDER], derivative: [0.0; MAX_ORDER] };
        for k in 0..=self.degree {
            let coefficient = |m: usize| span.polynomials[m][k + 1];
            let (mut value, mut slope) = (coefficient(self.degree), 0.0);
            for m in (0..self.degree).rev() {
                slope = slope * t + value;
                value = value * t + coefficient(m);
            }
            shape.value[k] = value;
            shape.derivative[k] = fault!("gradient-sign", slope * scale => -slope * scale);
        }
        shape
    }

    /// Means of the `order` = p + 1 functions of a span and the one beyond its nearer end over an interval
    /// around `x` (m), which should lie in `span`. The interval is shortened where it would reach beyond two
    /// spans, an end of the space or a repeated knot. Derivatives are means over an interval whose middle
    /// lies beside x by a small `offset` (m), to first order in that. Ends are looked at if `ENDS`.
    #[inline(always)]
    pub(crate) fn mean_functions<const ENDS: bool>(
        &self,
        span: usize,
        x: f64,
        [half_width, offset]: [f64; 2],
        order: usize,
    ) -> MeanFunctions {
        let span = &self.spans[span];
        let scale = 1.0 / span.length();
        let to_end = [x - span.left, span.right - x];
        let near = usize::from(to_end[1] < to_end[0]);
        let neighbour = &span.neighbours[near];
        let half_width = half_width.min(to_end[1 - near]).min(to_end[near] + neighbour.length);
        let (t, r) = (to_end[0] * scale, half_width * scale);
        let (tt, rr) = (t * t, r * r);
        // Means of the powers of the local coordinate, of their derivatives, and of the second ones times the
        // offset; by how much the average of both ends is more than the mean.
        let power = [1.0, t, tt + rr / 3.0, t * (tt + rr), tt * tt + 2.0 * tt * rr + rr * rr / 5.0];
        let slope = [0.0, scale, 2.0 * scale * t, scale * (3.0 * tt + rr), 4.0 * scale * t * (tt + rr)];
        let moved = offset * scale * scale;
        let bent = [0.0, 0.0, 2.0 * moved, 6.0 * moved * t, moved * (12.0 * tt + 4.0 * rr)];
        let ends = [0.0, 0.0, rr / 1.5, 2.0 * t * rr, 4.0 * tt * rr + 0.8 * rr * rr];
        let beyond = half_width - to_end[near];
        let reaches = fault!("domain-ends-at-the-knot", beyond > 0.0 => false);
        let before = reaches && near == 0;
        let sign = if before { -1.0 } else { 1.0 };
        let mut of_curve = if reaches { 0.5 / half_width } else { 0.0 };
        (2..order).for_each(|_| of_curve *= beyond);
        let of_slope = of_curve * beyond;
        let of_value = sign * beyond * of_slope / order as f64;
        let of_ends = sign * half_width * of_slope - of_value;
        let of_slope = of_slope + sign * offset * (order - 1) as f64 * of_curve;
        let start = usize::from(!before);
        let zeros = [0.0; MAX_REACH];
        let mut mean = MeanFunctions { start, value: zeros, derivative: zeros, ends_less_mean: zeros };
        for k in 0..=order {
            mean.value[k] = of_value * neighbour.kink[k];
            mean.derivative[k] = of_slope * neighbour.kink[k];
            mean.ends_less_mean[k] = if ENDS { of_ends * neighbour.kink[k] } else { 0.0 };
        }
        for m in 0..order {
            let coefficients = &span.polynomials[m][start..];
            for k in 0..=order {
                mean.value[k] += coefficients[k] * power[m];
                mean.derivative[k] += coefficients[k] * (slope[m] + bent[m]);
                if ENDS {
                    mean.ends_less_mean[k] += coefficients[k] * ends[m];
                }
            }
        }
        mean
    }

    /// Second derivatives (1/m²) of the shape functions at `x` (m), which should lie in `span`.
    #[inline]
    pub(crate) fn second_derivatives(&self, span: usize, x: f64) -> [f64; MAX_ORDER] {
        let span = &self.spans[span];
        let scale = 1.0 / span.length();
        let t = (x - span.left) * scale;
        let mut second = [0.0; MAX_ORDER];
        for k in 0..=self.degree {
            for m in (2..=self.degree).rev() {
                second[k] = second[k] * t + (m * (m - 1)) as f64 * span.polynomials[m][k + 1];
            }
            second[k] *= scale * scale;
        }
        second
    }

    /// `Σ N_I (x_I − x)²` of the Greville abscissae at any x on a span as long as its neighbours, m².
    #[inline(always)]
    pub(crate) fn spread(&self, span: usize) -> f64 {
        let length = self.spans[span].length();
        (self.degree + 1) as f64 / 12.0 * length * length
    }

    /// Greville abscissae, in the unit of the knots: the control values of the function x.
    pub fn greville(&self) -> Vec<f64> {
        let first = fault!("greville-a-knot-early", 1 => 0);
        (0..self.dimension())
            .map(|i| self.knots[i + first..i + first + self.degree].iter().sum::<f64>() / self.degree as f64)
            .collect()
    }
}

/// What lies beyond the knot between two spans, for the left and for the right one.
fn neighbours(degree: usize, [left, right]: [&Span; 2]) -> [Neighbour; 2] {
    let highest = |span: &Span, k: usize| span.polynomials[degree][k + 1] / span.length().powi(degree as i32);
    let mut kink = [0.0; MAX_REACH];
    for k in 0..=degree {
        kink[k] -= highest(left, k);
        kink[k + 1] += highest(right, k);
    }
    let sign = if degree.is_multiple_of(2) { 1.0 } else { -1.0 };
    let before = Neighbour { length: left.length(), kink: kink.map(|k| sign * k) };
    [Neighbour { length: right.length(), kink }, before]
}

/// Cox–de Boor on polynomials of the local coordinate of the span `[knots[i], knots[i + 1])`.
fn span_polynomials(degree: usize, knots: &[f64], i: usize) -> [[f64; MAX_REACH + 1]; MAX_ORDER] {
    let (left, length) = (knots[i], knots[i + 1] - knots[i]);
    let mut basis = [[0.0; MAX_ORDER]; MAX_ORDER];
    basis[0][0] = 1.0;
    for q in 1..=degree {
        let mut next = [[0.0; MAX_ORDER]; MAX_ORDER];
        // basis[k] is N_{i − q + 1 + k, q − 1}; each feeds N_{·, q} of the same index (rising) and the one
        // before (falling).
        for k in 0..q {
            let start = knots[i + 1 + k - q];
            let end = knots[i + 1 + k];
            let width = end - start;
            for m in 0..q {
                let c = basis[k][m] / width;
                next[k + 1][m] += c * (left - start);
                next[k + 1][m + 1] += c * length;
                next[k][m] += c * (end - left);
                next[k][m + 1] -= c * length;
            }
        }
        basis = next;
    }
    let mut polynomials = [[0.0; MAX_REACH + 1]; MAX_ORDER];
    for (k, coefficients) in basis.iter().enumerate() {
        for (m, coefficient) in coefficients.iter().enumerate() {
            polynomials[m][k + 1] = *coefficient;
        }
    }
    polynomials
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    fn graded(degree: usize) -> SplineSpace {
        let mut knots = vec![0.0; degree + 1];
        knots.extend([0.1, 0.15, 0.4, 0.4, 0.9]);
        knots.extend(vec![1.0; degree + 1]);
        SplineSpace::new(degree, &knots)
    }

    #[test]
    fn second_derivatives_are_the_slopes_of_the_first() {
        for degree in 2..=4 {
            let space = graded(degree);
            for n in 0..=1000 {
                let (x, step) = (n as f64 / 1000.0, 1e-6);
                let span = space.find_span(x).unwrap();
                let second = space.second_derivatives(span, x);
                let [before, beyond] = [-step, step].map(|step| space.shape_functions(span, x + step));
                for k in 0..=degree {
                    let difference = (beyond.derivative[k] - before.derivative[k]) / (2.0 * step);
                    assert_abs_diff_eq!(second[k], difference, epsilon = 1e-3 * (1.0 + second[k].abs()));
                }
            }
        }
    }

    #[test]
    fn means_are_those_of_many_points() {
        const MANY: usize = 2000;
        for degree in 1..=4 {
            let space = graded(degree);
            for (x, half_width) in [(0.02, 0.01), (0.11, 0.04), (0.148, 0.01), (0.3, 0.1), (0.42, 0.3), (0.89, 0.05)] {
                let span = space.find_span(x).unwrap();
                let mean = space.mean_functions::<false>(span, x, [half_width, 0.0], degree + 1);
                let (mut value, mut slope) = ([0.0; 16], [0.0; 16]);
                let to_end = [x - space.spans()[span].left, space.spans()[span].right - x];
                let (near, far) = (to_end[0].min(to_end[1]), to_end[0].max(to_end[1]));
                // A repeated knot at 0.4 ends the third span and begins the fourth.
                let beside_repeated = (to_end[0] > to_end[1] && span == 2) || (to_end[0] < to_end[1] && span == 3);
                let half_width = f64::min(half_width, if beside_repeated { near } else { far });
                for n in 0..MANY {
                    let y = x + half_width * ((2 * n + 1) as f64 / MANY as f64 - 1.0);
                    let span = space.find_span(y).unwrap();
                    let (shape, first) = (space.shape_functions(span, y), space.spans()[span].first);
                    for k in 0..=degree {
                        value[first + k] += shape.value[k] / MANY as f64;
                        slope[first + k] += shape.derivative[k] / MANY as f64;
                    }
                }
                let first = space.spans()[span].first + mean.start;
                for k in (0..=degree + 1).filter(|k| first + k > 0) {
                    let at = first + k - 1;
                    assert_abs_diff_eq!(mean.value[k], value[at], epsilon = 1e-4);
                    assert_abs_diff_eq!(mean.derivative[k], slope[at], epsilon = 2e-2);
                }
                assert_abs_diff_eq!(mean.value.iter().sum::<f64>(), 1.0, epsilon = 1e-14);
            }
        }
    }

    #[test]
    fn the_quadratic_uniform_basis_has_its_textbook_values() {
        let space = SplineSpace::new(2, &[0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0, 5.0]);
        let shape = space.shape_functions(2, 2.5);
        for (value, expected) in shape.value.iter().zip([0.125, 0.75, 0.125, 0.0, 0.0]) {
            assert_abs_diff_eq!(*value, expected, epsilon = 1e-15);
        }
        assert_eq!(space.dimension(), 7);
        assert_eq!(space.spans()[2].first, 2);
    }

    #[test]
    fn the_ends_belong_to_the_patch_and_beyond_does_not() {
        let space = graded(3);
        assert_eq!(space.find_span(0.0), Some(0));
        assert_eq!(space.find_span(1.0), Some(space.spans().len() - 1));
        assert_eq!(space.find_span(-1e-10), Some(0), "but for round-off");
        assert_eq!(space.find_span(1.0 + 1e-10), Some(space.spans().len() - 1), "but for round-off");
        assert_eq!(space.find_span(1.0 + 1e-8), None);
        assert_eq!(space.find_span(f64::NAN), None);
    }
}
