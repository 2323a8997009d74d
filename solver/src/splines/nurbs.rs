//! NURBS patches (E 13): rational splines on a tensor-product grid of control points with positive weights.
//!
//! ```text
//! R_a(ξ) = N_a(ξ) w_a / W(ξ),   W = Σ N_b w_b,   x(ξ) = Σ R_a(ξ) P_a,   J = ∂x/∂ξ,   ∇R_a = J⁻ᵀ ∂R_a/∂ξ
//! ```
//!
//! with `N_a` a product of two B-splines, `w_a` the weights (no unit), `P_a` the control points (m) and ξ the
//! parameters (in the unit of the knots). Notation and algorithms follow Piegl & Tiller, *The NURBS Book*,
//! chapters 3–5, except degree elevation, which goes by polar forms (Ramshaw 1989). Control points are stored
//! row by row, first direction fastest.
//!
//! Two special cases skip work and give the same numbers to round-off ([`Form`]): equal weights need no
//! division, and an affine rectangle needs no inverse map. [`NurbsPatch::general`] takes the fast path away,
//! so that this can be checked.
//!
//! A scene whose mesh has a geometry runs on such a patch: see [`crate::particles::lattice`] for how its
//! points use it.
//!
//! ```
//! use fisura::splines::nurbs::NurbsPatch;
//!
//! let ring = NurbsPatch::quarter_annulus(1.0, 2.0)?.elevate(0)?.insert_knots(1, &[0.25, 0.5])?;
//! let place = ring.locate([1.0, 1.0], None).unwrap();
//! let functions = ring.shape_functions(place.span, place.parameters);
//! let position = ring.map(&functions).position;
//! assert!((position[0] - 1.0).abs() < 1e-14 && (position[1] - 1.0).abs() < 1e-14);
//! # Ok::<(), fisura::splines::nurbs::NurbsError>(())
//! ```

pub(crate) mod check;
mod construct;
mod error;
mod functions;
pub(crate) mod locate;
mod refine;

pub use error::{LocateError, NurbsError};
pub(crate) use functions::products;

pub use functions::{MapPoint, PointValue, RationalFunctions, rational_functions};

use rayon::prelude::*;

use crate::linear_algebra::extremes::larger;
use crate::scene::Layout;
use crate::splines::quadrature::Rule;
use crate::splines::spline::SplineSpace;

/// What a patch may skip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// Equal weights and `x_d = origin_d + slope_d ξ_d`: no division, no inverse map, constant Jacobian.
    Affine {
        /// Position x that the map gives to the parameters ξ = 0, m.
        origin: [f64; 2],
        /// Derivative of x_d with respect to ξ_d, positive.
        slope: [f64; 2],
    },
    /// Equal weights: the basis functions are plain B-splines.
    Polynomial,
    /// Nothing is skipped.
    Rational,
}

/// A NURBS patch that has been checked: open knots, matching counts, positive weights, positive Jacobian.
#[derive(Debug, Clone)]
pub struct NurbsPatch {
    spaces: [SplineSpace; 2],
    control_points: Vec<[f64; 2]>,
    weights: Vec<f64>,
    form: Form,
    /// Largest extent of the control points from their first, m: the unit of tolerances.
    size: f64,
    /// Largest coordinate of a control point, m: the unit of round-off.
    reach: f64,
}

impl NurbsPatch {
    /// The patch of `degree` on open `knots`, with control points (m) and weights row by row, first direction
    /// fastest.
    ///
    /// # Errors
    /// [`NurbsError`] says what is wrong and where: degrees, knots, counts, weights, or a geometry that is
    /// folded, that is whose Jacobian determinant is not positive at the Gauss points (p + 1 per direction)
    /// of every span.
    pub fn new(
        degree: [usize; 2],
        knots: [&[f64]; 2],
        control_points: Vec<[f64; 2]>,
        weights: Vec<f64>,
    ) -> Result<Self, NurbsError> {
        let equal = weights.windows(2).all(|pair| pair[0] == pair[1]);
        let form = if equal { Form::Polynomial } else { Form::Rational };
        Self::with_form(degree, knots, control_points, weights, form)
    }

    /// The same with a form that is known to hold.
    fn with_form(
        degree: [usize; 2],
        knots: [&[f64]; 2],
        control_points: Vec<[f64; 2]>,
        weights: Vec<f64>,
        form: Form,
    ) -> Result<Self, NurbsError> {
        for d in 0..2 {
            check::knots(d, degree[d], knots[d])?;
        }
        let columns = knots[0].len() - degree[0] - 1;
        let rows = knots[1].len() - degree[1] - 1;
        check::control_net([columns, rows], &control_points, &weights)?;
        let spaces = [0, 1].map(|d| SplineSpace::new(degree[d], knots[d]));
        let from = control_points[0];
        let size = control_points.iter().map(|p| (p[0] - from[0]).abs().max((p[1] - from[1]).abs())).fold(0.0, larger);
        let reach = control_points.as_flattened().iter().fold(0.0, |m: f64, x| larger(m, x.abs()));
        let patch = Self { spaces, control_points, weights, form, size, reach };
        patch.check_geometry()?;
        Ok(patch)
    }

