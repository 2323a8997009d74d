//! Two blocks fly at each other: nothing may happen before the gap is closed, though their control points
//! share spans long before.

use std::collections::HashSet;

use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::particles::spans::largest_spans;
use fisura::scene::Scene;

use super::{dot, larger, run};
use crate::study::{Case, CaseScene, Findings, StudyError, exact, other};

pub(in super::super) fn study(_case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for CaseScene { name, scene, .. } in scenes {
        let quantities = [
            ("gap at the first force of contact, in spans", exact(0.0, "bodies touch where their boundaries do")),
            ("gap at which the supports of control points first overlap, in spans", None),
            ("change of momentum before it, over the momentum", exact(0.0, "no force before contact")),
            ("force of contact in the end over the momentum per second", None),
        ];
        findings.measure(name, quantities, || {
            let Onset { gap, sharing, momentum, force } = approach(scene)?;
            Ok([gap, sharing, momentum, force])
        })?;
    }
    Ok(())
}

/// What happened before the first force of contact.
struct Onset {
    /// Gap then, in spans.
    gap: f64,
    /// Gap at which a control point first has mass of both bodies, in spans.
    sharing: f64,
    /// Largest change of the momentum of a body before, over its first momentum.
    momentum: f64,
    /// Force in the end over momentum, 1/s.
    force: f64,
}

fn approach(scene: &Scene) -> Result<Onset, StudyError> {
    let [one, two] = scene.bodies.as_slice() else {
        return Err(other("this study needs two blocks"));
    };
    let (_, high) = one.shape.bounding_box();
    let (low, _) = two.shape.bounding_box();
    let (gap, closing) = (low[0] - high[0], one.velocity[0] - two.velocity[0]);
    let span = largest_spans(&scene.mesh)[0];
    let mut onset = Onset { gap: f64::NAN, sharing: f64::NAN, momentum: 0.0, force: f64::NAN };
    let mut first = vec![];
    run(scene, &mut |simulation| {
        let now = (gap - closing * simulation.time()) / span;
        let forces = simulation.contact_forces();
        let momenta: Vec<[f64; 2]> = simulation.momenta().into_iter().map(|(_, momentum)| momentum).collect();
        let size = |p: [f64; 2]| dot(p, p).sqrt();
        if first.is_empty() {
            first.clone_from(&momenta);
        }
        if onset.gap.is_nan() {
            for (p, p0) in momenta.iter().zip(&first) {
                onset.momentum = larger(onset.momentum, size([p[0] - p0[0], p[1] - p0[1]]) / size(*p0));
            }
            if !forces.is_empty() {
                onset.gap = now;
            }
        }
        if onset.sharing.is_nan() && simulation.updated_frame().is_some_and(|frame| share_a_control_point(frame, span))
        {
            onset.sharing = now;
        }
        onset.force = size(super::sum(&forces)) / size(first[0]);
    })?;
    Ok(onset)
}

/// Whether a control point of the patch has mass of two bodies.
fn share_a_control_point(frame: &UpdatedFrame, span: f64) -> bool {
    let places = |body: usize| {
        let nodes = &frame.fields[body].nodes;
        let massive = nodes.grid.indices().filter(|at| nodes.mass[*at] > 0.0);
        massive.map(|at| nodes.position(at).map(|x| (1e3 * x / span).round() as i64)).collect::<HashSet<_>>()
    };
    !places(0).is_disjoint(&places(1))
}
