//! What the modules of the solutions claim: boundary conditions, signs, ranges.

use std::f64::consts::TAU;

use fisura::linear_algebra::lane::Lane;
use fisura::material::elasticity::ElasticModuli;
use fisura::material::split::{driving_energy, tensile_strain};
use fisura::scene::{CrackModel, Split};

use super::named;
use crate::exact::{ExactSolution, kirsch, phase_field, standing_wave, vortex};
use crate::extremes;

/// Points on the sides of a rectangle with its lower left corner at the origin, with the direction of the
/// normal.
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

/// Stress vector on a circle about the origin, at an angle.
fn traction(solution: &dyn ExactSolution, radius: f64, angle: f64, time: f64) -> [f64; 2] {
    let normal = [angle.cos(), angle.sin()];
    let stress = solution.stress(normal.map(|n| n * radius), time);
    stress.map(|row| row[0] * normal[0] + row[1] * normal[1])
}

fn angles() -> impl Iterator<Item = f64> {
    (0..24).map(|i| f64::from(i) / 24.0 * TAU)
}

#[test]
fn the_hole_is_free_and_the_plate_is_under_tension_far_away() {
    for solution in named("kirsch") {
        for angle in angles() {
            assert!(traction(solution.as_ref(), kirsch::RADIUS, angle, 0.0).iter().all(|t| t.abs() < 1e-14), "{angle}");
            let far = traction(solution.as_ref(), 1e4, angle, 0.0);
            assert!((far[0] - kirsch::TENSION * angle.cos()).abs() < 1e-7 && far[1].abs() < 1e-7, "{far:?}");
        }
        let crown = solution.stress([0.0, kirsch::RADIUS], 0.0);
        assert!((crown[0][0] - 3.0 * kirsch::TENSION).abs() < 1e-14);
        for distance in [1.0, 2.3] {
            assert!(solution.displacement([distance, 0.0], 0.0)[1].abs() < 1e-15);
            assert!(solution.displacement([0.0, distance], 0.0)[0].abs() < 1e-15);
            assert!(solution.stress([distance, 0.0], 0.0)[0][1].abs() < 1e-15);
            assert!(solution.stress([0.0, distance], 0.0)[0][1].abs() < 1e-15);
        }
    }
}

#[test]
fn the_coupled_solutions_keep_their_signs_and_directions() {
    let names = ["coupled", "coupled-at1", "coupled-linear", "coupled-exponential", "coupled-cornelissen"];
    for solution in names.iter().flat_map(|name| named(name)) {
        let (phase, material) = (solution.phase().unwrap(), solution.material());
        let moduli = ElasticModuli::new(&material, solution.plane());
        let fracture = material.fracture.unwrap();
        let bounded = fracture.model != CrackModel::At2;
        for place in lattice([1.0, 1.0]) {
            let mut last = [0.0, 0.9];
            for time in (0..=20).map(|i| f64::from(i) / 20.0) {
                let [[xx, xy], [yx, yy]] = solution.displacement_gradient(place, time);
                let strain = [xx, yy, 0.5 * (xy + yx)].map(Lane::splat);
                let (_, principal) = tensile_strain(strain);
                let [larger, smaller] = principal.map(|e| e.0[0]);
                if bounded && fracture.split != Split::Rankine {
                    assert!(larger > 0.02 && larger + smaller < -0.02, "{place:?} {time}: {larger}, {smaller}");
                } else {
                    assert!(smaller > 0.05, "{place:?} {time}: smaller principal strain {smaller}");
                }
                let (drive, c) = (phase.history(place, time), phase.value(place, time));
                assert!((driving_energy(&moduli, fracture.split, strain).0[0] - drive).abs() < 1e-14);
                if bounded {
                    assert!(c < last[1] && c > 0.1 && drive > 0.0, "{place:?} {time}: c does not fall");
                } else {
                    assert!(drive > last[0], "{place:?} {time}: psi+ does not grow");
                    assert!((0.45..=0.95).contains(&c), "{place:?} {time}");
                }
                last = [drive, c];
            }
        }
    }
}

#[test]
fn bars_are_held_at_their_ends_and_indifferent_to_the_plane_state() {
    for name in ["finite-wave", "hencky-wave"] {
        let [strain, stress] = named(name);
        for time in [0.0, 0.2, 0.9] {
            for place in [[0.0, 0.3], [1.0, 0.7]] {
                assert!(strain.displacement(place, time)[0].abs() < 1e-16);
            }
            for place in lattice([1.0, 0.5]) {
                assert_eq!(strain.stress(place, time), stress.stress(place, time));
                assert!([0, 1].map(|i| strain.stress(place, time)[i][1]).iter().all(|s| s.abs() < 1e-16));
                assert!((0.7..1.3).contains(&(1.0 + strain.displacement_gradient(place, time)[0][0])));
            }
        }
    }
}

#[test]
fn the_axis_aligned_displacement_rests_on_rollers() {
    for solution in named("axis-aligned") {
        for (place, normal) in sides([1.0, 1.0]) {
            for time in [0.0, 0.4, 1.3] {
                assert!(solution.displacement(place, time)[normal].abs() < 1e-15, "{place:?}");
                assert!(solution.stress(place, time)[0][1].abs() < 1e-15, "{place:?}");
                assert!(solution.stress(place, time)[1][0].abs() < 1e-15, "{place:?}");
            }
        }
    }
}

#[test]
fn the_vortex_ends_at_its_radii_and_keeps_areas() {
    for solution in named("vortex") {
        for (angle, time) in angles().flat_map(|angle| [0.2, 0.5, 1.1].map(|time| (angle, time))) {
            for radius in vortex::RADII {
                let place = [radius * angle.cos(), radius * angle.sin()];
                assert!(solution.displacement(place, time).iter().all(|u| u.abs() < 1e-14));
                assert!(solution.velocity(place, time).iter().all(|v| v.abs() < 1e-14));
                assert!(traction(solution.as_ref(), radius, angle, time).iter().all(|t| t.abs() < 1e-13));
            }
            for radius in [0.8, 0.95, 1.0, 1.13] {
                let [[xx, xy], [yx, yy]] =
                    solution.displacement_gradient([radius * angle.cos(), radius * angle.sin()], time);
                assert!(((1.0 + xx) * (1.0 + yy) - xy * yx - 1.0).abs() < 1e-14);
                // det F = 1: tr(F Fᵀ) = 2 + γ².
                let shear = (2.0 * (xx + yy) + xx * xx + xy * xy + yx * yx + yy * yy).max(0.0).sqrt();
                assert!(shear < 0.71, "shear {shear}");
            }
        }
    }
    assert!(named("vortex")[0].displacement([1.0, 0.0], 0.5)[1] > 0.09);
}

#[test]
fn the_standing_wave_rests_on_rollers() {
    for solution in named("standing-wave") {
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
        for solution in named(name) {
            let phase = solution.phase().unwrap();
            for place in lattice(phase_field::SIZE) {
                assert!(range.contains(&phase.value(place, 0.0)), "{name} {place:?}");
                assert!(phase.history(place, 0.0) > 0.0, "{name} {place:?}");
            }
            let flux = |(place, d): ([f64; 2], usize)| phase.gradient(place, 0.0)[d].abs();
            let largest = extremes::largest(sides(phase_field::SIZE).into_iter().map(flux));
            assert_eq!(largest < 1e-14, name == "phase-field-zero-flux", "{name}: {largest:e}");
        }
    }
}
