//! The bound on the highest frequency against dense eigenvalues, and the table of critical steps of free
//! bodies.

use crate::common::{body, elastic_scene, rectangle};
use fisura::Simulation;
use fisura::dynamics::critical_step::{StiffnessOperator, highest_frequency};
use fisura::scene::*;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Dense highest angular frequency of the free degrees of freedom, and the bound the solver takes.
fn frequencies(scene: &Scene) -> (f64, f64) {
    let simulation = Simulation::new(scene).unwrap();
    let mut operator = simulation.total_frame().unwrap().stiffness_operator();
    let bound = highest_frequency(&mut operator);
    let n = operator.size();
    let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
    let (mut stiffness, mut inverse_mass) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    for j in 0..n {
        unit[j] = 1.0;
        operator.stiffness(&unit, &mut column);
        stiffness.set_column(j, &DVector::from_column_slice(&column));
        operator.divide_by_mass(&unit, &mut column);
        inverse_mass.set_column(j, &DVector::from_column_slice(&column));
        unit[j] = 0.0;
    }
    let factor = inverse_mass.cholesky().expect("a positive mass").l();
    let matrix = factor.transpose() * stiffness * factor;
    let asymmetry = (&matrix - matrix.transpose()).amax();
    assert!(asymmetry <= 1e-12 * matrix.amax(), "the stiffness is symmetric");
    let eigenvalues = SymmetricEigen::new(matrix).eigenvalues;
    let largest = eigenvalues.max();
    let zero = eigenvalues.iter().filter(|e| e.abs() <= 1e-9 * largest).count();
    let free = scene.boundaries.is_empty();
    assert!(eigenvalues.min() >= -1e-9 * largest && (zero == 3) == free, "{zero} rigid motions");
    (largest.sqrt(), bound)
}

