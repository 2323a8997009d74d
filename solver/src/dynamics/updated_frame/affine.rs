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
//! computed at every point: h²/4 for quadratics and h²/3 for cubics on uniform knots, but it goes to zero at
//! the ends of an open knot vector, where the derivative of N is the limit, and at every knot for p = 1,
//! where both transfers are the same. C is kept rather than C D: an affine field is then carried exactly
//! wherever the point goes, and angular momentum to round-off as long as D does not change, which is on
//! uniform knots for p ≥ 2 away from the sides of the patch.

use rayon::prelude::*;

use super::transfer::walk;
use super::windows::{Window, control_values, cut, in_cell, scatter, zeros};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::lane::{Vectorised, dispatch, each};
use crate::material::hencky::Gradient;
use crate::particles::points::{Cell, Cells, Point};
use crate::splines::patch::Patch;
use crate::splines::spline::{MAX_REACH, MeanFunctions, SplineSpace};

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

    /// Velocity gradients from a velocity on the control points, m/s.
    pub(crate) fn take(&mut self, patch: &Patch, cells: &Cells, points: &[Point], velocity: &VectorField) {
        let Self { fit, gradients, greville } = self;
        let (fit, grid) = (*fit, patch.control_grid());
        let velocity = velocity.each_ref().map(|component| &component[..]);
        let gradients = cut(gradients, cells.strips.iter().map(|s| s.points.clone())).into_par_iter();
        gradients.zip(&cells.strips).for_each(|(gradients, strip)| {
            let points = &points[strip.points.clone()];
            let cells = &cells.cells[strip.cells.clone()];
            dispatch(GradientsFromGrid { patch, grid, fit, greville, velocity, cells, points, gradients });
        });
    }

    /// Adds `Σ m N_I C (x_I − x_p)` to the momentum of the control points, kg/s.
    pub(crate) fn give(
        &self,
        patch: &Patch,
        cells: &Cells,
        points: &[Point],
        density: f64,
        momentum: &mut VectorField,
    ) {
        let Self { gradients, greville, .. } = self;
        let grid = patch.control_grid();
        scatter(&cells.strips, momentum.each_mut().map(|f| &mut f[..]), [grid.stride; 2], |strip, window| {
            let cells = &cells.cells[strip.cells.clone()];
            dispatch(GradientsToGrid { patch, grid, density, greville, cells, points, gradients, window });
        });
    }

    /// The velocity gradients if they are fitted with the shape functions as weights, else none.
    pub(super) fn fitted(&mut self) -> &mut [Gradient] {
        if self.fit == Fit::Weighted { &mut self.gradients } else { &mut [] }
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.gradients.len() * size_of::<Gradient>() + 8 * (self.greville[0].len() + self.greville[1].len())
    }
}

impl Fit {
    /// Factors `Σ f(x_k) slope_k` that take the slope of a function from its control values.
    #[inline(always)]
    fn slopes(
        self,
        space: &SplineSpace,
        span: usize,
        shape: &MeanFunctions,
        lever: &[f64; MAX_REACH],
    ) -> [f64; MAX_REACH] {
        if self == Self::Taylor {
            return shape.derivative;
        }
        let spread: f64 = (0..MAX_REACH).map(|k| shape.value[k] * lever[k] * lever[k]).sum();
        let length = space.spans()[span].length();
        if spread <= DEGENERATE * length * length {
            return shape.derivative;
        }
        let inertia = fault!("apic-spread-of-quadratics", spread => 0.25 * length * length);
        let mut slopes = [0.0; MAX_REACH];
        for k in 0..MAX_REACH {
            slopes[k] = shape.value[k] * lever[k] / inertia;
        }
        slopes
    }
}

/// `x_k − x` of the control points that a point reaches; `first` is the first of its span.
#[inline(always)]
fn levers(greville: &[f64], first: usize, mean: &MeanFunctions, order: usize, x: f64) -> [f64; MAX_REACH] {
    let mut levers = [0.0; MAX_REACH];
    let end = (order + 1).min(greville.len() + 1 - first - mean.start);
    for k in 0..end {
        levers[k] = greville[first + mean.start + k - 1] - x;
    }
    levers
}

