//! Events of the crack: onset, branching, right edge, largest speed.

use super::curves::{AGREES, EVENTS_DECIDE, Numerics, decide, doubt};
use super::family::{END, Variant};
use super::table::Curve;
use super::verdict::{Comparison, Outcome};
use super::{TIP_X, TIP_Y};
use crate::extremes::{larger, smaller};
use crate::measure::fitted_speed;
use crate::reference::Library;

/// Places at which the crack has started and has reached the right edge, m.
const PASSED: [f64; 2] = [50.5e-3, 99.5e-3];
/// Height of the initial crack in the benchmark, m.
pub(super) const AXIS: f64 = 20e-3;
/// Distance from it that counts as branched, m.
const OFF_AXIS: f64 = 0.25e-3;
/// Half width of the window in which a speed is fitted, s.
const SPEED_WINDOW: f64 = 2e-6;

/// What an event is called, its value in the reference, and its unit.
const EVENTS: [(&str, &str, &str); 6] = [
    ("onset: tip passes 50.5 mm", "onset-time", "s"),
    ("branching", "branching-time", "s"),
    ("place of branching", "branching-x", "m"),
    ("largest speed before branching", "largest-speed", "m/s"),
    ("right edge: tip passes 99.5 mm", "right-edge-time", "s"),
    ("distance from the axis there", "right-edge-offset", "m"),
];

/// The time at which a tip first passes `goal`, interpolated, and the row.
pub fn passes(tip: &Curve, goal: f64) -> Option<(f64, usize)> {
    let row = tip.y.iter().position(|x| *x >= goal)?;
    if row == 0 || !tip.y[row - 1].is_finite() {
        return Some((tip.t[row], row));
    }
    let weight = (goal - tip.y[row - 1]) / (tip.y[row] - tip.y[row - 1]);
    Some((tip.t[row - 1] + weight * (tip.t[row] - tip.t[row - 1]), row))
}

/// Values of all events, SI; none where it did not happen or cannot be told.
fn values(x: &Curve, y: Option<&Curve>, branching: Option<f64>) -> [Option<f64>; 6] {
    let y = y.filter(|y| y.t == x.t);
    let onset = passes(x, PASSED[0]);
    let running = onset.map_or(x.t.len(), |o| o.1);
    let off = y.and_then(|y| (running..x.t.len()).find(|&i| (y.y[i] - AXIS).abs() > OFF_AXIS && x.y[i].is_finite()));
    let end = off.map(|row| x.t[row]).or(branching).unwrap_or(END);
    let centers = x.t.iter().copied().filter(|t| *t >= SPEED_WINDOW && *t <= end - SPEED_WINDOW);
    let speeds = centers.map(|t| fitted_speed(&x.t, &x.y, t)).filter(|v| v.is_finite());
    let edge = passes(x, PASSED[1]);
    let offset = edge.zip(y).map(|((_, row), y)| (y.y[row] - AXIS).abs());
    [
        onset.map(|o| o.0),
        off.map(|row| x.t[row]),
        off.map(|row| x.y[row]),
        speeds.reduce(larger),
        edge.map(|e| e.0),
        offset.filter(|o| o.is_finite()),
    ]
}

/// Whether an event passes or fails at a spacing over l0; the onset always does.
pub(super) fn decides_at(words: &str, spacing: f64) -> bool {
    spacing <= EVENTS_DECIDE * (1.0 + 1e-9) || words == EVENTS[0].0
}

