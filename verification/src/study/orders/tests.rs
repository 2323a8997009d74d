use super::*;
use crate::record::FigureBody;

/// Levels with `error = 2 h^order` plus a floor, h halved from 1/4.
fn levels(count: i32, order: f64, floor: f64) -> Vec<(f64, f64)> {
    (0..count).map(|n| 0.25 * 0.5f64.powi(n)).map(|h| (h, 2.0 * h.powf(order) + floor)).collect()
}

fn study() -> Convergence {
    let curve = |p: i32| {
        let meshes = levels(5, f64::from(p) + 1.0, 0.0).into_iter().zip(levels(5, f64::from(p), 0.0));
        let level = |((h, l2), (_, h1)): ((f64, f64), (f64, f64))| Level {
            h,
            unknowns: (2.0 / (h * h)) as usize,
            seconds: 1e-3 * f64::from(p) / h.powi(3),
            errors: vec![l2, h1],
        };
        let orders = vec![Some(f64::from(p) + 1.0), Some(f64::from(p))];
        Curve { name: format!("p={p}"), levels: meshes.map(level).rev().collect(), orders }
    };
    let norm = |name: &str| Norm { quantity: format!("displacement error in {name}"), unit: "1".into(), floor: 1e-8 };
    Convergence {
        suite: "manufactured".into(),
        stem: "manufactured-bar".into(),
        title: "A bar".into(),
        theory: "p + 1 in L2, p in H1".into(),
        refined: Refined::Mesh { dimensions: 2 },
        norms: vec![norm("L2"), norm("H1")],
        curves: (1..=3).map(curve).collect(),
        ..Convergence::default()
    }
}

#[test]
fn exact_powers_give_exact_orders() {
    for order in [1.0, 2.5, 4.0] {
        let levels = levels(5, order, 0.0);
        assert!((observed_order(&levels, 0.0).unwrap() - order).abs() < 1e-12);
        let pairs = pairwise_orders(&levels);
        assert!(pairs[0].is_nan() && pairs[1..].iter().all(|p| (p - order).abs() < 1e-12), "{pairs:?}");
    }
    let uneven = [(1.0, 1.0), (0.5, 0.125), (0.3, 0.027), (0.1, 0.001)];
    assert!((observed_order(&uneven, 0.0).unwrap() - 3.0).abs() < 1e-12);
}

#[test]
fn only_the_finest_levels_above_the_floor_count() {
    // a wrong first level is before the asymptotic range
    let mut coarse = levels(4, 3.0, 0.0);
    coarse[0].1 *= 7.0;
    assert!((observed_order(&coarse, 0.0).unwrap() - 3.0).abs() < 1e-12);
    // round-off flattens the last levels, and may rise again
    let mut flat = levels(7, 4.0, 0.0);
    for (index, error) in [(4, 5e-7), (5, 4e-7), (6, 3e-6)] {
        flat[index].1 = error;
    }
    assert!((observed_order(&flat, 1e-6).unwrap() - 4.0).abs() < 1e-12);
    assert_eq!(above_floor(&flat, 1e-6).len(), 4);
    assert!(observed_order(&flat, 0.0).unwrap() < 1.0, "without a floor the order is lost");
}

#[test]
fn too_few_levels_and_diverged_meshes_give_no_order() {
    assert_eq!(observed_order(&levels(2, 2.0, 0.0), 0.0), None);
    assert_eq!(observed_order(&levels(5, 2.0, 0.0), 0.05), None);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut levels = levels(5, 2.0, 0.0);
        levels[4].1 = bad;
        assert_eq!(observed_order(&levels, 0.0), None, "{bad}");
    }
    assert_eq!(observed_order(&[(1.0, 1.0), (1.0, 1.0), (1.0, 1.0)], 0.0), None, "one mesh three times");
    assert_eq!(observed_order(&[(1.0, 0.0), (0.5, 0.0), (0.25, 0.0)], 0.0), None, "no error at all");
    assert!(pairwise_orders(&[]).is_empty());
}

#[test]
fn measurements_name_order_and_finest_error() {
    let measurements = study().measurements();
    assert_eq!(measurements.len(), 12);
    let order = &measurements[0];
    assert_eq!((order.variant.as_str(), order.quantity.as_str()), ("p=1", "order of the displacement error in L2"));
    assert!((order.value.unwrap() - 2.0).abs() < 1e-12);
    assert_eq!(order.reference.as_ref().unwrap().value, Some(2.0));
    let finest = &measurements[1];
    assert_eq!(finest.quantity, "displacement error in L2 on the finest mesh");
    assert_eq!(finest.value, Some(levels(5, 2.0, 0.0)[4].1));
}

