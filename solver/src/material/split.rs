//! Splits of the elastic energy (E 4–6) into a part that drives fracture and is degraded, and the rest:
//!
//! ```text
//! sigma = g(c) dpsi+/de + dpsi−/de,          ⟨a⟩± = (a ± |a|)/2
//! spectral                 psi± = lam*/2 ⟨tr e⟩±² + mu tr[(e±)²]                    Miehe et al. 2010
//! volumetric-deviatoric    psi+ = K*/2 ⟨tr e⟩+² + psi_dev,  psi− = K*/2 ⟨tr e⟩−²    Amor et al. 2009
//! star-convex              psi+ = K*/2 (⟨tr e⟩+² − γ ⟨tr e⟩−²) + psi_dev            Vicentini et al. 2024
//! rankine                  psi+ = psi, driven by ⟨sigma_1⟩²/(2 E) instead of psi+   Wu 2017
//! none                     psi+ = psi
//! ```
//!
//! with lam* and K* of [`elasticity`](super::elasticity), and psi_dev what is left of the intact energy psi.
//! In plane stress the strain across the plane is that of the intact material. The degradation g(c) is in
//! [`degradation`](super::degradation).
//!
//! The spectral split needs no eigenvectors. With `m = (exx + eyy)/2` and `r = hypot((exx − eyy)/2, exy)` the
//! principal strains are `e1, e2 = m ± r`, and the tensile part is
//!
//! ```text
//! e+ = (⟨e1⟩+ + ⟨e2⟩+)/2 I + q (e − m I),          q = (⟨e1⟩+ − ⟨e2⟩+)/(2 r).
//! ```
//!
//! q lies between 0 and 1, and its error is that of the strains over r, so equal and nearly equal principal
//! strains need no special care. Squares are scaled: those of strains down to 1e-270 do not underflow.
//! A strain that is not a number has energies and stresses that are none: the energy of a body tells that one
//! of its points has lost its numbers.

use crate::linear_algebra::lane::{Lane, each};
use crate::material::elasticity::ElasticModuli;
use crate::scene::Split;

/// The part of energy and stress of a batch of points that drives fracture and is degraded, of the intact
/// material.
#[derive(Debug, Clone, Copy)]
pub struct SplitState {
    /// Energy density psi+, J/m³.
    pub energy_plus: Lane,
    /// Its stress dpsi+/de `[xx, yy, xy]`, Pa.
    pub stress_plus: [Lane; 3],
}

impl SplitState {
    /// What a degradation g takes from the energy density (J/m³) and the stress `[xx, yy, xy]` (Pa) of the
    /// intact material, with the other sign.
    #[inline(always)]
    pub fn change(&self, g: Lane) -> (Lane, [Lane; 3]) {
        let loss = g - Lane::splat(1.0);
        (loss * self.energy_plus, each!(i in [0, 1, 2] => loss * self.stress_plus[i]))
    }

    /// Energy density (J/m³) that drives fracture: psi+, or that of the largest principal stress.
    #[inline(always)]
    pub fn driving_energy<const FMA: bool>(&self, moduli: &ElasticModuli, law: Split) -> Lane {
        if law != Split::Rankine {
            return self.energy_plus;
        }
        let [xx, yy, xy] = self.stress_plus;
        let radius = hypotenuse::<FMA>((xx - yy) * 0.5, xy);
        let largest =
            ((xx + yy) * 0.5 + fault!("rankine-smallest-stress", radius => Lane::ZERO - radius)).at_least(Lane::ZERO);
        largest * largest * (fault!("rankine-modulus", 0.5 => 1.0) / moduli.young)
    }
}

/// Energy density (J/m³) and stress `[xx, yy, xy]` (Pa) of a material degraded by g (E 6), with what drives
/// fracture at the strain. The energy is half the product of stress and strain: every split is homogeneous.
#[inline(always)]
pub fn degraded<const FMA: bool>(
    moduli: &ElasticModuli,
    state: &SplitState,
    strain: [Lane; 3],
    g: Lane,
) -> (Lane, [Lane; 3]) {
    let (loss, intact) = (g - Lane::splat(1.0), moduli.stress::<FMA>(strain));
    let plus = fault!("compression-degraded", state.stress_plus => intact);
    let stress = each!(i in [0, 1, 2] => intact[i].add_product::<FMA>(loss, plus[i]));
    let shear = stress[2] * 2.0;
    let work = (stress[0] * strain[0]).add_product::<FMA>(stress[1], strain[1]).add_product::<FMA>(shear, strain[2]);
    (work * 0.5, stress)
}

