//! Rational basis functions, their gradients, and what the geometry map makes of them:
//! `R_a = N_a w_a / W` and `∂R_a = (w_a ∂N_a − R_a ∂W) / W` with `W = Σ N_b w_b`.

use crate::splines::spline::{MAX_FUNCTIONS, SplineSpace};

/// The basis functions that live at a pair of parameters; entries past `count` are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RationalFunctions {
    /// Parameters they were evaluated at.
    pub parameters: [f64; 2],
    /// Number of functions, (p + 1) (q + 1).
    pub count: usize,
    /// Index of the control point of each.
    pub control: [usize; MAX_FUNCTIONS],
    /// Values of the functions.
    pub value: [f64; MAX_FUNCTIONS],
    /// Parametric gradients, 1/unit of the knots.
    pub gradient: [[f64; 2]; MAX_FUNCTIONS],
}

impl RationalFunctions {
    /// Physical gradients, 1/m, for the Jacobian at the same place; not finite where its determinant is zero.
    pub fn physical_gradients(&self, point: &MapPoint) -> [[f64; 2]; MAX_FUNCTIONS] {
        let [[xu, xv], [yu, yv]] = point.jacobian;
        let scale = 1.0 / point.determinant();
        let mut physical = [[0.0; 2]; MAX_FUNCTIONS];
        for n in 0..self.count {
            let [u, v] = self.gradient[n];
            let [yu, xv] = fault!("inverse-map-transposed", [yu, xv] => [xv, yu]);
            physical[n] = [(yv * u - yu * v) * scale, (xu * v - xv * u) * scale];
        }
        physical
    }

    /// Interpolation of control values.
    pub fn interpolate(&self, field: &[f64]) -> f64 {
        (0..self.count).map(|n| self.value[n] * field[self.control[n]]).sum()
    }
}

/// Image of a pair of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPoint {
    /// Position x(ξ) of the image, m.
    pub position: [f64; 2],
    /// `jacobian[i][d]` = ∂x_i/∂ξ_d.
    pub jacobian: [[f64; 2]; 2],
}

impl MapPoint {
    /// Sums over control points.
    pub(super) fn sum(functions: &RationalFunctions, control_points: &[[f64; 2]]) -> Self {
        let mut point = Self { position: [0.0; 2], jacobian: [[0.0; 2]; 2] };
        for n in 0..functions.count {
            let control = control_points[functions.control[n]];
            for i in 0..2 {
                point.position[i] += functions.value[n] * control[i];
                for d in 0..2 {
                    point.jacobian[i][d] += functions.gradient[n][d] * control[i];
                }
            }
        }
        point
    }

    /// Determinant of the Jacobian; positive where the geometry is not folded.
    pub fn determinant(&self) -> f64 {
        let [[xu, xv], [yu, yv]] = self.jacobian;
        xu * yv - xv * yu
    }
}

/// A scalar field and its gradient at a position.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PointValue {
    /// Value of the field.
    pub value: f64,
    /// Gradient, 1/m; of a function of parameters, 1/unit of the knots.
    pub gradient: [f64; 2],
}

/// Products of the B-splines of two directions: the basis of a patch with equal weights.
pub(crate) fn products(spaces: &[SplineSpace; 2], span: [usize; 2], parameters: [f64; 2]) -> RationalFunctions {
    let [x, y] = spaces;
    let (sx, sy) = (x.shape_functions(span[0], parameters[0]), y.shape_functions(span[1], parameters[1]));
    let (first_column, first_row) = (x.spans()[span[0]].first, y.spans()[span[1]].first);
    let columns = x.dimension();
    let mut functions = RationalFunctions {
        parameters,
        count: 0,
        control: [0; MAX_FUNCTIONS],
        value: [0.0; MAX_FUNCTIONS],
        gradient: [[0.0; 2]; MAX_FUNCTIONS],
    };
    for l in 0..=y.degree() {
        for k in 0..=x.degree() {
            let n = functions.count;
            functions.control[n] = (first_row + l) * columns + first_column + k;
            functions.value[n] = sx.value[k] * sy.value[l];
            functions.gradient[n] = [sx.derivative[k] * sy.value[l], sx.value[k] * sy.derivative[l]];
            functions.count += 1;
        }
    }
    functions
}

/// Rational basis functions of `weights` (positive, first direction fastest) at `parameters`, which should
/// lie in `span`.
///
/// The basis needs no geometry; [`NurbsPatch::shape_functions`](super::NurbsPatch::shape_functions) is the
/// way in for a patch.
///
/// # Panics
/// If there are fewer weights than basis functions.
pub fn rational_functions(
    spaces: &[SplineSpace; 2],
    weights: &[f64],
    span: [usize; 2],
    parameters: [f64; 2],
) -> RationalFunctions {
    weighted(products(spaces, span, parameters), weights).0
}

/// The rational functions of some products, and the weight function they were divided by with its parametric
/// gradient.
pub(super) fn weighted(products: RationalFunctions, weights: &[f64]) -> (RationalFunctions, PointValue) {
    let mut functions = products;
    let (mut sum, mut slope) = (0.0, [0.0; 2]);
    for n in 0..functions.count {
        let weight = weights[functions.control[n]];
        functions.value[n] *= weight;
        sum += functions.value[n];
        for d in 0..2 {
            functions.gradient[n][d] *= weight;
            slope[d] += functions.gradient[n][d];
        }
    }
    let scale = 1.0 / sum;
    for n in 0..functions.count {
        functions.value[n] *= scale;
        for d in 0..2 {
            let of_weight = fault!("quotient-rule-forgotten", functions.value[n] * slope[d] => 0.0);
            functions.gradient[n][d] = (functions.gradient[n][d] - of_weight) * scale;
        }
    }
    (functions, PointValue { value: sum, gradient: slope })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn one_weight_pulls_as_the_textbook_says() {
        // Quadratic Bernstein with weights 1, 2, 1 at 1/2: values 1/4, 1, 1/4 over 3/2; linear with equal
        // weights across.
        let spaces = [SplineSpace::new(2, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), SplineSpace::new(1, &[0.0, 0.0, 1.0, 1.0])];
        let weights = [1.0, 2.0, 1.0, 1.0, 2.0, 1.0];
        let functions = rational_functions(&spaces, &weights, [0, 0], [0.5, 0.25]);
        assert_eq!(functions.count, 6);
        for (n, expected) in [1.0, 4.0, 1.0].into_iter().enumerate() {
            assert_abs_diff_eq!(functions.value[n], 0.75 * expected / 6.0, epsilon = 1e-15);
            assert_abs_diff_eq!(functions.value[n + 3], 0.25 * expected / 6.0, epsilon = 1e-15);
        }
        // d/dξ (1 − ξ)²/W at 1/2, where W' = 0: −1/W = −2/3.
        assert_abs_diff_eq!(functions.gradient[0][0], -0.75 * 2.0 / 3.0, epsilon = 1e-15);
        assert_abs_diff_eq!(functions.gradient[1][0], 0.0, epsilon = 1e-15);
        assert_abs_diff_eq!(functions.gradient[1][1], -4.0 / 6.0, epsilon = 1e-15);
    }
}
