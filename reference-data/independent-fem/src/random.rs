//! The random toughness of fisura, from its description: Weibull by a field that is Gaussian and correlated.

use std::f64::consts::{PI, SQRT_2};

/// A sample.
#[derive(Debug, Clone, Copy)]
pub struct Toughness {
    /// Modulus of Weibull.
    pub modulus: f64,
    /// Length of correlation, m.
    pub correlation: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Toughness {
    /// Toughness over its mean.
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let [u, v] = place.map(|x| 2.0 * x / self.correlation);
        let (mut total, mut squares) = (0.0, 0.0);
        for j in (v.round() as i64 - 6)..=(v.round() as i64 + 6) {
            for i in (u.round() as i64 - 6)..=(u.round() as i64 + 6) {
                let weight = (-0.5 * ((u - i as f64).powi(2) + (v - j as f64).powi(2))).exp();
                total += weight * self.corner(i, j);
                squares += weight * weight;
            }
        }
        let below = 0.5 * libm::erfc(total / (SQRT_2 * f64::sqrt(squares)));
        (-below.ln()).powf(1.0 / self.modulus) / libm::tgamma(1.0 + 1.0 / self.modulus)
    }

    /// The normal number of a corner of the lattice, by Box and Muller.
    fn corner(&self, column: i64, row: i64) -> f64 {
        let bits = scrambled(scrambled(self.seed ^ scrambled(column as u64)) ^ scrambled(!(row as u64)));
        let [first, second] = [bits, scrambled(bits)].map(|b| ((b >> 11) as f64 + 0.5) / (1u64 << 53) as f64);
        (-2.0 * first.ln()).sqrt() * (2.0 * PI * second).cos()
    }
}

/// A step of SplitMix64 (Steele, Lea, Flood 2014).
fn scrambled(bits: u64) -> u64 {
    let z = bits.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
