//! Constants of the phase field (E 7, E 11), and how it degrades the material. With d = 1 − c the surface
//! energy per volume is
//!
//! ```text
//! AT2    Gc [d²/(4 l0) + l0 |grad c|²]                                              E 3
//! AT1    3/4 Gc [d/(4 l0) + l0 |grad c|²]                                           Pham et al. 2011
//! PF-CZM 2/π Gc [(2 d − d²)/(4 l0) + l0 |grad c|²]                                  Wu 2017
//! ```
//!
//! Gc for a crack in each. An anisotropic material has `grad c · A grad c` for `|grad c|²`, and a crack with
//! the unit normal n costs `Gc sqrt(n · A n)`. Where H drives, c minimises the energy with `g H`: with AT2
//! for the largest H so far, with the others on control values between zero and those of the step before.
//! With s = g'/2, which is c unless the crack is [cohesive](super::cohesive),
//!
//! ```text
//! (4 l0 (1 − k) H/Gc + 1) c − 4 l0² lap c = 1                                       AT2, E 11
//! 4 l0 (1 − k) H/Gc c − 3 l0² lap c = 3/8                                           AT1
//! 4 l0 (1 − k) H/Gc s(c) − 8/π l0² lap c = 2/π c                                    PF-CZM
//! ```

use std::f64::consts::FRAC_2_PI;

use super::cohesive::Cohesive;
use super::elasticity::ElasticModuli;
use super::split::split;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::Lane;
use crate::scene::{Anisotropy, CrackModel, Material, Split};

/// Phase field below which a point counts as broken.
pub const BROKEN: f64 = 0.05;

/// Surface energy and degradation of a crack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CrackLaw {
    /// Quadratic in the damage.
    At2,
    /// Linear in the damage.
    At1,
    /// With a tensile strength, and stresses that fall with the opening.
    Cohesive(Cohesive),
}

/// Constants of the phase field in Borden's convention.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractureModel {
    /// Surface energy and degradation.
    pub law: CrackLaw,
    /// Critical energy release rate Gc, J/m².
    pub toughness: f64,
    /// Length scale l0, m.
    pub length_scale: f64,
    /// Residual stiffness k.
    pub residual_stiffness: f64,
    /// Split of the energy into what drives the crack and the rest.
    pub split: Split,
    /// Tensor A of the gradient term, `[xx, yy, xy]`.
    pub gradient: [f64; 3],
}

impl FractureModel {
    /// Constants of a material, if it is brittle.
    pub fn of(material: &Material) -> Option<Self> {
        let fracture = material.fracture.as_ref()?;
        let law = match fracture.model {
            CrackModel::At2 => CrackLaw::At2,
            CrackModel::At1 => CrackLaw::At1,
            CrackModel::PfCzm { softening, .. } => {
                CrackLaw::Cohesive(Cohesive::new(softening, fracture.brittleness(material.young_modulus)?))
            }
        };
        Some(Self {
            toughness: fracture.critical_energy_release_rate,
            length_scale: fault!("length-scale-doubled", fracture.length_scale => 2.0 * fracture.length_scale),
            residual_stiffness: fracture.residual_stiffness,
            law,
            split: fracture.split,
            gradient: fracture.anisotropy.map_or(Anisotropy::NONE, |anisotropy| anisotropy.components()),
        })
    }

    /// Degradation `(1 − k) g(c) + k`, with g = c² (E 7) unless the crack is cohesive. It is taken as it
    /// stands for the small negative c that splines produce beside a jump of the history field: clipping
    /// would break the energy balance. With bounds there is no such c.
    #[inline(always)]
    pub fn degradation(&self, phase: Lane) -> Lane {
        let k = self.residual_stiffness;
        let whole = match self.law {
            CrackLaw::Cohesive(law) => law.degradation(phase),
            _ => fault!("degradation-linear", phase * phase => phase),
        };
        whole.map(|g| (1.0 - k) * g + k)
    }

