//! How far material is distorted, which small strains do not follow.

use super::UpdatedFrame;
use super::field::DiscreteField;
use crate::material::degradation::BROKEN;
use crate::material::hencky::{Distortion, largest_principal};
use crate::particles::points::Point;

impl UpdatedFrame {
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
}

impl DiscreteField {
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
        let strained = points.map(|point| (point.position, largest_principal(point.strain)));
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
