//! Isotropic elasticity in the plane, and wave speeds.
//!
//! Plane strain uses Lamé's first parameter as it is, plane stress `lam* = 2 lam mu/(lam + 2 mu)` on the
//! in-plane tensor, which makes `lam*/2 (tr e)² + mu e:e` the exact energy of the intact material in either
//! state.

use crate::linear_algebra::lane::Lane;
use crate::scene::{Material, Plane};

/// Moduli of the in-plane tensor, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticModuli {
    /// First Lamé constant; in plane stress that of the reduced law, lam*.
    pub lambda: f64,
    /// Shear modulus mu, the second Lamé constant, Pa.
    pub mu: f64,
    /// Stress out of the plane over the trace of the strain in it.
    pub out_of_plane: f64,
    /// Twice the energy of the change of volume over the square of that trace: the bulk modulus in plane
    /// strain; in plane stress times `((1 − 2 nu)/(1 − nu))²`, since the body becomes thinner as it is drawn.
    pub volumetric: f64,
    /// Young's modulus E of the intact material, Pa.
    pub young: f64,
}

impl ElasticModuli {
    /// Moduli of `material` in a plane state.
    pub fn new(material: &Material, plane: Plane) -> Self {
        let (young, nu) = (material.young_modulus, material.poisson_ratio);
        let mu = young / (2.0 * (1.0 + nu));
        let lambda = young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        match plane {
            Plane::Strain => Self { lambda, mu, out_of_plane: lambda, volumetric: lambda + mu / 1.5, young },
            Plane::Stress => {
                let lambda = fault!("plane-stress-lambda", young * nu / (1.0 - nu * nu) => lambda);
                let thinner = (1.0 - 2.0 * nu) / ((1.0 - nu) * (1.0 - nu));
                let part = fault!("volumetric-modulus-of-plane-strain", thinner => 1.0 / (1.0 - 2.0 * nu));
                let volumetric = young * part / 3.0;
                Self { lambda, mu, out_of_plane: 0.0, volumetric, young }
            }
        }
    }

    /// Speed of dilatational plane waves at density (kg/m³), m/s.
    pub fn dilatational_speed(&self, density: f64) -> f64 {
        ((self.lambda + 2.0 * self.mu) / density).sqrt()
    }

    /// Speed of surface waves at density (kg/m³), m/s, to 0.5 % (Viktorov 1967, *Rayleigh and Lamb waves*).
    pub fn rayleigh_speed(&self, density: f64) -> f64 {
        let nu = 0.5 * self.lambda / (self.lambda + self.mu);
        (0.87 + 1.12 * nu) / (1.0 + nu) * (self.mu / density).sqrt()
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
