use super::*;

/// Values `3 + C h^p` on meshes of these spans.
fn power(spans: &[f64], p: f64, c: f64) -> Vec<(f64, f64)> {
    spans.iter().map(|h| (*h, 3.0 + c * h.powf(p))).collect()
}

fn close(found: Result<f64, String>, expected: f64) {
    let found = found.unwrap();
    assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{found} instead of {expected}");
}

#[test]
fn known_orders_and_limits_are_found_for_even_and_uneven_ratios() {
    for spans in [[1.0, 0.5, 0.25], [1.0, 0.8, 0.5], [1.0, 0.4, 0.3], [0.3, 1.0, 0.7]] {
        for p in [0.7, 1.0, 2.0, 3.5] {
            for c in [0.1, -2.0] {
                let meshes = power(&spans, p, c);
                close(combine(Estimate::ObservedOrder, meshes.clone(), None), p);
                close(combine(Estimate::Richardson, meshes, None), 3.0);
            }
        }
    }
}

#[test]
fn the_index_is_the_safety_factor_times_the_relative_error() {
    let meshes = power(&[0.4, 0.2, 0.1], 2.0, 1.0);
    let error = 0.01 / 3.01;
    let index = |theory| combine(Estimate::GridConvergenceIndex, meshes.clone(), theory);
    close(index(None), 1.25 * error);
    close(index(Some(2.0)), 1.25 * error);
    // observed 2 where theory says 4: the lower one counts, and is trusted less
    close(index(Some(4.0)), 3.0 * error);
    // observed 2 where theory says 1: a lucky sequence does not shrink the index
    close(index(Some(1.0)), 3.0 * 0.03 / 3.01);
    close(combine(Estimate::GridConvergenceIndex, meshes[1..].to_vec(), Some(2.0)), 3.0 * error);
}

#[test]
fn only_the_finest_three_meshes_count() {
    let mut meshes = power(&[0.4, 0.2, 0.1], 2.0, 1.0);
    meshes.push((0.8, -40.0));
    close(combine(Estimate::ObservedOrder, meshes, None), 2.0);
}

#[test]
fn what_does_not_converge_gives_words_and_no_number() {
    let on = |values: [f64; 3]| -> Vec<(f64, f64)> { [0.4, 0.2, 0.1].into_iter().zip(values).collect() };
    for (values, expected) in [
        ([1.0, 1.2, 1.1], "oscillatory"),
        ([1.0, 1.1, 1.3], "no convergence"),
        ([1.0, 1.1, 1.2], "no convergence"),
        ([1.0, 1.0, 1.2], "no convergence"),
        ([1.2, 1.0, 1.0], "does not change between the finest meshes"),
        ([1.0, 1.2, 1.2], "does not change between the finest meshes"),
        ([1.0, 1.0, 1.0], "does not change between any of the meshes"),
        ([1.0, f64::NAN, 1.0], "no convergence"),
    ] {
        for estimate in [Estimate::ObservedOrder, Estimate::Richardson, Estimate::GridConvergenceIndex] {
            let why = combine(estimate, on(values), Some(2.0)).unwrap_err();
            assert!(why.contains(expected) && why.contains("from coarse to fine"), "{values:?}: {why}");
        }
    }
    let slow = power(&[0.4, 0.2, 0.1], 0.2, 1.0);
    assert!(combine(Estimate::Richardson, slow.clone(), None).unwrap_err().contains("too far"));
    close(combine(Estimate::ObservedOrder, slow, None), 0.2);
    let zero = vec![(0.4, 16.0), (0.2, 4.0), (0.1, 0.0)];
    assert!(combine(Estimate::GridConvergenceIndex, zero, None).unwrap_err().contains("zero"));
}

#[test]
fn the_finest_mesh_has_an_uncertainty_whether_its_sequence_converges_or_not() {
    let (value, uncertainty) = on_finest_mesh(power(&[0.4, 0.2, 0.1], 2.0, 1.0), Some(2.0)).unwrap();
    assert!((value - 3.01).abs() < 1e-12 && (uncertainty - 1.25 * 0.01).abs() < 1e-9, "{value} {uncertainty}");
    for values in [[1.0, 1.2, 1.1], [1.0, 1.1, 1.3], [1.2, 1.0, 1.0]] {
        let meshes = [0.4, 0.2, 0.1].into_iter().zip(values).collect();
        let range = spread(&values);
        assert_eq!(on_finest_mesh(meshes, Some(2.0)).unwrap(), (values[2], 3.0 * range), "{values:?}");
    }
    let broken = [0.4, 0.2, 0.1].into_iter().zip([1.0, f64::NAN, 1.0]).collect();
    assert!(on_finest_mesh(broken, Some(2.0)).is_err(), "not a number is no value");
}
