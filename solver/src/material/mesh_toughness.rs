//! What a crack costs on a mesh: around a broken row of quadrature points the phase field is no better than
//! its functions, and the energy of a crack per length exceeds Gc by the factor `kappa = 1 + a h/l0`.
//!
//! With AT2 `a` is fitted to the cost of one broken row of points, which
//! `reference-data/derivations/crack_cost.py` computes (Borden's convention for l0; h/l0 from 1/4 to 1). With
//! AT1 control values lie between 0 and 1, and a row costs more the harder it is driven. There p = 1 has the
//! `3 h/(8 b)` of an element with c = 0 (Bourdin et al. 2008; b = 2 l0), and p = 2 what makes the speed of a
//! crack in a strip and the times of the test of Kalthoff and Winkler independent of the mesh: both lie
//! between the costs of a row with 1e3 times the energy of the threshold, and without a limit. A run with
//! Gc/kappa pays Gc, and its error is no longer of first order in h.

use crate::scene::{Body, CrackModel, Fracture, Layout};

/// `a` of a model, a degree, and quadrature points per span and direction. Those with p = 1 are bilinear
/// elements.
const MEASURED: [(CrackModel, usize, usize, f64); 5] = [
    (CrackModel::At2, 1, 2, 0.165),
    (CrackModel::At2, 2, 2, 0.12),
    (CrackModel::At2, 3, 3, 0.086),
    (CrackModel::At1, 1, 2, 3.0 / 16.0),
    (CrackModel::At1, 2, 2, 0.15),
];

/// `a` of kappa with so many Gauss points per direction, if it is known.
pub fn slope(model: CrackModel, degree: usize, points: usize) -> Option<f64> {
    MEASURED.iter().find(|known| (known.0, known.1, known.2) == (model, degree, points)).map(|known| known.3)
}

/// `a` of the cracks of a body on a mesh of this degree, if it is known.
pub fn slope_in(fracture: &Fracture, [p, q]: [usize; 2], body: &Body) -> Option<f64> {
    let [nx, ny] = body.particles_per_cell;
    let is_plain = fracture.anisotropy.is_none() && body.layout == Layout::Gauss && p == q && nx == ny;
    slope(fracture.model, p, nx).filter(|_| is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Costs of one broken row, as computed by the script beside them.
    const AT2: &str = include_str!("../../../reference-data/derivations/crack-cost.csv");
    const AT1: &str = include_str!("../../../reference-data/derivations/crack-cost-at1.csv");

    /// kappa and the row of the table, for rules that have it and h/l0 in a range.
    fn compared(model: CrackModel, costs: &str, range: [f64; 2]) -> Vec<(f64, Vec<f64>)> {
        let rows = costs.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse::<f64>().unwrap()));
        let rows = rows.map(Iterator::collect::<Vec<_>>).filter(|row| (range[0]..=range[1]).contains(&row[2]));
        rows.filter_map(|row| Some((1.0 + row[2] * slope(model, row[0] as usize, row[1] as usize)?, row))).collect()
    }

    #[test]
    fn the_fit_gives_the_computed_costs() {
        let rows = compared(CrackModel::At2, AT2, [0.25, 1.0]);
        assert_eq!(rows.len(), 15, "three rules, five spans");
        assert!(rows.iter().all(|(kappa, row)| (kappa - row[3]).abs() < 0.006), "{rows:?}");
        let rows = compared(CrackModel::At1, AT1, [0.5, 2.0]);
        assert_eq!(rows.len(), 10, "two rules, five spans");
        assert!(rows.iter().all(|(kappa, row)| row[3] < *kappa && *kappa < row[5]), "{rows:?}");
    }

    #[test]
    fn what_is_not_measured_has_no_factor() {
        assert_eq!(slope(CrackModel::At2, 2, 2), Some(0.12));
        assert_eq!((slope(CrackModel::At2, 2, 3), slope(CrackModel::At1, 4, 4)), (None, None));
    }
}
