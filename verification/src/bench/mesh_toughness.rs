//! What a crack costs on a mesh: around a broken row of quadrature points the phase field is no better than
//! its functions, and the energy of a crack per length exceeds Gc by the factor `kappa = 1 + a h/l0`.
//!
//! `a` is fitted to the cost of one broken row of points, which `reference-data/derivations/crack_cost.py`
//! computes (AT2, Borden's convention; h/l0 from 1/4 to 1). A run with Gc/kappa pays Gc, and
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

    /// Costs of one broken row, as computed by the script beside it.
    const COSTS: &str = include_str!("../../../reference-data/derivations/crack-cost.csv");

    #[test]
    fn the_fit_gives_the_computed_costs() {
        let rows = COSTS.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse::<f64>().unwrap()));
        let mut compared = 0;
        for row in rows.map(Iterator::collect::<Vec<_>>) {
            let fitted = kappa(row[0] as usize, row[1] as usize, row[2]).filter(|_| (0.25..=1.0).contains(&row[2]));
            if let Some(fitted) = fitted {
                assert!((fitted - row[3]).abs() < 0.006, "{row:?}: {fitted}");
                compared += 1;
            }
        }
        assert_eq!(compared, 15, "three rules, five spans");
    }

    #[test]
    fn what_is_not_measured_has_no_factor() {
        assert_eq!(kappa(2, 2, 0.5), Some(1.06));
        assert_eq!((kappa(2, 3, 0.5), kappa(4, 4, 0.5)), (None, None));
    }
}
