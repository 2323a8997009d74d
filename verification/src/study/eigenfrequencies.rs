//! Lowest frequencies of a bar held at both ends, from the solver's own operators, against `n π c/L`.
//!
//! The bar is a strip of unit length, one linear span high, between rollers above and below, with Poisson's
//! ratio zero: what does not vary over its height is one-dimensional, and shear modes lie far above. The
//! generalised eigenproblem is solved densely. With the consistent mass frequencies are too high, by order 2
//! p; with the lumped one too low, by order 2.

use fisura::dynamics::total_frame::TotalFrame;
use fisura::scene::{Mass, Mesh, Scene};

use super::{Case, CaseScene, Findings, StudyError, other};
use crate::scene::plain::PlainScene;
use crate::study::dense;
use crate::study::orders::{Convergence, Curve, Level, Norm, Refined};

/// Spans along the bar.
const MESHES: [usize; 4] = [8, 16, 32, 64];
const MODES: usize = 3;
/// Height over length: the lowest shear mode has the frequency 44 c/L, the third mode of the bar 9.4 c/L.
const HEIGHT: f64 = 0.05;
/// Relative errors at or below this are round-off: the spectrum spans four decades and the eigenvalues are
/// squares.
const FLOOR: f64 = 5e-12;

pub(super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let mut curves = Vec::new();
    for mass in [Mass::Consistent, Mass::Lumped] {
        for degree in 1..=3 {
            let words = if mass == Mass::Consistent { "consistent" } else { "lumped" };
            let name = format!("{words}, p={degree}");
            let mut levels = Vec::new();
            let mut finest = None;
            for spans in MESHES {
                let Some((errors, unknowns)) = findings.compute(|| relative_errors(mass, degree, spans))? else {
                    break;
                };
                let sizes = errors.iter().map(|e| e.abs()).collect();
                levels.push(Level { h: 1.0 / spans as f64, unknowns, seconds: 0.0, errors: sizes });
                finest = Some(errors);
            }
            let spans = MESHES[MESHES.len() - 1];
            for mode in 1..=MODES {
                let quantity = format!("relative frequency error of mode {mode} on {spans} spans");
                findings.add(&name, &quantity, finest.as_ref().map(|errors| errors[mode - 1]), None);
            }
            let order = if mass == Mass::Consistent { 2.0 * degree as f64 } else { 2.0 };
            curves.push(Curve { name, levels, orders: vec![Some(order); MODES] });
        }
    }
    let norm = |mode| Norm { quantity: format!("frequency error of mode {mode}"), unit: "1".into(), floor: FLOOR };
    let study = Convergence {
        title: "Frequencies of a bar held at both ends".into(),
        caption: "A strip one span high between rollers, Poisson's ratio zero; relative errors.".into(),
        theory: "eigenvalues converge twice as fast as functions in H1: 2 p; row sums leave order 2".into(),
        refined: Refined::Mesh { dimensions: 1 },
        norms: (1..=MODES).map(norm).collect(),
        curves,
        ..Convergence::of(case)
    };
    study.add_to(findings);
    Ok(())
}

/// Relative errors, with sign, of the lowest frequencies, and the number of unknowns.
fn relative_errors(mass: Mass, degree: usize, spans: usize) -> Result<(Vec<f64>, usize), StudyError> {
    let scene = bar(mass, degree, spans);
    fisura::validate::validate(&scene).map_err(|errors| other(errors[0].to_string()))?;
    let frame = TotalFrame::new(&scene).map_err(|_| other("there is no phase field"))?;
    let found = dense::frequencies(&frame)?;
    let exact = |mode: usize| mode as f64 * std::f64::consts::PI; // unit modulus, density and length
    let error = |(i, frequency): (usize, &f64)| frequency / exact(i + 1) - 1.0;
    Ok((found.iter().take(MODES).enumerate().map(error).collect(), found.len()))
}

/// The strip, all of unit modulus, density and length.
fn bar(mass: Mass, degree: usize, spans: usize) -> Scene {
    let mesh = Mesh::uniform([degree, 1], [0.0; 2], [1.0, HEIGHT], [spans, 1]);
    let mut scene = PlainScene::unit_bar(mesh, mass).scene();
    scene.bodies[0].particles_per_cell[1] = 2; // linear over the height
    scene
}
