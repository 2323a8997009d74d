//! A compressive uniaxial step must not drive fracture: H stays zero.
//!
//! The column is held at its sides, so the only strain is compressive and psi+ vanishes identically.
//! Round-off leaves transverse strains of relative size 1e-16, whose energy is of relative size 1e-32.

use fisura::scene::Scene;
use fisura::simulation::Simulation;

use super::{Case, CaseScene, Findings, StudyError, other, samples};
use crate::extremes::largest;

pub(super) fn study(_case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for scene in scenes {
        let quantity = "largest history energy over mean elastic energy density";
        findings.measure(&scene.name, [(quantity, None)], || ratio(&scene.scene).map(|ratio| [ratio]))?;
    }
    Ok(())
}

fn ratio(scene: &Scene) -> Result<f64, StudyError> {
    let mut simulation = Simulation::new(scene)?;
    let most_elastic = largest(samples(&mut simulation)?[1..].iter().map(|sample| sample.elastic));
    let (low, high) = scene.bodies[0].shape.bounding_box();
    let area = (high[0] - low[0]) * (high[1] - low[1]) * scene.analysis.thickness;
    let fracture = simulation.total_frame().and_then(|frame| frame.fracture.as_ref());
    let history = &fracture.ok_or_else(|| other("nothing fractures here"))?.history;
    Ok(largest(history.iter().flat_map(|lane| lane.0)) * area / most_elastic)
}
