//! Independent of symbolic algebra: what must be a derivative of what, by finite differences; stresses from
//! the solver's own moduli; the residuals of the equations.

use std::f64::consts::FRAC_2_PI;

use fisura::linear_algebra::lane::Lane;
use fisura::material::degradation::FractureModel;
use fisura::material::elasticity::ElasticModuli;
use fisura::material::split::split;
use fisura::scene::{CrackModel, Kinematics};
use nalgebra::{Matrix2, SymmetricEigen};

use super::difference::{first, laplacian, partial, second};
use super::{both_planes, samples};
use crate::exact::{ExactSolution, all, find};

/// Largest difference allowed, relative to the larger of 1 and the value.
const TOLERANCE: f64 = 1e-8;

fn assert_close(name: &str, what: &str, value: f64, expected: f64, tolerance: f64) {
    let difference = (value - expected).abs() / expected.abs().max(1.0);
    assert!(difference <= tolerance, "{name}: {what} is {value:e}, expected {expected:e}: {difference:e}");
}

/// Runs a check on every solution, plane state and sample.
fn everywhere(check: impl Fn(&str, &dyn ExactSolution, [f64; 2], f64)) {
    for solution in all() {
        for fields in both_planes(solution) {
            for (place, time) in samples(solution) {
                check(solution.name, fields.as_ref(), place, time);
            }
        }
    }
}

#[test]
fn gradient_velocity_and_acceleration_are_derivatives_of_the_displacement() {
    everywhere(|name, solution, place, time| {
        let (gradient, velocity) = (solution.displacement_gradient(place, time), solution.velocity(place, time));
        let acceleration = solution.acceleration(place, time);
        for i in [0, 1] {
            for d in [0, 1] {
                let expected = partial(|x| solution.displacement(x, time)[i], place, d);
                assert_close(name, "displacement gradient", gradient[i][d], expected, TOLERANCE);
            }
            let displacement = |h| solution.displacement(place, time + h)[i];
            assert_close(name, "velocity", velocity[i], first(displacement), TOLERANCE);
            assert_close(name, "acceleration", acceleration[i], second(displacement), TOLERANCE);
        }
    });
}

#[test]
fn the_equation_of_motion_holds() {
    everywhere(|name, solution, place, time| {
        let density = solution.material().density;
        for i in [0, 1] {
            let acceleration = second(|h| solution.displacement(place, time + h)[i]);
            let divergence: f64 = [0, 1].iter().map(|&d| partial(|x| solution.stress(x, time)[i][d], place, d)).sum();
            let residual = density * acceleration - divergence - solution.body_force(place, time)[i];
            assert_close(name, "residual of the equation of motion", residual, 0.0, TOLERANCE);
        }
    });
}

#[test]
fn the_phase_field_equation_holds() {
    everywhere(|name, solution, place, time| {
        assert_eq!(solution.phase().is_some(), solution.material().fracture.is_some(), "{name}");
        let (Some(phase), Some(fracture)) = (solution.phase(), solution.material().fracture) else { return };
        let (l0, k) = (fracture.length_scale, fracture.residual_stiffness);
        let drive = 4.0 * l0 * (1.0 - k) * phase.history(place, time) / fracture.critical_energy_release_rate;
        let curvature = laplacian(|x| phase.value(x, time), place);
        let c = phase.value(place, time);
        let model = FractureModel::of(&solution.material()).expect("a fracture table");
        let slope = first(|h| model.degradation(Lane::splat(c + h)).0[0]) / (1.0 - k);
        let (local, diffusion) = match fracture.model {
            CrackModel::At2 => (c, 4.0),
            CrackModel::At1 => (0.0, 3.0),
            CrackModel::PfCzm { .. } => (FRAC_2_PI * (1.0 - c), 4.0 * FRAC_2_PI),
        };
        let residual = drive * 0.5 * slope + local - diffusion * l0 * l0 * curvature;
        assert_close(name, "source", phase.source(place, time), residual, TOLERANCE);
        for d in [0, 1] {
            let expected = partial(|x| phase.value(x, time), place, d);
            assert_close(name, "phase gradient", phase.gradient(place, time)[d], expected, TOLERANCE);
        }
    });
}

#[test]
fn the_stress_follows_from_the_gradient() {
    everywhere(|name, solution, place, time| {
        let is_finite = find(name).expect("a registered name").kinematics == Kinematics::Finite;
        let law = if is_finite { hencky } else { linear };
        let moduli = ElasticModuli::new(&solution.material(), solution.plane());
        let gradient = solution.displacement_gradient(place, time);
        let expected = match (solution.phase(), FractureModel::of(&solution.material())) {
            (Some(phase), Some(model)) => {
                let [[xx, xy], [yx, yy]] = gradient;
                let state = split(&moduli, model.split, [xx, yy, 0.5 * (xy + yx)].map(Lane::splat));
                let g = model.degradation(Lane::splat(phase.value(place, time)));
                let [xx, yy, xy] = state.degraded::<false>(g).1.map(|s| s.0[0]);
                Matrix2::new(xx, xy, xy, yy)
            }
            _ => law(&moduli, gradient),
        };
        let stress = solution.stress(place, time);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            assert_close(name, "stress", stress[i][j], expected[(i, j)], 1e-13);
        }
    });
}

fn linear(moduli: &ElasticModuli, [[xx, xy], [yx, yy]]: [[f64; 2]; 2]) -> Matrix2<f64> {
    let [xx, yy, xy] = moduli.stress([xx, yy, 0.5 * (xy + yx)].map(Lane::splat)).map(|s| s.0[0]);
    Matrix2::new(xx, xy, xy, yy)
}

/// `P = tau F⁻ᵀ` with the logarithm from eigenvectors.
fn hencky(moduli: &ElasticModuli, [[xx, xy], [yx, yy]]: [[f64; 2]; 2]) -> Matrix2<f64> {
    let f = Matrix2::new(1.0 + xx, xy, yx, 1.0 + yy);
    let eigen = SymmetricEigen::new(f * f.transpose());
    let strain = eigen.eigenvalues.map(|value| 0.5 * value.ln());
    let e = eigen.eigenvectors * Matrix2::from_diagonal(&strain) * eigen.eigenvectors.transpose();
    let tau = linear(moduli, [[e[(0, 0)], e[(0, 1)]], [e[(1, 0)], e[(1, 1)]]]);
    tau * f.try_inverse().expect("an invertible deformation").transpose()
}
