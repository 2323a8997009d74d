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
use super::law::{self, Law, Tensor};
use super::{ExactPhase, ExactSolution, fracture, unit_material};

/// Index of time among the directions of differentiation.
const TIME: usize = 2;

/// What is chosen in an exact solution.
pub trait Motion: Send + Sync {
    /// Whether the motion needs no body force; then none is returned, not even round-off.
    const FORCE_FREE: bool = false;
    /// Law of the intact stress.
    const LAW: Law = law::linear;

    /// Material; a fracture table means that the phase field is part of the solution.
    fn material(&self) -> Material {
        unit_material(0.3)
    }
    /// Displacement, m, of x (m), y (m), t (s), in a plane state.
    fn displacement<T: Scalar>(&self, plane: Plane, variables: [T; 3]) -> [T; 2];
    /// Phase field; 1 where none is modelled.
    fn phase<T: Scalar>(&self, _variables: [T; 3]) -> T {
        T::constant(1.0)
    }
    /// History energy H, J/m³.
    fn history(&self, _plane: Plane, _variables: [Jet; 3]) -> f64 {
        0.0
    }
}

/// The exact solution of a [`Motion`].
#[derive(Debug, Clone, Copy)]
pub struct Derived<M> {
    /// Displacement, phase field and material, from which the other fields follow.
    pub motion: M,
    /// Plane state, strain or stress, for which the fields hold.
    pub plane: Plane,
}

impl<M: Motion> Derived<M> {
    fn moved<T: Scalar>(&self, variables: [T; 3]) -> [T; 2] {
        self.motion.displacement(self.plane, variables)
    }

    fn degraded_stress(&self, displacement: [Jet; 2], variables: [Jet; 3]) -> Tensor {
        let gradient = displacement.map(|u| [u.gradient[0], u.gradient[1]]);
        let material = self.motion.material();
        let moduli = ElasticModuli::new(&material, self.plane);
        let Some(model) = &material.fracture else { return M::LAW(&moduli, gradient) };
        let g = fracture::degradation(&material, model, self.motion.phase(variables).value);
        fracture::degraded_stress(&moduli, model.split, gradient, g)
    }
}

impl<M: Motion> ExactSolution for Derived<M> {
    fn material(&self) -> Material {
        self.motion.material()
    }

    fn plane(&self) -> Plane {
        self.plane
    }

    fn displacement(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        self.moved([position[0], position[1], time])
    }

    fn displacement_gradient(&self, position: [f64; 2], time: f64) -> [[f64; 2]; 2] {
        self.moved(Field::variables(position, time)).map(|u| [u.gradient[0], u.gradient[1]])
    }

    fn velocity(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        self.moved(Field::variables(position, time)).map(|u| u.gradient[TIME])
    }

    fn acceleration(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        self.moved(Jet::variables(position, time)).map(|u| u.gradient[TIME].gradient[TIME])
    }

    fn stress(&self, position: [f64; 2], time: f64) -> [[f64; 2]; 2] {
        let variables = Jet::variables(position, time);
        let stress = self.degraded_stress(self.moved(variables), variables);
        stress.map(|row| row.map(|component| component.value))
    }

    fn is_force_free(&self) -> bool {
        M::FORCE_FREE
    }

    fn body_force(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        if M::FORCE_FREE {
            return [0.0; 2];
        }
        let density = self.motion.material().density;
        let variables = Jet::variables(position, time);
        let displacement = self.moved(variables);
        let acceleration = displacement.map(|u| u.gradient[TIME].gradient[TIME]);
        let stress = self.degraded_stress(displacement, variables);
        [0, 1].map(|i| density * acceleration[i] - stress[i][0].gradient[0] - stress[i][1].gradient[1])
    }

    fn phase(&self) -> Option<&dyn ExactPhase> {
        self.motion.material().fracture.is_some().then_some(self)
    }
}

impl<M: Motion> ExactPhase for Derived<M> {
    fn value(&self, position: [f64; 2], time: f64) -> f64 {
        self.motion.phase([position[0], position[1], time])
    }

    fn gradient(&self, position: [f64; 2], time: f64) -> [f64; 2] {
        let Dual { gradient: [x, y, _], .. } = self.motion.phase(Field::variables(position, time));
        [x, y]
    }

    fn history(&self, position: [f64; 2], time: f64) -> f64 {
        self.motion.history(self.plane, Jet::variables(position, time))
    }

    fn source(&self, position: [f64; 2], time: f64) -> f64 {
        let variables = Jet::variables(position, time);
        let Dual { value: Field { value: phase, .. }, gradient: [x, y, _] } = self.motion.phase(variables);
        let material = self.motion.material();
        let (Some(law), Some(model)) = (&material.fracture, FractureModel::of(&material)) else { return phase };
        let coefficient = model.reaction_per_energy() * self.motion.history(self.plane, variables);
        let reaction = fracture::reaction(&material, law, phase, coefficient);
        reaction - model.diffusion() * (x.gradient[0] + y.gradient[1])
    }
}
