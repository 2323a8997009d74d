//! Stress laws on fields that know their derivatives: the divergence of the stress follows without another
//! formula.
//!
//! Linear elasticity: `sigma = lam* tr(e) I + 2 mu e` with `e = sym(grad u)`.
//!
//! Hencky: `tau = lam* tr(e) I + 2 mu e` with `e = ½ ln B`, `B = F Fᵀ`, `F = I + grad u`, and `P = tau F⁻ᵀ`.
//! The logarithm of the 2×2 tensor needs no eigenvectors. With `m = tr B/2`, the deviator `D = B − m I` and
//! `z = (D:D)/(2 m²)`, the principal values of B are `m (1 ± sqrt z)`, and
//!
//! ```text
//! e = ¼ ln(det B) I + φ(z)/(2 m) D,      φ(z) = artanh(sqrt z)/sqrt z = 1 + z/3 + z²/5 + …
//! ```
//!
//! which is smooth where the principal values meet (z = 0). Moduli per plane state: [`ElasticModuli`].

use fisura::material::elasticity::ElasticModuli;

use super::dual::{Field, Scalar};

/// A 2×2 tensor that varies in space and time.
pub type Tensor = [[Field; 2]; 2];

/// First Piola–Kirchhoff stress, Pa, from the displacement gradient.
pub type Law = fn(&ElasticModuli, Tensor) -> Tensor;

/// Cauchy stress of linear elasticity, Pa, from the displacement gradient.
pub fn linear(moduli: &ElasticModuli, gradient: Tensor) -> Tensor {
    let shear = (gradient[0][1] + gradient[1][0]) * 0.5;
    isotropic(moduli, [[gradient[0][0], shear], [shear, gradient[1][1]]])
}

/// First Piola–Kirchhoff stress of the Hencky law, Pa, from the displacement gradient.
pub fn hencky(moduli: &ElasticModuli, gradient: Tensor) -> Tensor {
    let [[xx, xy], [yx, yy]] = gradient;
    let f = [[xx + 1.0, xy], [yx, yy + 1.0]];
    let tau = isotropic(moduli, hencky_strain(f));
    let jacobian = f[0][0] * f[1][1] - f[0][1] * f[1][0];
    let cofactor = [[f[1][1], -f[1][0]], [-f[0][1], f[0][0]]];
    let component = |i: usize, j: usize| (tau[i][0] * cofactor[0][j] + tau[i][1] * cofactor[1][j]) / jacobian;
    [[component(0, 0), component(0, 1)], [component(1, 0), component(1, 1)]]
}

/// `lam* tr(e) I + 2 mu e`.
fn isotropic(moduli: &ElasticModuli, [[xx, xy], [yx, yy]]: Tensor) -> Tensor {
    let spherical = (xx + yy) * moduli.lambda;
    let twice = 2.0 * moduli.mu;
    [[spherical + xx * twice, xy * twice], [yx * twice, spherical + yy * twice]]
}

/// Hencky strain `½ ln(F Fᵀ)` of the deformation gradient F.
fn hencky_strain(f: Tensor) -> Tensor {
    let product = |i: usize, j: usize| f[i][0] * f[j][0] + f[i][1] * f[j][1];
    let (b_xx, b_xy, b_yy) = (product(0, 0), product(0, 1), product(1, 1));
    let mean = (b_xx + b_yy) * 0.5;
    let half_difference = (b_xx - b_yy) * 0.5;
    let z = (half_difference * half_difference + b_xy * b_xy) / (mean * mean);
    let spherical = (b_xx * b_yy - b_xy * b_xy).ln() * 0.25;
    let factor = artanh_ratio(z) / (mean * 2.0);
    let shear = b_xy * factor;
    [[spherical + half_difference * factor, shear], [shear, spherical - half_difference * factor]]
}

/// `artanh(sqrt z)/sqrt z` for `0 ≤ z < 1`: the power series where it is fast, the closed form beyond.
fn artanh_ratio(z: Field) -> Field {
    let z0 = z.value;
    let (value, slope) = if z0 < 0.1 {
        // 18 terms: the first one left out is 1e-18/37.
        (0..18).rev().map(f64::from).fold((0.0, 0.0), |(value, slope), n| {
            let coefficient = 1.0 / (2.0 * n + 1.0);
            (value * z0 + coefficient, slope * z0 + value)
        })
    } else {
        let value = z0.sqrt().atanh() / z0.sqrt();
        (value, (1.0 / (1.0 - z0) - value) / (2.0 * z0))
    };
    z.chain(value, slope)
}
