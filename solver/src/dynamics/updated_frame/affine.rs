//! Affine velocities of the points: APIC and TPIC.
//!
//! A point carries a velocity gradient C beside its velocity, and gives the control point I at x_I (its
//! Greville point) `v_p + C (x_I − x_p)`. Both transfers take `C = Σ v_I g_Iᵀ` from the grid and differ in g
//! alone:
//!
//! ```text
//! APIC   g_I = D⁻¹ N_I (x_I − x_p),    D = Σ N_I (x_I − x_p)(x_I − x_p)ᵀ         Jiang et al. (2015)
//! TPIC   g_I = grad N_I
//! ```
//!
//! Greville points reproduce positions, so D is diagonal, and g a product of one-dimensional factors. D is
//! computed at every point: on uniform knots h²/4 for quadratics and h²/3 for cubics, and a third of the
//! square of half the width of the domain. It goes to zero only where a domain has no width at the end of an
//! open knot vector; there the derivative of N is the limit. C is kept rather than C D: an affine field is
//! then carried exactly wherever the point goes, and angular momentum to round-off as long as D changes with
//! the domain alone, which is on uniform knots for p ≥ 2 away from the sides of the patch.

use std::ops::Range;

use super::windows::{Reach, Slopes, control_sums, cut, side_by_side};
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::lane::each;
use crate::material::hencky::Gradient;
use crate::particles::points::{Cell, Cells, Point};
use crate::splines::patch::Patch;
use crate::splines::spline::{MAX_REACH, MeanFunctions};

/// `D/h²` below which the derivatives stand for the affine fit.
const DEGENERATE: f64 = 1e-14;

/// Where the velocity gradient of a point comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fit {
    /// Fit with the shape functions as weights: APIC.
    Weighted,
    /// Gradient at the point: TPIC.
    Taylor,
}

/// Velocity gradients of the points.
#[derive(Debug, Clone)]
pub(crate) struct AffineVelocities {
    fit: Fit,
    /// Velocity gradient of each point, 1/s, in the order of the points.
    pub gradients: Vec<Gradient>,
    greville: [Vec<f64>; 2],
}

impl AffineVelocities {
    /// Points without velocity gradients.
    pub(crate) fn new(fit: Fit, patch: &Patch, points: usize) -> Self {
        let greville = [0, 1].map(|d| patch.spaces[d].greville());
        Self { fit, gradients: vec![[[0.0; 2]; 2]; points], greville }
    }

    /// Goes over to another part of the patch.
    pub(crate) fn follow(&mut self, patch: &Patch) {
        self.greville = [0, 1].map(|d| patch.spaces[d].greville());
    }

    /// Velocity gradients of a velocity on the control points, m/s, where no step gives them.
    pub(crate) fn take(&mut self, patch: &Patch, cells: &Cells, points: &[Point], velocity: &VectorField) {
        let Self { fit, gradients, greville } = self;
        let (grid, order) = (patch.control_grid(), patch.spaces.each_ref().map(|space| space.degree() + 1));
        let [vx, vy] = velocity.each_ref().map(|component| &component[..]);
        let mut fields = Vec::new();
        side_by_side([vx, vy, vx, vy], &mut fields);
        let view = AffineView { fit: *fit, greville };
        for cell in &cells.cells {
            for at in cell.points.clone() {
                let functions = points[at].mean_functions::<false>(patch, cell, order);
                let levers = view.levers(cell, &functions, points[at].position, order);
                let slopes = view.slopes(patch, cell, &functions, &levers, order);
                let reach = Reach::new(grid, cell, &functions, order, 0);
                gradients[at] = control_sums(&functions, &slopes, &fields, [0.0; 4], reach).affine();
            }
        }
    }

    /// Their fit, and the gradients in pieces of these lengths.
    pub(super) fn pieces(
        &mut self,
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> impl Iterator<Item = (AffineView<'_>, &mut [Gradient])> {
        let view = AffineView { fit: self.fit, greville: &self.greville };
        cut(&mut self.gradients, ranges).into_iter().map(move |gradients| (view, gradients))
    }

    /// How the velocity gradients follow from control values, with the present Greville points.
    pub(super) fn view(&self) -> AffineView<'_> {
        AffineView { fit: self.fit, greville: &self.greville }
    }
}

/// How the velocity gradients of points follow from control values.
#[derive(Debug, Clone, Copy)]
pub struct AffineView<'a> {
    fit: Fit,
    /// Greville points, m.
    greville: &'a [Vec<f64>; 2],
}

impl AffineView<'_> {
    /// `x_I − x` of the columns and rows of control points that a point at `position` (m) reaches.
    #[inline(always)]
    pub(super) fn levers(
        self,
        cell: &Cell,
        functions: &[MeanFunctions; 2],
        position: [f64; 2],
        order: [usize; 2],
    ) -> Slopes {
        each!(d in [0, 1] => {
            let mut levers = [0.0; MAX_REACH];
            let first = cell.first[d] + functions[d].start;
            let end = (order[d] + 1).min(self.greville[d].len() + 1 - first);
            for k in 0..end {
                levers[k] = self.greville[d][first + k - 1] - position[d];
            }
            levers
        })
    }

    /// Factors `Σ f(x_I) slope_I` that take the slope of a function from its control values.
    #[inline(always)]
    pub(super) fn slopes(
        self,
        patch: &Patch,
        cell: &Cell,
        functions: &[MeanFunctions; 2],
        levers: &Slopes,
        order: [usize; 2],
    ) -> Slopes {
        each!(d in [0, 1] => {
            let MeanFunctions { value, derivative, .. } = &functions[d];
            let mut slopes = [0.0; MAX_REACH];
            let mut spread = 0.0;
            for k in 0..=order[d] {
                slopes[k] = value[k] * levers[d][k];
                spread += slopes[k] * levers[d][k];
            }
            let length = patch.spaces[d].spans()[cell.span[d]].length();
            if self.fit == Fit::Taylor || spread <= DEGENERATE * length * length {
                slopes = *derivative;
            } else {
                let factor = 1.0 / fault!("apic-spread-of-quadratics", spread => 0.25 * length * length);
                slopes.iter_mut().for_each(|slope| *slope *= factor);
            }
            slopes
        })
    }

    /// A gradient of a point whose domain grew from half a width and height to others, m: the spread D of a
    /// fit with weights grows by a third of the square, and the angular momentum of `C D` is to stay.
    #[inline(always)]
    pub(super) fn rescaled(
        self,
        gradient: Gradient,
        patch: &Patch,
        cell: &Cell,
        [before, after]: [[f64; 2]; 2],
    ) -> Gradient {
        if self.fit == Fit::Taylor || before == after {
            return gradient;
        }
        let factors = each!(d in [0, 1] => {
            let spread = patch.spaces[d].spread(cell.span[d]);
            let factor = (spread + before[d] * before[d] / 3.0) / (spread + after[d] * after[d] / 3.0);
            fault!("affine-not-scaled", factor => 1.0)
        });
        gradient.map(|row| [row[0] * factors[0], row[1] * factors[1]])
    }
}
