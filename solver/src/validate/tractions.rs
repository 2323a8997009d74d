//! Checks of tractions, of the edges of loads and conditions, which lie on their body, and of factors over
//! time.

use std::f64::consts::TAU;

use super::ground::{Findings, Look, TOLERANCE, side_name};
use crate::dynamics::surface::curve_of;
use crate::scene::edges::{BESIDE, beside};
use crate::scene::time::{Course, TimeFactor};
use crate::scene::{Edge, Load, Shape, Traction};

/// Intervals between the positions at which an edge is looked at.
const INTERVALS: usize = 32;

const ON_BOUNDARY: &str = "give an edge of which every point lies on the body's boundary; the faces of a slit carry no load: \
                           cut a notch";

/// Times at which a formula is looked at, of the simulated time.
const LOOKS: usize = 1000;

pub(super) fn check(key: &str, traction: &Traction, look: &Look<'_>, findings: &mut Findings) {
    match &traction.load {
        Load::Stress(stress) => drop(findings.finite(format!("{key}.stress"), stress)),
        Load::Pressure(pressure) => drop(findings.finite(format!("{key}.pressure"), &[*pressure])),
        Load::Field(_) => {} // whether it is finite where it acts is seen when the run begins
    }
    factor(&format!("{key}.time"), &traction.time, look.end_time, findings);
    if traction.time.range(look.end_time) == [0.0; 2] && traction.time.integral(look.end_time) == 0.0 {
        findings.warn(format!("{key}.time"), "the factor is zero until end_time: this load never acts");
    }
    edge(key, &traction.edge, traction.load.has_side(), look, findings);
}

/// An edge lies on the boundary of its body. What acts there needs a side if it has no meaning between
/// material on both sides.
pub(super) fn edge(key: &str, edge: &Edge, needs_side: bool, look: &Look<'_>, findings: &mut Findings) {
    let form = match edge {
        Edge::Side(_) => "edge",
        Edge::Segment(_) => "segment",
        Edge::Arc { .. } => "arc",
    };
    let key = format!("{key}.{form}");
    match edge {
        Edge::Side(_) if look.body.shape == Shape::Patch => {}
        _ if look.ground.mesh.geometry.is_some() => {
            let remedy = "give the body shape = \"patch\" and edge = \"left\", \"right\", \"bottom\" or \"top\"";
            let message = "on a patch with control_points or annulus only its sides can be loaded";
            findings.error(key, message, remedy);
        }
        Edge::Side(_) if matches!(look.body.shape, Shape::Rectangle { .. }) => {}
        Edge::Side(side) => {
            let message = format!("only a rectangle has a {} side", side_name(*side));
            findings.error(key, message, "give segment = [[x0, y0], [x1, y1]] instead");
        }
        Edge::Segment(ends) if ends[0] == ends[1] => {
            findings.error(key, "a segment of zero length", "give two different ends");
        }
        Edge::Segment(ends) if findings.finite(key.clone(), &ends.concat()) => {
            on_boundary(key, form, edge, needs_side, look, findings);
        }
        Edge::Arc { center, radius, angles } if is_arc(&key, *center, *radius, *angles, findings) => {
            on_boundary(key, form, edge, true, look, findings);
        }
        Edge::Segment(_) | Edge::Arc { .. } => {} // said already
    }
}

fn is_arc(key: &str, center: [f64; 2], radius: f64, angles: [f64; 2], findings: &mut Findings) -> bool {
    let swept = angles[1] - angles[0];
    let sound = findings.finite(key, &[center, angles].concat())
        && findings.positive(format!("{key}.radius"), radius, "radius = \"10 mm\"");
    let turns = swept > 0.0 && swept <= TAU * (1.0 + TOLERANCE);
    if sound && !turns {
        let remedy = "give two angles that increase by at most 360 degrees";
        findings.error(format!("{key}.angles"), format!("an arc of {:.6} degrees", swept.to_degrees()), remedy);
    }
    sound && turns
}

