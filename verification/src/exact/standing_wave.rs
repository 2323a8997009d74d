//! Free vibration of a rectangle on rollers: one dilatational and one shear wave, without loads.
//!
//! On [0, Lx] × [0, Ly] = [0, 1] × [0, 0.8] (m), with wave vectors `k = (π mx/Lx, π my/Ly)`, unit vectors
//! `n = k/|k|`, and `C = cos(kx x) cos(ky y)`, `S = sin(kx x) sin(ky y)`:
//!
//! ```text
//! u = 0.10 sin(ω_P t + 0.7) grad(C)/|k_P| + 0.07 cos(ω_S t) curl(S)/|k_S|,      curl S = (∂S/∂y, −∂S/∂x)
//! modes (mx, my):  (1, 2) for P,  (2, 1) for S
//! ω_P = |k_P| sqrt((lam* + 2 mu)/rho),      ω_S = |k_S| sqrt(mu/rho)
//! ```
//!
//! Normal displacement and shear stress vanish on all four sides at all times, so rollers are the only
//! conditions. At t = 0 neither displacement nor velocity vanishes: the P wave has both, the S wave starts
//! from rest. E = 1 Pa, nu = 0.3, rho = 1 kg/m³. The angular frequencies are 9.81 and 4.60 rad/s in plane
//! strain, 8.87 and 4.60 in plane stress.

use std::f64::consts::PI;

use fisura::material::elasticity::ElasticModuli;
use fisura::scene::Plane;

use super::dual::Scalar;
use super::motion::{Derived, Motion};
use super::{Held, Solution};

/// Size of the rectangle, m.
pub const SIZE: [f64; 2] = [1.0, 0.8];

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[Solution {
    held: Held::Rollers,
    ..Solution::of("standing-wave", |plane| Box::new(Derived { motion: StandingWave, plane }))
}];

/// Free vibration of a rectangle on rollers; see the module for its formulas.
#[derive(Debug, Clone, Copy)]
pub struct StandingWave;

/// Wave vector of a mode and its length, rad/m.
fn wave_vector(mode: [f64; 2]) -> ([f64; 2], f64) {
    let k = [0, 1].map(|d| PI * mode[d] / SIZE[d]);
    (k, k[0].hypot(k[1]))
}

impl Motion for StandingWave {
    const FORCE_FREE: bool = true;

    fn displacement<T: Scalar>(&self, plane: Plane, [x, y, t]: [T; 3]) -> [T; 2] {
        let density = self.material().density;
        let moduli = ElasticModuli::new(&self.material(), plane);
        let dilatational = {
            let (k, length) = wave_vector([1.0, 2.0]);
            let (px, py) = (x * k[0], y * k[1]);
            let amplitude = (t * (length * moduli.dilatational_speed(density)) + 0.7).sin() * (0.10 / length);
            [-(px.sin() * py.cos() * amplitude * k[0]), -(px.cos() * py.sin() * amplitude * k[1])]
        };
        let shear = {
            let (k, length) = wave_vector([2.0, 1.0]);
            let (px, py) = (x * k[0], y * k[1]);
            let amplitude = (t * (length * (moduli.mu / density).sqrt())).cos() * (0.07 / length);
            [px.sin() * py.cos() * amplitude * k[1], -(px.cos() * py.sin() * amplitude * k[0])]
        };
        [dilatational[0] + shear[0], dilatational[1] + shear[1]]
    }
}
