//! What the modules of the solutions claim: boundary conditions, signs, ranges.

use super::both_planes;
use crate::exact::{phase_field, standing_wave};

/// Points on the sides of a rectangle with its lower left corner at the origin, with the direction of the normal.
fn sides(size: [f64; 2]) -> Vec<([f64; 2], usize)> {
    let fractions = || (0..=10).map(|i| f64::from(i) / 10.0);
    let along = |d: usize, end: f64| {
        fractions().map(move |s| {
            let mut place = [s * size[0], s * size[1]];
            place[d] = end * size[d];
            (place, d)
        })
    };
    [(0, 0.0), (0, 1.0), (1, 0.0), (1, 1.0)].into_iter().flat_map(|(d, end)| along(d, end)).collect()
}

/// Points of a fine lattice on a rectangle.
fn lattice(size: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    (0..=40).flat_map(move |i| (0..=40).map(move |j| [f64::from(i) / 40.0 * size[0], f64::from(j) / 40.0 * size[1]]))
}

#[test]
fn the_standing_wave_rests_on_rollers() {
    for solution in both_planes("standing-wave") {
        for (place, normal) in sides(standing_wave::SIZE) {
            for time in [0.0, 0.4, 1.3] {
                assert!(solution.displacement(place, time)[normal].abs() < 1e-15, "{place:?}");
                assert!(solution.stress(place, time)[0][1].abs() < 1e-15, "{place:?}");
            }
        }
    }
}

#[test]
fn phase_fields_have_the_claimed_range_and_flux() {
    for (name, range) in [("phase-field", 0.3..=0.9), ("phase-field-zero-flux", 0.25..=0.95)] {
        for solution in both_planes(name) {
            let phase = solution.phase().unwrap();
            for place in lattice(phase_field::SIZE) {
                assert!(range.contains(&phase.value(place, 0.0)), "{name} {place:?}");
                assert!(phase.history(place, 0.0) > 0.0, "{name} {place:?}");
            }
            let flux = |(place, d): ([f64; 2], usize)| phase.gradient(place, 0.0)[d].abs();
            let largest = sides(phase_field::SIZE).into_iter().map(flux).fold(0.0, f64::max);
            assert_eq!(largest < 1e-14, name == "phase-field-zero-flux", "{name}: {largest:e}");
        }
    }
}
