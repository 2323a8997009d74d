//! Standing waves of finite displacement in a bar along x, 0 ≤ X ≤ 1 (m), of any height.
//!
//! ```text
//! u = 0.04 sin(πX) sin(πct) + 0.02 sin(2πX) sin(2πct),      v = 0,      c = sqrt(E/rho)
//! E = 1 Pa, nu = 0, rho = 1 kg/m³
//! finite-wave    P = E (F − 1)       b = 0
//! hencky-wave    P = E ln(F)/F       b = rho a − dP/dX
//! ```
//!
//! `finite-wave` is an exact solution without any load at any amplitude, since P is linear in F. It is what
//! the total frame computes with small kinematics, where shape functions and stress refer to the reference
//! configuration; in the updated frame it needs P = E (F − 1) as a law of its own. F lies within 0.75 and
//! 1.25: points cross many spans of a fine mesh.
//!
//! `hencky-wave` has the same displacement with the logarithmic law, which is what `kinematics = "finite"`
//! computes.
//!
//! Boundary conditions: no displacement along x at X = 0 and X = 1. As nu = 0 nothing happens across: other
//! sides may be free or on rollers, and both plane states agree. It starts from u = 0 with a velocity.

use std::f64::consts::PI;

use fisura::scene::{Frame, Kinematics, Material, Plane};

use super::dual::Scalar;
use super::law::{self, Law};
use super::motion::{Derived, Motion};
use super::{Held, Solution, unit_material};

/// Amplitudes of the first and the second mode, m.
const AMPLITUDES: [f64; 2] = [0.04, 0.02];

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[
    Solution {
        held: Held::Rollers,
        ..Solution::of("finite-wave", |plane| Box::new(Derived { motion: BarWave::<false>, plane }))
    },
    Solution {
        held: Held::Rollers,
        kinematics: Kinematics::Finite,
        frames: &[Frame::Total, Frame::Updated],
        ..Solution::of("hencky-wave", |plane| Box::new(Derived { motion: BarWave::<true>, plane }))
    },
];

/// The wave with the logarithmic law and a body force, or with the linear one and none.
#[derive(Debug, Clone, Copy)]
pub struct BarWave<const HENCKY: bool>;

impl<const HENCKY: bool> Motion for BarWave<HENCKY> {
    const FORCE_FREE: bool = !HENCKY;
    const LAW: Law = if HENCKY { law::hencky } else { law::linear };

    fn material(&self) -> Material {
        unit_material(0.0)
    }

    fn displacement<T: Scalar>(&self, _: Plane, [x, _, t]: [T; 3]) -> [T; 2] {
        let speed = (self.material().young_modulus / self.material().density).sqrt();
        let mode = |n: f64| (x * (n * PI)).sin() * (t * (n * PI * speed)).sin();
        [mode(1.0) * AMPLITUDES[0] + mode(2.0) * AMPLITUDES[1], T::constant(0.0)]
    }
}
