//! Spline bases on random open knot vectors: partition of unity, linear precision, derivatives and
//! continuity.
//!
//! Knots come from a fixed linear congruential sequence, with span ratios up to 100. Continuity C^(p−1) at
//! the inner knots is measured on the values and first derivatives from both sides, relative to their size.

use fisura::splines::spline::SplineSpace;

use super::{Case, CaseScene, Findings, StudyError};
use crate::extremes::larger;
use crate::study::random::Random;

const KNOT_VECTORS: u64 = 20;
const SPANS: usize = 12;
const POINTS: usize = 50;

pub(super) fn study(_case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for degree in 1..=4 {
        let quantities = [
            ("partition of unity, largest error", None),
            ("linear precision, largest error", None),
            ("gradients, largest error times span length", None),
            ("continuity at inner knots, largest jump", None),
        ];
        findings.measure(&format!("p={degree}"), quantities, || {
            let mut worst = Worst::default();
            for seed in 0..KNOT_VECTORS {
                let space = SplineSpace::new(degree, &Random::scrambled(seed).knots(degree, SPANS, false));
                worst.look(&space);
            }
            Ok([worst.unity, worst.linear, worst.gradient, worst.jump])
        })?;
    }
    Ok(())
}

#[derive(Default)]
struct Worst {
    unity: f64,
    linear: f64,
    gradient: f64,
    jump: f64,
}

impl Worst {
    fn look(&mut self, space: &SplineSpace) {
        let greville = space.greville();
        let degree = space.degree();
        for (index, span) in space.spans().iter().enumerate() {
            for i in 0..=POINTS {
                let x = span.left + span.length() * i as f64 / POINTS as f64;
                let shape = space.shape_functions(index, x);
                let sum = |table: &[f64], factors: &dyn Fn(usize) -> f64| -> f64 {
                    (0..=degree).map(|k| table[k] * factors(k)).sum()
                };
                let control = |k: usize| greville[span.first + k];
                self.unity = larger(self.unity, (sum(&shape.value, &|_| 1.0) - 1.0).abs());
                self.linear = larger(self.linear, (sum(&shape.value, &control) - x).abs());
                self.gradient = larger(self.gradient, span.length() * sum(&shape.derivative, &|_| 1.0).abs());
                self.gradient = larger(self.gradient, span.length() * (sum(&shape.derivative, &control) - 1.0).abs());
            }
        }
        for index in 1..space.spans().len() {
            self.jump = larger(self.jump, jump_at_knot(space, index));
        }
    }
}

/// Largest jump of a value, and for p ≥ 2 of a first derivative times the shorter span, over the left knot of
/// a span.
fn jump_at_knot(space: &SplineSpace, index: usize) -> f64 {
    let (before, after) = (&space.spans()[index - 1], &space.spans()[index]);
    let degree = space.degree();
    let (left, right) = (space.shape_functions(index - 1, after.left), space.shape_functions(index, after.left));
    let shorter = before.length().min(after.length());
    let mut worst = 0.0_f64;
    for function in before.first..=after.first + degree {
        let at = |shape: &[f64], first: usize| {
            function.checked_sub(first).filter(|k| *k <= degree).map_or(0.0, |k| shape[k])
        };
        worst = larger(worst, (at(&left.value, before.first) - at(&right.value, after.first)).abs());
        if degree >= 2 {
            let jump = at(&left.derivative, before.first) - at(&right.derivative, after.first);
            worst = larger(worst, shorter * jump.abs());
        }
    }
    worst
}