    /// `s = g'/2`, the derivative of the degradation over 2 (1 − k).
    #[inline(always)]
    pub fn half_slope(&self, phase: Lane) -> Lane {
        match self.law {
            CrackLaw::Cohesive(law) => law.slope(phase) * fault!("cohesive-slope-doubled", 0.5 => 1.0),
            _ => phase,
        }
    }

    /// The derivative of s.
    #[inline(always)]
    pub fn half_curvature(&self, phase: Lane) -> Lane {
        match self.law {
            CrackLaw::Cohesive(law) => law.curvature(phase) * 0.5,
            _ => Lane::splat(1.0),
        }
    }

    /// Coefficient of s in the phase-field equation per unit of history energy: `4 l0 (1 − k)/Gc`, m³/J.
    pub fn reaction_per_energy(&self) -> f64 {
        let k = fault!("one-minus-k-missing", self.residual_stiffness => 0.0);
        4.0 * self.length_scale * (1.0 - k) / self.toughness
    }

    /// Coefficient of the gradient term, m².
    pub fn diffusion(&self) -> f64 {
        let factor = match self.law {
            CrackLaw::At2 => fault!("phase-gradient-halved", 4.0 => 2.0),
            CrackLaw::At1 => fault!("at1-gradient-of-at2", 3.0 => 4.0),
            CrackLaw::Cohesive(_) => fault!("cohesive-gradient-halved", 4.0 => 2.0) * FRAC_2_PI,
        };
        factor * self.length_scale * self.length_scale
    }

    /// Right-hand side of the phase-field equation of intact material.
    pub fn source(&self) -> f64 {
        match self.law {
            CrackLaw::At2 => 1.0,
            CrackLaw::At1 => fault!("at1-source-doubled", 0.375 => 0.75),
            CrackLaw::Cohesive(_) => fault!("cohesive-source-halved", FRAC_2_PI => 0.5 * FRAC_2_PI),
        }
    }

    /// Driving energy up to which material stays intact, J/m³: `3 Gc/(32 l0 (1 − k))` with AT1, `ft²/(2 E (1
    /// − k))` with a cohesive crack; none if damage begins with the first load.
    pub fn threshold(&self) -> Option<f64> {
        let slope = match self.law {
            CrackLaw::At2 => return None,
            CrackLaw::At1 => 1.0,
            CrackLaw::Cohesive(law) => 0.5 * law.a1(),
        };
        Some(self.source() / (slope * self.reaction_per_energy()))
    }

    /// Energy density of the intact body up to which nothing is driven to a threshold (J/m³), with a margin
    /// for the step that crosses it, J/m³.
    pub(crate) fn screening_level(&self, moduli: &ElasticModuli, threshold: f64) -> f64 {
        let least_share = match self.split {
            Split::Rankine => moduli.young / (moduli.lambda + 2.0 * moduli.mu),
            _ => 1.0,
        };
        fault!("tiles-enter-late", 0.5 => 5.0) * least_share * threshold
    }

    /// By how much damage raises a squared frequency of the body at most. Compression of broken material has
    /// the star-convex energy `(1 + γ) K*/2 e²`, that of intact material at least `(lam* + mu)/2 e²`.
    pub(crate) fn stiffening(&self, moduli: &ElasticModuli) -> f64 {
        match self.split {
            Split::StarConvex(gamma) => larger(1.0, (1.0 + gamma) * moduli.volumetric / (moduli.lambda + moduli.mu)),
            _ => 1.0,
        }
    }

