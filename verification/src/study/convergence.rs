//! Convergence to an exact solution: the `[convergence]` table of a case says which, on which meshes, and how.
//!
//! A dynamic problem is run with steps in proportion to `h^((p + 1)/2)`, so that the second order in time shows as p + 1,
//! unless the case gives another power. Errors are relative, and integrated with an independent, finer quadrature.

mod errors;
mod problem;
mod solve;

use fisura::scene::{Layout, Mass};

use super::{Findings, StudyError};
use crate::case::Case;
use crate::case::convergence::{ConvergenceSetup, Loading, PatchFamily, Refine};
use crate::convergence::{Convergence, Curve, Level, Norm, Refined};
use crate::expand::CaseScene;
use problem::{Kind, Problem};
use solve::Discrete;

/// Relative errors at or below this are round-off.
const FLOOR: f64 = 1e-11;

pub(super) fn study(case: &Case, _scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let setup =
        case.convergence.as_ref().ok_or_else(|| StudyError::Other("a [convergence] table is missing".into()))?;
    let problem = problem::find(&setup.problem, setup.plane, setup.patch).map_err(StudyError::Other)?;
    let norms = Discrete::norms(&problem);
    let mut findings = Findings::default();
    let mut curves = Vec::new();
    for (n, &degree) in setup.degrees.iter().enumerate() {
        let repeated = setup.degrees.iter().filter(|&other| *other == degree).count() > 1;
        let points = if repeated { format!(", {0}x{0} points", setup.points(n)) } else { String::new() };
        let name = format!("p={degree}{points}");
        let orders = norms.iter().map(|&(_, below)| Some(theory(setup, &problem, degree, below))).collect();
        let (levels, best) = levels(setup, &problem, n)?;
        for (index, (quantity, _)) in norms.iter().enumerate() {
            let error = levels.last().map_or(f64::NAN, |level| level.errors[index]);
            findings.add(&name, &format!("{quantity} over that of the best approximation"), error / best[index], None);
        }
        curves.push(Curve { name, levels, orders });
    }
    let norm = |&(quantity, _): &(&str, usize)| Norm { quantity: quantity.into(), unit: "1".into(), floor: FLOOR };
    let study = Convergence {
        suite: case.suite.clone(),
        stem: format!("{}-{}", case.suite, case.name),
        title: title(case, setup),
        caption: caption(setup, &problem),
        deviations: case.deviations.clone(),
        theory: words_of_theory(setup, &problem),
        refined: match setup.refine {
            Refine::Mesh(_) => Refined::Mesh { dimensions: 2 },
            Refine::TimeStep => Refined::TimeStep,
        },
        norms: norms.iter().map(norm).collect(),
        curves,
    };
    study.add_to(&mut findings);
    Ok(findings)
}

/// The levels of the n-th degree, and the errors of the best approximation on the last.
fn levels(setup: &ConvergenceSetup, problem: &Problem, n: usize) -> Result<(Vec<Level>, Vec<f64>), StudyError> {
    let mesh = |cells: usize| Discrete::new(setup, problem, n, cells);
    let finest = setup.cells[setup.cells.len() - 1];
    let dynamic = problem.kind == Kind::Dynamic;
    let levels: Result<Vec<Level>, StudyError> = match setup.refine {
        Refine::Mesh(power) => {
            let power = power.unwrap_or(0.5 * (setup.degrees[n] + 1) as f64);
            let coarsest = mesh(setup.cells[0])?;
            let critical = if dynamic { coarsest.critical_step() } else { 0.0 };
            let level = |&cells: &usize| {
                let mut mesh = mesh(cells)?;
                let step = setup.safety[0] * critical * (mesh.span_length() / coarsest.span_length()).powf(power);
                mesh.level(step)
            };
            setup.cells.iter().map(level).collect()
        }
        Refine::TimeStep => {
            let critical = mesh(finest)?.critical_step();
            let level = |&fraction: &f64| {
                let level = mesh(finest)?.level(fraction * critical)?;
                Ok(Level { h: fraction * critical, ..level })
            };
            setup.safety.iter().map(level).collect()
        }
    };
    Ok((levels?, mesh(finest)?.best_errors()?))
}

/// Order that theory gives an error `below` orders under that of the displacement.
fn theory(setup: &ConvergenceSetup, problem: &Problem, degree: usize, below: usize) -> f64 {
    let space = (degree + 1 - below) as f64;
    match (problem.kind, setup.refine) {
        (Kind::Dynamic, Refine::TimeStep) => 2.0,
        (Kind::Dynamic, Refine::Mesh(Some(power))) => space.min(2.0 * power),
        (Kind::Dynamic, _) if setup.mass == Mass::Lumped => space.min(2.0),
        _ => space,
    }
}

fn words_of_theory(setup: &ConvergenceSetup, problem: &Problem) -> String {
    match (problem.kind, setup.refine) {
        (Kind::Dynamic, Refine::TimeStep) => "velocity Verlet is of order 2",
        (Kind::Dynamic, _) if setup.mass == Mass::Lumped => "a lumped mass is of order 2 for every degree",
        _ => "best approximation by splines: p + 1 in L2, p in H1",
    }
    .into()
}

fn title(case: &Case, setup: &ConvergenceSetup) -> String {
    if case.label.is_empty() {
        format!("{}, {}", setup.problem, words_of_patch(setup.patch))
    } else {
        case.label.clone()
    }
}

fn words_of_patch(family: PatchFamily) -> &'static str {
    match family {
        PatchFamily::Square => "equal spans",
        PatchFamily::Graded => "graded spans",
        PatchFamily::Bent => "a curved polynomial patch",
        PatchFamily::Annulus => "a quarter annulus",
        PatchFamily::Weighted => "a curved patch with random weights",
        PatchFamily::Random => "random weights and knots",
    }
}

fn caption(setup: &ConvergenceSetup, problem: &Problem) -> String {
    let layout = match setup.layout {
        Layout::Gauss => "Gauss",
        Layout::Uniform => "uniform",
        Layout::Maclaurin => "Maclaurin",
    };
    let points: Vec<String> =
        (0..setup.degrees.len()).map(|n| format!("{0}x{0} for p = {1}", setup.points(n), setup.degrees[n])).collect();
    let loading = match setup.loading {
        Loading::Strong => "body force and traction",
        Loading::Weak => "loads through the code's own sums",
    };
    let mut words = format!("On {}; {layout} points, {}; {loading}", words_of_patch(setup.patch), points.join(", "));
    if problem.kind == Kind::Dynamic {
        let mass = if setup.mass == Mass::Lumped { "lumped" } else { "consistent" };
        words.push_str(&format!("; {mass} mass"));
    }
    words + ". Errors relative to the exact field."
}
