//! Positions on the boundary of a body that move with it.
//!
//! Such a position may stand in a span that no material point has reached. It is evaluated with the
//! polynomials of the nearest span with material, continued beyond its end: they still sum to one and
//! reproduce positions. A load takes the nearest span whose control points all answer to a force, so no force
//! and no torque is lost.

use super::points::{Cells, OutsidePatch};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::extremes::larger;
use crate::material::hencky::Gradient;
use crate::splines::patch::Patch;
use crate::splines::spline::{ShapeFunctions, SplineSpace};

/// Least mass of a control point that a load, a condition or contact takes hold of, as a part of
/// `ρ A N^(1 + 1/p)` with the value N of its function there and the area A of a span. The material within a
/// straight edge, a corner or an oblique edge gives it 0.2 to 0.7 of that, however little of it is in the
/// support of the function. Less means that the domains of points, which are boxes, leave a gap before the
/// edge.
const SHARE: f64 = 0.05;

/// A position that moves with a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Follower {
    /// Present position, m.
    pub position: [f64; 2],
    /// Span whose polynomials are used.
    span: [usize; 2],
}

impl Follower {
    /// A position at t = 0, m, to be attached.
    pub(crate) fn new(position: [f64; 2]) -> Self {
        Self { position, span: [0, 0] }
    }

    /// A position (m) with the polynomials of the span it is in or nearest to; `None` if there is no material
    /// within one span of it.
    pub(crate) fn nearest(position: [f64; 2], patch: &Patch, cells: &Cells) -> Option<Self> {
        let span = nearest_span(&patch.spaces, position, |span| cells.is_occupied(span))?;
        Some(Self { position, span })
    }

    /// A position (m) with the polynomials of the nearest span whose control points all have a [share](SHARE)
    /// of the mass that goes with the values of their functions there in a body of a density (kg/m³); `None`
    /// if there is none within one span of it.
    pub(crate) fn carried(position: [f64; 2], patch: &Patch, inverse_mass: &[f64], density: f64) -> Option<Self> {
        let grid = patch.control_grid();
        let degree = patch.spaces[0].degree().min(patch.spaces[1].degree());
        let exponent = 1.0 + 1.0 / degree as f64;
        let carries = |span: [usize; 2]| {
            let area: f64 = (0..2).map(|d| patch.spaces[d].spans()[span[d]].length()).product();
            let least = fault!("next-to-no-mass-is-held", SHARE => 0.0) * density * area;
            let mut carries = patch.all_functions(span, |at| inverse_mass[at] > 0.0);
            Self { position, span }.for_each_function(patch, grid, |at, n| {
                let (share, n) = (inverse_mass[at] * least, n.abs());
                carries &= share * larger(n * n, 1.0) <= 1.0 || share * n.powf(exponent) <= 1.0;
            });
            carries
        };
        let span = nearest_span(&patch.spaces, position, carries)?;
        Some(Self { position, span })
    }

    /// Chooses the span anew: that of [`Self::carried`], or else, as at the point of a needle, the nearest
    /// whose control points all answer to a force.
    ///
    /// # Errors
    /// If there is none within one span of it.
    pub(crate) fn attach(&mut self, patch: &Patch, inverse_mass: &[f64], density: f64) -> Result<(), OutsidePatch> {
        let answers = |span| patch.all_functions(span, |at| inverse_mass[at] > 0.0);
        let nearest = || nearest_span(&patch.spaces, self.position, answers);
        let carried = Self::carried(self.position, patch, inverse_mass, density).map(|carried| carried.span);
        self.span = carried.or_else(nearest).ok_or(OutsidePatch(self.position))?;
        Ok(())
    }

    /// Moves with a velocity field (m/s) for `dt` seconds; the gradient of that there, 1/s.
    pub(crate) fn follow(&mut self, patch: &Patch, grid: ControlGrid, velocity: &VectorField, dt: f64) -> Gradient {
        let (mut v, mut gradient) = ([0.0; 2], [[0.0; 2]; 2]);
        self.for_each_gradient(patch, grid, |at, n, slope| {
            for c in 0..2 {
                v[c] += n * velocity[c][at];
                (0..2).for_each(|d| gradient[c][d] += velocity[c][at] * slope[d]);
            }
        });
        self.position = [0, 1].map(|c| self.position[c] + dt * v[c]);
        gradient
    }

    /// Calls `f` with control point and value of every shape function at the position.
    pub(crate) fn for_each_function(&self, patch: &Patch, grid: ControlGrid, mut f: impl FnMut(usize, f64)) {
        self.for_each_gradient(patch, grid, |at, n, _| f(at, n));
    }

    /// Calls `f` with control point, value and gradient (1/m) of every shape function at the position.
    pub(crate) fn for_each_gradient(&self, patch: &Patch, grid: ControlGrid, mut f: impl FnMut(usize, f64, [f64; 2])) {
        let [(column, x), (row, y)] = self.shape_functions(patch);
        for l in 0..=patch.spaces[1].degree() {
            for k in 0..=patch.spaces[0].degree() {
                let slope = [x.derivative[k] * y.value[l], x.value[k] * y.derivative[l]];
                f(grid.index(column + k, row + l), x.value[k] * y.value[l], slope);
            }
        }
    }

    /// Shape functions in x at the position with the control column of the first, and those in y with the
    /// control row.
    #[inline]
    pub(crate) fn shape_functions(&self, patch: &Patch) -> [(usize, ShapeFunctions); 2] {
        let along = |d: usize| {
            let (space, span) = (&patch.spaces[d], self.span[d]);
            (space.spans()[span].first, space.shape_functions(span, self.position[d]))
        };
        [along(0), along(1)]
    }
}

/// The span that is nearest to a position (m) among its own and its eight neighbours, of those that `carries`
/// says can stand for it; its own if it can.
pub(crate) fn nearest_span(
    spaces: &[SplineSpace; 2],
    position: [f64; 2],
    carries: impl Fn([usize; 2]) -> bool,
) -> Option<[usize; 2]> {
    let home = [0, 1].map(|d| clamped_span(&spaces[d], position[d]));
    if carries(home) {
        return Some(home);
    }
    let near = |d: usize| home[d].saturating_sub(1)..(home[d] + 2).min(spaces[d].spans().len());
    let distance = |span: &[usize; 2]| {
        let beyond = |d: usize| {
            let s = &spaces[d].spans()[span[d]];
            (s.left - position[d]).max(position[d] - s.right).max(0.0)
        };
        beyond(0).hypot(beyond(1))
    };
    let spans = near(1).flat_map(|j| near(0).map(move |i| [i, j]));
    spans.filter(|span| carries(*span)).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The span of `x`, or the end span nearest to it.
fn clamped_span(space: &SplineSpace, x: f64) -> usize {
    let last = space.spans().len() - 1;
    space.find_span(x).unwrap_or(if x > space.spans()[last].right { last } else { 0 })
}