/// The functions at the sides of a mesh have the highest frequencies.
#[test]
fn long_spans_at_the_sides_allow_steps_nearly_twice_as_long() {
    for (degree, least) in [(1, 0.99), (2, 1.85), (3, 1.85), (4, 1.85)] {
        let highest = |sides: &[Side]| {
            let mut scene = elastic_scene(degree, [1.0; 2], [16; 2]);
            scene.bodies[0].particles_per_cell = [degree.max(2); 2];
            assert!(sides.iter().all(|side| scene.mesh.lengthen_end(*side)));
            let simulation = Simulation::new(&scene).unwrap();
            highest_frequency(&mut simulation.total_frame().unwrap().stiffness_operator())
        };
        let longer = highest(&[]) / highest(&[Side::Left, Side::Right, Side::Bottom, Side::Top]);
        assert!((least..2.0).contains(&longer), "p = {degree}: {longer}");
    }
    let mut one = Mesh::uniform([2; 2], [0.0; 2], [1.0; 2], [2, 1]);
    assert!(one.lengthen_end(Side::Left) && !one.lengthen_end(Side::Right) && !one.lengthen_end(Side::Top));
    assert_eq!(one.knots[0], [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
}

/// A chain of so many masses of 4 kg between springs of 1 N/m, held at both ends.
struct Chain(usize);

impl StiffnessOperator for Chain {
    fn size(&self) -> usize {
        self.0
    }

    fn stiffness(&mut self, x: &[f64], out: &mut [f64]) {
        let at = |i: usize| x.get(i).copied().unwrap_or(0.0);
        for i in 0..x.len() {
            out[i] = 2.0 * x[i] - at(i.wrapping_sub(1)) - at(i + 1);
        }
    }

    fn divide_by_mass(&mut self, x: &[f64], out: &mut [f64]) {
        for i in 0..x.len() {
            out[i] = x[i] / 4.0;
        }
    }
}

#[test]
fn the_bound_of_a_spring_chain_is_above_and_within_half_a_percent() {
    let n = 500;
    let exact = (std::f64::consts::FRAC_PI_2 * n as f64 / (n as f64 + 1.0)).sin();
    let bound = highest_frequency(&mut Chain(n));
    assert!(bound >= exact && bound <= 1.005 * exact, "{bound} against {exact}");
}

/// The residual norm bounds the distance to *some* eigenvalue. Where modes of several corners lie within a
/// millionth of each other, as at nu = 0, the Lanczos vector may have settled below the largest one by as
/// much (measured: 4e-7). The tolerance is that, a thousand times less than the distance of the default
/// safety factor.
const CLUSTER: f64 = 1e-5;

fn check(name: &str, scene: &Scene) {
    let (dense, bound) = frequencies(scene);
    assert!(
        bound >= dense * (1.0 - CLUSTER) && bound <= 1.02 * dense,
        "{name}: bound {bound:e}, dense {dense:e}, {}",
        bound / dense
    );
}

#[test]
fn the_bound_is_above_the_dense_frequency_and_within_two_percent() {
    for degree in 1..=3 {
        for nu in [0.0, 0.2, 0.45] {
            let mut scene = elastic_scene(degree, [0.01, 0.008], [10, 8]);
            scene.materials.get_mut("glass").unwrap().poisson_ratio = nu;
            check(&format!("degree {degree}, nu {nu}"), &scene);
            scene.boundaries = vec![Boundary::fixed(Side::Left, [true, true])];
            check(&format!("degree {degree}, nu {nu}, clamped"), &scene);
            scene.analysis.plane = Plane::Stress;
            check(&format!("degree {degree}, nu {nu}, plane stress"), &scene);
        }
    }
}

#[test]
fn the_bound_holds_for_cut_graded_and_oblong_spans() {
    for degree in 1..=3 {
        let mut cut = elastic_scene(degree, [0.01, 0.008], [10, 8]);
        cut.bodies[0] = body(rectangle([0.00195, 0.0011], [0.0082, 0.0067]), [degree.max(2); 2]);
        check(&format!("degree {degree}, cut"), &cut);
        check(&format!("degree {degree}, oblong"), &elastic_scene(degree, [0.03, 0.008], [10, 8]));
        let mut graded = elastic_scene(degree, [0.01, 0.008], [10, 8]);
        let knots = crate::common::graded_knots(degree, 10, &[]).iter().map(|k| 0.001 * k).collect::<Vec<_>>();
        let end = knots[knots.len() - 1];
        graded.mesh.knots[0] = knots;
        graded.bodies[0].shape = rectangle([0.0; 2], [end, 0.008]);
        check(&format!("degree {degree}, graded"), &graded);
    }
}

/// `c dt/h` of a large free square of square spans, lumped mass, plane strain, nu = 0: measured 1.00 / 0.86 /
/// 0.65.
#[test]
fn table_of_free_bodies() {
    for (degree, expected) in [(1, 1.00), (2, 0.86), (3, 0.65)] {
        let cells = 40;
        let mut scene = elastic_scene(degree, [0.04, 0.04], [cells; 2]);
        scene.bodies[0].particles_per_cell = [degree + 1; 2];
        scene.materials.get_mut("glass").unwrap().poisson_ratio = 0.0;
        let critical = Simulation::new(&scene).unwrap().plan().critical;
        let speed = (32e9f64 / 2450.0).sqrt();
        let number = speed * critical / (0.04 / cells as f64);
        assert!((number / expected - 1.0).abs() <= 0.02, "degree {degree}: c dt/h = {number:.4} for {expected}");
    }
}

/// The consistent mass, free and held, over rectangles and on curved patches.
#[test]
fn the_bound_holds_for_the_consistent_mass() {
    for degree in 1..=3 {
        for nu in [0.0, 0.3] {
            let mut scene = elastic_scene(degree, [0.01, 0.008], [8, 6]);
            scene.analysis.mass = Mass::Consistent;
            scene.bodies[0].particles_per_cell = [degree + 1; 2];
            scene.materials.get_mut("glass").unwrap().poisson_ratio = nu;
            check(&format!("consistent, degree {degree}, nu {nu}"), &scene);
            scene.boundaries =
                vec![Boundary::fixed(Side::Left, [true, true]), Boundary::fixed(Side::Bottom, [false, true])];
            check(&format!("consistent, degree {degree}, nu {nu}, held"), &scene);
        }
        for mass in [Mass::Lumped, Mass::Consistent] {
            let mut curved = crate::common::patch_scene(&crate::common::annulus(degree.max(2), 5), 4);
            curved.analysis.mass = mass;
            check(&format!("annulus, degree {}, {mass:?}", degree.max(2)), &curved);
            curved.mesh = Mesh::of(&crate::common::random_patch([degree, 2], [5, 4], degree as u64));
            check(&format!("random weights, degree {degree}, {mass:?}"), &curved);
        }
    }
}
