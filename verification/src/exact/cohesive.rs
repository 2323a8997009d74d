//! The law of a cohesive crack (Wu 2017), in numbers of its own. With d = 1 − c and P of the softening
//!
//! ```text
//! g = c^p/(c^p + a1 d P(d)),     P = 1 + a2 d + a2 a3 d²,     a1 = 2 E Gc/(π l0 ft²)
//! ```
//!
//! In the localised solution of a slender bar with the stress s and the largest damage d* in the middle
//!
//! ```text
//! s = ft √((2 − d*) (1 − d*)^p/(2 P(d*))),     w = 2 s/E ∫ (1/g − 1)/|d'| dd from 0 to d*
//! b² d'² = 2 d − d² − π b s²/(2 E Gc) (1/g − 1),     b = 2 l0
//! ```
//!
//! The opening w is what the bar is longer than its stress makes it. Linear softening is `s = ft (1 − w ft/(2
//! Gc))`, whatever l0 is.

use std::f64::consts::{FRAC_2_PI, PI};

use fisura::scene::{CrackModel, Material, Softening};

/// Points of the integral of the opening, and of the curve.
const INTEGRAL: usize = 2000;
const CURVE: usize = 400;

/// Constants of the law.
#[derive(Debug, Clone, Copy)]
pub struct CohesiveLaw {
    power: f64,
    a: [f64; 3],
}

impl CohesiveLaw {
    /// That of a material.
    pub fn of(material: &Material) -> Option<Self> {
        let fracture = material.fracture.as_ref()?;
        let CrackModel::PfCzm { tensile_strength, softening } = fracture.model else { return None };
        let (power, a2, a3) = match softening {
            Softening::Linear => (2.0, -0.5, 0.0),
            Softening::Exponential => (2.5, 0.174_802_103_936_398_8, 0.0), // 2^(5/3) − 3
            Softening::Cornelissen => (2.0, 1.3868, 0.6567),
        };
        let characteristic = material.young_modulus * fracture.critical_energy_release_rate / tensile_strength.powi(2);
        Some(Self { power, a: [FRAC_2_PI * characteristic / fracture.length_scale, a2, a3] })
    }

    /// g and dg/dc, by way of `1/g = 1 + a1 (d + a2 d² + a2 a3 d³) c^-p`.
    pub fn degradation(&self, c: f64) -> [f64; 2] {
        let Self { power, a: [a1, a2, a3] } = *self;
        let d = 1.0 - c;
        let [series, fall] = [d * (1.0 + a2 * d * (1.0 + a3 * d)), 1.0 + a2 * d * (2.0 + 3.0 * a3 * d)];
        let compliance = 1.0 + a1 * series * c.powf(-power);
        let slope = -a1 * c.powf(-power) * (fall + power * series / c);
        [1.0 / compliance, -slope / (compliance * compliance)]
    }

    /// Opening at which nothing is transmitted any more, over Gc/ft; with exponential softening next to
    /// nothing.
    pub fn furthest(&self) -> f64 {
        match self.a[1] {
            a2 if a2 < 0.0 => 2.0,
            a2 if a2 < 1.0 => 6.0,
            _ => 5.1361,
        }
    }

    /// Stress over ft in the localised solution with a largest damage d*.
    pub fn stress(&self, largest: f64) -> f64 {
        let Self { power, a: [_, a2, a3] } = *self;
        let series = 1.0 + a2 * largest * (1.0 + a3 * largest);
        ((2.0 - largest) * (1.0 - largest).powf(power) / (2.0 * series)).sqrt()
    }

    /// Opening over Gc/ft and stress over ft for growing d*.
    pub fn softening(&self) -> Vec<[f64; 2]> {
        let a1 = self.a[0];
        let of = |largest: f64| {
            let squared = self.stress(largest).powi(2);
            // with d = d* (1 − s²) the integrand is smooth at d*; E, Gc and ft are in a1
            let integrand = |n: usize| {
                let s = (n as f64 + 0.5) / INTEGRAL as f64;
                let d = largest * (1.0 - s * s);
                let excess = 1.0 / self.degradation(1.0 - d)[0] - 1.0;
                let slope = (2.0 * d - d * d - 2.0 * squared / a1 * excess).max(0.0).sqrt();
                excess / slope * 2.0 * largest * s / INTEGRAL as f64
            };
            // w ft/Gc = 2 s b ft/(E Gc) ∫ …, and b ft²/(E Gc) = 4/(π a1)
            let opening = 8.0 / (PI * a1) * squared.sqrt() * (0..INTEGRAL).map(integrand).sum::<f64>();
            [opening, squared.sqrt()]
        };
        (0..CURVE)
            .map(|n| if n == 0 { [0.0, 1.0] } else { of(1.0 - (1.0 - n as f64 / CURVE as f64).powi(2)) })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_linear_law_is_linear() {
        for a1 in [2.0, 4.0, 15.0] {
            let law = CohesiveLaw { power: 2.0, a: [a1, -0.5, 0.0] };
            for [opening, stress] in law.softening() {
                assert!((stress - (1.0 - 0.5 * opening)).abs() < 1e-4, "a1 = {a1}: {stress} at {opening}");
            }
        }
    }
}
