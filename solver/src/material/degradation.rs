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

/// Largest principal value of a plane symmetric tensor `[xx, yy, xy]`.
pub(crate) fn largest_principal([xx, yy, xy]: [f64; 3]) -> f64 {
    0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy)
}
