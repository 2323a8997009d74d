//! Elastodynamics with a phase field, manufactured, for domains within [0, 1]² (m) and t in [0, 1] (s).
//!
//! ```text
//! u = α(t) [x + 0.15 sin(1.7 x + 0.9 y + 0.3)],      α = 0.20 + 0.15 sin(1.2 t + 0.1)
//! v = β(t) [y + 0.12 cos(1.1 x − 1.4 y + 0.5)],      β = 0.15 + 0.10 t + 0.08 t²
//! E = 1 Pa, nu = 0.3, rho = 1 kg/m³, l0 = 0.1 m, k = 0
//!
//! coupled                     AT2     spectral             in tension
//! coupled-at1                 AT1     spectral             squeezed
//! coupled-linear              PF-CZM  rankine              in tension
//! coupled-exponential         PF-CZM  volumetric-dev.      squeezed
//! coupled-cornelissen         PF-CZM  star-convex, γ 0.2   squeezed
//!
//! c = 0.7 + 0.25 sin(1.9 x − 0.6 + 0.5 t) cos(1.3 y + 0.4 − 0.8 t),              Gc = 0.02 J/m²   (AT2)
//! c = 0.75 + 0.12 sin(1.9 x − 0.6) cos(1.3 y + 0.4) − 0.4 t [1 + 0.2 sin(x + y)],
//!                                                     Gc = 0.01 J/m², ft = 0.12 Pa    (the others)
//! ```
//!
//! In tension both principal strains are positive, so `psi− = 0`. With AT2, psi+ grows strictly in time
//! everywhere, hence H = psi+. Squeezed means α/2 and −2 β − 0.05 for α and β: everywhere one principal
//! strain is positive, the other negative, and so is the trace. So every split is smooth, and a wrong term of
//! one shows. A change of sign would make it rough, and orders of convergence would fall without a bug.
//!
//! With a threshold c falls strictly in time and stays below 1: no bound is active, and the equation holds.
//!
//! The problem needs the body force `rho a − Div sigma`, the source of the phase field, its flux `D grad c ·
//! n` and the displacement or the traction on the boundary, and non-zero displacement, velocity and history
//! at t = 0.

use fisura::material::elasticity::ElasticModuli;
use fisura::scene::{CrackModel, Fracture, Material, Plane, Softening, Split};

use super::dual::{Jet, Scalar};
use super::motion::{Derived, Motion};
use super::{ExactSolution, Solution, fracture, unit_material};

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[
    solution("coupled", |plane| fields(plane, CrackModel::At2, Split::Spectral)),
    solution("coupled-at1", |plane| fields(plane, CrackModel::At1, Split::Spectral)),
    solution("coupled-linear", |plane| fields(plane, cohesive(Softening::Linear), Split::Rankine)),
    solution("coupled-exponential", |plane| {
        fields(plane, cohesive(Softening::Exponential), Split::VolumetricDeviatoric)
    }),
    solution("coupled-cornelissen", |plane| fields(plane, cohesive(Softening::Cornelissen), Split::StarConvex(0.2))),
];

const fn solution(name: &'static str, fields: fn(Plane) -> Box<dyn ExactSolution>) -> Solution {
    Solution { end_time: 0.5, ..Solution::of(name, fields) }
}

const fn cohesive(softening: Softening) -> CrackModel {
    CrackModel::PfCzm { tensile_strength: 0.12, softening }
}

fn fields(plane: Plane, model: CrackModel, split: Split) -> Box<dyn ExactSolution> {
    let critical_energy_release_rate = if model == CrackModel::At2 { 0.02 } else { 0.01 };
    let fracture = Fracture { model, split, ..Fracture::at2(critical_energy_release_rate, 0.1) };
    Box::new(Derived { motion: Coupled { fracture }, plane })
}

/// Elastodynamics with a phase field; see the module for its formulas.
#[derive(Debug, Clone)]
pub struct Coupled {
    /// Model of the crack.
    pub fracture: Fracture,
}

impl Motion for Coupled {
    fn material(&self) -> Material {
        Material { fracture: Some(self.fracture.clone()), ..unit_material(0.3) }
    }

    fn displacement<T: Scalar>(&self, _: Plane, [x, y, t]: [T; 3]) -> [T; 2] {
        let mut alpha = (t * 1.2 + 0.1).sin() * 0.15 + 0.20;
        let mut beta = t * t * 0.08 + t * 0.10 + 0.15;
        if self.fracture.model != CrackModel::At2 && self.fracture.split != Split::Rankine {
            (alpha, beta) = (alpha * 0.5, beta * -2.0 - 0.05);
        }
        let u = x + (x * 1.7 + y * 0.9 + 0.3).sin() * 0.15;
        let v = y + (x * 1.1 - y * 1.4 + 0.5).cos() * 0.12;
        [alpha * u, beta * v]
    }

    fn phase<T: Scalar>(&self, [x, y, t]: [T; 3]) -> T {
        if self.fracture.model == CrackModel::At2 {
            return (x * 1.9 - 0.6 + t * 0.5).sin() * (y * 1.3 + 0.4 - t * 0.8).cos() * 0.25 + 0.7;
        }
        let fall = (x + y).sin() * 0.2 + 1.0;
        (x * 1.9 - 0.6).sin() * (y * 1.3 + 0.4).cos() * 0.12 + 0.75 - t * fall * 0.4
    }

    fn history(&self, plane: Plane, variables: [Jet; 3]) -> f64 {
        let moduli = ElasticModuli::new(&self.material(), plane);
        let gradient = self.displacement(plane, variables).map(|u| [u.gradient[0], u.gradient[1]]);
        fracture::driving_energy(&moduli, self.fracture.split, gradient)
    }
}
