//! Checks of materials: ranges of the constants, and whether the wave speed they imply is possible.

use super::ground::Findings;
use crate::material::cohesive::Cohesive;
use crate::material::elasticity::ElasticModuli;
use crate::scene::{CrackModel, Fracture, Frame, Material, Plane, Scene, Split};

/// Least a1 of a cohesive crack (Wu 2017): with linear softening g is convex from there on.
const LEAST_BRITTLENESS: f64 = 1.5;
/// An a1 beyond belongs to a number without its unit: process zones are not ten thousand times as long as l0.
const MOST_BRITTLENESS: f64 = 1e5;
/// What two entries of a symmetric tensor may differ by, of themselves.
const SYMMETRY: f64 = 1e-12;
/// Least modulus of Weibull: the median is then half of the mean by far.
const LEAST_MODULUS: f64 = 0.5;
/// No solid carries waves faster than this, m/s (diamond: 18 km/s).
const FASTEST: f64 = 3e4;
/// Speeds below this are suspicious, m/s.
const SLOW: f64 = 50.0;
/// Speeds below this are a wrong unit, m/s.
const SLOWEST: f64 = 0.05;
/// Common solids carry waves no faster than this, m/s (beryllium: 12.9 km/s).
const COMMON_SPEED: f64 = 13e3;
/// Densities outside are suspicious, kg/m³ (aerogel: 1; osmium: 22 600).
const LIGHTEST: f64 = 1.0;
const HEAVIEST: f64 = 25e3;
/// Common solids are at least as dense, kg/m³. Up to [`HEAVIEST`] that is a factor of a thousand, as between
/// units.
const COMMON_DENSITY: f64 = 25.0;
/// Units of density and of modulus that are in use, in SI, the largest modulus first.
const DENSITY_UNITS: [(&str, f64); 6] =
    [("g/m^3", 1e-3), ("kg/m^3", 1.0), ("g/cm^3", 1e3), ("g/mm^3", 1e6), ("kg/mm^3", 1e9), ("t/mm^3", 1e12)];
