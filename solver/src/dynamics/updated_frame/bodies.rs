//! Bodies recorded one by one: centres, velocities, spins and the forces between them.

use super::UpdatedFrame;
use super::begin::center_of_mass;
use super::field::DiscreteField;
use crate::contact::gap_potential::GapForce;
use crate::dynamics::body_sample::{BodySample, BodySamples, PairForce, pairs};
use crate::dynamics::energy::Sample;
use crate::linear_algebra::extremes::smaller;

impl UpdatedFrame {
    /// The bodies of these names; `samples` are theirs, a metre thick, and `dt` is the step in use.
    pub(super) fn sample_bodies(&self, names: &[String], samples: &[Sample], dt: f64) -> BodySamples {
        let bodies = self.fields.iter().zip(samples).zip(names);
        let bodies = bodies.map(|((field, sample), name)| field.sample_body(name, sample)).collect();
        if !self.has_contact() {
            return BodySamples { bodies, ..BodySamples::default() };
        }
        let forces = self.contact_forces(dt);
        let force = |pair: [usize; 2]| {
            let acting = forces.iter().filter(|force| force.bodies == pair);
            let sum = acting.fold([0.0; 2], |[x, y], f| [x + f.force[0], y + f.force[1]]);
            PairForce { names: pair.map(|i| names[i].clone()), force: sum.map(|f| f * self.thickness) }
        };
        let constraints = self.contact.iter().flat_map(|contact| contact.constraints().iter().map(|c| c.gap));
        let depths = self.gap_potential.iter().flat_map(|potential| potential.forces().iter().map(GapForce::gap));
        let gaps = constraints.chain(depths);
        let smallest_gap = Some(gaps.reduce(smaller).unwrap_or(f64::NAN));
        BodySamples { bodies, forces: pairs(self.fields.len(), names.len()).map(force).collect(), smallest_gap }
    }
}

impl DiscreteField {
    /// The body as `sample`, that of a body a metre thick, has it; its spin is that of the points about the
    /// centre of mass, `Σ m r × v/Σ m r²`, with their velocities half a step back.
    fn sample_body(&self, name: &str, sample: &Sample) -> BodySample {
        let (mass, center) = (self.mass(), center_of_mass(&self.points));
        let mean = self.momentum().map(|p| p / mass);
        let parts = self.points.iter().map(|point| {
            let [x, y] = [0, 1].map(|d| point.position[d] - center[d]);
            let [u, v] = [0, 1].map(|d| point.velocity[d] - mean[d]);
            [point.volume * (x * v - y * u), point.volume * (x * x + y * y)]
        });
        let [moment, inertia] = parts.fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
        BodySample {
            name: name.to_string(),
            mass,
            center,
            velocity: sample.momentum.map(|p| p * self.thickness / mass),
            spin: moment / inertia,
            kinetic: sample.kinetic * self.thickness,
        }
    }
}
