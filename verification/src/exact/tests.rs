//! Checks that every exact solution is one: against symbolic derivations (`symbolic`), by finite differences that know
//! nothing of how a solution is programmed (`residual`), and by what its module claims (`claims`).

mod claims;
mod difference;
mod residual;
mod symbolic;

use fisura::scene::Plane;

use super::{ExactSolution, find};

/// Places and times in the domain of a solution, and in it with a margin for differences.
fn samples(name: &str) -> Vec<([f64; 2], f64)> {
    let places: Vec<[f64; 2]> = match name {
        "kirsch" | "vortex" => {
            let radii = if name == "kirsch" { [1.0, 1.7, 3.1] } else { [0.75, 0.93, 1.25] };
            let polar = |r: f64| [0.2, 1.1, 2.9, 4.4, 5.8].map(|angle: f64| [r * angle.cos(), r * angle.sin()]);
            radii.into_iter().flat_map(polar).collect()
        }
        _ => [0.07, 0.31, 0.62, 0.94].into_iter().flat_map(|x| [0.11, 0.37, 0.74].map(|y| [x, y])).collect(),
    };
    places.into_iter().flat_map(|place| [0.0, 0.37, 0.81].map(|t| (place, t))).collect()
}

/// Solutions of a name in both plane states.
fn both_planes(name: &str) -> [Box<dyn ExactSolution>; 2] {
    [Plane::Strain, Plane::Stress].map(|plane| find(name, plane).expect("a registered name"))
}

#[test]
fn registry_knows_its_names_and_no_other() {
    for name in super::NAMES {
        for plane in [Plane::Strain, Plane::Stress] {
            assert_eq!(find(name, plane).expect(name).plane(), plane);
        }
    }
    assert!(find("nothing", Plane::Strain).is_none());
}
