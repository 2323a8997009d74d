//! Poisson's ratio towards 1/2 in plane strain: locking, and the step that goes with the bulk modulus.
//!
//! The lowest frequency of a square held at its bottom (shear and bending, hardly any change of volume) on 8
//! × 8 spans is held against that of quartics on 12 × 12. Where a space cannot deform without changing its
//! volume the frequency rises with the bulk modulus, as `1/(1 − 2 nu)` in its square: it locks. A run at nu =
//! 0.4999 is held to its ledger.

use fisura::scene::{Boundary, Mesh, Scene, Side};

use super::{logarithmic, total_frame, with_step};
use crate::extremes::largest;
use crate::output::history::Table;
use crate::record::{CurveStyle, Reference, ReferenceKind};
use crate::scene::plain::PlainScene;
use crate::study::charts::curve;
use crate::study::dense;
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, exact, samples};

const RATIOS: [f64; 4] = [0.3, 0.49, 0.499, 0.4999];
const SPANS: usize = 8;
/// Degree and spans of the reference.
const FINE: (usize, usize) = (4, 12);
const STEPS: usize = 2000;

pub(in super::super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let stem = series_stem(case, "locking");
    let mut table = Table::new(&["one_less_twice_nu", "p1", "p2", "p3"]);
    for nu in RATIOS {
        let fine = findings.compute(|| lowest_frequency(&square(FINE.0, FINE.1, nu)))?;
        let mut row = vec![1.0 - 2.0 * nu];
        for degree in 1..=3 {
            let found = findings.compute(|| lowest_frequency(&square(degree, SPANS, nu)))?;
            let error = found.zip(fine).map(|(found, fine)| found / fine - 1.0);
            let source = "quartics on 12 × 12 spans".to_string();
            let reference = Reference::new(Some(0.0), ReferenceKind::SelfConvergence, source);
            let quantity = "lowest frequency, relative error";
            findings.add(&format!("p={degree}, nu={nu}"), quantity, error, Some(reference));
            row.push(error.map_or(f64::NAN, f64::abs));
        }
        table.push(&row);
    }
    for degree in 1..=3 {
        let quantities = [
            ("critical step over that of the dense eigenvalue", exact(1.0, "2/ω")),
            ("closure of the ledger over the energy", None),
        ];
        findings.measure(&format!("p={degree}, nu={}", RATIOS[3]), quantities, || {
            let scene = square(degree, SPANS, RATIOS[3]);
            let frame = total_frame(&scene)?;
            let highest = dense::highest(&dense::frequencies(&frame)?);
            let step = frame.critical_step();
            Ok([step * highest / 2.0, closure(scene, 0.9 * step)?])
        })?;
    }
    let name = |degree: usize| format!("p{degree}");
    let curves =
        (1..=3).map(|p| curve(&format!("p = {p}"), &stem, ["one_less_twice_nu", &name(p)], CurveStyle::Markers));
    let caption = "A square of 8 × 8 spans held at its bottom, plane strain, lumped mass.";
    let axes = ["1 − 2 nu", "relative error of the lowest frequency"];
    let title = "Error towards an incompressible material";
    findings.figures.push(logarithmic(case, "locking", title, caption, axes, curves.collect()));
    findings.series.push((stem, table));
    Ok(())
}

/// A unit square of unit modulus and density held at its bottom.
fn square(degree: usize, spans: usize, nu: f64) -> Scene {
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [1.0; 2], [spans; 2]);
    let mut scene = PlainScene::unit(mesh, nu).scene();
    scene.boundaries = vec![Boundary::fixed(Side::Bottom, [true; 2])];
    scene
}

fn lowest_frequency(scene: &Scene) -> Result<f64, StudyError> {
    Ok(dense::frequencies(&total_frame(scene)?)?[0])
}

/// Largest closure over the energy at t = 0 of a run of steps of `dt` (s).
fn closure(mut scene: Scene, dt: f64) -> Result<f64, StudyError> {
    scene.bodies[0].velocity = [1e-3, 3e-4];
    let samples = samples(&mut with_step(&scene, dt, STEPS)?)?;
    Ok(largest(samples[1..].iter().map(|sample| sample.closure.abs())) / samples[0].stored())
}
