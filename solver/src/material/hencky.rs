//! Hencky strain `e = ½ ln(F Fᵀ)` of plane deformations, in closed form.
//!
//! The deformation gradient F is kept as the displacement gradient `D = F − I`, so that small strains keep
//! their digits. With `B = F Fᵀ − I = D + Dᵀ + D Dᵀ`, its mean `m = tr B/2` and
//! `r = √((Bxx − Byy)²/4 + Bxy²)`, the eigenvalues of `F Fᵀ` are `1 + m ± r`, and
//!
//! ```text
//! e = ½ ln(det F) I + β (B − m I),    β = atanh(q)/q / (2 (1 + m)),    q = r/(1 + m)
//! ln(det F) = log1p(tr D + det D)
//! ```
//!
//! Nothing is divided by the difference of the eigenvalues, so equal ones need no special care, and no
//! logarithm is taken of a number that lost its digits to the 1 it stands beside. The stress that goes with
//! it is Kirchhoff's, `tau = dpsi/de`: for an isotropic energy it has the principal directions of e, and
//! `tau : d` is the power per unit of reference volume for the rate of deformation d. It is computed from e
//! by the law of small strains, where points are: in `transfer/finite.rs` and, for the updated frame, in
//! `transfer.rs`.

use crate::linear_algebra::lane::each;

/// Ratio q above which β comes from the larger eigenvalue and the determinant: q itself rounds to 1 and its
/// atanh to infinity where one principal stretch is a hundred million times the other, as in broken material
/// that is drawn out.
const STRETCHED: f64 = 0.9;

/// Tensor of the plane, `[i][j]` with i the component and j the direction of the derivative.
pub(crate) type Gradient = [[f64; 2]; 2];

/// Below this ratio `atanh(q)/q` is its series, whose first missing term is then 1e-18.
const SERIES: f64 = 0.02;

/// Displacement gradient after one more step: `F ← (I + A) F` with the gradient `A = dt grad v` at the
/// present positions.
#[inline(always)]
pub fn advance(displacement: &Gradient, step: &Gradient) -> Gradient {
    let (h, a) = (displacement, step);
    let [left, right] = fault!("deformation-from-the-wrong-side", [a, h] => [h, a]);
    each!(i in [0, 1] =>
        each!(j in [0, 1] => h[i][j] + (a[i][j] + (left[i][0] * right[0][j] + left[i][1] * right[1][j]))))
}

/// Hencky strain `[xx, yy, xy]` of a displacement gradient; not finite if the deformation has turned inside
/// out.
#[inline(always)]
pub fn hencky_strain(displacement: &Gradient) -> [f64; 3] {
    let [[xx, xy], [yx, yy]] = *displacement;
    let half_log = 0.5 * (xx + yy + (xx * yy - xy * yx)).ln_1p();
    // Mean, half difference and shear of F Fᵀ − I.
    let mean = xx + yy + 0.5 * (xx * xx + xy * xy + yx * yx + yy * yy);
    let half_difference = xx - yy + 0.5 * (xx * xx + xy * xy - yx * yx - yy * yy);
    let shear = xy + yx + (xx * yx + xy * yy);
    let radius = (half_difference * half_difference + shear * shear).sqrt();
    let ratio = radius / (1.0 + mean);
    let factor = if ratio < STRETCHED {
        atanh_over(ratio) / (2.0 * (1.0 + mean))
    } else {
        (0.5 * (mean + radius).ln_1p() - half_log) / radius
    };
    let deviator = factor * half_difference;
    let strain = [half_log + deviator, half_log - deviator, factor * shear];
    fault!("hencky-without-half", strain => strain.map(|e| 2.0 * e))
}

/// `A (I + A)⁻¹`: the same motion as `A = dt grad v`, differentiated with respect to the positions it ends
/// at.
///
/// Along the step, `F(s) = (I + s A) F`, the velocity gradient is A/dt at its start and this over dt at its
/// end. With both, the trapezoidal sum of the stress work is of second order in dt.
#[inline(always)]
pub(crate) fn gradient_at_end(step: &Gradient) -> Gradient {
    let [[xx, xy], [yx, yy]] = *step;
    let determinant = xx * yy - xy * yx;
    let scale = 1.0 / (1.0 + xx + yy + determinant);
    // A (I + A)⁻¹ = (A + det A I)/det(I + A) in the plane.
    [[(xx + determinant) * scale, xy * scale], [yx * scale, (yy + determinant) * scale]]
}

