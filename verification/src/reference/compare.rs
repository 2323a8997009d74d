//! Distances between a result and a reference curve.
//!
//! Both are taken over the reference's own abscissae x_i in [from, to], with reference ordinates r_i and the
//! result y interpolated linearly to x_i:
//!
//! - [`relative_rms`]: sqrt( Σ (y(x_i) − r_i)² / Σ r_i² ), the rms difference over the rms of the reference;
//! - [`rms_difference`]: sqrt( Σ (y(x_i) − r_i)² / n ), in the units of the ordinate.
//!
//! A result that does not reach all those abscissae, or is not a number there, has no distance (`None`), so
//! that a run that ended early cannot pass.

use fisura::fault;

use super::ReferenceCurve;
use super::curve::{blend, bracket};

/// sqrt( Σ (y − r)² / Σ r² ) over the reference's abscissae in [from, to]; SI in, a plain number out.
///
/// `None` if the reference has no point in [from, to] or is zero there, or if the result (abscissae `x`
/// increasing) does not cover its points.
///
/// # Panics
/// If `x` and `y` differ in length.
pub fn relative_rms(reference: &ReferenceCurve, x: &[f64], y: &[f64], from: f64, to: f64) -> Option<f64> {
    let pairs = pairs(reference, x, y, from, to)?;
    let scale: f64 = pairs.iter().map(|(_, r)| r * r).sum();
    let mean =
        fault!("curves-compared-by-their-mean", squares(&pairs) => pairs.iter().map(|(y, r)| y - r).sum::<f64>().abs());
    (scale > 0.0).then(|| (mean / scale).sqrt())
}

/// sqrt( Σ (y − r)² / n ) over the reference's abscissae in [from, to]; SI in, SI out.
///
/// `None` if the reference has no point in [from, to], or if the result (abscissae `x` increasing) does not
/// cover them.
///
/// # Panics
/// If `x` and `y` differ in length.
pub fn rms_difference(reference: &ReferenceCurve, x: &[f64], y: &[f64], from: f64, to: f64) -> Option<f64> {
    let pairs = pairs(reference, x, y, from, to)?;
    Some((squares(&pairs) / pairs.len() as f64).sqrt())
}

/// The uncertainty of the reference in the norm of [`relative_rms`]: the distance of a result that is off by
/// it everywhere.
///
/// `None` if the reference has no point in [from, to], is zero there, or if none is known.
pub fn relative_uncertainty(reference: &ReferenceCurve, from: f64, to: f64) -> Option<f64> {
    let rows = rows(reference, from, to);
    let scale = root_of_squares(rows.iter().map(|&i| reference.y[i]));
    let size = root_of_squares(rows.iter().map(|&i| reference.uncertainty_at_row(i)));
    (scale > 0.0 && size > 0.0).then(|| size / scale)
}

/// The uncertainty of the reference in the norm of [`rms_difference`]; SI, `None` as
/// [`relative_uncertainty`].
pub fn rms_uncertainty(reference: &ReferenceCurve, from: f64, to: f64) -> Option<f64> {
    let rows = rows(reference, from, to);
    let size = root_of_squares(rows.iter().map(|&i| reference.uncertainty_at_row(i)));
    (size > 0.0).then(|| size / (rows.len() as f64).sqrt())
}

fn root_of_squares(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|v| v * v).sum::<f64>().sqrt()
}

/// Rows of the reference in [from, to], whose ends are stretched by 1e-9 of the larger one.
fn rows(reference: &ReferenceCurve, from: f64, to: f64) -> Vec<usize> {
    let slack = 1e-9 * from.abs().max(to.abs());
    (0..reference.x.len()).filter(|&i| (from - slack..=to + slack).contains(&reference.x[i])).collect()
}

fn squares(pairs: &[(f64, f64)]) -> f64 {
    pairs.iter().map(|(y, r)| (y - r) * (y - r)).sum()
}

/// Result and reference at the reference's abscissae in [from, to]. The ends of the window and of the result
/// are stretched by 1e-9 of the largest abscissa, so that a sum of time steps that ends a round-off short
/// still covers them.
fn pairs(reference: &ReferenceCurve, x: &[f64], y: &[f64], from: f64, to: f64) -> Option<Vec<(f64, f64)>> {
    assert_eq!(x.len(), y.len(), "one ordinate per abscissa");
    let slack = 1e-9 * from.abs().max(to.abs());
    let (first, last) = (*x.first()?, *x.last()?);
    let rows = reference.x.iter().zip(&reference.y).filter(|(t, _)| (from - slack..=to + slack).contains(*t));
    let pairs = rows
        .map(|(&t, &r)| {
            let inside = (first - slack..=last + slack).contains(&t);
            let (i, weight) = bracket(x, if inside { t.clamp(first, last) } else { t })?;
            let value = blend(y, i, weight);
            value.is_finite().then_some((value, r))
        })
        .collect::<Option<Vec<_>>>()?;
    (!pairs.is_empty()).then_some(pairs)
}
