//! Exact solutions, one file each. Their derivations stand under `reference-data/derivations/`.
//!
//! A solution states its displacement (and phase field) and its stress law; velocity, stress, body force and
//! source follow by differentiation ([`motion`], [`dual`]). The problem it solves stands beside it in its
//! file, as a [`Solution`]; a new file is known to studies and tests by its line in the list below.
//! [`cohesive`] is the law of a crack in one dimension, without a problem of its own.

use fisura::scene::{Frame, Kinematics, Material, Plane, Side};

pub mod axis_aligned;
pub mod bar_wave;
pub mod cohesive;
pub mod coupled;
pub mod disc_wave;
pub mod dual;
pub mod elastostatics;
pub mod fracture;
pub mod kirsch;
pub mod law;
pub mod motion;
pub mod phase_field;
pub mod standing_wave;
#[cfg(test)]
mod tests;
pub mod translating_block;
pub mod vortex;

/// What every file registers.
const REGISTERED: [&[Solution]; 10] = [
    axis_aligned::SOLUTIONS,
    bar_wave::SOLUTIONS,
    coupled::SOLUTIONS,
    disc_wave::SOLUTIONS,
    elastostatics::SOLUTIONS,
    kirsch::SOLUTIONS,
    phase_field::SOLUTIONS,
    standing_wave::SOLUTIONS,
    translating_block::SOLUTIONS,
    vortex::SOLUTIONS,
];

/// An exact solution and the problem it solves: all that a study of convergence has to know of it.
pub struct Solution {
    /// Name in case files.
    pub name: &'static str,
    /// The fields in a plane state.
    pub fields: fn(Plane) -> Box<dyn ExactSolution>,
    /// Equation that is solved.
    pub equation: Equation,
    /// Where components are prescribed; the exact traction acts on the other sides.
    pub held: Held,
    /// End of the simulated time, s.
    pub end_time: f64,
    /// Small strains, or the Hencky law.
    pub kinematics: Kinematics,
    /// Frames in which it can be solved for.
    pub frames: &'static [Frame],
    /// Radii of a ring about the origin, m, at which tests look at it; none for the unit square.
    pub radii: &'static [f64],
}

impl Solution {
    /// The motion of a body that is free on the unit square, with small strains, for 0.6 s.
    const fn of(name: &'static str, fields: fn(Plane) -> Box<dyn ExactSolution>) -> Self {
        Self {
            name,
            fields,
            equation: Equation::Dynamic,
            held: Held::Sides(&[]),
            end_time: 0.6,
            kinematics: Kinematics::Small,
            frames: &[Frame::Total],
            radii: &[],
        }
    }
}

/// Which equation is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equation {
    /// Least-squares projection of the displacement.
    Projection,
    /// Equilibrium under loads and conditions that do not change.
    Static,
    /// The phase-field equation with a given history energy.
    PhaseField,
    /// Equations of motion, and the phase field where the solution has one.
    Dynamic,
}

/// Sides on which components of the displacement are prescribed.
#[derive(Debug, Clone, Copy)]
pub enum Held {
    /// These sides, with the components that are held.
    Sides(&'static [(Side, [bool; 2])]),
    /// Rollers on the axes x = 0 and y = 0, which bound a quarter.
    Axes,
    /// Rollers on all sides of a rectangle, and no side of a curved patch.
    Rollers,
}

/// Every exact solution that a module of this folder registers.
pub fn all() -> impl Iterator<Item = &'static Solution> {
    REGISTERED.into_iter().flatten()
}

/// The solution of a name.
pub fn find(name: &str) -> Option<&'static Solution> {
    all().find(|solution| solution.name == name)
}

/// Elastic material with E = 1 Pa and a density of 1 kg/m³.
fn unit_material(poisson_ratio: f64) -> Material {
    Material { young_modulus: 1.0, poisson_ratio, density: 1.0, fracture: None }
}

/// Fields that solve the equations of motion exactly, with the loads they need. Positions are in the
/// reference configuration, in m; times in s.
pub trait ExactSolution: Send + Sync {
    /// Material of the body.
    fn material(&self) -> Material;
    /// Plane state, strain or stress, for which the fields hold.
    fn plane(&self) -> Plane;
    /// Displacement `[u_x, u_y]`, m.
    fn displacement(&self, position: [f64; 2], time: f64) -> [f64; 2];
    /// Gradient of the displacement, `∂u_i/∂x_j`.
    fn displacement_gradient(&self, position: [f64; 2], time: f64) -> [[f64; 2]; 2];
    /// Velocity `[v_x, v_y]`, m/s.
    fn velocity(&self, position: [f64; 2], time: f64) -> [f64; 2];
    /// Acceleration, m/s².
    fn acceleration(&self, position: [f64; 2], time: f64) -> [f64; 2];
    /// Stress `stress[i][j]`, Pa: first Piola–Kirchhoff (component i, reference normal j); that is the Cauchy
    /// stress for small strains. It is the degraded one where a phase field is modelled.
    fn stress(&self, position: [f64; 2], time: f64) -> [[f64; 2]; 2];
    /// Whether there is no body force.
    fn is_force_free(&self) -> bool;
    /// Body force per reference volume, N/m³: `rho a − Div stress`.
    fn body_force(&self, position: [f64; 2], time: f64) -> [f64; 2];
    /// The phase field, where one is modelled.
    fn phase(&self) -> Option<&dyn ExactPhase>;
}

/// A phase field that solves the equation of its model ([`fracture`]) exactly, with AT2 `[4 l0 (1 − k) H/Gc
/// + 1] c − 4 l0² Δc = s`.
pub trait ExactPhase: Sync {
    /// Phase field c, from 0 in broken to 1 in intact material.
    fn value(&self, position: [f64; 2], time: f64) -> f64;
    /// Gradient `[∂c/∂x, ∂c/∂y]` of the phase field, 1/m.
    fn gradient(&self, position: [f64; 2], time: f64) -> [f64; 2];
    /// Driving energy H, J/m³.
    fn history(&self, position: [f64; 2], time: f64) -> f64;
    /// Source s on the right-hand side of the phase-field equation, without a unit.
    fn source(&self, position: [f64; 2], time: f64) -> f64;
}
