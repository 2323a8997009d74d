//! NURBS patches with random knots, weights and degrees: what must hold for each, and what refinement must
//! not change.

use approx::assert_abs_diff_eq;
use fisura::linear_algebra::extremes::smaller;
use fisura::scene::Mesh;
use fisura::splines::nurbs::{Form, LocateError, NurbsError, NurbsPatch, RationalFunctions};
use fisura::splines::patch::Patch;
use fisura::splines::spline::SplineSpace;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// One direction: degree and spans between 1 and 100 (arbitrary units), each inner knot repeated up to degree
/// times.
#[derive(Debug, Clone)]
struct Direction {
    degree: usize,
    knots: Vec<f64>,
}

fn direction() -> impl Strategy<Value = Direction> {
    let spans = prop::collection::vec((0.0..2.0f64, 0usize..8), 1..7);
    (1usize..=4, spans).prop_map(|(degree, spans)| {
        let total: f64 = spans.iter().map(|(log, _)| 10f64.powf(*log)).sum();
        let mut knots = vec![0.0; degree + 1];
        let mut position = 0.0;
        for (log, draw) in &spans[..spans.len() - 1] {
            position += 10f64.powf(*log) / total;
            // Half of the inner knots are simple.
            let times = if *draw < 4 { 1 } else { (draw - 3).min(degree) };
            knots.extend(vec![position; times]);
        }
        knots.extend(vec![1.0; degree + 1]);
        Direction { degree, knots }
    })
}

fn functions(patch: &NurbsPatch, parameters: [f64; 2]) -> RationalFunctions {
    patch.shape_functions(patch.find_span(parameters).unwrap(), parameters)
}

fn position(patch: &NurbsPatch, parameters: [f64; 2]) -> [f64; 2] {
    patch.map(&functions(patch, parameters)).position
}

/// Lengths of the span at a place, h.
fn lengths(spaces: &[SplineSpace; 2], span: [usize; 2]) -> [f64; 2] {
    [0, 1].map(|d| spaces[d].spans()[span[d]].length())
}

fn sum(f: &RationalFunctions, term: impl Fn(usize) -> f64) -> f64 {
    (0..f.count).map(term).sum()
}

const GRID: [f64; 6] = [0.0, 0.137, 0.4, 0.5, 0.83, 1.0];

/// A fixed set of parameters, ends included.
fn places() -> impl Iterator<Item = [f64; 2]> {
    GRID.iter().flat_map(|&v| GRID.iter().map(move |&u| [u, v]))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, rng_seed: RngSeed::Fixed(20240), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_affine_rectangle_is_the_patch_of_the_mesh([x, y] in [direction(), direction()]) {
        let (degree, knots) = ([x.degree, y.degree], [x.knots, y.knots]);
        let rectangle = NurbsPatch::rectangle(degree, [&knots[0], &knots[1]], [0.0, 0.0], [1.0, 1.0]).unwrap();
        let general = rectangle.general();
        let patch = Patch::new(&Mesh::of_knots(degree, knots));
        let grid = patch.control_grid();
        let control: Vec<f64> = (0..grid.rows * grid.columns).map(|n| (1.7 * n as f64).sin()).collect();
        let mut field = grid.zeros();
        grid.indices().zip(&control).for_each(|(at, value)| field[at] = *value);
        for parameters in places() {
            let expected = patch.evaluate(&field, parameters).unwrap();
            let h = lengths(rectangle.spaces(), rectangle.find_span(parameters).unwrap());
            for nurbs in [&rectangle, &general] {
                let f = functions(nurbs, parameters);
                let (point, place) = (nurbs.map(&f), nurbs.locate(parameters, None).unwrap());
                let gradient = f.physical_gradients(&point);
                assert_abs_diff_eq!(f.interpolate(&control), expected.value, epsilon = 1e-13);
                for d in 0..2 {
                    assert_abs_diff_eq!(point.position[d], parameters[d], epsilon = 1e-13);
                    assert_abs_diff_eq!(point.jacobian[d][d], 1.0, epsilon = 1e-13 / h[d]);
                    let slope = sum(&f, |n| gradient[n][d] * control[f.control[n]]);
                    // The fast path has a Jacobian of one; the general one sums it: relative 1e-13/h more.
                    let room = 1e-13 / h[d] * (1.0 + 1.0 / smaller(h[0], h[1]));
                    assert_abs_diff_eq!(slope, expected.gradient[d], epsilon = room);
                    assert_abs_diff_eq!(place.parameters[d], parameters[d], epsilon = 1e-12);
                }
            }
        }
    }

    #[test]
    fn points_of_a_refined_annulus_find_their_parameters(at in [0.0..1.0f64, 0.0..1.0f64], from in [0.0..1.0f64, 0.0..1.0f64], cuts in 1usize..6) {
        let ring = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap().elevate(0).unwrap().subdivide(cuts).unwrap();
        let point = position(&ring, at);
        for start in [None, Some(from)] {
            let place = ring.locate(point, start).unwrap();
            assert_abs_diff_eq!(place.parameters[0], at[0], epsilon = 1e-12);
            assert_abs_diff_eq!(place.parameters[1], at[1], epsilon = 1e-12);
        }
    }
}

#[test]
fn a_fold_inside_is_found_and_named() {
    // A middle control point drawn over the opposite edge.
    let knots: &[f64] = &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let mut control: Vec<[f64; 2]> = (0..9).map(|n| [(n % 3) as f64 / 2.0, (n / 3) as f64 / 2.0]).collect();
    assert!(NurbsPatch::new([2, 2], [knots, knots], control.clone(), vec![1.0; 9]).is_ok());
    control[4] = [4.0, 0.5];
    let error = NurbsPatch::new([2, 2], [knots, knots], control, vec![1.0; 9]).unwrap_err();
    assert!(matches!(error, NurbsError::Folded { determinant, .. } if determinant <= 0.0), "{error}");
}

#[test]
fn points_outside_are_refused_from_any_start() {
    let ring = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap().subdivide(4).unwrap();
    for point in [[0.5, 0.5], [2.0, 2.0], [1.5, -1e-6], [-1e-6, 1.5], [-1.5, 0.0], [1e300, -1e300]] {
        for start in [None, Some([0.0, 0.0]), Some([0.9, 0.1]), Some([f64::INFINITY, 0.0])] {
            assert!(matches!(ring.locate(point, start), Err(LocateError::Outside { .. })), "{point:?}");
        }
    }
    let knots: &[f64] = &[0.0, 0.0, 2.0, 2.0];
    let rectangle = NurbsPatch::rectangle([1, 1], [knots, knots], [1.0, 1.0], [3.0, 2.0]).unwrap();
    assert!(matches!(rectangle.form(), Form::Affine { .. }));
    match rectangle.locate([3.5, 1.5], None).unwrap_err() {
        LocateError::Outside { nearest, distance, .. } => assert_eq!((nearest, distance), ([3.0, 1.5], 0.5)),
        other => panic!("{other}"),
    }
}
