//! A smooth static displacement of linear elasticity, manufactured. It is defined everywhere and meant for
//! domains in and around [0, 2]².
//!
//! ```text
//! u = 0.10 sin(1.3 x + 0.4) cos(0.9 y − 0.3) + 0.03 exp(0.5 x − 0.4 y)
//! v = 0.08 cos(0.8 x − 0.2) sin(1.7 y + 0.6) + 0.02 exp(0.6 y − 0.3 x)
//! b = −Div sigma,      E = 1 Pa, nu = 0.3, rho = 1 kg/m³
//! ```
//!
//! Boundary conditions: the displacement, or the traction sigma n, neither of which vanishes anywhere in
//! particular.

use fisura::scene::{Plane, Side};

use super::dual::Scalar;
use super::motion::{Derived, Motion};
use super::{Equation, Held, Solution};

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[Solution {
    equation: Equation::Static,
    held: Held::Sides(&[(Side::Left, [true; 2])]),
    end_time: 0.0,
    ..Solution::of("elastostatics", |plane| Box::new(Derived { motion: Elastostatics, plane }))
}];

/// Smooth static displacement of linear elasticity; see the module for its formulas.
#[derive(Debug, Clone, Copy)]
pub struct Elastostatics;

impl Motion for Elastostatics {
    fn displacement<T: Scalar>(&self, _: Plane, [x, y, _]: [T; 3]) -> [T; 2] {
        [
            (x * 1.3 + 0.4).sin() * (y * 0.9 - 0.3).cos() * 0.10 + (x * 0.5 - y * 0.4).exp() * 0.03,
            (x * 0.8 - 0.2).cos() * (y * 1.7 + 0.6).sin() * 0.08 + (y * 0.6 - x * 0.3).exp() * 0.02,
        ]
    }
}