const MODULUS_UNITS: [(&str, f64); 4] = [("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3), ("Pa", 1.0)];

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
            let key = format!("{key}.fracture");
            check_fracture(&key, fracture, findings);
            model(&key, fracture, scene.analysis.frame, findings);
            cohesive(&key, fracture, material.young_modulus, findings);
            varying_toughness(&key, fracture, scene.analysis.frame, findings);
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

/// The wave speed and the density are possible; where they are not, a remedy says which units look mixed.
fn wave_speed(key: &str, material: &Material, plane: Plane, findings: &mut Findings) {
    let (density, key) = (material.density, format!("{key}.density"));
    let speed = ElasticModuli::new(material, plane).dilatational_speed(density);
    let implied = format!("with this density dilatational waves travel at {speed:.3e} m/s");
    let remedy = likely_units(material, speed);
    if speed > FASTEST {
        findings.error(key, format!("{implied}, faster than in any solid"), remedy);
    } else if speed < SLOWEST {
        findings.error(key, format!("{implied}, slower than in any solid"), remedy);
    } else if speed < SLOW {
        findings.warn(key, format!("{implied}, which is slow for a solid, though right for a gel; {remedy}"));
    } else if !(LIGHTEST..HEAVIEST).contains(&density) {
        let than = if density < LIGHTEST { "lighter" } else { "heavier" };
        findings.warn(key, format!("{density:e} kg/m^3 is {than} than any solid; {remedy}"));
    }
}

/// The units in which density and modulus were probably written, and what to write. The density has one unit
/// in which it is that of a solid, and the modulus is then in the largest that leaves the speed of waves one.
fn likely_units(material: &Material, speed: f64) -> String {
    let (density, modulus) = (material.density, material.young_modulus);
    let of_density = DENSITY_UNITS.iter().find(|(_, si)| (COMMON_DENSITY..HEAVIEST).contains(&(density * si)));
    let &(density_unit, factor) = of_density.unwrap_or(&("kg/m^3", 1.0));
    let faster = |si: f64| speed * (si / factor).sqrt();
    let of_modulus = MODULUS_UNITS.iter().find(|(_, si)| (SLOW..COMMON_SPEED).contains(&faster(*si)));
    let modulus_unit = of_modulus.map_or("Pa", |(unit, _)| unit);
    let mut looks = Vec::new();
    if density_unit != "kg/m^3" {
        looks.push(format!("density = {density:e} like {density_unit} ({} kg/m^3)", rounded(density * factor)));
    }
    if modulus_unit != "Pa" {
        looks.push(format!("young_modulus = {modulus:e} like {modulus_unit}"));
    }
    if looks.is_empty() {
        return "check the units of density (kg/m^3) and young_modulus (Pa)".to_string();
    }
    format!(
        "check both values and their units; numbers without a unit are SI, and if these have none, they look like \
         other units: {}; then write the unit with every number, lengths and loads too, as in density = \"{density:e} {density_unit}\" and young_modulus = \"{modulus:e} {modulus_unit}\"",
        looks.join(", ")
    )
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

/// What surface energies and splits combine with.
fn model(key: &str, fracture: &Fracture, frame: Frame, findings: &mut Findings) {
    if fracture.model.has_threshold() && frame == Frame::Updated {
        let word = fracture.model.word();
        let message =
            format!("{word} bounds the phase field on control points, which the updated frame changes in every step");
        findings.error(format!("{key}.model"), message, "use frame = \"total\", or model = \"at2\"");
    }
    if let Split::StarConvex(gamma) = fracture.split
        && !(gamma >= 0.0 && gamma.is_finite())
    {
        let remedy = "give a number such as 3.0; 0 is the volumetric-deviatoric split";
        findings.error(format!("{key}.split.star-convex"), format!("{gamma} is not zero or more"), remedy);
    }
}

/// A toughness that depends on direction or place belongs to the total frame; it stays positive.
fn varying_toughness(key: &str, fracture: &Fracture, frame: Frame, findings: &mut Findings) {
    if let Some(anisotropy) = fracture.anisotropy {
        let [[xx, xy], [yx, yy]] = anisotropy.tensor;
        let key = format!("{key}.anisotropy.tensor");
        if findings.finite(key.clone(), &[xx, xy, yx, yy, anisotropy.angle]) {
            if (xy - yx).abs() > SYMMETRY * (xy.abs() + yx.abs()) {
                findings.error(key, format!("{xy} and {yx} differ"), "give a symmetric tensor");
            } else if anisotropy.smallest() <= SYMMETRY * (xx.abs() + yy.abs()) {
                let message = "the tensor is not positive definite: cracks of some direction would cost nothing";
                findings.error(key, message, "give positive principal values, such as [[1.0, 0.0], [0.0, 4.0]]");
            }
        }
    }
    if let Some(random) = fracture.random {
        let key = |name: &str| format!("{key}.random.{name}");
        findings.positive(key("correlation"), random.correlation, "correlation = \"1 mm\"");
        if findings.positive(key("modulus"), random.modulus, "modulus = 2.0") && random.modulus < LEAST_MODULUS {
            let message = format!("with {} most of the material has next to no toughness", random.modulus);
            findings.error(key("modulus"), message, format!("give at least {LEAST_MODULUS}"));
        }
        if matches!(fracture.model, CrackModel::PfCzm { .. }) {
            let message = "with pf-czm the softening would change with the toughness from place to place";
            findings.error(key("field"), message, "use model = \"at1\" or \"at2\"");
        }
    }
    let given = [
        ("anisotropy", fracture.anisotropy.is_some()),
        ("random", fracture.random.is_some()),
        ("mesh_toughness", fracture.mesh_toughness),
    ];
    for (name, _) in given.into_iter().filter(|(_, given)| *given && frame == Frame::Updated) {
        let message = "in the updated frame Gc is the same in every direction and at every place";
        findings.error(format!("{key}.{name}"), message, "use frame = \"total\", or remove the key");
    }
}

/// A cohesive crack is elastic up to its strength if l0 is short enough, and stable beyond if it is shorter.
fn cohesive(key: &str, fracture: &Fracture, young_modulus: f64, findings: &mut Findings) {
    let CrackModel::PfCzm { tensile_strength, softening } = fracture.model else { return };
    let like = "tensile_strength = \"3 MPa\"";
    if !findings.positive(format!("{key}.tensile_strength"), tensile_strength, like) {
        return;
    }
    let positive = |value: f64| value > 0.0 && value.is_finite();
    if ![young_modulus, fracture.critical_energy_release_rate, fracture.length_scale].into_iter().all(positive) {
        return; // each has an error of its own
    }
    let Some(a1) = fracture.brittleness(young_modulus) else { return };
    if !a1.is_finite() || a1 > MOST_BRITTLENESS {
        let message = format!("{tensile_strength:e} Pa is next to no strength: a1 = 2 E Gc/(pi l0 ft^2) is {a1:.3e}");
        findings.error(
            format!("{key}.tensile_strength"),
            message,
            "write the unit, as in tensile_strength = \"3 MPa\"",
        );
        return;
    }
    let longest = |a1_at_least: f64| fracture.length_scale * a1 / a1_at_least;
    let law = Cohesive::new(softening, a1);
    if a1 < LEAST_BRITTLENESS {
        let message = format!("l0 is {} m, longer than 4/(3 pi) E Gc/ft^2", fracture.length_scale);
        let remedy = format!("give l0 of at most {:.4e} m, or a lower tensile_strength", longest(LEAST_BRITTLENESS));
        findings.error(format!("{key}.length_scale"), message, remedy);
    } else if a1 < law.stable_from() {
        let (needed, longest) = (law.stable_from(), longest(law.stable_from()));
        let message = format!(
            "a1 = 2 E Gc/(pi l0 ft^2) is {a1:.3}, below {needed:.3}: where the strength is reached over a region, its \
             damage jumps; with l0 of at most {longest:.4e} m it grows"
        );
        findings.warn(format!("{key}.length_scale"), message);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of a density and a modulus, and whether it is an error.
    fn said(density: f64, young_modulus: f64) -> Option<(bool, String)> {
        let material = Material { young_modulus, poisson_ratio: 0.2, density, fracture: None };
        let mut findings = Findings::default();
        wave_speed("material.glass", &material, Plane::Strain, &mut findings);
        let error = findings.errors.pop().map(|error| (true, error.message + &error.remedy));
        error.or_else(|| findings.warnings.pop().map(|warning| (false, warning.message)))
    }

    #[test]
    fn the_units_that_are_mixed_are_named() {
        for (density, modulus, refused, units) in [
            (2450e-9, 32e3, true, ["like kg/mm^3 (2450 kg/m^3)", "young_modulus = 3.2e4 like MPa"]),
            (2450e-9, 32e9, true, ["like kg/mm^3 (2450 kg/m^3)", "\"3.2e10 Pa\""]),
            (2450e-9, 32.0, false, ["like kg/mm^3 (2450 kg/m^3)", "young_modulus = 3.2e1 like GPa"]),
            (7.85e-9, 210e3, true, ["like t/mm^3 (7850 kg/m^3)", "young_modulus = 2.1e5 like MPa"]),
            (2.45e-3, 32e3, false, ["lighter than any solid", "like g/mm^3 (2450 kg/m^3)"]),
            (2.45, 32e9, true, ["like g/cm^3 (2450 kg/m^3)", "\"2.45e0 g/cm^3\""]),
            (2.45e6, 32e9, false, ["heavier than any solid", "like g/m^3 (2450 kg/m^3)"]),
            (2450.0, 32e3, false, ["slow for a solid", "young_modulus = 3.2e4 like MPa"]),
            (2450.0, 0.032, true, ["slower than in any solid", "young_modulus = 3.2e-2 like GPa"]),
            (2450.0, 32e15, true, ["faster than in any solid", "check the units"]),
        ] {
            let (is_error, text) = said(density, modulus).unwrap_or_else(|| panic!("{density} and {modulus} pass"));
            assert_eq!(is_error, refused, "{density} and {modulus}: {text}");
            assert!(units.iter().all(|part| text.contains(part)), "{density} and {modulus}: {text}");
        }
        for (density, modulus) in [(2450.0, 32e9), (3500.0, 1.1e12), (30.0, 20e6), (1000.0, 10e6), (22_600.0, 560e9)] {
            assert_eq!(said(density, modulus), None, "{density} and {modulus}");
        }
    }
}
