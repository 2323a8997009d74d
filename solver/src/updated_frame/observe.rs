//! What is read from a body in the updated frame: energies, crack tip, pictures.

use super::UpdatedFrame;
use super::losses::TransferLosses;
use super::points::{FracturePoint, Point};
use crate::energy::{FractureSample, Sample};
use crate::fracture::BROKEN;
use crate::hencky::Gradient;
use crate::material::ElasticModuli;
use crate::patch::Patch;
use crate::picture::Raster;

use super::grid::NodalFields;
use super::points::Cells;

/// Side of the square a point fills in a picture, over the root of its volume. The points of a Gauss rule stand up to
/// 1.16 of that apart.
const FILL: f64 = 1.25;

impl UpdatedFrame {
    /// Energies, momenta and crack tip at the present whole step; `dt` is the step in use. Closure is left at zero.
    pub fn sample(&self, dt: f64) -> Sample {
        let (thickness, nodes) = (self.thickness, &self.nodes);
        let half = if self.at_start { 0.0 } else { 0.5 * dt };
        let greville = [0, 1].map(|d| self.patch.spaces[d].greville());
        let (mut kinetic, mut stagger, mut momentum, mut angular) = (0.0, 0.0, [0.0; 2], 0.0);
        for at in nodes.grid.indices() {
            let m = nodes.mass[at];
            let a = [0, 1].map(|c| nodes.acceleration[c][at]);
            let v = [0, 1].map(|c| nodes.velocity[c][at] + half * a[c]);
            kinetic += 0.5 * m * (v[0] * v[0] + v[1] * v[1]);
            stagger += 0.125 * dt * dt * m * (a[0] * a[0] + a[1] * a[1]);
            momentum = [momentum[0] + m * v[0], momentum[1] + m * v[1]];
            let (x, y) = (greville[0][nodes.grid.column_of(at)], greville[1][nodes.grid.row_of(at)]);
            angular += m * (x * v[1] - y * v[0]);
        }
        let fracture = self.fracture.as_ref().map(|f| FractureSample {
            energy: f.surface_energy * thickness,
            history_work: self.ledger.history_work * thickness,
            crack_tip: self.crack_tip(),
            min_phase: f.least_phase,
            iterations: f.iterations,
        });
        Sample {
            time: self.time,
            kinetic: kinetic * thickness,
            stagger: stagger * thickness,
            elastic: self.elastic_energy * thickness,
            fracture,
            external_work: self.ledger.external_work * thickness,
            transfer_loss: Some(self.ledger.transfer_loss * thickness),
            closure: 0.0,
            momentum: momentum.map(|p| p * thickness),
            angular_momentum: angular * thickness,
            time_step: dt,
        }
    }

    /// Point of largest x with c below [`BROKEN`] in the upper half of the body, moved along x to where c is [`BROKEN`]
    /// by the gradient of c, at most by the distance between points.
    pub fn crack_tip(&self) -> Option<[f64; 2]> {
        let fracture = self.fracture.as_ref()?;
        let broken = |(p, f): &(&Point, &FracturePoint)| f.phase < BROKEN && p.position[1] >= self.lowest_tip;
        let pairs = || self.points.iter().zip(&fracture.points).filter(broken);
        let (foremost, _) = pairs().max_by(|a, b| a.0.position[0].total_cmp(&b.0.position[0]))?;
        let spacing = foremost.volume.sqrt();
        let candidates = pairs().filter(|(p, _)| p.position[0] > foremost.position[0] - spacing);
        let tips = candidates.map(|(p, f)| {
            let c = self.patch.evaluate(fracture.field.control_values(), p.position).unwrap_or_default();
            let ahead = (BROKEN - f.phase) / c.gradient[0];
            let ahead = if ahead >= 0.0 { ahead.min(spacing) } else { 0.0 };
            [p.position[0] + ahead, p.position[1]]
        });
        tips.max_by(|a, b| a[0].total_cmp(&b[0]))
    }

