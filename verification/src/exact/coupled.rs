//! Elastodynamics with a phase field, manufactured, in tension everywhere and at all times, for domains
//! within [0, 1]² (m) and t in [0, 1] (s).
//!
//! ```text
//! u = α(t) [x + 0.15 sin(1.7 x + 0.9 y + 0.3)],      α = 0.20 + 0.15 sin(1.2 t + 0.1)
//! v = β(t) [y + 0.12 cos(1.1 x − 1.4 y + 0.5)],      β = 0.15 + 0.10 t + 0.08 t²
//! c = 0.7 + 0.25 sin(1.9 x − 0.6 + 0.5 t) cos(1.3 y + 0.4 − 0.8 t)
//! E = 1 Pa, nu = 0.3, rho = 1 kg/m³, l0 = 0.1 m, Gc = 0.02 J/m², k = 0
//! ```
//!
//! Both principal strains are positive, so `psi− = 0` and the spectral split is smooth: `psi+ = ½ e : C e`
//! and `sigma = c² C e`. psi+ grows strictly in time everywhere, hence H = psi+. A change of sign would make
//! the split rough and H stale, and orders of convergence would fall without a bug.
//!
//! It needs the body force `rho a − Div sigma`, the source of the phase field, the flux `4 l0² grad c · n`
//! and the displacement or the traction on the boundary, and non-zero displacement, velocity and history at t
//! = 0. c lies in (0.45, 0.95).

use fisura::scene::{CrackModel, Fracture, Frame, Kinematics, Material, Plane, Split};

use super::dual::{Field, Jet, Scalar};
use super::motion::{Derived, Motion, displacement_gradient};
use super::{Equation, Held, Solution, unit_material};

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[Solution {
    name: "coupled",
    fields: |plane| Box::new(Derived(Coupled { plane })),
    equation: Equation::Dynamic,
    held: Held::Sides(&[]),
    end_time: 0.5,
    kinematics: Kinematics::Small,
    frames: &[Frame::Total],
    radii: &[],
}];

/// See the module.
#[derive(Debug, Clone, Copy)]
pub struct Coupled {
    /// Plane state.
    pub plane: Plane,
}

impl Motion for Coupled {
    fn material(&self) -> Material {
        let fracture = Fracture {
            model: CrackModel::At2,
            critical_energy_release_rate: 0.02,
            length_scale: 0.1,
            residual_stiffness: 0.0,
            split: Split::Spectral,
        };
        Material { fracture: Some(fracture), ..unit_material(0.3) }
    }

    fn plane(&self) -> Plane {
        self.plane
    }

    fn displacement(&self, [x, y, t]: [Jet; 3]) -> [Jet; 2] {
        let alpha = (t * 1.2 + 0.1).sin() * 0.15 + 0.20;
        let beta = t * t * 0.08 + t * 0.10 + 0.15;
        let u = x + (x * 1.7 + y * 0.9 + 0.3).sin() * 0.15;
        let v = y + (x * 1.1 - y * 1.4 + 0.5).cos() * 0.12;
        [alpha * u, beta * v]
    }

    fn phase(&self, [x, y, t]: [Jet; 3]) -> Jet {
        (x * 1.9 - 0.6 + t * 0.5).sin() * (y * 1.3 + 0.4 - t * 0.8).cos() * 0.25 + 0.7
    }

    /// `psi+ = ½ sigma : e` of the intact material.
    fn history(&self, variables: [Jet; 3]) -> f64 {
        let gradient = displacement_gradient(self, variables);
        let stress = self.stress(gradient);
        let work = |i: usize, j: usize| stress[i][j] * gradient[i][j];
        let energy: Field = (work(0, 0) + work(0, 1) + work(1, 0) + work(1, 1)) * 0.5;
        energy.value
    }
}
