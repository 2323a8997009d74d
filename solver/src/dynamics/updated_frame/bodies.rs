//! Bodies recorded one by one: centres, velocities, spins and the forces between them.

use super::UpdatedFrame;
use super::begin::center_of_mass;
use super::field::DiscreteField;
use crate::dynamics::body_sample::{BodySample, BodySamples, PairForce, pairs};
use crate::dynamics::energy::Sample;
use crate::linear_algebra::extremes::smaller;

impl UpdatedFrame {
    /// Kinetic energy (J) of the motion of all bodies as one rigid body with the momentum (kg m/s) and the
    /// angular momentum about the origin (kg m²/s) of a sample.
    pub(crate) fn rigid_energy(&self, sample: &Sample) -> f64 {
        let ([x, y], mean, spin) = rigid_motion(&self.fields.iter().collect::<Vec<_>>());
        let [px, py] = sample.momentum;
        let about_center = sample.angular_momentum - (x * py - y * px);
        0.5 * (mean[0] * px + mean[1] * py + spin * about_center)
    }

    /// The bodies of these names; `samples` are those of the fields, a metre thick, and `dt` is the step in
    /// use.
    pub(super) fn sample_bodies(&self, names: &[String], samples: &[Sample], dt: f64) -> BodySamples {
        let deformable = (0..self.fields.len()).map(|field| self.bodies[field] + 1).max().unwrap_or_default();
        let body = |body: usize| {
            let of_body = self.fields.iter().zip(samples).enumerate().filter(|(at, _)| self.bodies[*at] == body);
            let (fields, samples): (Vec<_>, Vec<_>) = of_body.map(|(_, pair)| pair).unzip();
            sample_body(&names[body], &fields, &samples, self.thickness)
        };
        let bodies = (0..deformable).map(body).collect();
        if self.contact.is_none() {
            return BodySamples { bodies, ..BodySamples::default() };
        }
        // Rigid bodies are counted after the fields there, after the other bodies in the names.
        let named = |at: usize| if at < samples.len() { self.bodies[at] } else { at - samples.len() + deformable };
        let forces = self.contact_forces(dt);
        let force = |pair: [usize; 2]| {
            let sum = forces.iter().fold([0.0; 2], |sum, force| {
                let sign = match force.bodies.map(named) {
                    bodies if bodies == pair => 1.0,
                    [b, a] if [a, b] == pair => -1.0,
                    _ => return sum,
                };
                [0, 1].map(|d| sum[d] + sign * force.force[d])
            });
            PairForce { names: pair.map(|i| names[i].clone()), force: sum.map(|f| f * self.thickness) }
        };
        let gaps = self.contact.iter().flat_map(|contact| contact.constraints.iter().map(|c| c.gap));
        let smallest_gap = Some(gaps.reduce(smaller).unwrap_or(f64::NAN));
        BodySamples { bodies, forces: pairs(deformable, names.len()).map(force).collect(), smallest_gap }
    }
}

/// Motion of fields as one rigid body: centre of mass (m), its velocity (m/s), and the spin of the points
/// about it, `Σ m r × v/Σ m r²` with their velocities half a step back, rad/s.
fn rigid_motion(fields: &[&DiscreteField]) -> ([f64; 2], [f64; 2], f64) {
    let center = center_of_mass(fields.iter().flat_map(|field| &field.points));
    let mass: f64 = fields.iter().map(|field| field.mass()).sum();
    let mean = [0, 1].map(|d| fields.iter().map(|field| field.momentum()[d]).sum::<f64>() / mass);
    let points = fields.iter().flat_map(|field| field.points.iter().map(|point| (field.density * point.volume, point)));
    let [moment, inertia] = points.fold([0.0; 2], |[moment, inertia], (mass, point)| {
        let [x, y] = [0, 1].map(|d| point.position[d] - center[d]);
        let [u, v] = [0, 1].map(|d| point.velocity[d] - mean[d]);
        [moment + mass * (x * v - y * u), inertia + mass * (x * x + y * y)]
    });
    (center, mean, moment / inertia)
}

/// A body as the fields of its fragments and their samples have it, those of bodies a metre thick.
fn sample_body(name: &str, fields: &[&DiscreteField], samples: &[&Sample], thickness: f64) -> BodySample {
    let mass: f64 = fields.iter().map(|field| field.mass()).sum();
    let (center, _, spin) = rigid_motion(fields);
    BodySample {
        name: name.to_string(),
        mass,
        center,
        velocity: [0, 1].map(|d| samples.iter().map(|sample| sample.momentum[d]).sum::<f64>() * thickness / mass),
        spin,
        kinetic: samples.iter().map(|sample| sample.kinetic).sum::<f64>() * thickness,
    }
}
