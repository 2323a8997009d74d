//! Axis-aligned displacement of the unit square, manufactured, after Wallstedt & Guilkey (2008), *An
//! evaluation of explicit time integration schemes for use with the generalized interpolation material point
//! method*, Journal of Computational Physics 227.
//!
//! ```text
//! u = A sin(2πX) sin(πct),      v = A sin(2πY) sin(πct + 2π/3),      c = sqrt(E/rho)
//! P = tau/F per axis,      tau_i = lam* (e_x + e_y) + 2 mu e_i,      e_i = ln F_i
//! b = rho a − Div P,      E = 1 Pa, nu = 0.3, rho = 1 kg/m³,      A = 0.05 m
//! ```
//!
//! The displacement is theirs, the law is fisura's own (Hencky instead of neo-Hookean), so body forces
//! differ. F_i lies within 1 ± 2πA: 0.69 and 1.31 at A = 0.05, where material points with linear shape
//! functions blow up. The period is 2 s.
//!
//! Boundary conditions: rollers on all four sides of [0, 1]²; shear vanishes everywhere. Displacement and
//! velocity are not zero at t = 0.

use std::f64::consts::PI;

use fisura::scene::{Frame, Kinematics, Plane};

use super::dual::Scalar;
use super::law::{self, Law};
use super::motion::{Derived, Motion};
use super::{Held, Solution};

/// Amplitude A, m; below 1/(2π).
const AMPLITUDE: f64 = 0.05;

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[Solution {
    held: Held::Rollers,
    kinematics: Kinematics::Finite,
    frames: &[Frame::Total, Frame::Updated],
    ..Solution::of("axis-aligned", |plane| Box::new(Derived { motion: AxisAligned, plane }))
}];

/// Displacement of the unit square along the axes, with the Hencky law; see the module for its formulas.
#[derive(Debug, Clone, Copy)]
pub struct AxisAligned;

impl Motion for AxisAligned {
    const LAW: Law = law::hencky;

    fn displacement<T: Scalar>(&self, _: Plane, [x, y, t]: [T; 3]) -> [T; 2] {
        let speed = (self.material().young_modulus / self.material().density).sqrt();
        let along =
            |coordinate: T, phase: f64| (coordinate * (2.0 * PI)).sin() * (t * (PI * speed) + phase).sin() * AMPLITUDE;
        [along(x, 0.0), along(y, 2.0 * PI / 3.0)]
    }
}
