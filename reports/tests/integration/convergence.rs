//! Charts of a convergence study with made-up errors: four degrees down to round-off.

use std::path::Path;

use fisura_reports::figure::{file_name, render_figure};
use fisura_reports::series::SeriesSet;
use fisura_verification::study::orders::{Convergence, Curve, Level, Norm, Refined};
use insta::assert_snapshot;

/// Errors `C h^order`, a little off on coarse meshes, and round-off that grows as meshes are refined.
fn level(degree: i32, refinement: i32) -> Level {
    let h = 0.5f64.powi(refinement + 1);
    let unknowns = 2.0 * (1.0 / h + f64::from(degree)).powi(2);
    let coarse = 1.0 + 2.0 * h * h;
    let error = |order: i32| 0.5 * coarse * h.powi(order) + 1e-15 / (h * h);
    let seconds = 2e-6 * unknowns.powf(1.5) * f64::from((degree + 1) * (degree + 1));
    Level { h, unknowns: unknowns as usize, seconds, errors: vec![error(degree + 1), error(degree)] }
}

fn study() -> Convergence {
    let curve = |p: i32| Curve {
        name: format!("p={p}"),
        levels: (0..8).map(|n| level(p, n)).collect(),
        orders: vec![Some(f64::from(p + 1)), Some(f64::from(p))],
    };
    let norm = |name: &str| Norm { quantity: format!("displacement error in {name}"), unit: "1".into(), floor: 1e-10 };
    Convergence {
        suite: "manufactured".into(),
        stem: "manufactured-annulus".into(),
        title: "Elastostatics on an annulus".into(),
        caption: "Made-up numbers.".into(),
        theory: "p + 1 in L2, p in H1".into(),
        refined: Refined::Mesh { dimensions: 2 },
        norms: vec![norm("L2"), norm("H1")],
        curves: (1..=4).map(curve).collect(),
        ..Convergence::default()
    }
}

/// The figures of the study as SVG, in their order.
fn drawings() -> Vec<(String, String)> {
    let study = study();
    let mut set = SeriesSet::default();
    for (stem, table) in study.series() {
        set.insert(format!("series/{stem}.csv"), table);
    }
    let draw = |figure| render_figure(figure, &set).unwrap();
    study.figures().iter().map(|figure| (file_name(&figure.id).unwrap(), draw(figure))).collect()
}

/// Every text of a drawing, in order.
fn texts(svg: &str) -> String {
    let after_tag = |part: &str| part.split_once('>').map(|(_, text)| text.trim().to_string());
    svg.split("<text").skip(1).filter_map(|p| after_tag(p.split("</text").next()?)).collect::<Vec<_>>().join("\n")
}

#[test]
fn charts_of_a_convergence_study_keep_their_words_and_numbers() {
    let drawings = drawings();
    let names: Vec<&str> = drawings.iter().map(|d| d.0.as_str()).collect();
    let stem = "manufactured-annulus-displacement-error-in";
    let expected = [
        format!("figures/{stem}-l2.svg"),
        format!("figures/{stem}-l2-unknowns.svg"),
        format!("figures/timing/{stem}-l2.svg"),
        format!("figures/{stem}-h1.svg"),
    ];
    assert_eq!(names, expected);
    // kept for a look: `rsvg-convert` makes pictures of them
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("convergence");
    for (name, svg) in &drawings {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, svg).unwrap();
    }
    assert_snapshot!("against_h", texts(&drawings[0].1));
    assert_snapshot!("against_unknowns", texts(&drawings[1].1));
    assert_snapshot!("against_cost", texts(&drawings[2].1));
}

#[test]
fn markers_in_round_off_are_hollow_and_others_are_not() {
    let (_, svg) = &drawings()[0];
    let colour_of_quartics = "#CC79A7";
    // markers of one look share a path, each with an end of its own
    let shapes =
        |look: &str| svg.split('<').filter(|e| e.contains(look)).map(|e| e.matches('z').count()).sum::<usize>();
    let rimmed = format!("fill=\"{colour_of_quartics}\" stroke=\"#FFFFFF\"");
    assert_eq!(shapes(&rimmed), 8 + 1, "eight markers and the sample of the legend");
    let below = study().curves[3].levels.iter().filter(|l| l.errors[0] <= 1e-10).count();
    assert_eq!(below, 2);
    assert_eq!(shapes("fill=\"#FFFFFF\""), below, "a hole in each marker below the floor");
}
