//! An exact solution from its displacement: everything else follows by differentiation.
//!
//! ```text
//! grad u, v, a        derivatives of u(x, y, t)
//! P                   the stress law on grad u (degraded where a phase field is modelled)
//! b  = rho a − Div P
//! s                   the phase-field equation ([`fracture`])
//! ```

use fisura::material::degradation::FractureModel;
use fisura::material::elasticity::ElasticModuli;
use fisura::scene::{Material, Plane};

use super::dual::{Dual, Field, Jet, Scalar};
use super::law::{self, Tensor};
use super::{ExactPhase, ExactSolution, fracture};

/// Index of time among the directions of differentiation.
const TIME: usize = 2;

/// What is chosen in an exact solution.
pub trait Motion: Send + Sync {
    /// Whether the motion needs no body force; then none is returned, not even round-off.
    const FORCE_FREE: bool = false;

    /// Material; a fracture table means that the phase field is part of the solution.
    fn material(&self) -> Material;
    /// Plane state.
    fn plane(&self) -> Plane;
    /// Displacement, m, of x (m), y (m), t (s).
    fn displacement<T: Scalar>(&self, variables: [T; 3]) -> [T; 2];
    /// Intact first Piola–Kirchhoff stress, Pa, from the displacement gradient; that of linear elasticity if
    /// not given.
    fn stress(&self, gradient: Tensor) -> Tensor {
        law::linear(&ElasticModuli::new(&self.material(), self.plane()), gradient)
    }
    /// Phase field; 1 where none is modelled.
    fn phase<T: Scalar>(&self, _variables: [T; 3]) -> T {
        T::constant(1.0)
    }
    /// History energy H, J/m³.
    fn history(&self, _variables: [Jet; 3]) -> f64 {
        0.0
    }
}

/// The exact solution of a [`Motion`].
#[derive(Debug, Clone, Copy)]
pub struct Derived<M>(pub M);

/// `∂u_i/∂x_j` with its own derivatives.
pub fn displacement_gradient<M: Motion>(motion: &M, variables: [Jet; 3]) -> Tensor {
    motion.displacement(variables).map(|u| [u.gradient[0], u.gradient[1]])
}

impl<M: Motion> Derived<M> {
    fn stress_field(&self, position: [f64; 2], time: f64) -> Tensor {
        let variables = Jet::variables(position, time);
        self.degraded_stress(self.0.displacement(variables), variables)
    }

    fn degraded_stress(&self, displacement: [Jet; 2], variables: [Jet; 3]) -> Tensor {
        let gradient = displacement.map(|u| [u.gradient[0], u.gradient[1]]);
        let material = self.0.material();
        let Some(model) = &material.fracture else { return self.0.stress(gradient) };
        let g = fracture::degradation(&material, model, self.0.phase(variables).value);
        fracture::degraded_stress(&ElasticModuli::new(&material, self.0.plane()), model.split, gradient, g)
    }
}

impl<M: Motion> ExactSolution for Derived<M> {
    fn material(&self) -> Material {
        self.0.material()
    }

    fn plane(&self) -> Plane {
        self.0.plane()
    }

    fn displacement(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        self.0.displacement([position[0], position[1], time])
    }

    fn displacement_gradient(&self, position: [f64; 2], time: f64) -> [[f64; 2]; 2] {
        self.0.displacement(Field::variables(position, time)).map(|u| [u.gradient[0], u.gradient[1]])
    }

    fn velocity(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        self.0.displacement(Field::variables(position, time)).map(|u| u.gradient[TIME])
    }

    fn acceleration(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        self.0.displacement(Jet::variables(position, time)).map(|u| u.gradient[TIME].gradient[TIME])
    }

    fn stress(&self, position: [f64; 2], time: f64) -> [[f64; 2]; 2] {
        values(self.stress_field(position, time))
    }

    fn is_force_free(&self) -> bool {
        M::FORCE_FREE
    }

    fn body_force(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        if M::FORCE_FREE {
            return [0.0; 2];
        }
        let density = self.0.material().density;
        let variables = Jet::variables(position, time);
        let displacement = self.0.displacement(variables);
        let acceleration = displacement.map(|u| u.gradient[TIME].gradient[TIME]);
        let stress = self.degraded_stress(displacement, variables);
        [0, 1].map(|i| density * acceleration[i] - stress[i][0].gradient[0] - stress[i][1].gradient[1])
    }

    fn phase(&self) -> Option<&dyn ExactPhase> {
        self.0.material().fracture.is_some().then_some(self)
    }
}

impl<M: Motion> ExactPhase for Derived<M> {
    fn value(&self, position: [f64; 2], time: f64) -> f64 {
        self.0.phase([position[0], position[1], time])
    }

    fn gradient(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        let Dual { gradient: [x, y, _], .. } = self.0.phase(Field::variables(position, time));
        [x, y]
    }

    fn history(&self, position: [f64; 2], time: f64) -> f64 {
        self.0.history(Jet::variables(position, time))
    }

    fn source(&self, position: [f64; 2], time: f64) -> f64 {
        let variables = Jet::variables(position, time);
        let Dual { value: Field { value: phase, .. }, gradient: [x, y, _] } = self.0.phase(variables);
        let material = self.0.material();
        let (Some(law), Some(model)) = (&material.fracture, FractureModel::of(&material)) else { return phase };
        let coefficient = model.reaction_per_energy() * self.0.history(variables);
        let reaction = fracture::reaction(&material, law, phase, coefficient);
        reaction - model.diffusion() * (x.gradient[0] + y.gradient[1])
    }
}

fn values(tensor: Tensor) -> [[f64; 2]; 2] {
    tensor.map(|row| row.map(|component| component.value))
}
