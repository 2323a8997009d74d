//! How the critical energy release rate varies: with the direction of a crack, and from place to place.

/// A critical energy release rate that depends on the direction of the crack: `Gc sqrt(n · A n)` with the
/// unit normal n of the crack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anisotropy {
    /// A in axes of its own, symmetric and positive definite.
    pub tensor: [[f64; 2]; 2],
    /// Angle of these axes to those of the scene, anticlockwise, rad.
    pub angle: f64,
}

impl Anisotropy {
    /// A of isotropic material, as [`Self::components`].
    pub const NONE: [f64; 3] = [1.0, 1.0, 0.0];

    /// `[A_xx, A_yy, A_xy]` in the axes of the scene.
    pub fn components(&self) -> [f64; 3] {
        let [[xx, xy], [_, yy]] = self.tensor;
        let (sin, cos) = fault!("tensor-turned-back", self.angle => -self.angle).sin_cos();
        let shear = 2.0 * sin * cos * xy;
        [
            cos * cos * xx + sin * sin * yy - shear,
            sin * sin * xx + cos * cos * yy + shear,
            sin * cos * (xx - yy) + (cos * cos - sin * sin) * xy,
        ]
    }

    /// The smaller principal value of A.
    pub fn smallest(&self) -> f64 {
        let [[xx, xy], [_, yy]] = self.tensor;
        0.5 * (xx + yy) - (0.5 * (xx - yy)).hypot(xy)
    }
}

/// A random critical energy release rate with the distribution of Weibull and the mean Gc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomToughness {
    /// Modulus of Weibull; the larger, the less it varies.
    pub modulus: f64,
    /// Distance at which the correlation of the underlying normal field is 1/e, m.
    pub correlation: f64,
    /// Seed: another one gives another sample.
    pub seed: u64,
}
