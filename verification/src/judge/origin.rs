//! Times that count from another moment than the one from which the load is on.
//!
//! Before the crack runs the body is elastic and its energies grow from rest, so a constant added to the
//! times shows as itself. It is told from a wrong load, which scales the energies, and has to agree with the
//! run as a whole.

use super::family::{FAMILY, Variant};
use super::mistakes::{Curves, fit_load, pairs_at, window};
use super::submission::Submission;
use super::table::Curve;
use super::verdict::Finding;
use super::{FRACTURE, KINETIC};
use crate::extremes::larger;
use crate::reference::{Library, ReferenceCurve};

/// Least and largest shift that is looked for, s, and the interval in which it is.
const LEAST: f64 = 0.25e-6;
const MOST: f64 = 20e-6;
const INTERVAL: f64 = 0.05e-6;
/// In which the energies of the reference are compared, s: from rest to the crack.
const ELASTIC: [f64; 2] = [2e-6, 12e-6];
/// Relative rms of what is left when the shift is taken away; more by this part of what elements of the
/// spacing are off by.
const LEFT: f64 = 0.04;
const OF_MESH: f64 = 0.5;
/// What is left over what was there before, or over what is left with another load.
const BETTER: f64 = 0.5;
/// What may be left over the whole run; more by this times what elements of the spacing are off by.
const LEFT_OF_RUN: f64 = 0.06;
const OF_MESH_IN_RUN: f64 = 1.5;

/// A constant in the times, and the curves without it. `mesh` is what elements of the spacing are off by.
pub(super) fn find(
    submission: &Submission,
    curves: &Curves,
    variant: &Variant<'_>,
    library: &Library,
    mesh: f64,
) -> Option<(Finding, Curves)> {
    let energies: Vec<(&Curve, &ReferenceCurve, usize)> =
        (KINETIC..=FRACTURE).filter_map(|q| Some((curves[q].as_ref()?, variant.curves[q]?, q))).collect();
    let elastic = |shift: f64| left(&energies, shift, 1.0, |q| (q < FRACTURE).then(|| from_rest(shift)));
    let run = |shift: f64| left(&energies, shift, 1.0, |q| Some(window(q)));
    let steps = (MOST / INTERVAL).round() as i32;
    let shifts = (-steps..=steps).map(|step| f64::from(step) * INTERVAL);
    let (shift, rest) = shifts.filter_map(|s| Some((s, elastic(s)?))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (before, run_before, run_rest) = (elastic(0.0)?, run(0.0)?, run(shift)?);
    let other_load = least_with_another_load(&energies, curves, library);
    let better = rest < BETTER * before && rest < BETTER * other_load && rest < LEFT + OF_MESH * mesh;
    let whole = run_rest < larger(BETTER * run_before, LEFT_OF_RUN + OF_MESH_IN_RUN * mesh);
    if shift.abs() < LEAST || !(better && whole) {
        return None;
    }
    let time = submission.time.as_ref()?;
    let (when, load) = if shift > 0.0 {
        ("late", format!("a load that grows over some {:.1} µs looks the same", 2e6 * shift))
    } else {
        ("early", "the load is on before the time is 0".to_string())
    };
    let text = format!(
        "the run is {:.2} µs {when}: before the crack runs, the energies are {:.1} % off those of the reference, and {:.1} % \
         without that; the benchmark has the whole load from t = 0: give the time offset = {:.4} ({load})",
        1e6 * shift.abs(),
        100.0 * before,
        100.0 * rest,
        (time.offset - shift) * time.factor / time.scale
    );
    let mut right = curves.clone();
    right.iter_mut().flatten().for_each(|curve| curve.t.iter_mut().for_each(|t| *t -= shift));
    Some((Finding { id: "time-origin".into(), text }, right))
}

/// Times of the reference that are compared before the crack runs; a run that starts under load lacks the
/// first of them.
fn from_rest(shift: f64) -> [f64; 2] {
    let lacking = larger(-shift, 0.0);
    [larger(ELASTIC[0], lacking), ELASTIC[1] + lacking]
}

/// Relative rms over all energies between results, divided by `scale`, at the times t + shift and their
/// references at t, in the windows of the quantities.
fn left(
    energies: &[(&Curve, &ReferenceCurve, usize)],
    shift: f64,
    scale: f64,
    window: impl Fn(usize) -> Option<[f64; 2]>,
) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for (curve, reference, quantity) in energies {
        let Some(window) = window(*quantity) else { continue };
        let pairs = pairs_at(curve, reference, window, shift);
        if pairs.len() < 10 {
            return None;
        }
        let square = pairs.iter().map(|(_, r)| r * r).sum::<f64>();
        sum += pairs.iter().map(|(y, r)| (y / scale - r).powi(2)).sum::<f64>() / square;
        count += 1.0;
    }
    Some((sum / count).sqrt()).filter(|left| left.is_finite())
}

/// What is left before the crack runs with the traction that fits best, of the declared model or another.
fn least_with_another_load(
    energies: &[(&Curve, &ReferenceCurve, usize)],
    curves: &Curves,
    library: &Library,
) -> f64 {
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
    others.chain(own).min_by(f64::total_cmp).unwrap_or(f64::INFINITY)
}