#[test]
fn tables_run_from_coarse_to_fine_and_times_stand_apart() {
    let series = study().series();
    let stems: Vec<&str> = series.iter().map(|s| s.0.as_str()).collect();
    let of_first = ["manufactured-bar-p1", "timing/manufactured-bar-p1"];
    assert!(stems.len() == 6 && of_first.iter().all(|stem| stems.contains(stem)), "{stems:?}");
    let table = &series[0].1;
    assert_eq!(
        table.names[..4],
        ["h_m", "unknowns", "displacement_error_in_l2", "displacement_error_in_l2_pairwise_order"]
    );
    assert!(table.columns[0].windows(2).all(|pair| pair[0] > pair[1]));
    for (stem, table) in &series {
        assert_eq!(table.column("seconds").is_some(), stem.starts_with("timing/"), "{stem}");
    }
}

#[test]
fn figures_carry_theory_and_floor() {
    let study = study();
    let figures = study.figures();
    let ids: Vec<&str> = figures.iter().map(|f| f.id.as_str()).collect();
    let name = "manufactured-bar-displacement-error-in-l2";
    assert_eq!(ids[..3], [name.to_string(), format!("{name}-unknowns"), format!("timing/{name}")]);
    let series: Vec<String> = study.series().into_iter().map(|s| format!("series/{}.csv", s.0)).collect();
    let expected = [vec![2.0, 3.0, 4.0], vec![-2.0, -1.5, -1.0], vec![]];
    for (figure, expected) in figures.iter().zip(expected) {
        let FigureBody::Chart { curves, slopes, floors, .. } = &figure.body else { panic!("a chart") };
        assert!(curves.iter().all(|c| series.contains(&c.series)), "{curves:?}");
        assert_eq!(slopes.iter().map(|s| s.slope).collect::<Vec<_>>(), expected);
        assert_eq!(floors.len(), 1, "p = 3 comes near the floor");
    }
    let FigureBody::Chart { slopes, .. } = &figures[1].body else { panic!("a chart") };
    assert_eq!(slopes.iter().map(|s| s.label.as_str()).collect::<Vec<_>>(), ["2", "3/2", "1"]);
}

#[test]
fn a_triangle_stands_below_its_curve_and_above_the_next() {
    let figures = study().figures();
    let FigureBody::Chart { slopes, .. } = &figures[0].body else { panic!("a chart") };
    for (index, triangle) in slopes.iter().enumerate() {
        let curve = |p: f64, x: f64| 2.0 * x.powf(p + 1.0);
        let y = |x: f64| triangle.y0 * (x / triangle.x[0]).powf(triangle.slope);
        let p = index as f64 + 1.0;
        assert!(triangle.x.iter().all(|x| y(*x) < curve(p, *x)), "{triangle:?}");
        assert!(index == 2 || triangle.x.iter().all(|x| triangle.y0 > curve(p + 1.0, *x)), "{triangle:?}");
    }
}

#[test]
fn curves_of_one_order_share_a_triangle_clear_of_all() {
    let mut study = study();
    study.norms.truncate(1);
    study.curves = [1.0, 0.9, 0.2]
        .map(|factor| {
            let level = |(h, error)| Level { h, unknowns: 1, seconds: 0.0, errors: vec![factor * error] };
            let levels = levels(4, 2.0, 0.0).into_iter().map(level).collect();
            Curve { name: format!("lumped, {factor}"), levels, orders: vec![Some(2.0)] }
        })
        .to_vec();
    let figures = study.figures();
    assert_eq!(figures.len(), 2, "no times, no figure of cost");
    let FigureBody::Chart { slopes, .. } = &figures[0].body else { panic!("a chart") };
    let [triangle] = slopes.as_slice() else { panic!("one triangle: {slopes:?}") };
    let over = |factor: f64| triangle.y0 / (factor * 2.0 * triangle.x[0] * triangle.x[0]);
    assert!(over(0.9) < 1.0 && !(0.8..=1.0).contains(&over(0.2)), "it stands clear of every curve: {triangle:?}");
}
