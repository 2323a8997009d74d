//! Models, transfers and solves in words, and the strength that a model has.

use fisura::scene::{CrackModel, Fracture, Material, PhaseFieldInterval, Plane, SolverSettings, Split, Transfer};

/// A transfer in words, with what it loses.
pub(super) fn transfer(transfer: Transfer) -> String {
    match transfer {
        Transfer::Apic => "apic, the default: keeps angular momentum, damps motion that varies over a span".into(),
        Transfer::Tpic => "tpic: nearly keeps angular momentum, damps motion that varies over a span".into(),
        Transfer::Flip => "flip: loses spin as a body turns, and keeps velocities that the mesh cannot see".into(),
        Transfer::Pic => "pic: damps all motion and keeps no spin".into(),
        Transfer::Xpic(order) => format!("xpic of order {order}: loses spin as a body turns"),
    }
}

/// Surface energy and split in words.
pub(super) fn words(fracture: &Fracture) -> String {
    let model = match fracture.model {
        CrackModel::At2 => "AT2".to_string(),
        CrackModel::At1 => "AT1".to_string(),
        CrackModel::PfCzm { softening, .. } => {
            format!("PF-CZM with {} softening", softening.word())
        }
    };
    let split = match fracture.split {
        Split::Spectral => format!("{model}, spectral split"),
        Split::VolumetricDeviatoric => format!("{model}, volumetric-deviatoric split"),
        Split::StarConvex(gamma) => format!("{model}, star-convex split with {gamma}"),
        Split::Rankine => format!("{model}, driven by the largest principal stress"),
        Split::None => format!("{model}, no split"),
    };
    let anisotropy = fracture.anisotropy.map(|anisotropy| {
        let [xx, yy, _] = anisotropy.components();
        format!(", Gc times {:.3} along x and {:.3} along y", yy.sqrt(), xx.sqrt())
    });
    let random = fracture.random.map(|random| {
        format!(", Gc random (Weibull, modulus {}, correlation {:e} m)", random.modulus, random.correlation)
    });
    let of_mesh = fracture.mesh_toughness.then(|| ", Gc less what cracks cost on this mesh".to_string());
    [Some(split), anisotropy, random, of_mesh].into_iter().flatten().collect()
}

/// How the phase field is solved, in words.
pub(super) fn solves(settings: &SolverSettings) -> String {
    let interval = match settings.phase_field_interval {
        PhaseFieldInterval::Steps(1) => "in every step".to_string(),
        PhaseFieldInterval::Steps(steps) => format!("once in {steps} steps"),
        PhaseFieldInterval::Automatic => "once in up to 4 steps".to_string(),
    };
    format!("solved {interval}, tolerance {:e}", settings.phase_field_tolerance)
}

/// Largest stress of a uniform bar (Pa), as if all of its energy drove: `9/16 √(E Gc/(6 l0))`, with AT1 `√(3
/// E Gc/(16 l0))`, with a cohesive crack `ft √(E/E0)` for Young's modulus E0; in plane strain E is over 1 −
/// nu², unless the largest principal stress drives.
pub(super) fn strength(material: &Material, fracture: &Fracture, plane: Plane) -> f64 {
    let Material { young_modulus, poisson_ratio, .. } = *material;
    let modulus = match plane {
        Plane::Strain if fracture.split != Split::Rankine => young_modulus / (1.0 - poisson_ratio * poisson_ratio),
        _ => young_modulus,
    };
    let unit = modulus * fracture.critical_energy_release_rate / fracture.length_scale;
    match fracture.model {
        CrackModel::At2 => 9.0 / 16.0 * (unit / 6.0).sqrt(),
        CrackModel::At1 => (3.0 * unit / 16.0).sqrt(),
        CrackModel::PfCzm { tensile_strength, .. } => tensile_strength * (modulus / young_modulus).sqrt(),
    }
}
