//! What a run shows of the updated frame: points one by one, the spans they are in, pictures, and columns of
//! each body (centres, velocities, spins, forces between bodies). It also finds material that is distorted
//! too far for small strains.

use super::UpdatedFrame;
use super::begin::center_of_mass;
use super::field::DiscreteField;
use crate::dynamics::body_sample::{BodySample, BodySamples, PairForce, pairs};
use crate::dynamics::energy::Sample;
use crate::linear_algebra::extremes::smaller;
use crate::material::degradation::{BROKEN, largest_principal, stress_out_of_plane};
use crate::material::hencky::{Distortion, spectral_radius};
use crate::output::inspection::{PointFracture, PointState};
use crate::output::picture::Raster;
use crate::output::span_grid::{Corner, SpanGrid};
use crate::particles::points::Point;

/// Side of the square a point fills in a picture, over the root of its volume. The points of a Gauss rule
/// stand up to 1.16 of that apart.
const FILL: f64 = 1.25;

impl UpdatedFrame {
    /// Calls `f` with the state of every point.
    pub(crate) fn for_each_point_state(&self, f: &mut dyn FnMut(PointState)) {
        for (field, body) in self.fields.iter().zip(self.bodies.iter().copied()) {
            for (point, carried) in field.points.iter().enumerate() {
                let cracked = field.fracture.as_ref().map(|fracture| (&fracture.model, fracture.points[point]));
                let fracture = cracked.map(|(_, c)| PointFracture { history: c.history, phase: c.phase });
                let Point { position, velocity, displacement, strain, stress, .. } = *carried;
                let degraded = cracked.map(|(model, c)| (model, c.phase));
                let stress_out_of_plane = stress_out_of_plane(&field.moduli, strain, degraded);
                f(PointState {
                    body,
                    point,
                    area: carried.volume,
                    position,
                    present: position,
                    displacement,
                    velocity,
                    strain,
                    stress,
                    stress_out_of_plane,
                    fracture,
                });
            }
        }
    }

    /// The spans with points of each body, with the nodal fields of that body.
    pub(crate) fn span_grid(&self) -> SpanGrid {
        let mut grid = SpanGrid::default();
        for (field, body) in self.fields.iter().zip(self.bodies.iter().copied()) {
            let spans = field.cells.cells.iter().map(|cell| cell.span);
            let velocity = &field.nodes.velocity;
            grid.add(&field.patch, spans, |functions| Corner {
                body,
                position: functions.position,
                velocity: velocity.each_ref().map(|v| functions.interpolate(v).value),
                phase: field.fracture.as_ref().map(|f| functions.interpolate(f.field.control_values()).value),
            });
        }
        grid
    }

    /// Phase field, if there is one, and largest principal stress (Pa) on a raster; NaN where there is no
    /// material.
    ///
    /// Each point fills a square, a quarter larger than its volume so that no gaps are left between them.
    /// The stress is a mean over the points weighted with volume, and the phase field that of the body
    /// with the most of a pixel.
    pub(crate) fn paint(&self, raster: &Raster) -> (Option<Vec<f64>>, Vec<f64>) {
        let count = raster.pixels[0] * raster.pixels[1];
        let (mut covered, mut stress, mut most) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        let mut phase = vec![f64::NAN; count];
        for field in &self.fields {
            let [own, weighted] = field.cover(raster);
            for pixel in (0..count).filter(|&pixel| own[pixel] > 0.0) {
                covered[pixel] += own[pixel];
                stress[pixel] += weighted[pixel];
                if own[pixel] > most[pixel] {
                    most[pixel] = own[pixel];
                    phase[pixel] = field.phase_at(raster.center(pixel));
                }
            }
        }
        let empty = |pixel: usize| covered[pixel] < 0.5 * raster.pixel[0] * raster.pixel[1];
        for pixel in 0..count {
            stress[pixel] /= covered[pixel];
            if empty(pixel) {
                (stress[pixel], phase[pixel]) = (f64::NAN, f64::NAN);
            }
        }
        (self.fields.iter().any(|field| field.fracture.is_some()).then_some(phase), stress)
    }

