//! What a crack costs on a mesh: around a broken row of quadrature points the phase field is no better than
//! its functions, and the energy of a crack per length exceeds Gc by the factor `kappa = 1 + a h/l0`.
//!
//! `a` is fitted to the cost of one broken row of points, which `reference-data/derivations/crack_cost.py`
//! computes (AT2, Borden's convention; h/l0 from 1/4 to 1). A run with Gc/kappa pays Gc, and its error is no
//! longer of first order in h.

use crate::scene::{Body, CrackModel, Fracture, Layout};

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

/// Degree and points per direction of a body, if the cost of its cracks on a mesh of this degree is known.
pub fn rule(fracture: &Fracture, [p, q]: [usize; 2], body: &Body) -> Option<[usize; 2]> {
    let [nx, ny] = body.particles_per_cell;
    let is_plain = fracture.model == CrackModel::At2 && fracture.anisotropy.is_none() && body.layout == Layout::Gauss;
    (is_plain && p == q && nx == ny && kappa(p, nx, 0.0).is_some()).then_some([p, nx])
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
