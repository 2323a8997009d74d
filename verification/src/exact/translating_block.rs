//! A block that flies through the mesh and vibrates, manufactured: a free body whose boundary cuts spans.
//!
//! ```text
//! u = V t + A B(X) B(Y) [sin(2πct), sin(2πct + 2)],      B(s) = sin²(πs) on 0 ≤ s ≤ 1,      c = sqrt(E/rho)
//! P from the Hencky law,      b = rho a − Div P
//! V = (0.75, 0.4) m/s, A = 0.06 m, E = 1 Pa, nu = 0.3, rho = 1 kg/m³
//! ```
//!
//! B vanishes with its slope at both ends: F = I and no traction on the boundary of [0, 1]², which is free.
//! Second derivatives do not vanish there. Strains reach 0.2, with shear in the corners of the middle. Until
//! 0.9 s it crosses 0.675 m, which is 10.8 spans of 1/16 m, in x and 0.36 m in y.

use std::f64::consts::PI;

use fisura::scene::{Frame, Kinematics, Plane};

use super::Solution;
use super::dual::Scalar;
use super::law::{self, Law};
use super::motion::{Derived, Motion};

/// Amplitude A of the vibration, m.
const AMPLITUDE: f64 = 0.06;
/// Velocity `[V_x, V_y]` of the flight, m/s.
const VELOCITY: [f64; 2] = [0.75, 0.4];
/// Phase of the vibration in y, rad.
const PHASE: f64 = 2.0;

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[Solution {
    end_time: 0.9,
    kinematics: Kinematics::Finite,
    frames: &[Frame::Updated],
    ..Solution::of("translating-block", |plane| Box::new(Derived { motion: TranslatingBlock, plane }))
}];

/// A block that flies through the mesh and vibrates, with the Hencky law; see the module for its formulas.
#[derive(Debug, Clone, Copy)]
pub struct TranslatingBlock;

impl Motion for TranslatingBlock {
    const LAW: Law = law::hencky;

    fn displacement<T: Scalar>(&self, _: Plane, [x, y, t]: [T; 3]) -> [T; 2] {
        let bump = |coordinate: T| {
            let sine = (coordinate * PI).sin();
            sine * sine
        };
        let (shape, angle) = (bump(x) * bump(y) * AMPLITUDE, t * (2.0 * PI));
        [t * VELOCITY[0] + shape * angle.sin(), t * VELOCITY[1] + shape * (angle + PHASE).sin()]
    }
}