    /// Column of the work of what drives beyond psi+: of the history, or of another driving energy. None
    /// where psi+ itself drives.
    pub(crate) fn driving_work(&self) -> Option<&'static str> {
        match (self.law, self.split) {
            (CrackLaw::At2, split) if split != Split::Rankine => Some("history_work_j"),
            (_, Split::Rankine | Split::StarConvex(_)) => Some("driving_work_j"),
            _ => None,
        }
    }

    /// Columns of the work that the phase field does; `skips` if there are steps without a solve.
    pub fn columns_of_work(&self, skips: bool) -> Vec<&'static str> {
        let of_bounds = self.threshold().map(|_| "phase_field_bounds_j");
        let of_residual = of_bounds.or(skips.then_some("phase_field_lag_j"));
        self.driving_work().into_iter().chain(of_residual).collect()
    }

    /// Surface energy per volume, J/m³, with the mean of Gc.
    #[inline(always)]
    pub fn surface_energy(&self, phase: Lane, [gx, gy]: [Lane; 2]) -> Lane {
        let Self { toughness, length_scale, gradient: [xx, yy, xy], .. } = *self;
        let broken = Lane::splat(1.0) - phase;
        let (local, unit) = match self.law {
            CrackLaw::At2 => (broken * broken, toughness),
            CrackLaw::At1 => (broken, fault!("at1-surface-unscaled", 0.75 => 1.0) * toughness),
            CrackLaw::Cohesive(_) => (
                broken * (fault!("cohesive-surface-linear", phase => Lane::ZERO) + Lane::splat(1.0)),
                FRAC_2_PI * toughness,
            ),
        };
        local * (unit / (fault!("surface-energy-doubled", 4.0 => 2.0) * length_scale))
            + (gx * gx * xx + gy * gy * yy + gx * gy * (2.0 * xy)) * (unit * length_scale)
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
    let Some((model, phase)) = fracture else { return moduli.out_of_plane * trace };
    let degradation = model.degradation(Lane::splat(phase))[0];
    let spared = match model.split {
        Split::Spectral if trace <= 0.0 => moduli.out_of_plane,
        Split::VolumetricDeviatoric if moduli.out_of_plane > 0.0 => moduli.volumetric,
        Split::StarConvex(gamma) if moduli.out_of_plane > 0.0 => (1.0 + gamma) * moduli.volumetric,
        _ => 0.0,
    };
    (degradation * (moduli.out_of_plane * trace - spared * trace.min(0.0))) + spared * trace.min(0.0)
}

/// Largest principal value of a plane symmetric tensor `[xx, yy, xy]`.
pub(crate) fn largest_principal([xx, yy, xy]: [f64; 3]) -> f64 {
    0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Plane;

    /// The derivative of the energy by the strain across the plane: of g(c) psi+ + psi− with the principal
    /// strains of the plane and a third one.
    #[test]
    fn the_stress_out_of_the_plane_is_the_derivative_of_the_energy_there() {
        let material = Material { young_modulus: 32e9, poisson_ratio: 0.2, density: 2450.0, fracture: None };
        let [strain_state, stress_state] =
            [Plane::Strain, Plane::Stress].map(|plane| ElasticModuli::new(&material, plane));
        for split in [Split::Spectral, Split::None] {
            let (law, residual_stiffness) = (CrackLaw::At2, 0.0);
            let gradient = Anisotropy::NONE;
            let model = FractureModel { law, toughness: 3.0, length_scale: 1e-3, residual_stiffness, split, gradient };
            for (strain, phase) in [([1e-3, 2e-4, 3e-4], 0.4), ([-1e-3, 2e-4, 3e-4], 0.4), ([1e-3, -2e-4, 0.0], 1.0)] {
                let fracture = Some((&model, phase));
                let found = stress_out_of_plane(&strain_state, strain, fracture);
                let energy = |across: f64| {
                    let ElasticModuli { lambda, mu, .. } = strain_state;
                    let (mean, g) = (0.5 * (strain[0] + strain[1]), phase * phase);
                    let radius = (0.5 * (strain[0] - strain[1])).hypot(strain[2]);
                    let weighted = |x: f64| if x > 0.0 || split == Split::None { g * x * x } else { x * x };
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
