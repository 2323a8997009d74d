//! A linear displacement on rational patches: interpolated exactly, in equilibrium up to the quadrature by
//! points.
//!
//! A linear field lies in the space of every patch, so its strain is exact at the points. Its internal forces
//! and the tractions on the four sides then balance but for the error of the point sums, whose integrands are
//! rational: the *equilibrium residual*. Its work on a smooth field is the error of a composite rule of n
//! Gauss points per direction on a smooth integrand and falls with order 2 n. The largest nodal force left
//! over, relative to the largest of the tractions, falls with order 2 n − p only: the functions of a single
//! control point change over a span. The tractions are integrated with 16 points per span. Weights are drawn
//! once on the coarsest mesh and carried by knot insertion.

use fisura::particles::lattice::Lattice;
use fisura::scene::{Body, Layout, Side};
use fisura::splines::patch::Patch;
use fisura::splines::quadrature::{MAX_POINTS, Rule};

use super::{Case, CaseScene, Findings, StudyError, other};
use crate::case::convergence::PatchFamily;
use crate::extremes::larger;
use crate::study::orders::{Convergence, Curve, Level, Norm, Refined};
use crate::study::patches;

const FAMILIES: [(PatchFamily, &str, [usize; 4]); 3] = [
    (PatchFamily::Annulus, "annulus", [2, 4, 8, 16]),
    (PatchFamily::Weighted, "weighted", [4, 8, 16, 32]),
    (PatchFamily::Random, "random", [6, 12, 24, 48]),
];
/// Displacement gradient, and the stress it stands for: any constants balance, so no material is needed.
const GRADIENT: [[f64; 2]; 2] = [[0.3, -0.7], [0.2, 0.5]];
const STRESS: [[f64; 2]; 2] = [[1.0, 0.4], [0.4, -0.6]];
const FLOOR: f64 = 1e-13;

const NORMS: [&str; 2] = ["equilibrium residual of a linear field", "work of the residual on a smooth field"];

pub(super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let mut curves = Vec::new();
    for (family, words, cells) in FAMILIES {
        for degree in [2, 3] {
            let on = |spans: usize| patch(family, degree, spans);
            let quantities = [
                ("linear field, largest error at a point", None),
                ("its gradient, largest error at a point", None),
                ("equilibrium residual of a linear field on 8 or 9 spans, p + 6 points", None),
                ("equilibrium residual of a linear field on 8 or 9 spans, 3 points", None),
            ];
            findings.measure(&format!("{words}, p={degree}"), quantities, || {
                let [value, gradient] = interpolation_errors(&on(cells[1])?);
                // Random families have a multiple of three spans.
                let fine = on(if family == PatchFamily::Random { 9 } else { 8 })?;
                Ok([value, gradient, residual(&fine, degree + 6)[0], residual(&fine, 3)[0]])
            })?;
            for points in [2, 3, 4] {
                let level = |spans: usize| {
                    crate::watch::check()?;
                    let patch = on(spans)?;
                    let unknowns = 2 * patch.control_grid().columns * patch.control_grid().rows;
                    let errors = residual(&patch, points).to_vec();
                    Ok(Level { h: 1.0 / spans as f64, unknowns, seconds: 0.0, errors })
                };
                let levels = findings.compute(|| cells.into_iter().map(level).collect())?.unwrap_or_default();
                let name = format!("{words}, p={degree}, {points}x{points} points");
                curves.push(Curve {
                    name,
                    levels,
                    orders: vec![Some(2.0 * points as f64 - degree as f64), Some(2.0 * points as f64)],
                });
            }
        }
    }
    let study = Convergence {
        title: "Equilibrium of a linear field on rational patches".into(),
        caption:
            "Largest nodal force left over, relative to the largest of the tractions, and its work on a smooth field, \
                  relative to that of the tractions; h in parameters."
                .into(),
        theory: "n Gauss points per direction integrate smooth integrands with order 2 n, less p for single functions"
            .into(),
        refined: Refined::Mesh { dimensions: 2 },
        norms: NORMS.map(|quantity| Norm { quantity: quantity.into(), unit: "1".into(), floor: FLOOR }).to_vec(),
        curves,
        ..Convergence::of(case)
    };
    study.add_to(findings);
    Ok(())
}

fn patch(family: PatchFamily, degree: usize, spans: usize) -> Result<Patch, StudyError> {
    let mesh = patches::mesh(family, degree, spans).map_err(other)?;
    Ok(Patch::new(&mesh))
}

fn lattice(patch: &Patch, points: usize) -> Lattice {
    let body = Body { particles_per_cell: [points; 2], ..Body::at_rest("body", "none", fisura::scene::Shape::Patch) };
    Lattice::new(patch, &body)
}

/// Largest errors of value and gradient at the points, found through the inverse map.
fn interpolation_errors(patch: &Patch) -> [f64; 2] {
    let [x, y] = patch.control_positions();
    let fields = GRADIENT.map(|[a, b]| x.iter().zip(&y).map(|(x, y)| a * x + b * y).collect::<Vec<f64>>());
    let mut worst = [0.0_f64; 2];
    lattice(patch, 3).for_each_point(|_, _, position, _| {
        for (field, gradient) in fields.iter().zip(GRADIENT) {
            let Some(found) = patch.evaluate(field, position) else { return worst = [f64::INFINITY; 2] };
            let exact = gradient[0] * position[0] + gradient[1] * position[1];
            worst[0] = larger(worst[0], (found.value - exact).abs());
            for d in 0..2 {
                worst[1] = larger(worst[1], (found.gradient[d] - gradient[d]).abs());
            }
        }
    });
    worst
}

/// What internal forces and tractions leave: the largest nodal force, relative to the largest of the
/// tractions, and the work on a smooth field, relative to the sum of the magnitudes of that of the tractions.
fn residual(patch: &Patch, points: usize) -> [f64; 2] {
    let lattice = lattice(patch, points);
    let mut tractions = [lattice.grid.zeros(), lattice.grid.zeros()];
    let rule = Rule::new(Layout::Gauss, MAX_POINTS);
    for side in [Side::Left, Side::Right, Side::Bottom, Side::Top] {
        for point in patch.boundary(side, &rule) {
            let [x, y] = point.normal.map(|n| n * point.length);
            for &(at, value) in &point.functions.values {
                for i in 0..2 {
                    tractions[i][at] += value * (STRESS[i][0] * x + STRESS[i][1] * y);
                }
            }
        }
    }
    let mut internal = [lattice.grid.zeros(), lattice.grid.zeros()];
    let [x, y] = &mut internal;
    lattice.add_integral(&mut [x, y], |_, _, _| ([0.0; 2], STRESS));
    let [x, y] = patch.control_positions();
    let smooth = |i: usize, at: usize| if i == 0 { x[at] * (x[at] - y[at]) } else { y[at] * (x[at] + y[at]) };
    let [mut largest, mut most, mut work, mut scale] = [0.0_f64; 4];
    for (i, (internal, traction)) in internal.iter().zip(&tractions).enumerate() {
        for at in lattice.grid.indices() {
            let left_over = internal[at] - traction[at];
            largest = larger(largest, left_over.abs());
            most = larger(most, traction[at].abs());
            work += smooth(i, at) * left_over;
            scale += (smooth(i, at) * traction[at]).abs();
        }
    }
    [largest / most, work.abs() / scale]
}
