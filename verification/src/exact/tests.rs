//! Checks that every exact solution is one: against symbolic derivations (`symbolic`), by finite differences
//! that know nothing of how a solution is programmed (`residual`), and by what its module claims (`claims`).

mod claims;
mod difference;
mod residual;
mod symbolic;

use fisura::scene::Plane;

use super::{ExactSolution, Solution, all, find};

/// Places and times in the domain of a solution, and in it with a margin for differences.
fn samples(solution: &Solution) -> Vec<([f64; 2], f64)> {
    let polar = |r: &f64| [0.2, 1.1, 2.9, 4.4, 5.8].map(|angle: f64| [r * angle.cos(), r * angle.sin()]);
    let mut places: Vec<[f64; 2]> = solution.radii.iter().flat_map(polar).collect();
    if places.is_empty() {
        places = [0.07, 0.31, 0.62, 0.94].into_iter().flat_map(|x| [0.11, 0.37, 0.74].map(|y| [x, y])).collect();
    }
    places.into_iter().flat_map(|place| [0.0, 0.37, 0.81].map(|t| (place, t))).collect()
}

/// A solution in both plane states.
fn both_planes(solution: &Solution) -> [Box<dyn ExactSolution>; 2] {
    [Plane::Strain, Plane::Stress].map(solution.fields)
}

/// The solution of a name in both plane states.
fn named(name: &str) -> [Box<dyn ExactSolution>; 2] {
    both_planes(find(name).expect("a registered name"))
}

#[test]
fn registry_knows_its_names_and_no_other() {
    for solution in all() {
        assert_eq!(find(solution.name).map(|found| found.name), Some(solution.name));
        assert_eq!(all().filter(|other| other.name == solution.name).count(), 1);
        assert_eq!(both_planes(solution).map(|fields| fields.plane()), [Plane::Strain, Plane::Stress]);
    }
    assert!(find("nothing").is_none());
}
