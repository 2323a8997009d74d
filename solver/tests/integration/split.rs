//! The spectral split against eigenvectors, on random strains and where eigenvalues coincide or vanish; every
//! split against the slopes of its energies, and turned frames.

use crate::common::{glass, moduli};
use fisura::linear_algebra::extremes::larger;
use fisura::linear_algebra::lane::Lane;
use fisura::material::elasticity::ElasticModuli;
use fisura::material::split::{SplitState, driving_energy, split, tensile_strain};
use fisura::scene::{Material, Plane, Split};
use nalgebra::{Matrix2, SymmetricEigen};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

type Strain = [f64; 3];

fn tensile(strain: Strain) -> Strain {
    tensile_strain(strain.map(Lane::splat)).0.map(|e| e[3])
}

const SPLITS: [Split; 6] = [
    Split::Spectral,
    Split::VolumetricDeviatoric,
    Split::StarConvex(0.5),
    Split::StarConvex(4.0),
    Split::Rankine,
    Split::None,
];

fn state(moduli: &ElasticModuli, law: Split, strain: Strain) -> SplitState {
    split(moduli, law, strain.map(Lane::splat))
}

fn energies(moduli: &ElasticModuli, law: Split, strain: Strain) -> [f64; 2] {
    let state = state(moduli, law, strain);
    [state.energy_plus[0], state.energy_minus[0]]
}

/// Glass of another Poisson ratio.
fn moduli_in(plane: Plane, poisson_ratio: f64) -> ElasticModuli {
    ElasticModuli::new(&Material { poisson_ratio, ..glass() }, plane)
}

/// Norm of the tensor.
fn norm([xx, yy, xy]: Strain) -> f64 {
    xx.hypot(yy).hypot(std::f64::consts::SQRT_2 * xy)
}

