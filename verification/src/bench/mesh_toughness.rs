//! What a crack costs on a mesh: around a broken row of quadrature points the phase field is no better than
//! its functions, and the energy of a crack per length exceeds Gc by the factor `kappa = 1 + a h/l0`.
//!
//! `a` is fitted to the minimum of `Σ w [(1 − c)²/(4 l0) + l0 c'²]` over the functions of a line with one
//! broken quadrature point (AT2, Borden's convention; h/l0 from 1/4 to 1). A run with Gc/kappa pays Gc, and
//! its error is no longer of first order in h. Codes of any method can do so, and in the comparison of
//! [`super::plate`] all of them do.

/// A discretisation, and `a` of its cracks.
struct Discretisation {
    degree: usize,
    points: usize,
    slope: f64,
}

/// Degree, quadrature points per span and direction, `a`. Bilinear elements are the first.
const MEASURED: [Discretisation; 3] = [
    Discretisation { degree: 1, points: 2, slope: 0.165 },
    Discretisation { degree: 2, points: 2, slope: 0.12 },
    Discretisation { degree: 3, points: 3, slope: 0.086 },
];

/// kappa for spans of `h` length scales with so many Gauss points per direction, if `a` is known.
pub fn kappa(degree: usize, points: usize, h: f64) -> Option<f64> {
    let found = MEASURED.iter().find(|d| (d.degree, d.points) == (degree, points))?;
    Some(1.0 + found.slope * h)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Energy of a crack over Gc on equal spans of piecewise linear functions with two Gauss points, one of
    /// which is broken: the minimum over the values at the nodes, by elimination from both far ends.
    fn cracked_line(h: f64) -> f64 {
        let (near, far) = (0.5 + 0.5 / 3f64.sqrt(), 0.5 - 0.5 / 3f64.sqrt());
        // Energy of a half line in d = 1 − c: the least of it is s d0²; s is a fixed point of one more span.
        let span = |s: f64| {
            let mass = |a: f64, b: f64| 0.5 * h / 4.0 * (a * a + b * b);
            let (own, mixed) = (mass(near, far) + 1.0 / h, 2.0 * 0.5 * h / 4.0 * near * far - 1.0 / h);
            own - mixed * mixed / (own + s)
        };
        let s = (0..10_000).fold(0.5, |s, _| span(s));
        // The broken span: near d0 + far d1 = 1 at its first Gauss point; half lines on either side.
        let energy = |d0: f64| {
            let d1 = (1.0 - near * d0) / far;
            let other = far * d0 + near * d1;
            s * (d0 * d0 + d1 * d1) + 0.5 * h / 4.0 * (1.0 + other * other) + (d1 - d0) * (d1 - d0) / h
        };
        // A parabola through three of its values.
        let [a, b, c] = [0.0, 1.0, 2.0].map(energy);
        let (second, first) = (0.5 * (a - 2.0 * b + c), 0.5 * (4.0 * b - 3.0 * a - c));
        a - first * first / (4.0 * second)
    }

    #[test]
    fn a_broken_gauss_point_of_linear_elements_costs_what_the_table_says() {
        for h in [1.0, 0.5, 0.25] {
            let (exact, table) = (cracked_line(h), kappa(1, 2, h).unwrap());
            assert!((exact - table).abs() < 0.005, "{exact}, table {table}, h = {h}");
        }
    }

    #[test]
    fn what_is_not_measured_has_no_factor() {
        assert_eq!(kappa(2, 2, 0.5), Some(1.06));
        assert_eq!((kappa(2, 3, 0.5), kappa(4, 4, 0.5)), (None, None));
    }
}