    /// Whether the transfers keep the spin of bodies.
    pub(crate) fn keeps_spin(&self) -> bool {
        self.fields.iter().all(|field| field.affine.is_some())
    }

    /// Where material that is not broken is distorted most (m) and how, if that is beyond a limit; `None`
    /// with finite strains.
    pub(crate) fn distorted_beyond(&self, limit: f64) -> Option<([f64; 2], Distortion)> {
        let fields = self.fields.iter().filter(|field| field.deformation.is_none());
        let distorted = fields.flat_map(|field| [field.most_turned(), field.most_strained()]).flatten();
        distorted.filter(|(_, found)| found.size() > limit).max_by(|a, b| a.1.size().total_cmp(&b.1.size()))
    }

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

impl DiscreteField {
    /// Area of the body in each pixel, m², and the largest principal stress times area.
    fn cover(&self, raster: &Raster) -> [Vec<f64>; 2] {
        let mut covered = vec![0.0; raster.pixels[0] * raster.pixels[1]];
        let mut stress = covered.clone();
        for point in &self.points {
            let half = 0.5 * FILL * point.volume.sqrt();
            let principal = largest_principal(point.stress) / self.volume_ratio(point.strain);
            raster.for_each_overlap(point.position.map(|x| [x - half, x + half]), |pixel, area| {
                covered[pixel] += area;
                stress[pixel] += area * principal;
            });
        }
        [covered, stress]
    }

    /// Phase field at a position, m: 1 if the body does not fracture.
    fn phase_at(&self, position: [f64; 2]) -> f64 {
        let Some(fracture) = &self.fracture else { return 1.0 };
        self.patch.evaluate(fracture.field.control_values(), position).map_or(f64::NAN, |c| c.value)
    }

    /// Present volume over that at t = 0, which leads from the stress of a point to Cauchy's; 1 for small
    /// strains.
    fn volume_ratio(&self, strain: [f64; 3]) -> f64 {
        let dilatation = strain[0] + strain[1];
        if self.deformation.is_some() { (self.thickening * dilatation).exp() } else { 1.0 }
    }

    /// The span whose points have turned most around each other (m), and their angle. One point alone does
    /// not turn.
    fn most_turned(&self) -> Option<([f64; 2], Distortion)> {
        let broken = |at: usize| self.fracture.as_ref().is_some_and(|fracture| fracture.points[at].phase < BROKEN);
        let several = self.cells.cells.iter().filter(|cell| cell.points.len() > 1);
        let intact = several.filter(|cell| !cell.points.clone().any(broken));
        let turned = intact.map(|cell| turned(&self.points[cell.points.clone()]));
        let (place, angle) = turned.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((place, Distortion::Turned(angle)))
    }

    /// The point with the largest principal strain (m) of a body that cannot break.
    fn most_strained(&self) -> Option<([f64; 2], Distortion)> {
        let points = self.points.iter().filter(|_| self.fracture.is_none());
        let strained = points.map(|point| (point.position, spectral_radius(point.strain)));
        let (place, strain) = strained.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((place, Distortion::Strained(strain)))
    }
}

/// Centre of some points (m) and the magnitude of the rotation (rad) that comes closest to their motion
/// around it, in the least squares weighted with volume.
fn turned(points: &[Point]) -> ([f64; 2], f64) {
    let volume: f64 = points.iter().map(|point| point.volume).sum();
    let mean = |value: fn(&Point) -> [f64; 2]| {
        let sum = |d: usize| points.iter().map(|point| point.volume * value(point)[d]).sum::<f64>();
        [0, 1].map(|d| sum(d) / volume)
    };
    let [center, before] = [mean(|point| point.position), mean(Point::reference)];
    let (mut sine, mut cosine) = (0.0, 0.0);
    for point in points {
        let reference = point.reference();
        let [x, y] = [0, 1].map(|d| point.position[d] - center[d]);
        let [from_x, from_y] = [0, 1].map(|d| reference[d] - before[d]);
        sine += point.volume * (from_x * y - from_y * x);
        cosine += point.volume * (from_x * x + from_y * y);
    }
    (center, sine.atan2(cosine).abs())
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
