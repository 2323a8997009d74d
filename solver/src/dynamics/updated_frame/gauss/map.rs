//! The inverse of the motion, `X = x − d(x)`, with the displacement d as a spline of present positions.

use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::extremes::largest;
use crate::linear_algebra::lane::each;
use crate::material::hencky::{Gradient, gradient_at_end};
use crate::splines::patch::Patch;

/// Corrections at most; each squares the error.
const LIMIT: usize = 20;
/// A correction below this fraction of a span is the last, or below this multiple of the round-off of a
/// position.
const CLOSE: f64 = 1e-9;
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// No present position was found of material near this place, m: the displacement is turned inside out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Folded(pub [f64; 2]);

/// Displacement `d(x)`, m, of the material that is at x now.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InverseMap<'a> {
    /// Background patch.
    pub patch: &'a Patch,
    /// Layout of the control points.
    grid: ControlGrid,
    /// Control values of the displacement less its mean, m.
    displacement: &'a VectorField,
    /// Its mean, m.
    mean: [f64; 2],
    /// Length of the shortest span, m.
    shortest_span: f64,
}

impl<'a> InverseMap<'a> {
    /// For control values of the displacement less its mean, m.
    pub(crate) fn new(patch: &'a Patch, displacement: &'a VectorField, mean: [f64; 2]) -> Self {
        Self { patch, grid: patch.control_grid(), displacement, mean, shortest_span: patch.shortest_span() }
    }

    /// Displacement (m) and its gradient at a position (m), with the polynomials of the nearest span.
    pub(crate) fn at(&self, position: [f64; 2]) -> ([f64; 2], Gradient) {
        let along = |d: usize| {
            let spans = self.patch.spaces[d].spans();
            let span = spans.partition_point(|span| span.right <= position[d]).min(spans.len() - 1);
            (spans[span].first, self.patch.spaces[d].shape_functions(span, position[d]))
        };
        let [(column, x), (row, y)] = [along(0), along(1)];
        let (mut value, mut gradient) = (self.mean, [[0.0; 2]; 2]);
        for l in 0..=self.patch.spaces[1].degree() {
            let first = self.grid.index(column, row + l);
            for c in 0..2 {
                let along = &self.displacement[c][first..=first + self.patch.spaces[0].degree()];
                let (mut sum, mut slope) = (0.0, 0.0);
                for (k, u) in along.iter().enumerate() {
                    sum += x.value[k] * u;
                    slope += x.derivative[k] * u;
                }
                value[c] += y.value[l] * sum;
                gradient[c][0] += y.value[l] * slope;
                gradient[c][1] += y.derivative[l] * sum;
            }
        }
        (value, gradient)
    }

    /// Where the material of a reference position is now, m, by Newton's method from `start`, and how a
    /// reference vector `along` is carried there, `F along`.
    ///
    /// # Errors
    /// If Newton's method finds no root.
    pub(crate) fn forward(
        &self,
        reference: [f64; 2],
        along: [f64; 2],
        start: [f64; 2],
    ) -> Result<([f64; 2], [f64; 2]), Folded> {
        let close = CLOSE * self.shortest_span + ROUND_OFF * largest(reference.map(f64::abs));
        let mut x = start;
        for _ in 0..LIMIT {
            let (d, gradient) = self.at(x);
            let carried = displacement_gradient(&gradient);
            let apart = [0, 1].map(|c: usize| reference[c] + d[c] - x[c]);
            let step = times(&carried, apart);
            x = [0, 1].map(|c| x[c] + step[c]);
            if largest(step.map(f64::abs)) <= close {
                return Ok((x, times(&carried, along)));
            }
        }
        Err(Folded(start))
    }
}

/// `F v` from `F − I`.
fn times(h: &Gradient, v: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| v[i] + h[i][0] * v[0] + h[i][1] * v[1])
}

/// `F − I` of the deformation gradient `F = (I − ∇d)⁻¹`.
#[inline(always)]
pub(crate) fn displacement_gradient(gradient: &Gradient) -> Gradient {
    let inverse = gradient_at_end(&each!(i in [0, 1] => each!(j in [0, 1] => -gradient[i][j])));
    each!(i in [0, 1] => each!(j in [0, 1] => -inverse[i][j]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    /// What `forward` finds from (0.5, 0.5) m where the displacement is `slope x` along x.
    fn found(slope: f64, reference: [f64; 2]) -> Result<([f64; 2], [f64; 2]), Folded> {
        let patch = Patch::new(&Mesh::uniform([2; 2], [0.0; 2], [1.0; 2], [4; 2]));
        let grid = patch.control_grid();
        let mut displacement = [grid.zeros(), grid.zeros()];
        let abscissae = patch.spaces[0].greville();
        for row in 0..grid.rows {
            for (column, x) in abscissae.iter().enumerate() {
                displacement[0][grid.index(column, row)] = slope * x;
            }
        }
        InverseMap::new(&patch, &displacement, [0.0; 2]).forward(reference, [1.0, 1.0], [0.5; 2])
    }

    #[test]
    fn a_position_is_found_and_a_vector_carried_with_it() {
        let (x, carried) = found(0.5, [0.2, 0.3]).unwrap();
        assert!((x[0] - 0.4).abs() < 1e-14 && (x[1] - 0.3).abs() < 1e-14, "x − x/2 = 0.2: {x:?}");
        assert!((carried[0] - 2.0).abs() < 1e-13 && (carried[1] - 1.0).abs() < 1e-13, "{carried:?}");
    }

    #[test]
    fn a_displacement_that_has_no_inverse_is_said_with_its_place() {
        assert_eq!(found(1.0, [0.2, 0.3]), Err(Folded([0.5; 2])), "all x come from X = 0");
        assert!(found(f64::NAN, [0.2, 0.3]).is_err());
    }
}
