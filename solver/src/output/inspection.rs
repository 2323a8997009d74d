//! What a point carries, and what a run looks like where it broke down: the points whose numbers are worst,
//! and the extremes.
//!
//! Nothing of this is computed while a run is well, unless someone asks for the points.

use crate::linear_algebra::extremes::larger;

/// Points that are kept as the worst ones.
const WORST: usize = 8;

/// What a point carries. After a step that failed, strain and history energy may be those of the new step
/// already.
#[derive(Debug, Clone, PartialEq)]
pub struct PointState {
    /// Number of the body among those that deform, in the order of the scene.
    pub body: usize,
    /// Number of the point in its body; in the updated frame points are numbered anew whenever one changes
    /// spans.
    pub point: usize,
    /// Area that the point stands for at t = 0, m².
    pub area: f64,
    /// Position, m; that at t = 0 in the total frame.
    pub position: [f64; 2],
    /// Present position in either frame, m.
    pub present: [f64; 2],
    /// Displacement since t = 0, m.
    pub displacement: [f64; 2],
    /// Velocity, m/s; in the updated frame that of half a step before, at t = 0 the initial one.
    pub velocity: [f64; 2],
    /// Strain `[xx, yy, xy]`: linear, or Hencky's with finite kinematics.
    pub strain: [f64; 3],
    /// Stress of the degraded material `[xx, yy, xy]`, Pa; Kirchhoff's with finite kinematics.
    pub stress: [f64; 3],
    /// Stress out of the plane of the degraded material, Pa: zero in plane stress.
    pub stress_out_of_plane: f64,
    /// What only a point of a fracturing body has.
    pub fracture: Option<PointFracture>,
}

/// A point whose deformation is turned inside out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct InvertedPoint {
    /// Number of the point in its body.
    pub point: usize,
    /// Position, m; that at t = 0 in the total frame.
    pub position: [f64; 2],
    /// Determinant of its deformation gradient: zero or less.
    pub determinant: f64,
}

impl InvertedPoint {
    /// The one of two that is turned further.
    pub(crate) fn worse(self, other: Self) -> Self {
        if other.determinant < self.determinant { other } else { self }
    }
}

/// What only a point of a fracturing body has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointFracture {
    /// History energy H, or with a threshold the present driving energy, J/m³.
    pub history: f64,
    /// Phase field of the last solve that succeeded.
    pub phase: f64,
}

/// Extremes of a body of points; of finite numbers only.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Inspection {
    /// Number of material points.
    pub points: usize,
    /// Points with a number that is not finite.
    pub not_finite: usize,
    /// The worst points, the worst first: those with numbers that are not finite, then those of largest
    /// strain.
    pub worst: Vec<PointState>,
    /// Largest magnitude of a strain component.
    pub largest_strain: f64,
    /// Largest magnitude of a stress component, Pa.
    pub largest_stress: f64,
    /// Largest history energy, J/m³, and smallest and largest phase field, if there is one.
    pub fracture: Option<FractureExtremes>,
    /// Position (m) and speed (m/s) of the fastest control point.
    pub fastest: ([f64; 2], f64),
}

/// Extremes of a phase field at the points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractureExtremes {
    /// Largest history energy, J/m³.
    pub largest_history: f64,
    /// Smallest phase field.
    pub least_phase: f64,
    /// Largest phase field.
    pub largest_phase: f64,
}

impl PointState {
    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        let motion = self.position.iter().chain(&self.displacement).chain(&self.velocity);
        let vectors = motion.chain(&self.strain).chain(&self.stress);
        let fracture = self.fracture.iter().flat_map(|f| [f.history, f.phase]);
        vectors.copied().chain(fracture).all(f64::is_finite)
    }

    /// Von Mises stress, Pa.
    pub fn von_mises(&self) -> f64 {
        let ([xx, yy, xy], zz) = (self.stress, self.stress_out_of_plane);
        let square = |a: f64, b: f64| (a - b) * (a - b);
        (0.5 * (square(xx, yy) + square(yy, zz) + square(zz, xx)) + 3.0 * xy * xy).sqrt()
    }

    /// Largest magnitude of a strain component; infinite if a number of the point is not finite.
    fn severity(&self) -> f64 {
        if self.is_finite() { largest(&self.strain) } else { f64::INFINITY }
    }
}

