//! NURBS patches with random knots, weights and degrees: what must hold for each, and what refinement must
//! not change.

use approx::assert_abs_diff_eq;
use fisura::linear_algebra::extremes::{larger, smaller};
use fisura::scene::Mesh;
use fisura::splines::nurbs::{Form, LocateError, NurbsError, NurbsPatch, RationalFunctions, rational_functions};
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

/// Two directions, and weights between 0.1 and 10 for every control point.
fn weighted() -> impl Strategy<Value = ([Direction; 2], Vec<f64>)> {
    [direction(), direction()].prop_flat_map(|directions| {
        let count: usize = directions.iter().map(|d| d.knots.len() - d.degree - 1).product();
        let weights = prop::collection::vec((-1.0..1.0f64).prop_map(|log| 10f64.powf(log)), count);
        (Just(directions), weights)
    })
}

/// A bent patch on those knots; bend and weights are tamed until it is not folded.
fn bent([x, y]: &[Direction; 2], weights: &[f64]) -> NurbsPatch {
    let [gx, gy] = [x, y].map(|d| SplineSpace::new(d.degree, &d.knots).greville());
    for tame in [1.0, 0.5, 0.25, 0.1, 0.0] {
        let bend = |u: f64, v: f64| [u + 0.3 * tame * v * v, v + 0.4 * tame * u * (1.0 - u) + 0.2 * tame * u * v];
        let control = gy.iter().flat_map(|&v| gx.iter().map(move |&u| bend(u, v))).collect();
        let weights = weights.iter().map(|w| w.powf(tame)).collect();
        if let Ok(patch) = NurbsPatch::new([x.degree, y.degree], [&x.knots, &y.knots], control, weights) {
            return patch;
        }
    }
    unreachable!("equal weights on a straight grid are not folded")
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
    fn gradients_are_the_slopes_of_the_values((directions, weights) in weighted(), fraction in [0.0..=1.0f64, 0.0..=1.0f64]) {
        let spaces = directions.each_ref().map(|d| SplineSpace::new(d.degree, &d.knots));
        for (i, s) in spaces[0].spans().iter().enumerate() {
            for (j, t) in spaces[1].spans().iter().enumerate() {
                let centre = [s.left + s.length() * fraction[0], t.left + t.length() * fraction[1]];
                let f = rational_functions(&spaces, &weights, [i, j], centre);
                for d in 0..2 {
                    // Central differences extrapolated to O(step⁴): round-off over the step is what is left.
                    let h = lengths(&spaces, [i, j])[d];
                    // Steps of 3e-6 spans, since weights 100 apart make the basis change over a hundredth of
                    // a span.
                    let difference = |step: f64| {
                        let [plus, minus] = [step, -step].map(|step| {
                            let mut moved = centre;
                            moved[d] += step * h;
                            (moved[d], rational_functions(&spaces, &weights, [i, j], moved).value)
                        });
                        (0..f.count).map(|n| (plus.1[n] - minus.1[n]) / (plus.0 - minus.0)).collect::<Vec<_>>()
                    };
                    let (wide, narrow) = (difference(6e-6), difference(3e-6));
                    for n in 0..f.count {
                        let slope = (4.0 * narrow[n] - wide[n]) / 3.0;
                        assert_abs_diff_eq!(f.gradient[n][d], slope, epsilon = 1e-8 / h);
                    }
                }
            }
        }
    }

    #[test]
    fn physical_gradients_reproduce_a_linear_field((directions, weights) in weighted()) {
        let patch = bent(&directions, &weights);
        let field: Vec<f64> = patch.control_points().iter().map(|p| 3.0 + 2.0 * p[0] - p[1]).collect();
        for parameters in places() {
            let f = functions(&patch, parameters);
            let point = patch.map(&f);
            assert_abs_diff_eq!(f.interpolate(&field), 3.0 + 2.0 * point.position[0] - point.position[1], epsilon = 1e-13);
            // 1/h in space: the parametric gradients times the inverse of the Jacobian.
            let gradient = f.physical_gradients(&point);
            let largest = |numbers: &[f64]| numbers.iter().fold(0.0, |m: f64, g| larger(m, g.abs()));
            let inverse = largest(point.jacobian.as_flattened()) / point.determinant().abs();
            let per_length = inverse * largest(f.gradient[..f.count].as_flattened());
            for (d, expected) in [2.0, -1.0].into_iter().enumerate() {
                assert_abs_diff_eq!(sum(&f, |n| gradient[n][d] * field[f.control[n]]), expected, epsilon = 1e-13 * per_length.max(1.0));
            }
        }
    }

    #[test]
    fn new_knots_and_a_higher_degree_leave_the_geometry((directions, weights) in weighted(), new in prop::collection::vec(0.001..0.999f64, 1..6)) {
        let patch = bent(&directions, &weights);
        for direction in 0..2 {
            let before = &patch.spaces()[direction];
            for (refined, raised) in [(patch.insert_knots(direction, &new), 0), (patch.elevate(direction), 1)] {
                let refined = match refined {
                    Ok(refined) => refined,
                    Err(NurbsError::Knots { .. }) if before.degree() == 4 => continue,
                    // More Gauss points look closer: a fold between the old ones may come to light.
                    Err(error) => {
                        prop_assert!(matches!(error, NurbsError::Folded { .. }), "{}", error);
                        continue;
                    }
                };
                let after = &refined.spaces()[direction];
                prop_assert_eq!(after.degree(), before.degree() + raised);
                prop_assert!(raised == 1 || after.dimension() == before.dimension() + new.len());
                for parameters in places() {
                    let [before, after] = [&patch, &refined].map(|patch| position(patch, parameters));
                    for d in 0..2 {
                        assert_abs_diff_eq!(before[d], after[d], epsilon = 1e-13);
                    }
                }
            }
        }
    }

    #[test]
    fn equal_weights_are_a_b_spline([x, y] in [direction(), direction()], weight in 0.1..10.0f64) {
        let count = [&x, &y].map(|d| d.knots.len() - d.degree - 1).iter().product();
        let fast = bent(&[x, y], &vec![weight; count]);
        let general = fast.general();
        prop_assert_eq!([fast.form(), general.form()], [Form::Polynomial, Form::Rational]);
        for parameters in places() {
            let [a, b] = [&fast, &general].map(|patch| functions(patch, parameters));
            let h = lengths(fast.spaces(), fast.find_span(parameters).unwrap());
            for n in 0..a.count {
                prop_assert_eq!(a.control[n], b.control[n]);
                assert_abs_diff_eq!(a.value[n], b.value[n], epsilon = 1e-13);
                for d in 0..2 {
                    assert_abs_diff_eq!(a.gradient[n][d], b.gradient[n][d], epsilon = 1e-13 / h[d]);
                }
            }
        }
    }

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
    fn points_find_their_parameters((directions, weights) in weighted(), at in [0.0..1.0f64, 0.0..1.0f64], from in [0.0..1.0f64, 0.0..1.0f64]) {
        let patch = bent(&directions, &weights);
        let point = position(&patch, at);
        for start in [None, Some(at), Some(from)] {
            match patch.locate(point, start) {
                Ok(place) => {
                    prop_assert!(patch.find_span(place.parameters).is_some());
                    let image = patch.map(&patch.shape_functions(place.span, place.parameters)).position;
                    assert_abs_diff_eq!(image[0], point[0], epsilon = 1e-12);
                    assert_abs_diff_eq!(image[1], point[1], epsilon = 1e-12);
                }
                // A fold between the Gauss points is told, never passed over.
                Err(error) => prop_assert!(matches!(error, LocateError::Folded { .. }), "{}", error),
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
