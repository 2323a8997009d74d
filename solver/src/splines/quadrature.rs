//! Positions and weights of material points in a span: the layouts.
//!
//! A rule is given on [0, 1] with weights that sum to one. Gauss–Legendre points make the point sums exact
//! for polynomials of degree `2 n − 1`; equally spaced points with Maclaurin weights for degree `n` (odd n)
//! or `n − 1`; equally spaced points of equal volume only for degree one.

use crate::scene::Layout;

/// Most points per span and direction.
pub const MAX_POINTS: usize = 16;

/// Points and weights on [0, 1].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rule {
    /// Positions in [0, 1], increasing.
    pub points: Vec<f64>,
    /// Weights, summing to one.
    pub weights: Vec<f64>,
}

impl Rule {
    /// The rule of `layout` with `n` points.
    ///
    /// # Panics
    /// If `n` is zero, above [`MAX_POINTS`], or above 5 for Maclaurin weights; validation refuses such
    /// scenes.
    pub fn new(layout: Layout, n: usize) -> Self {
        assert!((1..=MAX_POINTS).contains(&n), "1 to {MAX_POINTS} points per span");
        let rule = match layout {
            Layout::Gauss => gauss_legendre(n),
            Layout::Uniform => equally_spaced(vec![1.0 / n as f64; n]),
            Layout::Maclaurin => equally_spaced(maclaurin_weights(n)),
        };
        fault!("volumes-off-by-a-layer", rule => Rule { weights: [&rule.weights[1..], &rule.weights[..1]].concat(), ..rule })
    }

    /// Positions and weights between two ends.
    pub(crate) fn between(&self, left: f64, right: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let length = right - left;
        self.points.iter().zip(&self.weights).map(move |(t, w)| (left + t * length, w * length))
    }
}

fn equally_spaced(weights: Vec<f64>) -> Rule {
    let n = weights.len();
    Rule { points: (0..n).map(|i| (i as f64 + 0.5) / n as f64).collect(), weights }
}

/// Open Newton–Cotes weights at the midpoints of n equal parts.
fn maclaurin_weights(n: usize) -> Vec<f64> {
    let (numerators, denominator): (&[f64], f64) = match n {
        1 => (&[1.0], 1.0),
        2 => (&[1.0, 1.0], 2.0),
        3 => (&[3.0, 2.0, 3.0], 8.0),
        4 => (&[13.0, 11.0, 11.0, 13.0], 48.0),
        5 => (&[275.0, 100.0, 402.0, 100.0, 275.0], 1152.0),
        _ => panic!("Maclaurin weights are tabulated for 1 to 5 points"),
    };
    numerators.iter().map(|w| w / denominator).collect()
}

/// Gauss–Legendre points by Newton's method on the Legendre polynomial.
fn gauss_legendre(n: usize) -> Rule {
    let mut rule = Rule { points: vec![0.0; n], weights: vec![0.0; n] };
    for i in 0..n {
        let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..100 {
            let (value, derivative) = legendre(n, x);
            slope = derivative;
            let step = value / derivative;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        rule.points[i] = 0.5 * (1.0 + x);
        rule.weights[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
    rule
}

/// Legendre polynomial of degree n and its derivative.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k);
    }
    (value, n as f64 * (x * value - previous) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    fn moment(rule: &Rule, m: i32) -> f64 {
        rule.points.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(m)).sum()
    }

    #[test]
    fn each_layout_integrates_what_it_should() {
        let exact = |layout, n| match layout {
            Layout::Gauss => 2 * n as i32 - 1,
            Layout::Uniform => 1,
            Layout::Maclaurin => n as i32 - 1 + (n % 2) as i32,
        };
        for (layout, most) in [(Layout::Gauss, MAX_POINTS), (Layout::Uniform, 8), (Layout::Maclaurin, 5)] {
            for n in 1..=most {
                let rule = Rule::new(layout, n);
                for m in 0..=exact(layout, n) {
                    assert_abs_diff_eq!(moment(&rule, m), 1.0 / f64::from(m + 1), epsilon = 1e-14);
                }
            }
        }
    }
}
