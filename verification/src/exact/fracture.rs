//! The models of a crack on fields that know their derivatives: what is degraded, and the terms of the
//! phase-field equation. Formulas: [`fisura::material::split`] and [`fisura::material::degradation`]; here
//! they are written by eigenvalues and projectors, and a cohesive crack by [`cohesive`](super::cohesive).
//!
//! ```text
//! sigma = g dpsi+/de + (C e − dpsi+/de)
//! s     = 4 l0 (1 − k) H/Gc g'/2 + local(c) − D Δc
//! local = c (AT2), 0 (AT1), 2/π (1 − c) (PF-CZM)
//! ```
//!
//! s is the right-hand side of [`fisura::dynamics::forcing::Forcing::phase_source`].

use std::f64::consts::FRAC_2_PI;

use fisura::material::elasticity::ElasticModuli;
use fisura::scene::{CrackModel, Fracture, Material, Split};

use super::cohesive::CohesiveLaw;
use super::dual::{Field, Scalar};
use super::law::{self, Tensor};

/// Degradation with the residual stiffness.
pub fn degradation(material: &Material, fracture: &Fracture, phase: Field) -> Field {
    let k = fracture.residual_stiffness;
    let whole = match CohesiveLaw::of(material) {
        Some(law) => {
            let [value, slope] = law.degradation(phase.value);
            phase.chain(value, slope)
        }
        None => phase * phase,
    };
    whole * (1.0 - k) + k
}

/// What stands in the phase-field equation beside `D Δc`, given the coefficient `4 l0 (1 − k) H/Gc`.
pub fn reaction(material: &Material, fracture: &Fracture, phase: f64, coefficient: f64) -> f64 {
    let half_slope = CohesiveLaw::of(material).map_or(phase, |law| 0.5 * law.degradation(phase)[1]);
    let local = match fracture.model {
        CrackModel::At2 => phase,
        CrackModel::At1 => 0.0,
        CrackModel::PfCzm { .. } => FRAC_2_PI * (1.0 - phase),
    };
    coefficient * half_slope + local
}

/// Stress of which a part is degraded by g, Pa, from the displacement gradient.
pub fn degraded_stress(moduli: &ElasticModuli, split: Split, gradient: Tensor, g: Field) -> Tensor {
    let intact = law::linear(moduli, gradient);
    let driving = driving_part(moduli, split, gradient).0;
    let mixed = |i: usize, j: usize| intact[i][j] + driving[i][j] * (g - 1.0);
    [[mixed(0, 0), mixed(0, 1)], [mixed(1, 0), mixed(1, 1)]]
}

/// Energy that drives a crack, J/m³, from the displacement gradient.
pub fn driving_energy(moduli: &ElasticModuli, split: Split, gradient: Tensor) -> f64 {
    if split == Split::Rankine {
        let [largest, _] = principal(law::linear(moduli, gradient));
        return largest.value.max(0.0).powi(2) / (2.0 * moduli.young);
    }
    driving_part(moduli, split, gradient).1.value
}

/// Principal values of a symmetric tensor, largest first.
fn principal([[xx, xy], [_, yy]]: Tensor) -> [Field; 2] {
    let (mean, half) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
    let radius = (half * half + xy * xy).sqrt();
    [mean + radius, mean - radius]
}

/// `dpsi+/de` (Pa) and psi+ (J/m³).
fn driving_part(moduli: &ElasticModuli, split: Split, gradient: Tensor) -> (Tensor, Field) {
    let shear = (gradient[0][1] + gradient[1][0]) * 0.5;
    let strain = [[gradient[0][0], shear], [shear, gradient[1][1]]];
    let [[xx, _], [_, yy]] = strain;
    let (trace, zero) = (xx + yy, Field::constant(0.0));
    let intact = law::linear(moduli, gradient);
    let psi = trace * trace * (0.5 * moduli.lambda) + (xx * xx + yy * yy + shear * shear * 2.0) * moduli.mu;
    let with_pressure = |[[xx, xy], [yx, yy]]: Tensor, pressure: Field| [[xx + pressure, xy], [yx, yy + pressure]];
    let star_convex = |gamma: f64| {
        let kept = (1.0 + gamma) * moduli.volumetric;
        let compression = if trace.value < 0.0 { trace } else { zero };
        (with_pressure(intact, compression * -kept), psi - compression * compression * (0.5 * kept))
    };
    match split {
        Split::None | Split::Rankine => (intact, psi),
        Split::VolumetricDeviatoric => star_convex(0.0),
        Split::StarConvex(gamma) => star_convex(gamma),
        Split::Spectral => {
            let [e1, e2] = principal(strain);
            if e2.value >= 0.0 {
                return (intact, psi);
            }
            let tension = |a: Field| if a.value > 0.0 { a } else { zero };
            // e+ = e1 (e − e2 I)/(e1 − e2)
            let factor = tension(e1) / (e1 - e2) * (2.0 * moduli.mu);
            let tensile = [[(xx - e2) * factor, shear * factor], [shear * factor, (yy - e2) * factor]];
            let energy = tension(trace) * tension(trace) * (0.5 * moduli.lambda) + tension(e1) * e1 * moduli.mu;
            (with_pressure(tensile, tension(trace) * moduli.lambda), energy)
        }
    }
}
