//! Exact solutions, one file each. Their derivations stand under `reference-data/derivations/`.
//!
//! A solution states its displacement (and phase field) and its stress law; velocity, stress, body force and source
//! follow by differentiation ([`motion`], [`dual`]). [`find`] gives a solution by name.

use fisura::scene::{Material, Plane};

pub mod axis_aligned;
pub mod bar_wave;
pub mod coupled;
pub mod dual;
pub mod elastostatics;
pub mod kirsch;
pub mod law;
pub mod motion;
pub mod phase_field;
pub mod standing_wave;
#[cfg(test)]
mod tests;
pub mod vortex;

use axis_aligned::AxisAligned;
use bar_wave::{FiniteWave, HenckyWave};
use coupled::Coupled;
use elastostatics::Elastostatics;
use kirsch::Kirsch;
use motion::Derived;
use phase_field::PhaseField;
use standing_wave::StandingWave;
use vortex::Vortex;

/// Names that [`find`] knows.
pub const NAMES: &[&str] = &[
    "elastostatics",
    "kirsch",
    "standing-wave",
    "phase-field",
    "phase-field-zero-flux",
    "coupled",
    "finite-wave",
    "hencky-wave",
    "axis-aligned",
    "vortex",
];

/// The exact solution of a name in a plane state.
pub fn find(name: &str, plane: Plane) -> Option<Box<dyn ExactSolution>> {
    Some(match name {
        "elastostatics" => Box::new(Derived(Elastostatics { plane })),
        "kirsch" => Box::new(Derived(Kirsch { plane })),
        "standing-wave" => Box::new(Derived(StandingWave { plane })),
        "phase-field" => Box::new(Derived(PhaseField { plane, zero_flux: false })),
        "phase-field-zero-flux" => Box::new(Derived(PhaseField { plane, zero_flux: true })),
        "coupled" => Box::new(Derived(Coupled { plane })),
        "finite-wave" => Box::new(Derived(FiniteWave { plane })),
        "hencky-wave" => Box::new(Derived(HenckyWave { plane })),
        "axis-aligned" => Box::new(Derived(AxisAligned { plane, amplitude: axis_aligned::AMPLITUDE })),
        "vortex" => Box::new(Derived(Vortex { plane })),
        _ => return None,
    })
}

/// Elastic material with E = 1 Pa and a density of 1 kg/m³.
fn unit_material(poisson_ratio: f64) -> Material {
    Material { young_modulus: 1.0, poisson_ratio, density: 1.0, fracture: None }
}

/// Fields that solve the equations of motion exactly, with the loads they need. Positions are in the reference
/// configuration, in m; times in s.
pub trait ExactSolution: Send + Sync {
    /// Material.
    fn material(&self) -> Material;
    /// Plane state.
    fn plane(&self) -> Plane;
    /// Displacement, m.
    fn displacement(&self, position: [f64; 2], time: f64) -> [f64; 2];
    /// `∂u_i/∂x_j`.
    fn displacement_gradient(&self, position: [f64; 2], time: f64) -> [[f64; 2]; 2];
    /// Velocity, m/s.
    fn velocity(&self, _position: [f64; 2], _time: f64) -> [f64; 2] {
        [0.0; 2]
    }
    /// Acceleration, m/s².
    fn acceleration(&self, _position: [f64; 2], _time: f64) -> [f64; 2] {
        [0.0; 2]
    }
    /// Stress `stress[i][j]`, Pa: first Piola–Kirchhoff (component i, reference normal j); that is the Cauchy stress for
    /// small strains. It is the degraded one where a phase field is modelled.
    fn stress(&self, position: [f64; 2], time: f64) -> [[f64; 2]; 2];
    /// Whether there is no body force.
    fn is_force_free(&self) -> bool;
    /// Body force per reference volume, N/m³: `rho a − Div stress`.
    fn body_force(&self, position: [f64; 2], time: f64) -> [f64; 2];
    /// The phase field, where one is modelled.
    fn phase(&self) -> Option<&dyn ExactPhase> {
        None
    }
}

/// A phase field that solves `[4 l0 (1 − k) H/Gc + 1] c − 4 l0² Δc = s` exactly.
pub trait ExactPhase: Sync {
    /// Phase field.
    fn value(&self, position: [f64; 2], time: f64) -> f64;
    /// Its gradient, 1/m.
    fn gradient(&self, position: [f64; 2], time: f64) -> [f64; 2];
    /// History energy H, J/m³.
    fn history(&self, position: [f64; 2], time: f64) -> f64;
    /// Source s.
    fn source(&self, position: [f64; 2], time: f64) -> f64;
}