    /// Paints the largest principal stress, a mean over the points weighted with volume, and the phase field where there
    /// is material. Each point fills a square, a quarter larger than its volume so that no gaps are left between them.
    pub fn paint(&self, raster: &Raster) -> (Option<Vec<f64>>, Vec<f64>) {
        let mut covered = vec![0.0; raster.pixels[0] * raster.pixels[1]];
        let mut stress = covered.clone();
        for point in &self.points {
            let half = 0.5 * FILL * point.volume.sqrt();
            let [xx, yy, xy] = point.stress;
            let principal = (0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy)) / self.volume_ratio(point);
            raster.for_each_overlap(point.position.map(|x| [x - half, x + half]), |pixel, area| {
                covered[pixel] += area;
                stress[pixel] += area * principal;
            });
        }
        let material = |pixel: usize| covered[pixel] >= 0.5 * raster.pixel[0] * raster.pixel[1];
        let phase = self.fracture.as_ref().map(|fracture| {
            let control = fracture.field.control_values();
            let at = |pixel| self.patch.evaluate(control, raster.center(pixel)).map_or(f64::NAN, |c| c.value);
            (0..covered.len()).map(|pixel| if material(pixel) { at(pixel) } else { f64::NAN }).collect()
        });
        let mean = |pixel| if material(pixel) { stress[pixel] / covered[pixel] } else { f64::NAN };
        (phase, (0..covered.len()).map(mean).collect())
    }

    /// Present volume over that at t = 0, which leads from the stress of a point to Cauchy's; 1 for small strains.
    fn volume_ratio(&self, point: &Point) -> f64 {
        let dilatation = point.strain[0] + point.strain[1];
        if self.deformation.is_some() { (self.thickening * dilatation).exp() } else { 1.0 }
    }

    /// Parts of the transfer loss so far, J.
    pub fn transfer_losses(&self) -> TransferLosses {
        let TransferLosses { kinetic, power, imposed } = self.losses;
        let t = self.thickness;
        TransferLosses { kinetic: kinetic * t, power: power * t, imposed: imposed * t }
    }

    /// Kinetic energy of the points as the scheme keeps it, `1/2 Σ m v_p(n − 1/2) · v_p(n + 1/2)` with FLIP or MUSL, J; at
    /// t = 0 that of the initial velocities. `dt` is the step in use.
    pub fn point_kinetic_energy(&self, dt: f64) -> f64 {
        let square = |p: &Point| p.volume * (p.velocity[0] * p.velocity[0] + p.velocity[1] * p.velocity[1]);
        let points = 0.5 * self.density * self.points.iter().map(square).sum::<f64>();
        let nodes = &self.nodes;
        // Σ m v_p · (S a)_p = w · M a with the velocity w that arrived.
        let kick = |c: usize| -> f64 {
            let product = |((m, w), a): ((&f64, &f64), &f64)| m * w * a;
            nodes.mass.iter().zip(&nodes.arrived[c]).zip(&nodes.acceleration[c]).map(product).sum()
        };
        let half = if self.at_start { 0.0 } else { 0.5 * dt };
        (points + half * (kick(0) + kick(1))) * self.thickness
    }

    /// Elastic energy, J.
    pub fn elastic_energy(&self) -> f64 {
        self.elastic_energy * self.thickness
    }

    /// External work so far, J.
    pub fn external_work(&self) -> f64 {
        self.ledger.external_work * self.thickness
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Material points, sorted by span.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Order of the points.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// Nodal fields at the present whole step.
    pub fn nodes(&self) -> &NodalFields {
        &self.nodes
    }

    /// Background patch.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// Moduli.
    pub fn moduli(&self) -> ElasticModuli {
        self.moduli
    }

    /// Heap memory of mechanics and of the phase field, bytes.
    pub fn bytes(&self) -> [usize; 2] {
        let points = self.points.len() * size_of::<Point>() + self.cells.bytes();
        let loads: usize = self.loads.iter().map(|load| load.bytes()).sum();
        let affine = self.affine.as_ref().map_or(0, |affine| affine.bytes());
        let deformation = self.deformation.as_ref().map_or(0, |gradients| gradients.len() * size_of::<Gradient>());
        let forcing = self.forcing.as_ref().map_or(0, |forcing| forcing.bytes());
        let points = points + affine + deformation + forcing;
        [points + self.nodes.bytes() + self.departure.bytes() + loads, self.fracture.as_ref().map_or(0, |f| f.bytes())]
    }
}
