//! A random critical energy release rate over its mean, as a function of place alone: neither the mesh nor
//! the points enter.
//!
//! ```text
//! r = [−ln(1 − Φ(g))]^(1/m)/Γ(1 + 1/m)                 Weibull with modulus m and mean 1
//! g = Σ_k w_k ξ_k/(Σ_k w_k²)^½,  w_k = exp(−2 |x − x_k|²/ℓ²)
//! ```
//!
//! The ξ_k are independent and standard normal, at the corners x_k of a lattice of spacing ℓ/2 about the
//! origin; so is g at every place, with the correlation `exp(−d²/ℓ²)` at the distance d.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use crate::scene::RandomToughness;

/// Corners per correlation length.
const PER_LENGTH: f64 = 2.0;
/// Corners on either side whose weight counts: exp(−12.5) is left out.
const REACH: i64 = 5;

/// A random field of the critical energy release rate over its mean.
#[derive(Debug, Clone, Copy)]
pub struct RandomField {
    random: RandomToughness,
    /// Scale `1/Γ(1 + 1/m)` of the Weibull distribution, with which the mean is 1.
    scale: f64,
}

impl RandomField {
    /// The sample of a scene.
    pub fn new(random: RandomToughness) -> Self {
        Self { random, scale: libm::tgamma(1.0 + 1.0 / random.modulus).recip() }
    }

    /// Toughness over its mean at a place (m).
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let normal = self.normal(place);
        let exceeded = if normal < 0.0 {
            -(-0.5 * libm::erfc(-normal * FRAC_1_SQRT_2)).ln_1p()
        } else {
            -(0.5 * libm::erfc(normal * FRAC_1_SQRT_2)).ln()
        };
        exceeded.powf(self.random.modulus.recip()) * self.scale
    }

    /// Value g of the Gaussian field at a place, of variance one.
    fn normal(&self, place: [f64; 2]) -> f64 {
        let [x, y] = place.map(|x| x / self.random.correlation * PER_LENGTH);
        let [column, row] = [x, y].map(|x| x.round() as i64);
        let (mut sum, mut squares) = (0.0, 0.0);
        for j in row - REACH..=row + REACH {
            for i in column - REACH..=column + REACH {
                let squared = (x - i as f64).powi(2) + (y - j as f64).powi(2);
                let weight = (-2.0 / (PER_LENGTH * PER_LENGTH) * squared).exp();
                sum += weight * self.corner(i, j);
                squares += weight * weight;
            }
        }
        sum / squares.sqrt()
    }

    /// ξ of a corner, by the transform of Box and Muller.
    fn corner(&self, column: i64, row: i64) -> f64 {
        let of_corner = scrambled(scrambled(self.random.seed ^ scrambled(column as u64)) ^ scrambled(!(row as u64)));
        let uniform = |bits: u64| ((bits >> 11) as f64 + 0.5) / (1u64 << 53) as f64;
        let (radius, angle) = (uniform(of_corner), uniform(scrambled(of_corner)));
        (-2.0 * radius.ln()).sqrt() * (TAU * angle).cos()
    }
}

/// A step of SplitMix64 (Steele, Lea, Flood 2014): bits without visible relation to those given.
fn scrambled(bits: u64) -> u64 {
    let mut z = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear_algebra::extremes::larger;

    fn field(modulus: f64, seed: u64) -> RandomField {
        RandomField::new(RandomToughness { modulus, correlation: 1.0, seed })
    }

    /// Places three correlation lengths apart: next to independent (exp(−9)).
    fn places() -> impl Iterator<Item = [f64; 2]> {
        (0..100).flat_map(|i| (0..100).map(move |j| [f64::from(3 * i) + 0.27, f64::from(3 * j) - 130.61]))
    }

    /// Kolmogorov and Smirnov: 1.95/sqrt(n) is exceeded once in a thousand samples.
    #[test]
    fn the_distribution_is_that_of_weibull_with_mean_one() {
        for (modulus, seed) in [(2.0, 1), (2.0, 77), (8.0, 3), (0.9, 4)] {
            let field = field(modulus, seed);
            let mut values: Vec<f64> = places().map(|place| field.at(place)).collect();
            values.sort_by(f64::total_cmp);
            let n = values.len() as f64;
            let unit = libm::tgamma(1.0 + 1.0 / modulus);
            let distance =
                |(k, r): (usize, &f64)| (1.0 - (-(r * unit).powf(modulus)).exp() - (k as f64 + 0.5) / n).abs();
            let largest = values.iter().enumerate().map(distance).fold(0.0, larger);
            assert!(largest < 1.95 / n.sqrt(), "modulus {modulus}, seed {seed}: {largest}");
        }
    }

    #[test]
    fn the_correlation_falls_with_the_length_in_every_direction() {
        let field = field(2.0, 5);
        for distance in [0.5, 1.0, 1.7] {
            for angle in [0.0, 0.5, 1.2] {
                let other = |[x, y]: [f64; 2]| [x + distance * f64::cos(angle), y + distance * f64::sin(angle)];
                let products: Vec<f64> = places().map(|p| field.normal(p) * field.normal(other(p))).collect();
                let found = products.iter().sum::<f64>() / products.len() as f64;
                let expected = (-distance * distance).exp();
                assert!((found - expected).abs() < 0.045, "{distance}, {angle}: {found} instead of {expected}");
            }
        }
    }

    #[test]
    fn seeds_give_independent_samples() {
        let [one, two] = [field(2.0, 1), field(2.0, 2)];
        let products: Vec<f64> = places().map(|p| one.normal(p) * two.normal(p)).collect();
        assert!((products.iter().sum::<f64>() / products.len() as f64).abs() < 0.04);
        assert_eq!(one.at([0.3, 0.4]), field(2.0, 1).at([0.3, 0.4]));
    }
}