struct GradientsFromGrid<'a> {
    patch: &'a Patch,
    grid: ControlGrid,
    fit: Fit,
    greville: &'a [Vec<f64>; 2],
    velocity: [&'a [f64]; 2],
    cells: &'a [Cell],
    points: &'a [Point],
    gradients: &'a mut [Gradient],
}

impl Vectorised for GradientsFromGrid<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        walk!(self, FMA)
    }
}

impl GradientsFromGrid<'_> {
    #[inline(always)]
    fn walk(self, kx: usize, ky: usize) {
        let [x, y] = &self.patch.spaces;
        let offset = self.cells.first().map_or(0, |cell| cell.points.start);
        for cell in self.cells {
            let local = control_values(self.velocity, self.grid, cell, kx, ky);
            for at in cell.points.start - offset..cell.points.end - offset {
                let position = self.points[at].position;
                let functions = self.points[at].mean_functions(self.patch, cell, [kx, ky]);
                let [sx, sy] = &functions;
                let lx = levers(&self.greville[0], cell.first[0], sx, kx, position[0]);
                let ly = levers(&self.greville[1], cell.first[1], sy, ky, position[1]);
                let gx = self.fit.slopes(x, cell.span[0], sx, &lx);
                let gy = self.fit.slopes(y, cell.span[1], sy, &ly);
                let mut value = [0.0; 2];
                for l in 0..=ky {
                    let first = in_cell(&functions, l, kx);
                    for k in 0..=kx {
                        value = each!(c in [0, 1] => value[c] + sx.value[k] * sy.value[l] * local[first + k][c]);
                    }
                }
                // Against the velocity at the point: a constant has no gradient, whatever rounding does to
                // the factors.
                let mut gradient = [[0.0; 2]; 2];
                for l in 0..=ky {
                    let first = in_cell(&functions, l, kx);
                    for k in 0..=kx {
                        let factors = [gx[k] * sy.value[l], sx.value[k] * gy[l]];
                        let against = each!(c in [0, 1] => local[first + k][c] - value[c]);
                        gradient = each!(c in [0, 1] => each!(d in [0, 1] => gradient[c][d] + against[c] * factors[d]));
                    }
                }
                self.gradients[at] = gradient;
            }
        }
    }
}

struct GradientsToGrid<'a> {
    patch: &'a Patch,
    grid: ControlGrid,
    density: f64,
    greville: &'a [Vec<f64>; 2],
    cells: &'a [Cell],
    points: &'a [Point],
    gradients: &'a [Gradient],
    window: Window<'a, 2>,
}

impl Vectorised for GradientsToGrid<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        walk!(self, FMA)
    }
}

impl GradientsToGrid<'_> {
    #[inline(always)]
    fn walk(mut self, kx: usize, ky: usize) {
        for cell in self.cells {
            let mut sums = zeros();
            for at in cell.points.clone() {
                let point = &self.points[at];
                let functions = point.mean_functions(self.patch, cell, [kx, ky]);
                let [sx, sy] = &functions;
                let lx = levers(&self.greville[0], cell.first[0], sx, kx, point.position[0]);
                let ly = levers(&self.greville[1], cell.first[1], sy, ky, point.position[1]);
                let mass = self.density * point.volume;
                let [[xx, xy], [yx, yy]] = each!(c in [0, 1] => each!(d in [0, 1] => mass * self.gradients[at][c][d]));
                let [cx, cy] = fault!("affine-transposed", [[xx, xy], [yx, yy]] => [[xx, yx], [xy, yy]]);
                for l in 0..=ky {
                    let first = in_cell(&functions, l, kx);
                    for k in 0..=kx {
                        let n = sx.value[k] * sy.value[l];
                        let sum = &mut sums[first + k];
                        sum[0] += n * (cx[0] * lx[k] + cx[1] * ly[l]);
                        sum[1] += n * (cy[0] * lx[k] + cy[1] * ly[l]);
                    }
                }
            }
            self.window.add(self.grid, cell, &sums, kx, ky);
        }
    }
}
