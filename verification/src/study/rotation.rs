//! One revolution in a thousand increments, each applied exactly.
//!
//! The control points get the velocity `(R(θ) − I) x/dt` with θ = 2π/1000, which splines reproduce. What
//! strain is left is that of the kinematics alone: none for Hencky strain; linear strain gains `cos θ − 1` in
//! both directions per increment.

use std::f64::consts::TAU;

use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::scene::{Kinematics, Scene};

use super::{Case, CaseScene, Findings, StudyError, exact, other};
use crate::extremes::largest;

const INCREMENTS: usize = 1000;

pub(super) fn study(_case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for CaseScene { name, scene, .. } in scenes {
        let source = "no strain (Hencky); 1000 (cos θ − 1) in both directions (linear)";
        let quantities = [
            ("strain after a revolution, less the exact one", exact(0.0, source)),
            ("displacement after a revolution", exact(0.0, "none")),
        ];
        findings.measure(name, quantities, || revolution(scene))?;
    }
    Ok(())
}

/// Strain less the exact one, and displacement, after a revolution.
fn revolution(scene: &Scene) -> Result<[f64; 2], StudyError> {
    let (sine, cosine) = (TAU / INCREMENTS as f64).sin_cos();
    let broken = |_| other("a point left the mesh, or the phase field did not converge");
    let mut frame = UpdatedFrame::new(scene).map_err(broken)?;
    let turn = |[x, y]: [f64; 2]| [(cosine - 1.0) * x - sine * y, sine * x + (cosine - 1.0) * y];
    for _ in 0..INCREMENTS {
        crate::watch::check()?;
        frame.prescribe_motion(turn, 1.0).map_err(broken)?;
    }
    let left = match scene.analysis.kinematics {
        Kinematics::Finite => 0.0,
        Kinematics::Small => INCREMENTS as f64 * (cosine - 1.0),
    };
    let points = frame.fields[0].points.iter();
    let off = points.clone().flat_map(|p| [p.strain[0] - left, p.strain[1] - left, p.strain[2]]);
    Ok([largest(off.map(f64::abs)), largest(points.flat_map(|p| p.displacement).map(f64::abs))])
}
