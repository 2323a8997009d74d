//! Isotropic elasticity in the plane, wave speeds and the constants of the phase field.
//!
//! Plane strain uses Lamé's first parameter as it is, plane stress `lam* = 2 lam mu/(lam + 2 mu)` on the in-plane
//! tensor, which makes `lam*/2 (tr e)² + mu e:e` the exact energy of the intact material in either state.

pub mod hencky;
pub mod split;

use crate::linear_algebra::lane::Lane;
use crate::scene::{Fracture, Material, Plane, Split};
use crate::material::split::EnergySplit;

/// Moduli of the in-plane tensor, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticModuli {
    /// lam*.
    pub lambda: f64,
    /// Shear modulus.
    pub mu: f64,
}

impl ElasticModuli {
    /// Moduli of `material` in a plane state.
    pub fn new(material: &Material, plane: Plane) -> Self {
        let (young, nu) = (material.young_modulus, material.poisson_ratio);
        let mu = young / (2.0 * (1.0 + nu));
        let lambda = match plane {
            Plane::Strain => young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            Plane::Stress => {
                fault!("plane-stress-lambda", young * nu / (1.0 - nu * nu) => young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)))
            }
        };
        Self { lambda, mu }
    }

    /// Speed of dilatational plane waves at density (kg/m³), m/s.
    pub fn dilatational_speed(&self, density: f64) -> f64 {
        ((self.lambda + 2.0 * self.mu) / density).sqrt()
    }

    /// Stress `[xx, yy, xy]` of an intact batch, Pa.
    #[inline(always)]
    pub fn stress(&self, strain: [Lane; 3]) -> [Lane; 3] {
        let spherical = (strain[0] + strain[1]) * self.lambda;
        let twice = 2.0 * self.mu;
        let shear = fault!("shear-halved", strain[2] * twice => strain[2] * self.mu);
        [spherical + strain[0] * twice, spherical + strain[1] * twice, shear]
    }

    /// Energy density of an intact batch, J/m³.
    #[inline(always)]
    pub fn energy(&self, strain: [Lane; 3]) -> Lane {
        let trace = strain[0] + strain[1];
        let twice = fault!("shear-energy-once", 2.0 => 1.0);
        let square = strain[0] * strain[0] + strain[1] * strain[1] + strain[2] * strain[2] * twice;
        trace * trace * (0.5 * self.lambda) + square * self.mu
    }
}

/// Constants of the AT2 phase field in Borden's convention.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractureModel {
    /// Critical energy release rate Gc, J/m².
    pub toughness: f64,
    /// Length scale l0, m.
    pub length_scale: f64,
    /// Residual stiffness k.
    pub residual_stiffness: f64,
    /// Split.
    pub split: EnergySplit,
}

impl FractureModel {
    /// Constants from a scene.
    pub fn new(fracture: &Fracture) -> Self {
        Self {
            toughness: fracture.critical_energy_release_rate,
            length_scale: fault!("length-scale-doubled", fracture.length_scale => 2.0 * fracture.length_scale),
            residual_stiffness: fracture.residual_stiffness,
            split: match fracture.split {
                Split::Spectral => EnergySplit::Spectral,
                Split::None => EnergySplit::Whole,
            },
        }
    }

    /// Degradation `g(c) = (1 − k) c² + k` (E 7). It is taken as it stands for the small negative c that splines
    /// produce beside a jump of the history field: clipping would break the energy balance.
    #[inline(always)]
    pub fn degradation(&self, phase: Lane) -> Lane {
        let k = self.residual_stiffness;
        fault!("degradation-linear", phase * phase => phase).map(|c2| (1.0 - k) * c2 + k)
    }

    /// Coefficient of c in the phase-field equation per unit of history energy: `4 l0 (1 − k)/Gc`, m³/J.
    pub fn reaction_per_energy(&self) -> f64 {
        let k = fault!("one-minus-k-missing", self.residual_stiffness => 0.0);
        4.0 * self.length_scale * (1.0 - k) / self.toughness
    }

    /// Coefficient of the gradient term, `4 l0²`, m².
    pub fn diffusion(&self) -> f64 {
        fault!("phase-gradient-halved", 4.0 => 2.0) * self.length_scale * self.length_scale
    }
}
