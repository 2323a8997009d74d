//! Convergence to an exact solution: the `[convergence]` table of a case says which, on which meshes, and
//! how.
//!
//! A dynamic problem is run with steps in proportion to `h^((p + 1)/2)`, so that the second order in time
//! shows as p + 1, unless the case gives another power. Errors are relative. In the total frame they are
//! integrated with an independent, finer quadrature, in the updated frame they are those of the points.

pub(crate) mod errors;
mod meshes;
pub(crate) mod moving;
mod problem;
mod scene;
mod solve;

use fisura::scene::{Frame, Layout, Mass, Transfer};

use super::{Case, CaseScene, Findings, StudyError, other};
use crate::case::convergence::{ConvergenceSetup, Loading, PatchFamily, Refine};
use crate::exact::Equation;
use crate::study::orders::{Convergence, Curve, Level, Norm, Refined};
pub(crate) use meshes::{CurveKey, Meshes};
use problem::Problem;
use solve::Discrete;

/// Relative errors at or below this are round-off.
const FLOOR: f64 = 1e-11;

/// A problem on one mesh.
trait OnMesh {
    /// Solves and measures; a dynamic problem with steps of at most `step` (s).
    fn level(self: Box<Self>, step: f64) -> Result<Level, StudyError>;
    /// Errors of the best approximation of the exact fields in the end, in the order of those of a level;
    /// none where errors are those of points that move.
    fn best_errors(&self) -> Result<Vec<f64>, StudyError>;
    /// Critical time step, s.
    fn critical_step(&self) -> f64;
    /// Side of a square as large as the mean span, m.
    fn span_length(&self) -> f64;
}