/// Verdicts on the events of the reference, and on branching where the reference does not branch.
pub fn events(
    curves: &[Option<Curve>; 6],
    variant: &Variant<'_>,
    numerics: &Numerics<'_>,
    library: &Library,
) -> Vec<Comparison> {
    let Some(x) = &curves[TIP_X] else { return Vec::new() };
    let y = curves[TIP_Y].as_ref();
    let found = values(x, y, variant.branching);
    let widest = x.t.windows(2).map(|pair| pair[1] - pair[0]).reduce(larger).unwrap_or(0.0);
    let interval = smaller(widest, END); // nothing is less certain than to within the run
    let last = x.t[x.t.len() - 1];
    let mut out = Vec::new();
    for ((words, event, unit), value) in EVENTS.into_iter().zip(found) {
        let named = library.value("plate-family", &format!("{}/{}", variant.declared.name, event));
        let mut row = Comparison { name: words.into(), unit: unit.into(), value, ..Comparison::default() };
        let Some(reference) = named else {
            if event == "branching-time" && value.is_some() {
                row.outcome = Outcome::Fail;
                row.why = "the crack branches; that of the reference does not".into();
                out.push(row);
            }
            continue;
        };
        row.reference = Some(reference.value);
        let needs_y = !["onset-time", "largest-speed", "right-edge-time"].contains(&event);
        if needs_y && y.is_none() {
            row.outcome = Outcome::Incomplete;
            row.why = "needs tip_y, at the times of tip_x".into();
            out.push(row);
            continue;
        }
        row.error = value.map(|v| v - reference.value);
        // what leaves the axis or the edge is known to a row only; the tip moves in between
        let between = match event {
            "onset-time" | "right-edge-time" => 0.5 * interval,
            "branching-time" => interval,
            "largest-speed" => 0.0,
            _ => {
                interval
                    * library
                        .value("plate-family", &format!("{}/largest-speed", variant.declared.name))
                        .map_or(0.0, |v| v.value)
            }
        };
        let column = format!("{}_{}", event.replace('-', "_"), unit.replace('/', "_per_"));
        let u_num = numerics.of_event(&column);
        let u_num = if between > 0.0 { Some(u_num.unwrap_or(0.0).hypot(between)) } else { u_num };
        decide(&mut row, reference.uncertainty.unwrap_or(0.0), u_num);
        let agrees = if unit == "m" { AGREES[1] } else { AGREES[0] * reference.value };
        doubt(&mut row, [f64::INFINITY, agrees]);
        let due = if event.starts_with("right-edge") { END } else { reference.value.min(END) };
        let late = unit == "s" && reference.value + row.u_val.unwrap_or(0.0) > last.min(due.max(END));
        if value.is_none() && late {
            (row.outcome, row.why) = (Outcome::Diagnostic, "not within the run, and it need not be".into());
        } else if value.is_none() && last >= 0.95 * END && unit == "s" {
            (row.outcome, row.why) = (Outcome::Fail, "it does not happen".into());
        } else if value.is_none() && event == "right-edge-offset" {
            (row.outcome, row.why) = (Outcome::Diagnostic, "the tip does not reach the edge".into());
        }
        let decides = numerics.spacing().is_none_or(|h| decides_at(words, h));
        if matches!(row.outcome, Outcome::Pass | Outcome::Fail) && !decides {
            (row.outcome, row.why) = (Outcome::Diagnostic, "spacings above l0/2 miss such events".into());
        }
        out.push(row);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_read_from_the_tip() {
        let t: Vec<f64> = (0..=80).map(|i| f64::from(i) * 1e-6).collect();
        let x = Curve { y: t.iter().map(|t| 0.05 + 900.0 * (t - 12e-6).max(0.0)).collect(), t: t.clone() };
        let y = Curve { y: t.iter().map(|t| if *t > 30.5e-6 { 0.021 } else { 0.02 }).collect(), t };
        let [onset, branching, place, speed, edge, offset] = values(&x, Some(&y), None).map(Option::unwrap);
        assert!((onset - (12e-6 + 0.5e-3 / 900.0)).abs() < 1e-12 && (branching - 31e-6).abs() < 1e-12);
        assert!((place - (0.05 + 900.0 * 19e-6)).abs() < 1e-9 && (speed - 900.0).abs() < 1e-6);
        assert!((edge - (12e-6 + 49.5e-3 / 900.0)).abs() < 1e-9 && (offset - 1e-3).abs() < 1e-12);
    }
}
