//! Constants of the phase field (E 7, E 11), and how it degrades the material.

use super::elasticity::ElasticModuli;
use super::split::{EnergySplit, split};
use crate::linear_algebra::lane::Lane;
use crate::scene::{Fracture, Split};

/// Phase field below which a point counts as broken.
pub const BROKEN: f64 = 0.05;

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

    /// Degradation `g(c) = (1 − k) c² + k` (E 7). It is taken as it stands for the small negative c that
    /// splines produce beside a jump of the history field: clipping would break the energy balance.
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

/// Stress `[xx, yy, xy]` (Pa) at a strain `[xx, yy, xy]`, degraded (E 6) where there is a phase field.
pub(crate) fn stress_at(moduli: &ElasticModuli, strain: [f64; 3], fracture: Option<(&FractureModel, f64)>) -> [f64; 3] {
    let strain = strain.map(Lane::splat);
    let stress = match fracture {
        None => moduli.stress(strain),
        Some((model, phase)) => {
            split(moduli, model.split, strain).degraded::<false>(model.degradation(Lane::splat(phase))).1
        }
    };
    stress.map(|s| s[0])
}

/// Stress out of the plane (Pa) at a strain `[xx, yy, xy]`, degraded as [`stress_at`]. The strain across the
/// plane is zero in plane strain, so only the trace gives a stress there; in plane stress there is none.
pub(crate) fn stress_out_of_plane(
    moduli: &ElasticModuli,
    [xx, yy, _]: [f64; 3],
    fracture: Option<(&FractureModel, f64)>,
) -> f64 {
    let trace = xx + yy;
    let degraded = fracture.filter(|(model, _)| model.split == EnergySplit::Whole || trace > 0.0);
    let degradation = degraded.map_or(1.0, |(model, phase)| model.degradation(Lane::splat(phase))[0]);
    degradation * moduli.out_of_plane * trace
}

/// Largest principal value of a plane symmetric tensor `[xx, yy, xy]`.
pub(crate) fn largest_principal([xx, yy, xy]: [f64; 3]) -> f64 {
    0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Plane};

    /// The derivative of the energy by the strain across the plane: of g(c) psi+ + psi− with the principal
    /// strains of the plane and a third one.
    #[test]
    fn the_stress_out_of_the_plane_is_the_derivative_of_the_energy_there() {
        let material = Material { young_modulus: 32e9, poisson_ratio: 0.2, density: 2450.0, fracture: None };
        let [strain_state, stress_state] =
            [Plane::Strain, Plane::Stress].map(|plane| ElasticModuli::new(&material, plane));
        for split in [EnergySplit::Spectral, EnergySplit::Whole] {
            let model = FractureModel { toughness: 3.0, length_scale: 1e-3, residual_stiffness: 0.0, split };
            for (strain, phase) in [([1e-3, 2e-4, 3e-4], 0.4), ([-1e-3, 2e-4, 3e-4], 0.4), ([1e-3, -2e-4, 0.0], 1.0)] {
                let fracture = Some((&model, phase));
                let found = stress_out_of_plane(&strain_state, strain, fracture);
                let energy = |across: f64| {
                    let ElasticModuli { lambda, mu, .. } = strain_state;
                    let (mean, g) = (0.5 * (strain[0] + strain[1]), phase * phase);
                    let radius = (0.5 * (strain[0] - strain[1])).hypot(strain[2]);
                    let weighted = |x: f64| if x > 0.0 || split == EnergySplit::Whole { g * x * x } else { x * x };
                    let principal = [mean + radius, mean - radius, across].map(weighted);
                    0.5 * lambda * weighted(2.0 * mean + across) + mu * principal.iter().sum::<f64>()
                };
                let step = 1e-7;
                let slope = (energy(step) - energy(-step)) / (2.0 * step);
                assert!((found - slope).abs() < 1e-3 * 32e6, "{split:?}, {strain:?}: {found:e} instead of {slope:e}");
                assert_eq!(stress_out_of_plane(&stress_state, strain, fracture), 0.0);
            }
        }
        let intact = stress_at(&strain_state, [1e-3, 2e-4, 3e-4], None);
        let out = stress_out_of_plane(&strain_state, [1e-3, 2e-4, 3e-4], None);
        assert!((out / (0.2 * (intact[0] + intact[1])) - 1.0).abs() < 1e-14, "nu (sxx + syy) where intact");
    }
}