/// `det F`, the area of a region over that at t = 0; not positive if it is turned inside out.
pub fn growth([[xx, xy], [yx, yy]]: &Gradient) -> f64 {
    (1.0 + xx) * (1.0 + yy) - xy * yx
}

/// Angle by which a displacement gradient turns material, rad, counterclockwise: that of the polar
/// decomposition of F.
pub(crate) fn rotation([[xx, xy], [yx, yy]]: &Gradient) -> f64 {
    (yx - xy).atan2(2.0 + xx + yy)
}

/// What small strains do not follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Distortion {
    /// Angle by which material has turned, rad.
    Turned(f64),
    /// Magnitude of the largest principal strain.
    Strained(f64),
}

impl Distortion {
    /// Of a displacement gradient: the angle, or the strain if it is larger and `strains` count.
    pub(crate) fn of(gradient: &Gradient, strains: bool) -> Self {
        let (angle, strain) = (rotation(gradient).abs(), spectral_radius(symmetric(*gradient)));
        if strains && strain > angle { Self::Strained(strain) } else { Self::Turned(angle) }
    }

    /// Its size, rad or 1.
    pub(crate) fn size(self) -> f64 {
        match self {
            Self::Turned(size) | Self::Strained(size) => size,
        }
    }
}

impl std::fmt::Display for Distortion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Turned(angle) => write!(f, "has turned by {angle:.3} rad"),
            Self::Strained(strain) => write!(f, "is strained by {:.0} %", 100.0 * strain),
        }
    }
}

