//! From a physical point back to its parameters.
//!
//! Newton's method on `x(ξ) = x_p`, started from the last known parameters, clamped to the patch, with steps
//! halved until the distance falls. Where a bound stops one direction, the other takes its least-squares
//! step. If this gets stuck, the spans whose control points could reach the point (a span lies within the box
//! of its control points, the weights being positive) are searched one by one, each with iterates kept
//! inside, where the map is smooth.

use super::{Form, LocateError, MapPoint, NurbsPatch};

/// A point counts as on the patch if it is within this times [`NurbsPatch::size`] (and the round-off of its
/// coordinates) of it.
pub(crate) const INVERSION_TOLERANCE: f64 = 1e-12;

/// A determinant below this times the mean one is taken for a collapsed geometry.
const COLLAPSED: f64 = 1e-13;
const ITERATIONS: usize = 60;
const HALVINGS: usize = 30;
/// Starts within a span, per direction, the centre first.
const STARTS: [f64; 3] = [0.5, 1.0 / 6.0, 5.0 / 6.0];

/// Where a point lies on a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Location {
    /// Span in each direction.
    pub span: [usize; 2],
    /// Parameters of the patch, in units of the knots.
    pub parameters: [f64; 2],
}

/// A place Newton's method visits.
#[derive(Debug, Clone, Copy)]
struct Iterate {
    location: Location,
    image: MapPoint,
    distance: f64,
}

impl NurbsPatch {
    /// The parameters of a physical point (m), searched from `start`, its last known parameters.
    ///
    /// # Errors
    /// If the point is not on the patch by more than [`INVERSION_TOLERANCE`], is not finite, or lies where
    /// the Jacobian determinant is not positive.
    pub fn locate(&self, point: [f64; 2], start: Option<[f64; 2]>) -> Result<Location, LocateError> {
        if !point.iter().all(|x| x.is_finite()) {
            return Err(LocateError::NotFinite);
        }
        if let Form::Affine { origin, slope } = self.form {
            let parameters = [0, 1].map(|d| (point[d] - origin[d]) / slope[d]);
            return self.accept(self.visit(point, None, parameters));
        }
        let start = start.filter(|s| s.iter().all(|x| x.is_finite())).unwrap_or_else(|| self.nearest_centre(point));
        let mut best = self.newton(point, None, start);
        if best.distance > self.tolerance() {
            best = self.search(point, best);
        }
        self.accept(best)
    }

    /// Distance within which a point is on the patch, m.
    fn tolerance(&self) -> f64 {
        INVERSION_TOLERANCE * self.size + 8.0 * f64::EPSILON * self.reach
    }

    /// The location, if the point is there and the geometry is sound.
    fn accept(&self, found: Iterate) -> Result<Location, LocateError> {
        let Iterate { location, image, distance } = found;
        if distance > self.tolerance() {
            return Err(LocateError::Outside { nearest: image.position, distance });
        }
        let range: f64 = self.spaces.iter().map(|s| s.knot_vector().last().unwrap() - s.knot_vector()[0]).product();
        let determinant = image.determinant();
        if determinant.is_nan() || determinant * range <= COLLAPSED * self.size * self.size {
            return Err(LocateError::Folded { determinant });
        }
        Ok(location)
    }

    /// The centre of the span whose image is nearest.
    fn nearest_centre(&self, point: [f64; 2]) -> [f64; 2] {
        let mut best = (f64::INFINITY, [0.0; 2]);
        for span in self.all_spans() {
            let centre = self.parameters_at(span, [0.5, 0.5]);
            let distance = self.visit(point, Some(span), centre).distance;
            if distance < best.0 {
                best = (distance, centre);
            }
        }
        best.1
    }

    fn all_spans(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [columns, rows] = [0, 1].map(|d| self.spaces[d].spans().len());
        (0..rows).flat_map(move |j| (0..columns).map(move |i| [i, j]))
    }

    /// Searches every span that could hold the point; the best place found.
    fn search(&self, point: [f64; 2], mut best: Iterate) -> Iterate {
        for span in self.all_spans().filter(|&span| self.could_hold(span, point)) {
            for eta in STARTS {
                for xi in STARTS {
                    let found = self.newton(point, Some(span), self.parameters_at(span, [xi, eta]));
                    if found.distance < best.distance {
                        best = found;
                    }
                    if best.distance <= self.tolerance() {
                        return best;
                    }
                }
            }
        }
        best
    }

    /// Whether the point is in the box of the control points of a span.
    fn could_hold(&self, span: [usize; 2], point: [f64; 2]) -> bool {
        let columns = self.spaces[0].dimension();
        let [first, count] =
            [[0, 1].map(|d| self.spaces[d].spans()[span[d]].first), [0, 1].map(|d| self.spaces[d].degree() + 1)];
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for row in first[1]..first[1] + count[1] {
            for control in &self.control_points[row * columns + first[0]..][..count[0]] {
                for i in 0..2 {
                    bounds[i] = [bounds[i][0].min(control[i]), bounds[i][1].max(control[i])];
                }
            }
        }
        let room = self.tolerance();
        (0..2).all(|i| point[i] >= bounds[i][0] - room && point[i] <= bounds[i][1] + room)
    }

