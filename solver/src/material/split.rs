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

use crate::linear_algebra::lane::Lane;
use crate::material::elasticity::ElasticModuli;
use crate::scene::Split;

/// Energies and stresses of a batch of points: intact values of both parts.
#[derive(Debug, Clone, Copy)]
pub struct SplitState {
    /// Energy density that drives fracture, psi+, J/m³.
    pub energy_plus: Lane,
    /// The rest, psi−, J/m³.
    pub energy_minus: Lane,
    /// Stress of the driving part `[xx, yy, xy]`, Pa.
    pub stress_plus: [Lane; 3],
    /// Stress of the rest `[xx, yy, xy]`, Pa.
    pub stress_minus: [Lane; 3],
}

impl SplitState {
    /// Energy density (J/m³) and stress `[xx, yy, xy]` (Pa) of a material degraded by g (E 6).
    #[inline(always)]
    pub fn degraded<const FMA: bool>(&self, g: Lane) -> (Lane, [Lane; 3]) {
        // no array::map: it is compiled on its own, without FMA, where each product would be a call of the
        // library
        let mut stress = fault!("compression-degraded", self.stress_minus => self.stress_minus.map(|s| s * g));
        for (stress, plus) in stress.iter_mut().zip(self.stress_plus) {
            *stress = stress.add_product::<FMA>(g, plus);
        }
        (self.energy_minus.add_product::<FMA>(g, self.energy_plus), stress)
    }

    /// Energy density (J/m³) that drives fracture: psi+, or that of the largest principal stress.
    #[inline(always)]
    pub fn driving_energy(&self, moduli: &ElasticModuli, law: Split) -> Lane {
        if law != Split::Rankine {
            return self.energy_plus;
        }
        let [xx, yy, xy] = self.stress_plus;
        let radius = hypotenuse((xx - yy) * 0.5, xy);
        let largest =
            ((xx + yy) * 0.5 + fault!("rankine-smallest-stress", radius => Lane::ZERO - radius)).at_least(Lane::ZERO);
        largest * largest * (fault!("rankine-modulus", 0.5 => 1.0) / moduli.young)
    }
}

/// Splits the strain `[exx, eyy, exy]` (tensor shear).
#[inline(always)]
pub fn split(moduli: &ElasticModuli, split: Split, strain: [Lane; 3]) -> SplitState {
    match split {
        Split::Spectral => spectral(moduli, strain),
        Split::VolumetricDeviatoric => volumetric(moduli, 0.0, strain),
        Split::StarConvex(gamma) => volumetric(moduli, gamma, strain),
        Split::Rankine | Split::None => whole(moduli, strain),
    }
}

/// Energy density (J/m³) that drives fracture at a strain `[exx, eyy, exy]`.
#[inline(always)]
pub fn driving_energy(moduli: &ElasticModuli, law: Split, strain: [Lane; 3]) -> Lane {
    split(moduli, law, strain).driving_energy(moduli, law)
}

/// The tensile part `e+` of a strain and both principal strains, largest first.
#[inline(always)]
pub fn tensile_strain([xx, yy, xy]: [Lane; 3]) -> ([Lane; 3], [Lane; 2]) {
    let mean = (xx + yy) * 0.5;
    let half_difference = (xx - yy) * 0.5;
    let radius = hypotenuse(half_difference, xy);
    let (e1, e2) = fault!("split-swapped", (mean + radius, mean - radius) => (mean - radius, mean + radius));
    let (plus1, plus2) = (e1.at_least(Lane::ZERO), e2.at_least(Lane::ZERO));
    let half_sum = (plus1 + plus2) * 0.5;
    let diameter = (radius * 2.0).at_least(Lane::splat(f64::MIN_POSITIVE));
    let q = (plus1 - plus2).zip(diameter, |difference, diameter| difference / diameter);
    let deviator = half_difference * q;
    ([half_sum + deviator, half_sum - deviator, xy * q], [e1, e2])
}

/// `hypot(a, b)` for 1e-270 to 1e30: scaled by a power of two, which changes no bit where squares are normal
/// numbers.
#[inline(always)]
fn hypotenuse(a: Lane, b: Lane) -> Lane {
    const ROOT: f64 = (1_u128 << 100) as f64;
    const SCALE: f64 = ROOT * ROOT * ROOT * ROOT; // 2^400
    let (a, b) = (a * SCALE, b * SCALE);
    (a * a + b * b).map(f64::sqrt) * (1.0 / SCALE)
}

#[inline(always)]
fn spectral(moduli: &ElasticModuli, strain: [Lane; 3]) -> SplitState {
    let ElasticModuli { lambda, mu, .. } = *moduli;
    let (tensile, [e1, e2]) = tensile_strain(strain);
    let trace = strain[0] + strain[1];
    let (trace_plus, trace_minus) =
        fault!("trace-not-split", (trace.at_least(Lane::ZERO), trace.at_most(Lane::ZERO)) => (trace, Lane::ZERO));
    let square = |a: Lane, b: Lane| a * a + b * b;
    let plus = square(e1.at_least(Lane::ZERO), e2.at_least(Lane::ZERO));
    let minus = square(e1.at_most(Lane::ZERO), e2.at_most(Lane::ZERO));
    let stress = |trace: Lane, [xx, yy, xy]: [Lane; 3]| {
        [trace * lambda + xx * (2.0 * mu), trace * lambda + yy * (2.0 * mu), xy * (2.0 * mu)]
    };
    let compressive = [strain[0] - tensile[0], strain[1] - tensile[1], strain[2] - tensile[2]];
    SplitState {
        energy_plus: trace_plus * trace_plus * (0.5 * lambda) + plus * mu,
        energy_minus: trace_minus * trace_minus * (0.5 * lambda) + minus * mu,
        stress_plus: stress(trace_plus, tensile),
        stress_minus: stress(trace_minus, compressive),
    }
}

/// Volumetric-deviatoric for gamma = 0, else star-convex.
#[inline(always)]
fn volumetric(moduli: &ElasticModuli, gamma: f64, strain: [Lane; 3]) -> SplitState {
    let bulk = moduli.volumetric;
    let trace = strain[0] + strain[1];
    let compression = trace.at_most(Lane::ZERO);
    let energy = moduli.energy(strain);
    let stress = moduli.stress(strain);
    let star = fault!("star-convex-sign", 1.0 + gamma => 1.0 - gamma);
    let half = fault!("volumetric-energy-halved", 0.5 => 0.25);
    let energy_minus = compression * compression * (half * star * bulk);
    let pressure = compression * (star * bulk);
    SplitState {
        energy_plus: energy - energy_minus,
        energy_minus,
        stress_plus: [stress[0] - pressure, stress[1] - pressure, stress[2]],
        stress_minus: [pressure, pressure, Lane::ZERO],
    }
}

#[inline(always)]
fn whole(moduli: &ElasticModuli, strain: [Lane; 3]) -> SplitState {
    SplitState {
        energy_plus: moduli.energy(strain),
        energy_minus: Lane::ZERO,
        stress_plus: moduli.stress(strain),
        stress_minus: [Lane::ZERO; 3],
    }
}