    /// Positive Jacobian determinant at the Gauss points, p + 1 per direction, of every span.
    fn check_geometry(&self) -> Result<(), NurbsError> {
        let rules = [0, 1].map(|d| Rule::new(Layout::Gauss, self.spaces[d].degree() + 1));
        let folded = |span: [usize; 2]| {
            let positions = rules[1].points.iter().flat_map(|&eta| rules[0].points.iter().map(move |&xi| [xi, eta]));
            positions.map(|position| self.parameters_at(span, position)).find_map(|parameters| {
                let determinant = self.map(&self.shape_functions(span, parameters)).determinant();
                let holds = determinant > 0.0 && determinant.is_finite();
                (!holds).then_some(NurbsError::Folded { span, parameters, determinant })
            })
        };
        let columns = self.spaces[0].spans().len();
        let rows = (0..self.spaces[1].spans().len()).into_par_iter();
        let first = rows.find_map_first(|j| (0..columns).find_map(|i| folded([i, j])));
        first.map_or(Ok(()), Err)
    }

    /// Parameters at a fraction of a span.
    fn parameters_at(&self, span: [usize; 2], fraction: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| {
            let span = &self.spaces[d].spans()[span[d]];
            (span.left + span.length() * fraction[d]).clamp(span.left, span.right)
        })
    }

    /// Spline spaces of the two parametric directions.
    pub fn spaces(&self) -> &[SplineSpace; 2] {
        &self.spaces
    }

    /// Control points, m, row by row, first direction fastest.
    pub fn control_points(&self) -> &[[f64; 2]] {
        &self.control_points
    }

    /// Weights, in the order of the control points.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// What the patch may skip.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Largest extent of the control points from the first of them along x or y, m.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The same patch without a fast path.
    pub fn general(&self) -> Self {
        Self { form: Form::Rational, ..self.clone() }
    }

    /// Span of the parameters in each direction; `None` outside.
    pub fn find_span(&self, parameters: [f64; 2]) -> Option<[usize; 2]> {
        Some([self.spaces[0].find_span(parameters[0])?, self.spaces[1].find_span(parameters[1])?])
    }

    /// Basis functions at `parameters`, which should lie in `span`.
    pub fn shape_functions(&self, span: [usize; 2], parameters: [f64; 2]) -> RationalFunctions {
        match self.form {
            Form::Affine { .. } | Form::Polynomial => functions::products(&self.spaces, span, parameters),
            Form::Rational => rational_functions(&self.spaces, &self.weights, span, parameters),
        }
    }

    /// The image of a pair of parameters, and the weight function `W = Σ N_b w_b` with its parametric
    /// gradient.
    pub(crate) fn image(&self, span: [usize; 2], parameters: [f64; 2]) -> (MapPoint, PointValue) {
        let products = functions::products(&self.spaces, span, parameters);
        let (rational, weight) = functions::weighted(products, &self.weights);
        let functions = if self.form == Form::Rational { rational } else { products };
        (self.map(&functions), weight)
    }

    /// Position and Jacobian where `functions` were evaluated.
    pub fn map(&self, functions: &RationalFunctions) -> MapPoint {
        match self.form {
            Form::Affine { origin, slope } => MapPoint {
                position: [0, 1].map(|d| origin[d] + slope[d] * functions.parameters[d]),
                jacobian: [[slope[0], 0.0], [0.0, slope[1]]],
            },
            Form::Polynomial | Form::Rational => MapPoint::sum(functions, &self.control_points),
        }
    }

    /// Homogeneous control points (w x, w y, w), as splines without division see them.
    fn homogeneous(&self) -> Vec<[f64; 3]> {
        self.control_points.iter().zip(&self.weights).map(|(p, &w)| [w * p[0], w * p[1], w]).collect()
    }

    /// This patch after a change of one direction: `change` maps each line of homogeneous control points
    /// along it.
    fn with_direction_changed(
        &self,
        direction: usize,
        degree: usize,
        knots: &[f64],
        change: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]>,
    ) -> Result<Self, NurbsError> {
        let [columns, rows] = [0, 1].map(|d| self.spaces[d].dimension());
        let points = self.homogeneous();
        let lines: Vec<Vec<[f64; 3]>> = match direction {
            0 => points.chunks(columns).map(&change).collect(),
            _ => {
                (0..columns).map(|i| change(&(0..rows).map(|j| points[j * columns + i]).collect::<Vec<_>>())).collect()
            }
        };
        let new: Vec<[f64; 3]> = match direction {
            0 => lines.concat(),
            _ => (0..lines[0].len()).flat_map(|j| lines.iter().map(move |line| line[j])).collect(),
        };
        let mut degrees = [0, 1].map(|d| self.spaces[d].degree());
        degrees[direction] = degree;
        let mut vectors = [0, 1].map(|d| self.spaces[d].knot_vector());
        vectors[direction] = knots;
        let (control_points, weights) = match self.form {
            Form::Rational => new.iter().map(|&[x, y, w]| ([x / w, y / w], w)).unzip(),
            // The weights stay equal; keep them so in every bit.
            Form::Affine { .. } | Form::Polynomial => {
                let weight = self.weights[0];
                new.iter().map(|&[x, y, _]| ([x / weight, y / weight], weight)).unzip()
            }
        };
        Self::with_form(degrees, vectors, control_points, weights, self.form)
    }
}