fn minus(a: Strain, b: Strain) -> Strain {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn product(a: Strain, b: Strain) -> f64 {
    a[0] * b[0] + a[1] * b[1] + 2.0 * a[2] * b[2]
}

/// `Σ <e_i>+ n_i n_i` from eigenvectors.
fn oracle(strain: Strain) -> Strain {
    let scale = strain.iter().fold(0.0, |m: f64, e| larger(m, e.abs()));
    if scale == 0.0 {
        return [0.0; 3];
    }
    let [xx, yy, xy] = strain.map(|e| e / scale);
    let eigen = SymmetricEigen::new(Matrix2::new(xx, xy, xy, yy));
    let mut sum = Matrix2::zeros();
    for i in 0..2 {
        let n = eigen.eigenvectors.column(i);
        sum += n * n.transpose() * eigen.eigenvalues[i].max(0.0);
    }
    [sum[(0, 0)], sum[(1, 1)], sum[(0, 1)]].map(|e| e * scale)
}

fn check(strain: Strain) {
    let scale = norm(strain);
    let plus = tensile(strain);
    let minus_part = minus(strain, plus);
    assert!(plus.iter().all(|e| e.is_finite()), "{strain:?}: {plus:?}");
    let error = norm(minus(plus, oracle(strain)));
    assert!(error <= 1e-14 * scale, "{strain:?}: {plus:?} is {:e} off", error / scale);
    let unit = |e: Strain| e.map(|e| if scale > 0.0 { e / scale } else { 0.0 });
    let overlap = product(unit(plus), unit(minus_part)).abs();
    assert!(overlap <= 1e-14, "{strain:?}: e+:e- = {overlap:e}");
    let moduli = moduli();
    let state = state(&moduli, Split::Spectral, strain);
    let whole = moduli.energy(strain.map(Lane::splat))[0];
    let sum = state.energy_plus[0] + state.energy_minus[0];
    let rounding = 4e-15 * scale * scale + 1e-320; // squares near the smallest number are coarse
    assert!((sum - whole).abs() <= moduli.mu * rounding, "{strain:?}: psi+ + psi- = {sum} for {whole}");
    assert!(state.energy_plus[0] >= 0.0 && state.energy_minus[0] >= 0.0, "{strain:?}");
    let stress = moduli.stress(strain.map(Lane::splat));
    for i in 0..3 {
        let (parts, whole) = (state.stress_plus[i][0] + state.stress_minus[i][0], stress[i][0]);
        assert!((parts - whole).abs() <= 1e-14 * moduli.mu * scale, "{strain:?}: stress {parts} for {whole}");
    }
}

/// Principal strains e1, e2 turned by an angle.
fn turned(e1: f64, e2: f64, angle: f64) -> Strain {
    let (s, c) = angle.sin_cos();
    [e1 * c * c + e2 * s * s, e1 * s * s + e2 * c * c, (e1 - e2) * s * c]
}

#[test]
fn degenerate_families() {
    let angles = [0.0, 1e-9, 0.3, std::f64::consts::FRAC_PI_4, 1.2, std::f64::consts::FRAC_PI_2, 2.9];
    // equal, equal to a last digit, next to zero, zero, and of either sign
    let values = [1.0, 1.0 - 1e-16, 1.0 + 2.3e-16, 1e-16, 0.0, -1e-16, -1.0, -1.0 - 2.3e-16];
    for magnitude in [1.0, 1e-3, 1e-8, 1e-170, 1e-250, 1e30] {
        for (e1, e2) in values.into_iter().flat_map(|e1| values.map(|e2| (e1, e2))) {
            for angle in angles {
                check(turned(e1 * magnitude, e2 * magnitude, angle));
            }
        }
    }
    for shear in [1.0, -1e-5, 1e-170] {
        check([0.0, 0.0, shear]);
        assert_eq!(tensile([0.0, 0.0, shear]), [0.5 * shear.abs(), 0.5 * shear.abs(), 0.5 * shear]);
    }
    assert_eq!(tensile([0.0; 3]), [0.0; 3]);
    let kept = minus(tensile([2.0, 3.0, 0.5]), [2.0, 3.0, 0.5]);
    assert!(norm(kept) <= 1e-15, "tensile strains are kept as they are: {kept:?} is gone");
    assert_eq!(tensile([-2.0, -3.0, 0.5]).map(f64::abs), [0.0; 3], "compressive ones leave nothing");
}

#[test]
fn lanes_do_not_mix() {
    let strains: Vec<Strain> = (0..8).map(|l| turned(l as f64 - 3.5, 2.0 - l as f64, 0.4 * l as f64)).collect();
    let mut lanes = [Lane::ZERO; 3];
    for (l, strain) in strains.iter().enumerate() {
        for i in 0..3 {
            lanes[i][l] = strain[i];
        }
    }
    let (plus, _) = tensile_strain(lanes);
    for (l, strain) in strains.iter().enumerate() {
        assert_eq!(plus.map(|e| e[l]), tensile(*strain));
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 5000,
        rng_seed: RngSeed::Fixed(2024),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn random_strains(xx in -1.0f64..1.0, yy in -1.0f64..1.0, xy in -1.0f64..1.0, exponent in -160i32..3) {
        let magnitude = 10f64.powi(exponent);
        check([xx * magnitude, yy * magnitude, xy * magnitude]);
    }

    #[test]
    fn nearly_equal_principal_strains(mean in -1.0f64..1.0, gap in -20.0f64..0.0, angle in 0.0f64..3.1) {
        let gap = 10f64.powf(gap);
        check(turned(mean + gap, mean, angle));
        check(turned(gap, -gap, angle));
        check(turned(1.0, mean * gap, angle));
        check(turned(-1.0, mean * gap, angle));
    }

    /// sigma± = d psi±/d e; both energies have continuous first derivatives, so central differences see it
    /// anywhere.
    #[test]
    fn stresses_are_the_slopes_of_the_energies(
        xx in -1.0f64..1.0, yy in -1.0f64..1.0, xy in -1.0f64..1.0, dxx in -1.0f64..1.0, dyy in -1.0f64..1.0, dxy in -1.0f64..1.0
    ) {
        let (strain, direction, step) = ([xx, yy, xy], [dxx, dyy, dxy], 1e-8);
        let moved = |s: f64| [xx + s * dxx, yy + s * dyy, xy + s * dxy];
        for (law, plane) in SPLITS.into_iter().flat_map(|law| [(law, Plane::Strain), (law, Plane::Stress)]) {
            let moduli = moduli_in(plane, 0.3);
            let (ahead, behind) = (energies(&moduli, law, moved(step)), energies(&moduli, law, moved(-step)));
            let state = state(&moduli, law, strain);
            for (i, stress) in [state.stress_plus, state.stress_minus].into_iter().enumerate() {
                let slope = (ahead[i] - behind[i]) / (2.0 * step);
                let power = product(stress.map(|s| s[0]), direction);
                let scale = if let Split::StarConvex(gamma) = law { 1.0 + gamma } else { 1.0 };
                prop_assert!((slope - power).abs() <= 4e-7 * scale * moduli.mu, "{law:?}: {slope} for {power}");
            }
            let sum = state.energy_plus[0] + state.energy_minus[0];
            let whole = moduli.energy(strain.map(Lane::splat))[0];
            prop_assert!((sum - whole).abs() <= 1e-14 * moduli.mu, "{law:?}: {sum} for {whole}");
        }
    }

    /// Energies do not depend on the frame, and stresses turn with it.
    #[test]
    fn splits_turn_with_the_frame(e1 in -1.0f64..1.0, e2 in -1.0f64..1.0, angle in 0.0f64..3.1) {
        for law in SPLITS {
            let moduli = moduli();
            let [here, there] = [0.0, angle].map(|angle| state(&moduli, law, turned(e1, e2, angle)));
            let turn = |[xx, yy, _]: [Lane; 3]| turned(xx[0], yy[0], angle);
            for (a, b) in [(here.stress_plus, there.stress_plus), (here.stress_minus, there.stress_minus)] {
                let gap = norm(minus(turn(a), b.map(|s| s[0])));
                prop_assert!(gap <= 1e-13 * moduli.mu, "{law:?}: {gap:e}");
            }
            let drive = |angle: f64| driving_energy(&moduli, law, turned(e1, e2, angle).map(Lane::splat))[0];
            prop_assert!((drive(0.0) - drive(angle)).abs() <= 1e-13 * moduli.mu, "{law:?}");
        }
    }
}

/// What drives in uniaxial tension is `s²/(2 E)` for a largest principal stress s, whatever acts across it.
#[test]
fn rankine_is_driven_by_the_largest_principal_stress() {
    for (plane, nu) in [(Plane::Strain, 0.2), (Plane::Stress, 0.3), (Plane::Strain, -0.2)] {
        let moduli = moduli_in(plane, nu);
        for (e1, e2, angle) in [(1e-3, 2e-4, 0.3), (1e-3, -2e-3, 1.0), (3e-4, -1e-4, 2.0), (-1e-4, -2e-3, 0.7)] {
            let [xx, yy, xy] = moduli.stress(turned(e1, e2, angle).map(Lane::splat)).map(|s| s[0]);
            let largest = SymmetricEigen::new(Matrix2::new(xx, xy, xy, yy)).eigenvalues.max().max(0.0);
            let drive = driving_energy(&moduli, Split::Rankine, turned(e1, e2, angle).map(Lane::splat))[0];
            let exact = largest * largest / (2.0 * glass().young_modulus);
            assert!((drive - exact).abs() <= 1e-12 * exact, "{drive} for {exact}");
        }
    }
}

/// A point that has lost its numbers makes the energy of its body none, whichever component lost them.
#[test]
fn what_is_not_a_number_has_no_energy_and_no_stress() {
    for law in SPLITS {
        for (component, base) in [0, 1, 2].into_iter().flat_map(|c| [-1e-3, 0.0, 1e-3].map(|base| (c, base))) {
            let mut strain = [base, -0.5 * base, 0.3 * base];
            strain[component] = f64::NAN;
            let state = state(&moduli(), law, strain);
            let energy = state.energy_plus[0] + state.energy_minus[0];
            assert!(energy.is_nan(), "{law:?}, {strain:?}: energy {energy}");
            let stress: f64 = state.stress_plus.iter().chain(&state.stress_minus).map(|s| s[0]).sum();
            assert!(stress.is_nan(), "{law:?}, {strain:?}: stress {stress}");
        }
        assert!(
            Lane::splat(f64::NAN).at_least(Lane::ZERO)[0].is_nan()
                && Lane::splat(f64::NAN).at_most(Lane::ZERO)[0].is_nan()
        );
    }
}