impl Inspection {
    /// Of all points that `for_each` names.
    pub(crate) fn new(fastest: ([f64; 2], f64), for_each: impl FnOnce(&mut dyn FnMut(PointState))) -> Self {
        let mut inspection = Self { fastest, ..Self::default() };
        for_each(&mut |point| inspection.look_at(point));
        inspection
    }

    fn look_at(&mut self, point: PointState) {
        self.points += 1;
        self.not_finite += usize::from(!point.is_finite());
        if point.is_finite() {
            self.largest_strain = larger(self.largest_strain, largest(&point.strain));
            self.largest_stress = larger(self.largest_stress, largest(&point.stress));
        }
        if let Some(PointFracture { history, phase }) = point.fracture {
            let none =
                FractureExtremes { largest_history: 0.0, least_phase: f64::INFINITY, largest_phase: -f64::INFINITY };
            let so_far = self.fracture.unwrap_or(none);
            let [history, phase] = [history, phase].map(|value| if value.is_finite() { value } else { f64::NAN });
            self.fracture = Some(FractureExtremes {
                // NaN loses against a number
                largest_history: so_far.largest_history.max(history),
                least_phase: so_far.least_phase.min(phase),
                largest_phase: so_far.largest_phase.max(phase),
            });
        }
        let severity = point.severity();
        let place = self.worst.partition_point(|other| other.severity() >= severity);
        if place < WORST {
            self.worst.insert(place, point);
            self.worst.truncate(WORST);
        }
    }
}

/// Largest magnitude of the finite ones.
fn largest(values: &[f64]) -> f64 {
    values.iter().map(|value| value.abs()).filter(|value| value.is_finite()).fold(0.0, larger)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(number: usize, strain: f64) -> PointState {
        let fracture = Some(PointFracture { history: strain, phase: 0.5 });
        PointState {
            area: 1.0,
            body: 0,
            point: number,
            position: [0.0; 2],
            present: [0.0; 2],
            displacement: [0.0; 2],
            velocity: [0.0; 2],
            strain: [strain, 0.0, 0.0],
            stress: [1.0; 3],
            stress_out_of_plane: 0.0,
            fracture,
        }
    }

    #[test]
    fn the_stress_of_von_mises_is_that_of_three_normal_stresses_and_shear() {
        let of = |stress, stress_out_of_plane| PointState { stress, stress_out_of_plane, ..point(0, 0.0) }.von_mises();
        assert_eq!(of([2.0, 0.0, 0.0], 0.0), 2.0, "uniaxial");
        assert_eq!(of([3.0, 3.0, 0.0], 3.0), 0.0, "hydrostatic");
        assert!((of([0.0, 0.0, 2.0], 0.0) - 12f64.sqrt()).abs() < 1e-15, "shear");
    }

    #[test]
    fn points_that_are_no_numbers_come_first_and_extremes_are_of_numbers() {
        let strains = [0.1, -0.7, f64::NAN, 0.3, f64::INFINITY, 0.2, 0.0, 0.4, 0.5, 0.6];
        let inspection = Inspection::new(([0.0; 2], 1.0), |f| {
            strains.iter().enumerate().for_each(|(number, &strain)| f(point(number, strain)));
        });
        let worst: Vec<usize> = inspection.worst.iter().map(|p| p.point).collect();
        assert_eq!(worst, [2, 4, 1, 9, 8, 7, 3, 5]);
        assert_eq!((inspection.points, inspection.not_finite, inspection.largest_strain), (10, 2, 0.7));
        let fracture = inspection.fracture.unwrap();
        assert_eq!((fracture.largest_history, fracture.least_phase, fracture.largest_phase), (0.6, 0.5, 0.5));
    }
}
