//! A compressive uniaxial step must not drive fracture: H stays zero.
//!
//! The column is held at its sides, so the only strain is compressive and psi+ vanishes identically.
//! Round-off leaves transverse strains of relative size 1e-16, whose energy is of relative size 1e-32.

use fisura::simulation::Simulation;

use super::{Case, CaseScene, Findings, StudyError, other};
use crate::extremes::{larger, largest};

pub(super) fn offers(_case: &Case, scenes: &[CaseScene]) -> super::Offered {
    let bare = &["largest history energy over mean elastic energy density"];
    Ok(super::Offers::of_scenes(scenes, &[], bare))
}

pub(super) fn study(_case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    for scene in scenes {
        let mut simulation = Simulation::new(&scene.scene)?;
        let mut most_elastic = 0.0_f64;
        while !simulation.finished() {
            crate::watch::check()?;
            most_elastic = larger(most_elastic, simulation.advance_to_next_sample()?.elastic);
        }
        let area: f64 = {
            let (low, high) = scene.scene.bodies[0].shape.bounding_box();
            (high[0] - low[0]) * (high[1] - low[1]) * scene.scene.analysis.thickness
        };
        let history = simulation
            .total_frame()
            .and_then(|f| f.fracture.as_ref())
            .map(|f| &f.history)
            .ok_or_else(|| other("nothing fractures here"))?;
        let most = largest(history.iter().flat_map(|lane| lane.0));
        findings.add(
            &scene.name,
            "largest history energy over mean elastic energy density",
            most * area / most_elastic,
            None,
        );
    }
    Ok(findings)
}
