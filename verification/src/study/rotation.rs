//! One revolution in a thousand increments, each applied exactly.
//!
//! The control points get the velocity `(R(θ) − I) x/dt` with θ = 2π/1000, which splines reproduce. What
//! strain is left is that of the kinematics alone: none for Hencky strain; linear strain gains `cos θ − 1` in
//! both directions per increment.

use std::f64::consts::TAU;

use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::scene::Kinematics;

use super::{Case, CaseScene, Findings, StudyError, exact, other};
use crate::extremes::largest;

const INCREMENTS: usize = 1000;

pub(super) fn offers(_case: &Case, scenes: &[CaseScene]) -> super::Offered {
    let held = &["strain after a revolution, less the exact one", "displacement after a revolution"];
    Ok(super::Offers::of_scenes(scenes, held, &[]))
}

pub(super) fn study(_case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let (sine, cosine) = (TAU / INCREMENTS as f64).sin_cos();
    for CaseScene { name, scene, .. } in scenes {
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
        let off = frame.fields()[0].points().iter().flat_map(|p| [p.strain[0] - left, p.strain[1] - left, p.strain[2]]);
        let back = frame.fields()[0].points().iter().flat_map(|p| p.displacement);
        let source = exact(0.0, "no strain (Hencky); 1000 (cos θ − 1) in both directions (linear)");
        findings.add(name, "strain after a revolution, less the exact one", largest(off.map(f64::abs)), source);
        findings.add(name, "displacement after a revolution", largest(back.map(f64::abs)), exact(0.0, "none"));
    }
    Ok(findings)
}
