//! Measures on columns of the history.

use fisura::fault;
use fisura::material::elasticity::ElasticModuli;
use fisura::scene::Load;
use nalgebra::{DMatrix, DVector};

use super::tip::fitted_slope;
use super::{Measured, Run, column, position};
use crate::case::Check;
use crate::extremes::{self, larger};
use crate::record::{Reference, ReferenceKind};
use crate::reference::{Library, relative_rms, relative_uncertainty, rms_difference, rms_uncertainty};

/// Root mean square against a reference curve, relative or absolute. Curves of energy increments are compared
/// with increments.
pub(super) fn against_curve(name: &str, check: &Check, run: &Run, library: &Library) -> Result<Measured, String> {
    let path = check.reference.as_deref().ok_or("this measure needs reference = \"folder/quantity\"")?;
    let (folder, quantity) = path.split_once('/').ok_or("write reference = \"folder/quantity\"")?;
    let curve = library.curve(folder, quantity).ok_or_else(|| format!("no reference curve {path:?}"))?;
    let column = column(check)?;
    let values = if quantity.ends_with("increment") { run.increment(column)? } else { run.column(column)? };
    let [from, to] = check.window;
    let times = run.times()?;
    let (value, uncertainty) = if name == "relative-rms" {
        (relative_rms(curve, times, &values, from, to), relative_uncertainty(curve, from, to))
    } else {
        let uncertainty = rms_uncertainty(curve, from, to).map(|u| u * check.scale.abs());
        (rms_difference(curve, times, &values, from, to), uncertainty)
    };
    let reference = Some(Reference { uncertainty, ..Reference::new(None, curve.kind, &curve.label) });
    Ok(Measured { value, reference, ..Measured::default() })
}

/// Linear interpolation at the time `at`.
pub(super) fn value_at(check: &Check, run: &Run, increment: bool) -> Result<Option<f64>, String> {
    let (goal, times) = (position(check)?, run.times()?);
    let values = if increment { run.increment(column(check)?)? } else { run.column(column(check)?)? };
    let slack = 1e-9 * goal.abs();
    let Some(after) = times.iter().position(|&t| t >= goal - slack) else { return Ok(None) };
    if after == 0 {
        return Ok(Some(values[0]));
    }
    let s = (goal - times[after - 1]) / (times[after] - times[after - 1]);
    Ok(Some(values[after - 1] + s * (values[after] - values[after - 1])))
}

/// Slope of a straight line fitted over the window, per second.
pub(super) fn slope(check: &Check, run: &Run) -> Result<f64, String> {
    let (window, times, values) = (run.window(check)?, run.times()?, run.column(column(check)?)?);
    fitted_slope(window.map(|i| (times[i], values[i]))).ok_or_else(|| "the window contains only one sample".to_string())
}

/// Slope of a straight line fitted over the window against the place x of the tip, per metre.
pub(super) fn slope_over_tip(check: &Check, run: &Run) -> Result<f64, String> {
    let (window, tip, values) = (run.window(check)?, run.column("crack_tip_x_m")?, run.column(column(check)?)?);
    fitted_slope(window.map(|i| (tip[i], values[i]))).ok_or_else(|| "the tip stands still in the window".to_string())
}

/// Slope over the power `W sigma²/(rho c_d)` that two plane waves entering over the width W carry into
/// elastic energy.
pub(super) fn slope_over_plane_wave_power(check: &Check, run: &Run) -> Result<Measured, String> {
    let scene = run.scene;
    let body = scene.bodies.first().ok_or("no body")?;
    let material = &scene.materials[&body.material];
    let moduli = ElasticModuli::new(material, scene.analysis.plane);
    let (low, high) = body.shape.bounding_box();
    let Load::Stress([_, stress]) = &body.tractions.first().ok_or("no traction")?.load else {
        return Err("the first traction is no stress vector".to_string());
    };
    let impedance = material.density * moduli.dilatational_speed(material.density);
    let power = (high[0] - low[0]) * stress * stress / impedance * scene.analysis.thickness;
    let reference = Some(Reference::new(check.expect, ReferenceKind::Exact, "two plane waves: W sigma²/(rho c_d)"));
    Ok(Measured { value: Some(slope(check, run)? / power), reference, ..Measured::default() })
}

/// Largest |closure| over the largest energy of the run.
pub(super) fn closure(run: &Run) -> Result<f64, String> {
    let most = |name: &str| -> f64 { run.column(name).map_or(0.0, |c| extremes::largest(c.iter().map(|v| v.abs()))) };
    let scale = extremes::largest(["kinetic_j", "elastic_j", "fracture_j", "external_work_j"].map(most));
    let closure = fault!("closure-at-the-start", most("closure_j") => run.column("closure_j")?[0].abs());
    if scale > 0.0 { Ok(closure / scale) } else { Err("the run has no energy".to_string()) }
}

/// Largest departure from the first value, over the first value.
pub(super) fn drift(check: &Check, run: &Run) -> Result<f64, String> {
    let (window, values) = (run.window(check)?, run.column(column(check)?)?);
    let first = values[window.start];
    let off = |v: &f64| fault!("drift-upwards-only", (v - first).abs() => (v - first).max(0.0));
    Ok(extremes::largest(values[window].iter().map(off)) / first.abs())
}

/// Largest magnitude in the window.
pub(super) fn largest(check: &Check, run: &Run) -> Result<f64, String> {
    Ok(extremes::largest(run.column(column(check)?)?[run.window(check)?].iter().map(|v| v.abs())))
}