    /// Bounds of the parameters in a span, or in the patch.
    fn bounds(&self, span: Option<[usize; 2]>) -> [[f64; 2]; 2] {
        [0, 1].map(|d| {
            let spans = self.spaces[d].spans();
            let [first, last] = span.map_or([0, spans.len() - 1], |s| [s[d]; 2]);
            [spans[first].left, spans[last].right]
        })
    }

    /// The place at parameters clamped to a span, or to the patch.
    fn visit(&self, point: [f64; 2], span: Option<[usize; 2]>, parameters: [f64; 2]) -> Iterate {
        let bounds = self.bounds(span);
        let parameters = [0, 1].map(|d| parameters[d].clamp(bounds[d][0], bounds[d][1]));
        let span = span.or_else(|| self.find_span(parameters)).expect("clamped parameters are on the patch");
        let image = self.map(&self.shape_functions(span, parameters));
        let distance = (point[0] - image.position[0]).hypot(point[1] - image.position[1]);
        Iterate { location: Location { span, parameters }, image, distance }
    }

    /// Damped, clamped Newton; the place it comes to rest.
    fn newton(&self, point: [f64; 2], span: Option<[usize; 2]>, start: [f64; 2]) -> Iterate {
        let bounds = self.bounds(span);
        let mut here = self.visit(point, span, start);
        for _ in 0..ITERATIONS {
            let Some(step) = step(point, &here, bounds) else { break };
            // On the patch already: a step either polishes or it is done.
            let halvings = if here.distance <= self.tolerance() { 1 } else { HALVINGS };
            let parameters = here.location.parameters;
            let better = (0..halvings).map(|n| 0.5f64.powi(n as i32)).find_map(|scale| {
                let trial = self.visit(point, span, [0, 1].map(|d| parameters[d] + scale * step[d]));
                (trial.distance < here.distance).then_some(trial)
            });
            match better {
                Some(trial) => here = trial,
                None => break,
            }
        }
        here
    }
}

/// The Newton step; along one direction only where a bound stops the other. `None` if there is nowhere to go.
fn step(point: [f64; 2], here: &Iterate, bounds: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let residual = [0, 1].map(|i| point[i] - here.image.position[i]);
    let [[xu, xv], [yu, yv]] = here.image.jacobian;
    let determinant = here.image.determinant();
    let newton =
        [(yv * residual[0] - xv * residual[1]) / determinant, (xu * residual[1] - yu * residual[0]) / determinant];
    if here.distance == 0.0 || !newton.iter().all(|s| s.is_finite()) {
        return None;
    }
    let stopped = |d: usize, step: f64| {
        let parameter = here.location.parameters[d];
        (step < 0.0 && parameter <= bounds[d][0]) || (step > 0.0 && parameter >= bounds[d][1])
    };
    match [stopped(0, newton[0]), stopped(1, newton[1])] {
        [false, false] => Some(newton),
        [true, true] => None,
        [first_stopped, _] => {
            let free = usize::from(first_stopped);
            let column = [here.image.jacobian[0][free], here.image.jacobian[1][free]];
            let along = (column[0] * residual[0] + column[1] * residual[1]) / (column[0].powi(2) + column[1].powi(2));
            let mut step = [0.0; 2];
            step[free] = along;
            (along.is_finite() && !stopped(free, along)).then_some(step)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_far_start_on_an_almost_closed_ring_still_arrives() {
        let ring = NurbsPatch::annular_sector(0.9, 1.0, [0.0, 0.98 * TAU]).unwrap().subdivide(3).unwrap();
        for n in 0..=100 {
            let (sin, cos) = (0.98 * TAU * f64::from(n) / 100.0).sin_cos();
            let point = [0.95 * cos, 0.95 * sin];
            for start in [None, Some([0.5, 0.0]), Some([0.0, 1.0]), Some([f64::NAN, 7.0])] {
                let place = ring.locate(point, start).unwrap();
                let image = ring.map(&ring.shape_functions(place.span, place.parameters)).position;
                assert!((image[0] - point[0]).hypot(image[1] - point[1]) < 1e-14, "{point:?} from {start:?}");
            }
        }
    }

    #[test]
    fn points_off_the_patch_are_refused_with_the_distance() {
        let ring = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap();
        for (point, expected) in [([0.6, 0.6], 1.0 - 0.6 * 2f64.sqrt()), ([3.0, 0.0], 1.0), ([0.0, 2.0 + 1e-9], 1e-9)] {
            match ring.locate(point, None).unwrap_err() {
                LocateError::Outside { distance, .. } => assert!((distance - expected).abs() < 1e-6 * expected + 1e-14),
                other => panic!("{other}"),
            }
        }
        assert!(ring.locate([0.0, 2.0 + 1e-14], None).is_ok());
        assert!(matches!(ring.locate([f64::NAN, 1.0], None), Err(LocateError::NotFinite)));
    }

    #[test]
    fn the_collapsed_centre_of_a_sector_is_refused() {
        let sector = NurbsPatch::annular_sector(0.0, 1.0, [0.0, 1.0]).unwrap();
        assert!(matches!(sector.locate([0.0, 0.0], None), Err(LocateError::Folded { .. })));
        assert!(sector.locate([1e-3, 5e-4], None).is_ok());
    }
}