/// Spectral radius, the magnitude of the largest principal value, of a symmetric tensor `[xx, yy, xy]`.
#[inline(always)]
pub(crate) fn spectral_radius([xx, yy, xy]: [f64; 3]) -> f64 {
    0.5 * (xx + yy).abs() + (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt()
}

/// Symmetric part `[xx, yy, xy]`.
#[inline(always)]
pub fn symmetric([[xx, xy], [yx, yy]]: Gradient) -> [f64; 3] {
    [xx, yy, fault!("shear-strain-doubled", 0.5 => 1.0) * (xy + yx)]
}

/// The even function `atanh(q)/q`, also near zero.
#[inline(always)]
fn atanh_over(q: f64) -> f64 {
    if q < SERIES {
        let s = q * q;
        1.0 + s * (1.0 / 3.0 + s * (1.0 / 5.0 + s * (1.0 / 7.0 + s * (1.0 / 9.0))))
    } else {
        q.atanh() / q
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::Random;
    use crate::linear_algebra::extremes::larger;
    use nalgebra::{Matrix2, SymmetricEigen};

    fn of(f: Matrix2<f64>) -> [f64; 3] {
        let h = f - Matrix2::identity();
        hencky_strain(&[[h[(0, 0)], h[(0, 1)]], [h[(1, 0)], h[(1, 1)]]])
    }

    fn by_eigenvectors(f: Matrix2<f64>) -> [f64; 3] {
        let eigen = SymmetricEigen::new(f * f.transpose());
        let logs = Matrix2::from_diagonal(&eigen.eigenvalues.map(|b| 0.5 * b.ln()));
        let e = eigen.eigenvectors * logs * eigen.eigenvectors.transpose();
        [e[(0, 0)], e[(1, 1)], e[(0, 1)]]
    }

    fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|i| (a[i] - b[i]).abs()).max_by(f64::total_cmp).unwrap() // NaN is the largest
    }

    fn rotation_matrix(angle: f64) -> Matrix2<f64> {
        let (s, c) = angle.sin_cos();
        Matrix2::new(c, -s, s, c)
    }

    #[test]
    fn drawn_out_material_has_a_finite_strain() {
        for (long, short) in [(3.0_f64, 0.5_f64), (1e3, 1e-3), (1e6, 1e-5), (1e10, 1e-3)] {
            let strain = of(Matrix2::new(long, 0.0, 0.0, short));
            assert!(apart(strain, [long.ln(), short.ln(), 0.0]) < 1e-5, "{long} {short}: {strain:?}");
            let turned = of(rotation_matrix(0.3) * Matrix2::new(long, 0.0, 0.0, 1.0));
            let (s, c) = 0.3_f64.sin_cos();
            let exact = [c * c, s * s, c * s].map(|n| n * long.ln());
            assert!(apart(turned, exact) < 1e-5, "{long}: {turned:?} {exact:?}");
        }
    }

    #[test]
    fn it_is_the_logarithm_by_eigenvectors() {
        let mut random = Random::new(1);
        let mut next = || random.next();
        for _ in 0..2000 {
            let f = Matrix2::identity() + 0.45 * Matrix2::new(next(), next(), next(), next());
            assert!(f.determinant() > 0.0);
            let (e, exact) = (of(f), by_eigenvectors(f));
            let scale = exact.iter().fold(1.0_f64, |a, x| larger(a, x.abs()));
            assert!(apart(e, exact) <= 3e-14 * scale * scale, "{f}: {e:?} against {exact:?}");
        }
    }

    #[test]
    fn equal_and_nearly_equal_stretches_are_no_special_case() {
        for gap in [0.0, 1e-18, 1e-12, 1e-6, 1e-2, 0.0404] {
            let e = hencky_strain(&[[1.0 + gap, 0.0], [0.0, 1.0]]);
            let expected = [(2.0 + gap).ln(), 2.0_f64.ln(), 0.0];
            assert!(apart(e, expected) <= 3e-16, "{gap:e}: {e:?} against {expected:?}");
        }
    }

    #[test]
    fn a_rotation_before_changes_nothing_and_one_after_turns_it() {
        let mut random = Random::new(1);
        let mut next = || random.next();
        for _ in 0..200 {
            let f = Matrix2::identity() + 0.3 * Matrix2::new(next(), next(), next(), next());
            let turn = rotation_matrix(3.0 * next());
            assert!(apart(of(f * turn), of(f)) <= 2e-15, "{f}");
            let [xx, yy, xy] = of(f);
            let e = turn * Matrix2::new(xx, xy, xy, yy) * turn.transpose();
            assert!(apart(of(turn * f), [e[(0, 0)], e[(1, 1)], e[(0, 1)]]) <= 2e-15, "{f}");
        }
    }

    #[test]
    fn the_rotation_is_that_of_the_polar_decomposition() {
        for angle in [-3.0, -0.4, 0.0, 0.1, 2.0] {
            let h = rotation_matrix(angle) * Matrix2::new(1.3, 0.2, 0.2, 0.6) - Matrix2::identity();
            let found = rotation(&[[h[(0, 0)], h[(0, 1)]], [h[(1, 0)], h[(1, 1)]]]);
            assert!((found - angle).abs() < 1e-14, "{angle}: {found}");
        }
    }

    #[test]
    fn small_strains_are_linear_ones_with_all_their_digits() {
        for size in [1e-4, 1e-8, 1e-14, 1e-100, 1e-300] {
            let e = hencky_strain(&[[2.0 * size, 1.5 * size], [-0.5 * size, -size]]);
            let linear = [2.0 * size, -size, 0.5 * size];
            assert!(apart(e, linear) <= (4.0 * size + 1e-15) * size, "{size:e}: {e:?} against {linear:?}");
        }
        let stretch = 1e-9; // second order: ln(1 + x) = x − x²/2
        let [xx, ..] = hencky_strain(&[[stretch, 0.0], [0.0, 0.0]]);
        assert!((xx - stretch.ln_1p()).abs() <= 3e-16 * stretch);
    }

    #[test]
    fn increments_compose_the_deformation_and_have_a_rate_at_their_end() {
        let (mut h, mut f) = ([[0.0; 2]; 2], Matrix2::identity());
        let mut random = Random::new(1);
        let mut next = || random.next();
        for _ in 0..50 {
            let a = 0.1 * Matrix2::new(next(), next(), next(), next());
            let step = [[a[(0, 0)], a[(0, 1)]], [a[(1, 0)], a[(1, 1)]]];
            (h, f) = (advance(&h, &step), (Matrix2::identity() + a) * f);
            assert!(apart(hencky_strain(&h), of(f)) <= 1e-13);
            let end = a * (Matrix2::identity() + a).try_inverse().unwrap();
            let expected = [end[(0, 0)], end[(1, 1)], 0.5 * (end[(0, 1)] + end[(1, 0)])];
            assert!(apart(symmetric(gradient_at_end(&step)), expected) <= 1e-15);
        }
    }
}
