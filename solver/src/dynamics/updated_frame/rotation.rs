//! How far material has turned, which small strains do not follow.

use super::UpdatedFrame;
use super::field::DiscreteField;
use crate::material::degradation::BROKEN;
use crate::particles::points::Point;

impl UpdatedFrame {
    /// Where material that is not broken has turned most (m) and by which angle, if that is beyond a limit,
    /// rad; `None` with finite strains.
    pub(crate) fn turned_beyond(&self, limit: f64) -> Option<([f64; 2], f64)> {
        let turned = self.fields.iter().filter_map(DiscreteField::most_turned);
        turned.filter(|(_, angle)| *angle > limit).max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

impl DiscreteField {
    /// The span whose points have turned most around each other (m), and their angle, rad. One point alone
    /// does not turn.
    fn most_turned(&self) -> Option<([f64; 2], f64)> {
        if self.deformation.is_some() {
            return None;
        }
        let broken = |at: usize| self.fracture.as_ref().is_some_and(|fracture| fracture.points[at].phase < BROKEN);
        let several = self.cells.cells.iter().filter(|cell| cell.points.len() > 1);
        let intact = several.filter(|cell| !cell.points.clone().any(broken));
        let turned = intact.map(|cell| turned(&self.points[cell.points.clone()]));
        turned.max_by(|a, b| a.1.total_cmp(&b.1))
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