/// A curve lies on the boundary of its body, with material on one side.
fn on_boundary(key: String, form: &str, edge: &Edge, needs_side: bool, look: &Look<'_>, findings: &mut Findings) {
    let (body, (curve, [from, to])) = (look.body, curve_of(look.body, edge));
    let even = |part: f64| from + (to - from) * part / INTERVALS as f64;
    let ends = (0..=INTERVALS).map(|i| even(i as f64));
    let met = curve.places_met(&body.shape.edges(), [from, to]);
    let parts = met.windows(2).filter(|pair| pair[1] - pair[0] > TOLERANCE).map(|pair| 0.5 * (pair[0] + pair[1]));
    let middles: Vec<f64> = (0..INTERVALS).map(|i| even(i as f64 + 0.5)).chain(parts).collect();
    let sides = |s: f64| beside(&curve, s).map(|place| body.shape.contains(place));
    let is_off = |s: &f64| look.is_outside(curve.at(*s).0);
    let near = BESIDE * curve.length();
    let slits: Vec<_> = body.slits().collect();
    let on_slit = |s: f64| slits.iter().any(|slit| slit.distance(curve.at(s).0) < near);
    let is_inside = |s: &&f64| sides(**s) == [true; 2];
    let bare = || middles.iter().copied().find(|&s| is_off(&s) || sides(s) == [false; 2]);
    if let Some([x, y]) = ends.into_iter().find(is_off).or_else(bare).map(|s| curve.at(s).0) {
        let message = format!("the {form} leaves body {:?}: ({x}, {y}) m lies outside", body.name);
        findings.error(key, message, ON_BOUNDARY);
    } else if let Some(&s) = middles.iter().filter(is_inside).find(|&&s| needs_side || on_slit(s)) {
        let [x, y] = curve.at(s).0;
        let message =
            format!("the {form} runs inside body {:?}: there is material on both sides of ({x}, {y}) m", body.name);
        findings.error(key, message, ON_BOUNDARY);
    } else if let Some(&s) = middles.iter().find(is_inside) {
        let [x, y] = curve.at(s).0;
        let message = format!(
            "there is material of body {:?} on both sides of ({x}, {y}) m: the load is a line of forces inside it, not on \
             its boundary",
            body.name
        );
        findings.warn(key, message);
    }
}

/// Checks the factor at `key` of a load or a condition over the simulated time, `end` seconds.
pub(super) fn factor(key: &str, factor: &TimeFactor, end: f64, findings: &mut Findings) {
    match &factor.course {
        Course::Constant => {}
        Course::Ramp(rise) => {
            let like = "\"1 us\", or leave it out for the full value from t = 0";
            findings.positive(format!("{key}.ramp"), *rise, like);
        }
        Course::Smooth(rise) => {
            findings.positive(format!("{key}.smooth"), *rise, "\"1 us\"");
        }
        Course::Table(rows) => table(key, rows, findings), // of the scene, or of a file
        Course::Formula(formula) => {
            let times = (0..=LOOKS).map(|i| end * i as f64 / LOOKS as f64);
            if let Some(time) = times.clone().find(|&time| !factor.value(time).is_finite()) {
                let message = format!("{:?} is not finite at t = {time:e} s", formula.text());
                findings.error(format!("{key}.formula"), message, "give a formula that is finite from t = 0 on");
            }
        }
    }
    if let Some(until) = factor.until {
        findings.positive(format!("{key}.until"), until, "\"5 us\", or leave it out");
    }
}

/// Times that increase, and factors that are finite.
fn table(key: &str, rows: &[[f64; 2]], findings: &mut Findings) {
    if rows.is_empty() {
        return findings.error(key, "a table without rows", "give rows of time and factor: [[\"0 us\", 0.0], …]");
    }
    if !findings.finite(key, &rows.concat()) {
        return;
    }
    if let Some(i) = (1..rows.len()).find(|&i| rows[i][0] <= rows[i - 1][0]) {
        let message = format!("row {i} of the table is at {} s, after {} s", rows[i][0], rows[i - 1][0]);
        findings.error(key, message, "give times that increase from row to row");
    }
}
