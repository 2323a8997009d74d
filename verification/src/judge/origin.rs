//! Times that count from another moment than the one from which the load is on.
//!
//! Before the crack runs the body is elastic and its energies grow from rest, so a constant added to the
//! times shows as itself. It is told from a wrong load, which scales the energies, and has to agree with the
//! run as a whole.

use super::family::{FAMILY, Variant};
use super::mistakes::{Curves, ELASTIC, fit_load, pairs_at, window};
use super::submission::Submission;
use super::table::Curve;
use super::verdict::Finding;
use super::{FRACTURE, KINETIC};
use crate::extremes::larger;
use crate::output::history::format_number;
use crate::reference::{Library, ReferenceCurve};

/// Least and largest shift that is looked for, s, and the interval in which it is.
const LEAST: f64 = 0.25e-6;
const MOST: f64 = 20e-6;
const INTERVAL: f64 = 0.05e-6;
/// A run that starts under load is compared over at least so long from its start, s.
const AT_START: f64 = 4e-6;
/// A delay up to this may be half the time in which a load grows, s.
const RAMP: f64 = 2e-6;
/// Fewest times that are compared.
const FEWEST: usize = 8;
/// Relative rms of what is left when the shift is taken away; more by this part of what elements of the
/// spacing are off by.
const LEFT: f64 = 0.04;
const OF_MESH: f64 = 0.5;
/// What is left over what was there before, or over what is left with another load.
const BETTER: f64 = 0.5;
/// What may be left over the whole run; more by this times what elements of the spacing are off by.
const LEFT_OF_RUN: f64 = 0.06;
const OF_MESH_IN_RUN: f64 = 1.5;

/// A curve, its reference and its quantity.
type Energy<'a> = (&'a Curve, &'a ReferenceCurve, usize);

/// A constant in the times, and the curves without it. `mesh` is what elements of the spacing are off by.
pub(super) fn find(
    submission: &Submission,
    curves: &Curves,
    variant: &Variant<'_>,
    library: &Library,
    mesh: f64,
) -> Option<(Finding, Curves)> {
    let energies = energies(curves, variant);
    let (shift, rest) = nearest(&energies)?;
    let run = |shift: f64| left(&energies, shift, 1.0, |q| Some(window(q)));
    let (as_given, run_as_given) = (elastic(&energies, 0.0), run(0.0)?);
    let other_load = least_with_another_load(&energies, curves, library);
    let better = [as_given, other_load].iter().flatten().all(|other| rest < BETTER * other);
    let whole = run(shift)? < larger(BETTER * run_as_given, LEFT_OF_RUN + OF_MESH_IN_RUN * mesh);
    if shift.abs() < LEAST || !(better && rest < LEFT + OF_MESH * mesh && whole) {
        return None;
    }
    let time = submission.time.as_ref()?;
    let (when, load) = match shift {
        ..0.0 => ("ahead of", "the load is on before the time is 0".to_string()),
        ..=RAMP => ("behind", format!("a load that grows over some {:.1} µs looks the same", 2e6 * shift)),
        _ => ("behind", "the times start before the load".to_string()),
    };
    let unit = time.scale / time.factor;
    let text = format!(
        "the energies are {:.2} µs {when} those of the reference ({:.1} % off them otherwise, before the crack runs); there, the \
         whole load is on from t = 0: give the time offset = {} ({load})",
        1e6 * shift.abs(),
        100.0 * rest,
        format_number(rounded((time.offset - shift) / unit))
    );
    let mut right = curves.clone();
    right.iter_mut().flatten().for_each(|curve| curve.t.iter_mut().for_each(|t| *t -= shift));
    Some((Finding { id: "time-origin".into(), text }, right))
}

/// What is left before the crack runs with the constant in the times that fits best.
pub(super) fn least(curves: &Curves, variant: &Variant<'_>) -> Option<f64> {
    Some(nearest(&energies(curves, variant))?.1)
}

fn energies<'a>(curves: &'a Curves, variant: &Variant<'a>) -> Vec<Energy<'a>> {
    (KINETIC..=FRACTURE).filter_map(|q| Some((curves[q].as_ref()?, variant.curves[q]?, q))).collect()
}

/// The shift that fits best, and what is left with it.
fn nearest(energies: &[Energy<'_>]) -> Option<(f64, f64)> {
    let steps = (MOST / INTERVAL).round() as i32;
    let shifts = (-steps..=steps).map(|step| f64::from(step) * INTERVAL);
    shifts.filter_map(|s| Some((s, elastic(energies, s)?))).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// What is left before the crack runs. A run that starts under load lacks the first times of the reference.
fn elastic(energies: &[Energy<'_>], shift: f64) -> Option<f64> {
    let lacking = larger(-shift, 0.0);
    let window = [larger(ELASTIC[0], lacking), larger(ELASTIC[1], lacking + AT_START)];
    left(energies, shift, 1.0, |q| (q < FRACTURE).then_some(window))
}

/// A number with four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Relative rms over all energies between results, divided by `scale`, at the times t + shift and their
/// references at t, in the windows of the quantities.
fn left(energies: &[Energy<'_>], shift: f64, scale: f64, window: impl Fn(usize) -> Option<[f64; 2]>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for (curve, reference, quantity) in energies {
        let Some(window) = window(*quantity) else { continue };
        let pairs = pairs_at(curve, reference, window, shift);
        if pairs.len() < FEWEST {
            return None;
        }
        let square = pairs.iter().map(|(_, r)| r * r).sum::<f64>();
        sum += pairs.iter().map(|(y, r)| (y / scale - r).powi(2)).sum::<f64>() / square;
        count += 1.0;
    }
    Some((sum / count).sqrt()).filter(|left| left.is_finite())
}

/// What is left before the crack runs with the traction that fits best, of the declared model or another.
fn least_with_another_load(energies: &[Energy<'_>], curves: &Curves, library: &Library) -> Option<f64> {
    let (mut top, mut bottom) = (0.0, 0.0);
    for (curve, reference, _) in energies.iter().filter(|energy| energy.2 < FRACTURE) {
        let pairs = pairs_at(curve, reference, ELASTIC, 0.0);
        let square = pairs.iter().map(|(_, r)| r * r).sum::<f64>();
        top += pairs.iter().map(|(y, r)| y * r / square).sum::<f64>();
        bottom += 1.0;
    }
    let own = left(energies, 0.0, top / bottom, |q| (q < FRACTURE).then_some(ELASTIC));
    let variants = FAMILY.iter().filter_map(|declared| Variant::named(library, declared.name).ok());
    let others = variants.filter_map(|variant| Some(fit_load(curves, &variant)?.1));
    others.chain(own).min_by(f64::total_cmp)
}