/// Splits the strain `[exx, eyy, exy]` (tensor shear).
#[inline(always)]
pub fn split<const FMA: bool>(moduli: &ElasticModuli, split: Split, strain: [Lane; 3]) -> SplitState {
    match split {
        Split::Spectral => spectral::<FMA>(moduli, strain),
        Split::VolumetricDeviatoric => volumetric::<FMA>(moduli, 0.0, strain),
        Split::StarConvex(gamma) => volumetric::<FMA>(moduli, gamma, strain),
        Split::Rankine | Split::None => {
            SplitState { energy_plus: moduli.energy::<FMA>(strain), stress_plus: moduli.stress::<FMA>(strain) }
        }
    }
}

/// Energy density (J/m³) that drives fracture at a strain `[exx, eyy, exy]`.
#[inline(always)]
pub fn driving_energy<const FMA: bool>(moduli: &ElasticModuli, law: Split, strain: [Lane; 3]) -> Lane {
    split::<FMA>(moduli, law, strain).driving_energy::<FMA>(moduli, law)
}

/// The tensile part `e+` of a strain, and both principal strains, largest first.
#[inline(always)]
pub fn tensile_strain<const FMA: bool>([xx, yy, xy]: [Lane; 3]) -> ([Lane; 3], [Lane; 2]) {
    let mean = (xx + yy) * 0.5;
    let half_difference = (xx - yy) * 0.5;
    let radius = hypotenuse::<FMA>(half_difference, xy);
    let (e1, e2) = fault!("split-swapped", (mean + radius, mean - radius) => (mean - radius, mean + radius));
    let (plus1, plus2) = (e1.at_least(Lane::ZERO), e2.at_least(Lane::ZERO));
    let half_sum = (plus1 + plus2) * 0.5;
    let diameter = (radius * 2.0).at_least(Lane::splat(f64::MIN_POSITIVE));
    let q = (plus1 - plus2).zip(diameter, |difference, diameter| difference / diameter);
    let (first, second) = (half_sum.add_product::<FMA>(half_difference, q), half_difference.map(|half| -half));
    ([first, half_sum.add_product::<FMA>(second, q), xy * q], [e1, e2])
}

/// `hypot(a, b)` for 1e-270 to 1e30: scaled by a power of two, which changes no bit where squares are normal
/// numbers.
#[inline(always)]
fn hypotenuse<const FMA: bool>(a: Lane, b: Lane) -> Lane {
    const ROOT: f64 = (1_u128 << 100) as f64;
    const SCALE: f64 = ROOT * ROOT * ROOT * ROOT; // 2^400
    let (a, b) = (a * SCALE, b * SCALE);
    (a * a).add_product::<FMA>(b, b).map(f64::sqrt) * (1.0 / SCALE)
}

#[inline(always)]
fn spectral<const FMA: bool>(moduli: &ElasticModuli, strain: [Lane; 3]) -> SplitState {
    let ElasticModuli { lambda, mu, .. } = *moduli;
    let (tensile, [e1, e2]) = tensile_strain::<FMA>(strain);
    let trace = strain[0] + strain[1];
    let trace = fault!("trace-not-split", trace.at_least(Lane::ZERO) => trace);
    let (e1, e2) = (e1.at_least(Lane::ZERO), e2.at_least(Lane::ZERO));
    let (spherical, twice) = (trace * lambda, 2.0 * mu);
    let square = (e1 * e1).add_product::<FMA>(e2, e2);
    SplitState {
        energy_plus: (square * mu).add_product::<FMA>(spherical, trace * 0.5),
        stress_plus: [
            spherical.add_scaled::<FMA>(tensile[0], twice),
            spherical.add_scaled::<FMA>(tensile[1], twice),
            tensile[2] * twice,
        ],
    }
}

/// Volumetric-deviatoric for gamma = 0, else star-convex.
#[inline(always)]
fn volumetric<const FMA: bool>(moduli: &ElasticModuli, gamma: f64, strain: [Lane; 3]) -> SplitState {
    let bulk = moduli.volumetric;
    let compression = (strain[0] + strain[1]).at_most(Lane::ZERO);
    let [xx, yy, xy] = moduli.stress::<FMA>(strain);
    let star = fault!("star-convex-sign", 1.0 + gamma => 1.0 - gamma);
    let half = fault!("volumetric-energy-halved", 0.5 => 0.25);
    let pressure = compression * (star * bulk);
    SplitState {
        energy_plus: moduli.energy::<FMA>(strain) - compression * compression * (half * star * bulk),
        stress_plus: [xx - pressure, yy - pressure, xy],
    }
}
