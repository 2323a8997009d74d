//! A linear congruential sequence: the same numbers on every machine.

/// Numbers drawn one after the other.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// The sequence after the state `state`.
    pub fn new(state: u64) -> Self {
        Self(state)
    }

    /// A sequence that has nothing in common with those of neighbouring seeds.
    pub fn scrambled(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1))
    }

    /// A number on [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number on [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Open knots on [0, 1] with spans between 1 and 100 in arbitrary units; if `repeated`, every third inner
    /// knot up to p times.
    pub fn knots(&mut self, degree: usize, spans: usize, repeated: bool) -> Vec<f64> {
        let lengths: Vec<f64> = (0..spans).map(|_| 100f64.powf(self.unit())).collect();
        let total: f64 = lengths.iter().sum();
        let mut knots = vec![0.0; degree + 1];
        let mut position = 0.0;
        for (i, length) in lengths[..spans - 1].iter().enumerate() {
            position += length / total;
            let times = if repeated && i % 3 == 2 { 1 + (self.unit() * degree as f64) as usize } else { 1 };
            knots.extend(vec![position; times]);
        }
        knots.extend(vec![1.0; degree + 1]);
        knots
    }
}
