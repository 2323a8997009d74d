//! The phase-field equation alone, static, with a smooth history field, on [0, 1] × [0, 0.8] (m). Nothing
//! moves.
//!
//! ```text
//! [F + 1] c − 4 l0² Δc = s,      F = 4 l0 (1 − k) H/Gc = 2 + y sin(3 x)
//! phase-field             c = 0.6 + 0.3 sin(1.7 x + 0.3) cos(2.3 y − 0.4)
//! phase-field-zero-flux   c = 0.6 + 0.25 cos(π x) cos(2π y/0.8) + 0.1 cos(2π x)
//! l0 = 0.1 m, Gc = 1 J/m², k = 0.01
//! ```
//!
//! The first lies in (0.3, 0.9) everywhere and needs its flux `4 l0² grad c · n` on the boundary. The second
//! lies in [0.25, 0.95], and its normal derivative vanishes on the sides of the rectangle. k is not zero so
//! that a missing 1 − k shows.

use std::f64::consts::PI;

use fisura::material::degradation::FractureModel;
use fisura::scene::{Fracture, Material, Plane};

use super::dual::{Jet, Scalar};
use super::motion::{Derived, Motion};
use super::{Equation, ExactSolution, Solution, unit_material};

/// Size of the rectangle, m.
pub const SIZE: [f64; 2] = [1.0, 0.8];

const FRACTURE: Fracture = Fracture { residual_stiffness: 0.01, ..Fracture::at2(1.0, 0.1) };

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[
    solution("phase-field", |plane| Box::new(Derived { motion: PhaseField { zero_flux: false }, plane })),
    solution("phase-field-zero-flux", |plane| Box::new(Derived { motion: PhaseField { zero_flux: true }, plane })),
];

const fn solution(name: &'static str, fields: fn(Plane) -> Box<dyn ExactSolution>) -> Solution {
    Solution { equation: Equation::PhaseField, end_time: 0.0, ..Solution::of(name, fields) }
}

/// Static phase field under a given history energy, without a displacement; see the module for its formulas.
#[derive(Debug, Clone, Copy)]
pub struct PhaseField {
    /// Whether the normal derivative of c vanishes on the boundary.
    pub zero_flux: bool,
}

impl Motion for PhaseField {
    const FORCE_FREE: bool = true;

    fn material(&self) -> Material {
        Material { fracture: Some(FRACTURE), ..unit_material(0.3) }
    }

    fn displacement<T: Scalar>(&self, _: Plane, _: [T; 3]) -> [T; 2] {
        [T::constant(0.0); 2]
    }

    fn phase<T: Scalar>(&self, [x, y, _]: [T; 3]) -> T {
        if self.zero_flux {
            let coupled = (x * PI).cos() * (y * (2.0 * PI / SIZE[1])).cos();
            coupled * 0.25 + (x * (2.0 * PI)).cos() * 0.1 + 0.6
        } else {
            (x * 1.7 + 0.3).sin() * (y * 2.3 - 0.4).cos() * 0.3 + 0.6
        }
    }

    fn history(&self, _: Plane, [x, y, _]: [Jet; 3]) -> f64 {
        let reaction = y * (x * 3.0).sin() + 2.0;
        let model = FractureModel::of(&self.material());
        model.map_or(f64::NAN, |model| reaction.value.value / model.reaction_per_energy())
    }
}
