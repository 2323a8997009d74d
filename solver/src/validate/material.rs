//! Checks of materials: ranges of the constants, and whether the wave speed they imply is possible.

use super::findings::Findings;
use crate::material::elasticity::ElasticModuli;
use crate::scene::{Fracture, Material, Plane, Scene};

/// No solid carries waves faster than this, m/s (diamond: 18 km/s).
const FASTEST: f64 = 3e4;
/// Speeds below this are suspicious, m/s.
const SLOW: f64 = 50.0;
/// Speeds below this are a wrong unit, m/s.
const SLOWEST: f64 = 0.05;

pub(super) fn check(scene: &Scene, findings: &mut Findings) {
    for (name, material) in &scene.materials {
        let key = format!("material.{name}");
        let mut sound =
            findings.positive(format!("{key}.young_modulus"), material.young_modulus, "young_modulus = \"32 GPa\"");
        sound &= findings.positive(format!("{key}.density"), material.density, "density = \"2450 kg/m^3\"");
        sound &= poisson_ratio(&key, material.poisson_ratio, scene.analysis.plane, findings);
        if sound {
            wave_speed(&key, material, scene.analysis.plane, findings);
        }
        if let Some(fracture) = &material.fracture {
            check_fracture(&format!("{key}.fracture"), fracture, findings);
        }
        if !scene.bodies.iter().any(|b| b.material == *name) {
            findings.warn(key, "no body is made of this material; remove it, or correct body.material");
        }
    }
}

fn poisson_ratio(key: &str, ratio: f64, plane: Plane, findings: &mut Findings) -> bool {
    let key = format!("{key}.poisson_ratio");
    let remedy = "give a value between -1 and 0.5, such as 0.2";
    match plane {
        Plane::Strain if ratio == 0.5 => {
            let message = "0.5 is incompressible, which plane strain cannot model with displacements alone";
            let remedy = "plane strain needs a value below 0.5, such as 0.49; plane stress allows 0.5";
            findings.error(key, message, remedy);
            false
        }
        _ if ratio > -1.0 && ratio <= 0.5 => true,
        _ => {
            findings.error(key, format!("{ratio} is outside (-1, 0.5)"), remedy);
            false
        }
    }
}

/// Speed of dilatational waves, m/s, if a solid can have it.
pub(super) fn plausible_speed(material: &Material, plane: Plane) -> Option<f64> {
    let speed = ElasticModuli::new(material, plane).dilatational_speed(material.density);
    (SLOWEST..=FASTEST).contains(&speed).then_some(speed)
}

fn wave_speed(key: &str, material: &Material, plane: Plane, findings: &mut Findings) {
    let speed = ElasticModuli::new(material, plane).dilatational_speed(material.density);
    let key = format!("{key}.density");
    let implied = format!("with this density dilatational waves travel at {speed:.3e} m/s");
    if speed > FASTEST {
        let plausible = |factor: f64| (SLOW..FASTEST).contains(&(speed / factor.sqrt()));
        let looks_like = |unit: &str, factor: f64| {
            let si = rounded(material.density * factor);
            format!("{:e} looks like {unit}: write {si} kg/m^3", material.density)
        };
        let remedy = if plausible(1e12) {
            looks_like("tonnes per cubic millimetre", 1e12)
        } else if plausible(1e3) {
            looks_like("grams per cubic centimetre", 1e3)
        } else {
            "check the units of density (kg/m^3) and young_modulus (Pa)".to_string()
        };
        findings.error(key, format!("{implied}, faster than in any solid"), remedy);
    } else if speed < SLOWEST {
        let remedy = "check the units of density (kg/m^3) and young_modulus (Pa), or write them: \"32 GPa\"";
        findings.error(key, format!("{implied}, slower than in any solid"), remedy);
    } else if speed < SLOW {
        let message =
            format!("{implied}, which is slow for a solid; if young_modulus is in MPa or GPa, write the unit");
        findings.warn(key, message);
    }
}

/// `value` to ten significant digits, to drop what a factor left in the last ones.
fn rounded(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}

fn check_fracture(key: &str, fracture: &Fracture, findings: &mut Findings) {
    let rate = fracture.critical_energy_release_rate;
    let like = "critical_energy_release_rate = \"3 J/m^2\"";
    findings.positive(format!("{key}.critical_energy_release_rate"), rate, like);
    findings.positive(format!("{key}.length_scale"), fracture.length_scale, "length_scale = \"0.25 mm\"");
    if !(0.0..1.0).contains(&fracture.residual_stiffness) {
        let message = format!("{} is outside [0, 1)", fracture.residual_stiffness);
        findings.error(format!("{key}.residual_stiffness"), message, "give a small fraction, such as 0 or 1e-6");
    }
}