/// Norms in words, and how many orders an error in them stands below that of the displacement.
type Norms = Vec<(&'static str, usize)>;

/// What the case solves, and the norms of its errors.
fn problem_of(case: &Case) -> Result<(&ConvergenceSetup, Problem, Norms), StudyError> {
    let setup = case.convergence.as_ref().ok_or_else(|| other("a [convergence] table is missing"))?;
    let problem = problem::find(setup).map_err(StudyError::Other)?;
    let norms = match setup.frame {
        Frame::Total => Discrete::norms(&problem, setup.patch),
        Frame::Updated => moving::NORMS.to_vec(),
    };
    Ok((setup, problem, norms))
}

fn refined(setup: &ConvergenceSetup) -> Refined {
    match setup.refine {
        Refine::Mesh(_) => Refined::Mesh { dimensions: 2 },
        Refine::TimeStep => Refined::TimeStep,
    }
}

pub(super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let (setup, problem, norms) = problem_of(case)?;
    let mut curves = Vec::new();
    for (n, &degree) in setup.degrees.iter().enumerate() {
        for variant in variants(setup) {
            let orders = norms.iter().map(|&(_, below)| theory(setup, &problem, degree, below)).collect();
            let name = curve_name(setup, n, variant);
            let meshes = Meshes { setup, problem: &problem };
            let found = findings.compute(|| meshes.levels(CurveKey { n, variant }))?;
            for (index, (norm, _)) in norms.iter().enumerate().filter(|_| setup.frame == Frame::Total) {
                let over_best = found
                    .as_ref()
                    .map(|(levels, best)| levels.last().map_or(f64::NAN, |level| level.errors[index]) / best[index]);
                findings.add(&name, &format!("{norm} over that of the L2 projection"), over_best, None);
            }
            curves.push(Curve { name, levels: found.unwrap_or_default().0, orders });
        }
    }
    let norm = |&(quantity, _): &(&str, usize)| Norm { quantity: quantity.into(), unit: "1".into(), floor: FLOOR };
    let named = format!("{}, {}", setup.problem, words_of_patch(setup.patch));
    let study = Convergence {
        title: if case.label.is_empty() { named } else { case.label.clone() },
        caption: caption(setup, &problem),
        theory: words_of_theory(setup, &problem),
        refined: refined(setup),
        norms: norms.iter().map(norm).collect(),
        curves,
        ..Convergence::of(case)
    };
    study.add_to(findings);
    Ok(())
}

/// What distinguishes the curves of one degree.
#[derive(Debug, Clone, Copy)]
struct Variant {
    transfer: Transfer,
    /// Offset of the mesh, in spans.
    offset: f64,
}

impl Variant {
    /// In the total frame there is one.
    const PLAIN: Self = Self { transfer: Transfer::Apic, offset: 0.0 };
}

/// Name of a curve: the degree, with points, transfer or offset where these vary.
fn curve_name(setup: &ConvergenceSetup, n: usize, Variant { transfer, offset }: Variant) -> String {
    let degree = setup.degrees[n];
    let mut name = format!("p={degree}");
    if setup.degrees.iter().filter(|d| **d == degree).count() > 1 {
        name += &format!(" {0}x{0}", setup.points(n));
    }
    if setup.transfers.len() > 1 {
        name += &match transfer {
            Transfer::Xpic(order) => format!(" xpic({order})"),
            named => format!(" {named:?}").to_lowercase(),
        };
    }
    if setup.offsets.len() > 1 {
        name += &format!(" offset {offset}");
    }
    name
}

/// The curves of a degree.
fn variants(setup: &ConvergenceSetup) -> Vec<Variant> {
    let mut variants = Vec::new();
    for &transfer in &setup.transfers {
        variants.extend(setup.offsets.iter().map(|&offset| Variant { transfer, offset }));
    }
    variants
}

/// Order that theory gives an error `below` orders under that of the displacement. There is none for moving
/// points: the error of their quadrature does not fall with h.
fn theory(setup: &ConvergenceSetup, problem: &Problem, degree: usize, below: usize) -> Option<f64> {
    let space = (degree + 1 - below) as f64;
    match (problem.equation, setup.refine) {
        _ if setup.frame == Frame::Updated => None,
        (Equation::Dynamic, Refine::TimeStep) => Some(2.0),
        (Equation::Dynamic, Refine::Mesh(power)) => {
            let space = if setup.mass == Mass::Lumped { space.min(2.0) } else { space };
            Some(power.map_or(space, |power| space.min(2.0 * power)))
        }
        _ => Some(space),
    }
}

fn words_of_theory(setup: &ConvergenceSetup, problem: &Problem) -> String {
    match (problem.equation, setup.refine) {
        (Equation::Dynamic, Refine::TimeStep) => "velocity Verlet is of order 2",
        (Equation::Dynamic, _) if setup.mass == Mass::Lumped => "a lumped mass is of order 2 for every degree",
        _ => "best approximation by splines: p + 1 in L2, p in H1",
    }
    .into()
}

fn words_of_patch(family: PatchFamily) -> &'static str {
    match family {
        PatchFamily::Square => "equal spans",
        PatchFamily::Graded => "graded spans",
        PatchFamily::Bent => "a curved polynomial patch",
        PatchFamily::Annulus => "a quarter annulus",
        PatchFamily::Weighted => "a curved patch with random weights",
        PatchFamily::Random => "random weights and knots",
        PatchFamily::Strip => "a strip",
        PatchFamily::UnitSquare => "the unit square",
        PatchFamily::Block => "a block that cuts a rectangle",
        PatchFamily::Ring => "a ring cut out of a square",
        PatchFamily::Holed => "a square with a hole that cuts spans",
        PatchFamily::Disc => "a disc cut out of a square",
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
    if problem.equation == Equation::Dynamic {
        words.push_str(if setup.mass == Mass::Lumped { "; lumped mass" } else { "; consistent mass" });
    }
    if setup.frame == Frame::Updated {
        words.push_str("; updated frame, the points cross spans");
    }
    words + ". Errors relative to the exact field."
}