/// Time (s) and height of the peak in the window: a parabola fitted to the samples within `at` seconds of the
/// highest (its neighbours, if `at` is absent). A width beyond the ripples of a wave front makes the time of
/// a flat peak well defined. None if the highest stands at an end of the window: that is no peak.
pub(super) fn peak(check: &Check, run: &Run) -> Result<Option<(f64, f64)>, String> {
    let (times, values) = (run.times()?, run.column(column(check)?)?);
    let Ok(window) = run.window(check) else { return Ok(None) };
    let Some(top) = window.clone().max_by(|&a, &b| values[a].total_cmp(&values[b])) else { return Ok(None) };
    if top == window.start || top + 1 >= window.end {
        return Ok(None);
    }
    let step = times[top + 1] - times[top];
    let half_width = check.at.unwrap_or(step).max(step) * (1.0 + 1e-9);
    let near = (0..times.len()).filter(|&i| (times[i] - times[top]).abs() <= half_width);
    let rows: Vec<[f64; 2]> = near.map(|i| [(times[i] - times[top]) / step, values[i]]).collect();
    let matrix = DMatrix::from_fn(rows.len(), 3, |i, power| rows[i][0].powi(power as i32));
    let heights = DVector::from_iterator(rows.len(), rows.iter().map(|row| row[1]));
    let Ok(fit) = matrix.svd(true, true).solve(&heights, 1e-12) else { return Ok(None) };
    if fit[2] >= 0.0 {
        return Ok(None);
    }
    let shift = -0.5 * fit[1] / fit[2];
    Ok(Some((times[top] + shift * step, fit[0] + 0.5 * fit[1] * shift)))
}

/// Largest fall of a column from one row to the next.
pub(super) fn largest_fall(check: &Check, run: &Run) -> Result<f64, String> {
    let values = run.column(column(check)?)?;
    Ok(values.windows(2).map(|pair| pair[0] - pair[1]).fold(0.0, larger))
}

/// Mean over the window with the weight sin², which vanishes at both of its ends: the mean of an oscillation,
/// without knowing its period.
pub(super) fn smooth_mean(check: &Check, run: &Run) -> Result<f64, String> {
    let (times, values, window) = (run.times()?, run.column(column(check)?)?, run.window(check)?);
    let (first, last) = (times[window.start], times[window.end - 1]);
    let [from, to] = [check.window[0].max(first), check.window[1].min(last)];
    let weight = |time: f64| (std::f64::consts::PI * (time - from) / (to - from)).sin().powi(2);
    let sums = window.map(|i| [weight(times[i]), weight(times[i]) * values[i]]);
    let [weights, sum] = sums.fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
    if weights > 0.0 { Ok(sum / weights) } else { Err("too few samples lie between from and to".to_string()) }
}

/// Slope of the straight line through zero at t = 0 that is nearest over the window, per second.
pub(super) fn slope_from_zero(check: &Check, run: &Run) -> Result<f64, String> {
    let (times, values, window) = (run.times()?, run.column(column(check)?)?, run.window(check)?);
    let sums = window.map(|i| [times[i] * values[i], times[i] * times[i]]);
    let [moment, square] = sums.fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
    if square > 0.0 { Ok(moment / square) } else { Err("no sample lies after t = 0".to_string()) }
}

/// Largest fall of a column below an earlier value, over its largest value.
pub(super) fn largest_decrease(check: &Check, run: &Run) -> Result<f64, String> {
    let values = run.column(column(check)?)?;
    let (mut highest, mut fall) = (f64::NEG_INFINITY, 0.0_f64);
    for value in values {
        highest = fault!("fall-from-the-last-row", larger(highest, value) => value);
        fall = larger(fall, highest - value);
    }
    Ok(fall / highest.abs())
}

/// Largest difference of a column from that of the variant `against`, over the largest magnitude of the
/// latter, at equal times.
pub(super) fn difference(check: &Check, run: &Run, runs: &[Run]) -> Result<f64, String> {
    let name = check.against.as_deref().ok_or("this measure needs against = \"variant\"")?;
    let other = runs.iter().find(|r| r.name == name).ok_or_else(|| format!("no variant {name:?}"))?;
    let (values, others) = (run.column(column(check)?)?, other.column(column(check)?)?);
    let (times, other_times) = (run.times()?, other.times()?);
    if values.len() != others.len() || times.iter().zip(other_times).any(|(a, b)| (a - b).abs() > 1e-9 * a.abs()) {
        return Err("the two variants have different sample times".to_string());
    }
    let scale = extremes::largest(others.iter().map(|v| v.abs()));
    let apart = |(a, b): (&f64, &f64)| fault!("difference-upwards-only", (a - b).abs() => (a - b).max(0.0));
    Ok(extremes::largest(values.iter().zip(&others).map(apart)) / scale)
}

/// Largest principal stress in the middle of the mesh, Pa: mean over the frames, weighted with the square of
/// a sine that vanishes at both ends of the run, which takes the mean of an oscillation without knowing its
/// period.
pub(super) fn stress_in_the_middle(run: &Run) -> Result<f64, String> {
    let end = *run.times()?.last().ok_or("an empty history")?;
    let (mut sum, mut weights) = (0.0, 0.0);
    for frame in run.frames {
        let weight = (std::f64::consts::PI * frame.time / end).sin().powi(2);
        let [columns, rows] = frame.pixels;
        sum += weight * frame.stress[rows / 2 * columns + columns / 2];
        weights += weight;
    }
    if weights > 0.0 { Ok(sum / weights) } else { Err("no frame lies within the run".to_string()) }
}

/// Order at which a quantity falls with the time step over the variants: slope of log closure against log dt.
pub(super) fn order_in_step(check: &Check, runs: &[Run]) -> Result<Option<f64>, String> {
    let mut points = Vec::new();
    for run in runs {
        let step = *run.column("time_step_s")?.last().ok_or("an empty history")?;
        points.push((step.ln(), largest(check, run)?.ln()));
    }
    Ok(fitted_slope(points.into_iter()))
}
