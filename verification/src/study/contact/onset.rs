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
        findings.measure(name, quantities, || approach(scene))?;
    }
    Ok(())
}

/// Gap at the first force of contact and gap at which a control point first has mass of both bodies, in
/// spans; largest change of the momentum of a body before that force, over its first momentum; force in the
/// end over momentum, 1/s.
fn approach(scene: &Scene) -> Result<[f64; 4], StudyError> {
    let [one, two] = scene.bodies.as_slice() else {
        return Err(other("this study needs two blocks"));
    };
    let (_, high) = one.shape.bounding_box();
    let (low, _) = two.shape.bounding_box();
    let (gap, closing) = (low[0] - high[0], one.velocity[0] - two.velocity[0]);
    let span = largest_spans(&scene.mesh)[0];
    let [mut touching, mut sharing, mut change, mut force] = [f64::NAN, f64::NAN, 0.0, f64::NAN];
    let mut first = vec![];
    run(scene, &mut |simulation| {
        let now = (gap - closing * simulation.time()) / span;
        let forces = simulation.contact_forces();
        let momenta: Vec<[f64; 2]> = simulation.momenta().into_iter().map(|(_, momentum)| momentum).collect();
        let size = |p: [f64; 2]| dot(p, p).sqrt();
        if first.is_empty() {
            first.clone_from(&momenta);
        }
        if touching.is_nan() {
            for (p, p0) in momenta.iter().zip(&first) {
                change = larger(change, size([p[0] - p0[0], p[1] - p0[1]]) / size(*p0));
            }
            if !forces.is_empty() {
                touching = now;
            }
        }
        if sharing.is_nan() && simulation.updated_frame().is_some_and(|frame| share_a_control_point(frame, span)) {
            sharing = now;
        }
        force = size(super::sum(&forces)) / size(first[0]);
    })?;
    Ok([touching, sharing, change, force])
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
