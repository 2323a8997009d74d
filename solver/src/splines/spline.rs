//! One-dimensional B-spline spaces on open knot vectors (E 13).
//!
//! On every non-empty knot span the `p + 1` basis functions that live there are kept as polynomials in the
//! local coordinate `t = (x − left)/(right − left)`, computed once by the Cox–de Boor recursion. An
//! evaluation is then one Horner scheme per function for any knots, uniform or not.

use std::ops::Range;

/// Highest polynomial degree.
pub(crate) const MAX_DEGREE: usize = 4;
/// Positions beyond an end of a patch by up to this fraction of its length are on it: an end at `0.1 + 0.7`
/// lies short of 0.8.
pub const ROUND_OFF: f64 = 1e-9;
/// Most basis functions on a span, `MAX_DEGREE + 1`.
pub(crate) const MAX_ORDER: usize = MAX_DEGREE + 1;
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
    /// `polynomials[k][m]`: coefficient of `t^m` of the basis function `first + k`.
    polynomials: [[f64; MAX_ORDER]; MAX_ORDER],
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
    /// Values.
    pub value: [f64; MAX_ORDER],
    /// Derivatives with respect to x, 1/m or 1/unit of the knots.
    pub derivative: [f64; MAX_ORDER],
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
        let spans = (degree..knots.len() - degree - 1)
            .filter(|&i| knots[i + 1] > knots[i])
            .map(|i| Span {
                left: knots[i],
                right: knots[i + 1],
                first: i - degree,
                polynomials: span_polynomials(degree, knots, i),
            })
            .collect();
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
            let polynomial = &span.polynomials[k];
            let (mut value, mut slope) = (polynomial[self.degree], 0.0);
            for m in (0..self.degree).rev() {
                slope = slope * t + value;
                value = value * t + polynomial[m];
            }
            shape.value[k] = value;
            shape.derivative[k] = fault!("gradient-sign", slope * scale => -slope * scale);
        }
        shape
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
                second[k] = second[k] * t + (m * (m - 1)) as f64 * span.polynomials[k][m];
            }
            second[k] *= scale * scale;
        }
        second
    }

    /// Greville abscissae, in the unit of the knots: the control values of the function x.
    pub fn greville(&self) -> Vec<f64> {
        let first = fault!("greville-a-knot-early", 1 => 0);
        (0..self.dimension())
            .map(|i| self.knots[i + first..i + first + self.degree].iter().sum::<f64>() / self.degree as f64)
            .collect()
    }
}

/// Cox–de Boor on polynomials of the local coordinate of the span `[knots[i], knots[i + 1])`.
fn span_polynomials(degree: usize, knots: &[f64], i: usize) -> [[f64; MAX_ORDER]; MAX_ORDER] {
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
    basis
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
