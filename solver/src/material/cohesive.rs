//! Degradation of a cohesive crack (Wu 2017): with d = 1 − c
//!
//! ```text
//! g(c) = c^p/(c^p + a1 d (1 + a2 d + a2 a3 d²)),      a1 = 2 E Gc/(π l0 ft²)
//! ```
//!
//! A bar is elastic up to the tensile strength ft, whatever l0 is. The numbers p, a2 and a3 choose how its
//! stress falls with the opening of the crack.

use crate::linear_algebra::lane::Lane;
use crate::scene::Softening;

/// Constants of the degradation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cohesive {
    /// Exponent p of `c^p`: 5/2 for exponential softening, else 2.
    power: f64,
    /// a1, a1 a2 and a1 a2 a3.
    series: [f64; 3],
}

impl Cohesive {
    /// A law of softening with a value of a1.
    pub fn new(softening: Softening, a1: f64) -> Self {
        let (power, a2, a3) = match softening {
            Softening::Linear => (2.0, fault!("softening-not-linear", -0.5 => 0.0), 0.0),
            Softening::Exponential => (2.5, 2f64.powf(5.0 / 3.0) - 3.0, 0.0),
            Softening::Cornelissen => (2.0, 1.3868, fault!("cornelissen-without-a3", 0.6567 => 0.0)),
        };
        Self { power, series: [a1, a1 * a2, a1 * a2 * a3] }
    }

    /// Smallest a1 with which a uniform state is stable at its onset, `a2 + p + 1/2`.
    pub fn stable_from(&self) -> f64 {
        self.series[1] / self.series[0] + self.power + 0.5
    }

    /// First coefficient a1 of the denominator of g.
    pub fn a1(&self) -> f64 {
        self.series[0]
    }

    /// Degradation g of the stiffness at a phase field c.
    #[inline(always)]
    pub fn degradation(&self, phase: Lane) -> Lane {
        let [whole, lost] = [self.powers(phase)[0], self.lost(phase)[0]];
        whole.zip(whole + lost, |whole, all| whole / all)
    }

    /// Slope dg/dc at a phase field c.
    #[inline(always)]
    pub fn slope(&self, phase: Lane) -> Lane {
        let ([whole, first, _], [lost, fall, _]) = (self.powers(phase), self.lost(phase));
        let all = whole + lost;
        (first * lost - whole * fall).zip(all * all, |a, b| a / b)
    }

    /// Curvature d²g/dc² at a phase field c.
    #[inline(always)]
    pub fn curvature(&self, phase: Lane) -> Lane {
        let ([whole, first, second], [lost, fall, bend]) = (self.powers(phase), self.lost(phase));
        let all = whole + lost;
        let part = (second * lost - whole * bend).zip(all * all, |a, b| a / b);
        let rest = ((first * lost - whole * fall) * (first + fall)).zip(all * all * all, |a, b| a / b);
        part - rest * 2.0
    }

    /// `c^p` and its first two derivatives.
    #[inline(always)]
    fn powers(&self, phase: Lane) -> [Lane; 3] {
        let c = phase.at_least(Lane::ZERO);
        let p = self.power;
        let scale = if p == 2.0 { Lane::splat(1.0) } else { c.map(f64::sqrt) };
        [scale * c * c, scale * c * p, scale * (p * (p - 1.0))]
    }

    /// `a1 d (1 + a2 d + a2 a3 d²)` and its first two derivatives by c.
    #[inline(always)]
    fn lost(&self, phase: Lane) -> [Lane; 3] {
        let d = Lane::splat(1.0) - phase;
        let [a, b, c] = self.series.map(Lane::splat);
        let fall = a + d * (b * 2.0 + d * c * 3.0);
        [d * (a + d * (b + d * c)), Lane::ZERO - fall, b * 2.0 + d * c * 6.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slopes are those of the values, and intact material loses a1 times its damage.
    #[test]
    fn slopes_are_derivatives() {
        for softening in [Softening::Linear, Softening::Exponential, Softening::Cornelissen] {
            let law = Cohesive::new(softening, 4.3);
            for c in [0.02, 0.3, 0.71, 0.99] {
                let at = |f: &dyn Fn(Lane) -> Lane, c: f64| f(Lane::splat(c))[0];
                let step = 1e-6;
                let by_difference = |f: &dyn Fn(Lane) -> Lane| (at(f, c + step) - at(f, c - step)) / (2.0 * step);
                let slope = by_difference(&|c| law.degradation(c));
                let curvature = by_difference(&|c| law.slope(c));
                assert!((at(&|c| law.slope(c), c) - slope).abs() < 1e-8, "{softening:?}, c = {c}");
                assert!((at(&|c| law.curvature(c), c) - curvature).abs() < 1e-7, "{softening:?}, c = {c}");
            }
            assert_eq!(law.degradation(Lane::splat(1.0))[0], 1.0);
            assert_eq!(law.degradation(Lane::ZERO)[0], 0.0);
            assert!((law.slope(Lane::splat(1.0))[0] - 4.3).abs() < 1e-14);
            let onset = law.curvature(Lane::splat(1.0))[0] / law.slope(Lane::splat(1.0))[0];
            assert!((onset - (2.0 * 4.3 - 2.0 * law.stable_from() + 1.0)).abs() < 1e-13, "{softening:?}: {onset}");
        }
    }
}
