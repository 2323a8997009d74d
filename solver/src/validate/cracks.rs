//! Checks of initial cracks: polylines that lie in their body.

use super::findings::Findings;
use super::ground::Ground;
use super::look::{Look, MOST_POSITIONS};
use crate::scene::{Crack, CrackKind, Fracture, Frame, Mass, Scene};
use crate::splines::nurbs::NurbsPatch;

/// Distance from a knot line that counts as none, of the range of a parameter; and places on a straight part
/// of a slit that are looked at, less one.
const ON_KNOT: f64 = 1e-6;
const LOOKS: usize = 8;

/// A slit parts the control points of the total frame, which keep their places.
pub(super) fn slit(key: &str, crack: &Crack, scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    let key = format!("{key}.as");
    if ground.patch.as_ref().is_some_and(|patch| !crack.segments().all(|ends| follows_knots(patch, ends))) {
        let message = "a slit between the knot lines of a patch with a geometry acts up to half a span beside its place, and \
                       material between it and a loaded edge may move too far: let it follow knot lines";
        findings.warn(key.clone(), message);
    }
    if scene.analysis.frame == Frame::Updated {
        let remedy = "use frame = \"total\", or cut a notch out of the shape: { difference = { of, minus } }";
        findings.error(key.clone(), "a slit in the updated frame, which is not implemented", remedy);
    }
    if scene.analysis.mass == Mass::Consistent {
        findings.error(key, "a slit with the consistent mass, which is not implemented", "use mass = \"lumped\"");
    }
}

/// Whether a line (m) follows a knot line of a patch. What lies outside is found elsewhere.
fn follows_knots(patch: &NurbsPatch, [from, to]: [[f64; 2]; 2]) -> bool {
    let place = |i: usize| [0, 1].map(|d| from[d] + (to[d] - from[d]) * i as f64 / LOOKS as f64);
    let places = (0..=LOOKS).filter_map(|i| patch.locate(place(i), None).ok());
    let parameters: Vec<[f64; 2]> = places.map(|location| location.parameters).collect();
    (0..2).any(|d| {
        let spans = patch.spaces()[d].spans();
        let near = ON_KNOT * (spans[spans.len() - 1].right - spans[0].left);
        let follows = |knot: f64| parameters.iter().all(|at| (at[d] - knot).abs() < near);
        spans.iter().any(|span| follows(span.left) || follows(span.right))
    })
}

/// A crack that is driven grows by the history field of the total frame.
fn driven(key: &str, speed: f64, fracture: Option<&Fracture>, look: &Look<'_>, findings: &mut Findings) {
    let key = format!("{key}.speed");
    if look.frame == Frame::Updated {
        let message = "a crack that is driven is implemented in the total frame";
        findings.error(key.clone(), message, "use frame = \"total\", or leave speed out");
    }
    if let Some(model) = fracture.map(|fracture| fracture.model).filter(|model| model.has_threshold()) {
        let message = format!("a crack that is driven is not implemented with {}", model.word());
        findings.error(key.clone(), message, "use model = \"at2\", or leave speed out");
    }
    findings.positive(key, speed, "speed = \"500 m/s\"");
}

pub(super) fn check(key: &str, crack: &Crack, fracture: Option<&Fracture>, look: &Look<'_>, findings: &mut Findings) {
    if let CrackKind::Driven(speed) = crack.kind {
        driven(key, speed, fracture, look, findings);
    }
    if let CrackKind::Seed(Some(half_width)) = crack.kind {
        if let Some(model) = fracture.map(|fracture| fracture.model).filter(|model| model.has_threshold()) {
            let word = model.word();
            let message = format!("a seed of {word} is the bound c = 0 on its line: it has no initial history field");
            findings.error(format!("{key}.half_width"), message, "leave the key out, or use model = \"at2\"");
        }
        let like = "half_width = \"0.125 mm\", or leave it out for l0/2";
        findings.positive(format!("{key}.half_width"), half_width, like);
    }
    // A straight crack is usually written with `from` and `to`.
    let place = |i: usize| match crack.points.len() {
        2 => format!("{key}.{}", ["from", "to"][i]),
        _ => format!("{key}.points.{i}"),
    };
    if crack.points.len() < 2 {
        return findings.error(key, "a crack of one point", "give at least two points");
    }
    if !findings.finite(place(0), &crack.points.concat()) {
        return;
    }
    let mut inside = true;
    for (i, &[x, y]) in crack.points.iter().enumerate() {
        if i > 0 && crack.points[i - 1] == [x, y] {
            return findings.error(place(i), "a crack of zero length", "give two different ends");
        }
        if look.is_outside([x, y]) {
            let message = format!("the end ({x}, {y}) m of the crack lies outside body {:?}", look.body.name);
            findings.error(place(i), message, "give ends inside the body or on its boundary");
            inside = false;
        }
    }
    let finest = fracture.map_or(f64::INFINITY, |f| 0.5 * f.length_scale);
    for (i, [from, to]) in crack.segments().enumerate().filter(|_| inside) {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let intervals = ((length / finest).ceil() as usize).clamp(2, MOST_POSITIONS - 1);
        if let Some([x, y]) = look.first_outside([from, to], intervals) {
            let message = format!("the crack leaves body {:?} between its ends, at ({x}, {y}) m", look.body.name);
            findings.error(place(i), message, "give one crack for each part that lies inside the body");
        }
    }
}
