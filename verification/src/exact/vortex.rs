//! Generalised vortex in a ring, manufactured: concentric circles turn by different angles (Kamojjala,
//! Brannon, Sadeghirad & Guilkey 2015, *Verification tests in solid mechanics*, Engineering with Computers
//! 31).
//!
//! On 0.75 ≤ R ≤ 1.25 (m), with s = R − 1:
//!
//! ```text
//! x = Rot(α) X,      α(R, t) = A sin(πt) (1 − 32 s² + 256 s⁴)
//! F = Rot(α) (I + γ e_Θ ⊗ e_R),      γ = R ∂α/∂R,      det F = 1
//! P = tau F⁻ᵀ with the Hencky law,      b = rho a − Div P
//! A = 0.1 rad, E = 1 Pa, nu = 0.3, rho = 1 kg/m³
//! ```
//!
//! The bump equals 1 at R = 1 and vanishes at both radii with its slope: there is neither displacement, nor
//! strain, nor traction, so the boundary may be free or held. It starts from u = 0 with a velocity; the
//! period is 2 s.
//!
//! The amplitude is smaller than the 1 rad that others use with neo-Hookean materials, because the Hencky law
//! softens in shear: with these moduli it loses ellipticity between γ = 2 and 3 (and tau of simple shear
//! peaks at 3), beyond which the body is unstable and no code could follow the solution. Here |γ| ≤ 0.71.
//! Small kinematics would take the rotation by 0.1 rad for strains of 0.005.

use std::f64::consts::PI;

use fisura::scene::{Frame, Kinematics, Plane};

use super::Solution;
use super::dual::Scalar;
use super::law::{self, Law};
use super::motion::{Derived, Motion};

/// Inner and outer radius of the ring, m.
pub const RADII: [f64; 2] = [0.75, 1.25];

/// Largest angle A, rad.
pub const AMPLITUDE: f64 = 0.1;

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[Solution {
    kinematics: Kinematics::Finite,
    frames: &[Frame::Updated],
    radii: &[0.75, 0.93, 1.25],
    ..Solution::of("vortex", |plane| Box::new(Derived { motion: Vortex, plane }))
}];

/// Vortex in a ring, with the Hencky law; see the module for its formulas.
#[derive(Debug, Clone, Copy)]
pub struct Vortex;

impl Motion for Vortex {
    const LAW: Law = law::hencky;

    fn displacement<T: Scalar>(&self, _: Plane, [x, y, t]: [T; 3]) -> [T; 2] {
        let s = (x * x + y * y).sqrt() - 1.0;
        let square = s * s;
        let bump = square * square * 256.0 - square * 32.0 + 1.0;
        let angle = bump * (t * PI).sin() * AMPLITUDE;
        let (cos, sin) = (angle.cos(), angle.sin());
        [x * cos - y * sin - x, x * sin + y * cos - y]
    }
}
