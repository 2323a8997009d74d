//! Checks of tractions, and of the edges of loads and conditions: they lie on their body.

use std::f64::consts::TAU;

use super::findings::{Findings, side_name};
use super::look::{Look, TOLERANCE};
use super::time;
use crate::scene::edges::BoundaryEdge;
use crate::scene::{Body, Edge, Load, Shape, Traction};

/// Intervals between the positions at which the segment of a traction is looked at.
const SEGMENT_INTERVALS: usize = 32;
/// Distance from an edge at which material is looked for, of its length or radius.
const BESIDE: f64 = 1e-6;
const ON_BOUNDARY: &str = "give an edge of which every point lies on the body's boundary; the faces of a slit carry no load: \
                           cut a notch";

pub(super) fn check(key: &str, traction: &Traction, look: &Look<'_>, findings: &mut Findings) {
    match &traction.load {
        Load::Stress(stress) => drop(findings.finite(format!("{key}.stress"), stress)),
        Load::Pressure(pressure) => drop(findings.finite(format!("{key}.pressure"), &[*pressure])),
        Load::Field(_) => {} // whether it is finite where it acts is seen when the run begins
    }
    time::check(key, &traction.time, look.end_time, findings);
    if traction.time.range(look.end_time) == [0.0; 2] && traction.time.integral(look.end_time) == 0.0 {
        findings.warn(format!("{key}.time"), "the factor is zero until end_time: this load never acts");
    }
    edge(key, &traction.edge, traction.load.has_side(), look, findings);
}

/// An edge lies on the boundary of its body. What acts there needs a side if it has no meaning between
/// material on both sides.
pub(super) fn edge(key: &str, edge: &Edge, needs_side: bool, look: &Look<'_>, findings: &mut Findings) {
    let Look { body, ground, .. } = *look;
    match edge {
        Edge::Side(_) if body.shape == Shape::Patch => {}
        _ if ground.mesh.geometry.is_some() => {
            let remedy = "give the body shape = \"patch\" and edge = \"left\", \"right\", \"bottom\" or \"top\"";
            let form = match edge {
                Edge::Side(_) => "edge",
                Edge::Segment(_) => "segment",
                Edge::Arc { .. } => "arc",
            };
            let message = "on a patch with control_points or annulus only its sides can be loaded";
            findings.error(format!("{key}.{form}"), message, remedy);
        }
        Edge::Side(_) if matches!(body.shape, Shape::Rectangle { .. }) => {}
        Edge::Side(side) => {
            let message = format!("only a rectangle has a {} side", side_name(*side));
            findings.error(format!("{key}.edge"), message, "give segment = [[x0, y0], [x1, y1]] instead");
        }
        Edge::Arc { center, radius, angles } => arc(&format!("{key}.arc"), *center, *radius, *angles, look, findings),
        Edge::Segment(ends) => {
            let key = format!("{key}.segment");
            if !findings.finite(key.clone(), &[ends[0], ends[1]].concat()) {
                return;
            }
            let parts = || middles_of_parts(BoundaryEdge::Line(*ends), [0.0, 1.0], body);
            if ends[0] == ends[1] {
                findings.error(key, "a segment of zero length", "give two different ends");
            } else if let Some([x, y]) = look
                .first_outside(*ends, SEGMENT_INTERVALS)
                .or_else(|| middles(*ends).chain(parts()).find(|&at| look.is_outside(at) || is_bare(at, *ends, body)))
            {
                let message = format!("the segment leaves body {:?}: ({x}, {y}) m lies outside", body.name);
                findings.error(key, message, ON_BOUNDARY);
            } else if let Some([x, y]) =
                middles(*ends).chain(parts()).find(|&at| has_no_side(at, *ends, body, needs_side))
            {
                let message = format!(
                    "the segment runs inside body {:?}: there is material on both sides of ({x}, {y}) m",
                    body.name
                );
                findings.error(key, message, ON_BOUNDARY);
            } else if let Some([x, y]) = middles(*ends).find(|&at| sides(at, *ends, body) == [true; 2]) {
                let message = format!(
                    "there is material of body {:?} on both sides of ({x}, {y}) m: the load is a line of forces inside it, \
                     not on its boundary",
                    body.name
                );
                findings.warn(key, message);
            }
        }
    }
}

/// Middles of the parts (m) into which the edges of a body divide an edge between two places.
fn middles_of_parts(edge: BoundaryEdge, part: [f64; 2], body: &Body) -> impl Iterator<Item = [f64; 2]> {
    let places = edge.places_met(&body.shape.edges(), part);
    let parts: Vec<[f64; 2]> = places.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    let wide = parts.into_iter().filter(|pair| pair[1] - pair[0] > TOLERANCE);
    wide.map(move |pair| edge.at(0.5 * (pair[0] + pair[1])).0)
}

/// Middles of equal parts of a segment, m.
fn middles([from, to]: [[f64; 2]; 2]) -> impl Iterator<Item = [f64; 2]> {
    let part = |i: usize| (i as f64 + 0.5) / SEGMENT_INTERVALS as f64;
    (0..SEGMENT_INTERVALS).map(move |i| [0, 1].map(|d| from[d] + part(i) * (to[d] - from[d])))
}

/// Whether there is material on either side of a position (m) on a segment.
fn sides([x, y]: [f64; 2], [from, to]: [[f64; 2]; 2], body: &Body) -> [bool; 2] {
    let beside = [0, 1].map(|d| BESIDE * (to[d] - from[d]));
    [1.0, -1.0].map(|side| body.shape.contains([x - side * beside[1], y + side * beside[0]]))
}

/// Whether there is none: in the mouth of a notch that begins on the segment.
fn is_bare(at: [f64; 2], ends: [[f64; 2]; 2], body: &Body) -> bool {
    body.shape != Shape::Patch && sides(at, ends, body) == [false, false]
}

/// Whether what acts at a position (m) on a segment has no meaning: it needs a side, or the segment is on a
/// slit, which has two faces.
fn has_no_side(at: [f64; 2], [from, to]: [[f64; 2]; 2], body: &Body, needs_side: bool) -> bool {
    let near = BESIDE * (to[0] - from[0]).hypot(to[1] - from[1]);
    let on_slit = || body.cracks.iter().any(|crack| crack.is_slit() && crack.distance(at) < near);
    sides(at, [from, to], body) == [true, true] && (needs_side || on_slit())
}

/// An arc lies on the boundary of its body.
fn arc(key: &str, center: [f64; 2], radius: f64, angles: [f64; 2], look: &Look<'_>, findings: &mut Findings) {
    if !findings.finite(key, &[center, angles].concat())
        || !findings.positive(format!("{key}.radius"), radius, "radius = \"10 mm\"")
    {
        return;
    }
    let swept = angles[1] - angles[0];
    if !(swept > 0.0 && swept <= TAU * (1.0 + TOLERANCE)) {
        let message = format!("an arc of {:.6} degrees", swept.to_degrees());
        return findings.error(
            format!("{key}.angles"),
            message,
            "give two angles that increase by at most 360 degrees",
        );
    }
    let position = |i: usize| {
        let (sine, cosine) = (angles[0] + swept * i as f64 / SEGMENT_INTERVALS as f64).sin_cos();
        [center[0] + radius * cosine, center[1] + radius * sine]
    };
    let (circle, part) = (BoundaryEdge::Circle { center, radius, sign: 1.0 }, angles.map(|angle| angle / TAU));
    let parts: Vec<_> = middles_of_parts(circle, part, look.body).collect();
    let positions = || (0..=SEGMENT_INTERVALS).map(position).chain(parts.iter().copied());
    let is_between = |p: &[f64; 2]| {
        let beside = |part: f64| [0, 1].map(|d| center[d] + part * (p[d] - center[d]));
        [1.0 - BESIDE, 1.0 + BESIDE].iter().all(|part| look.body.shape.contains(beside(*part)))
    };
    let name = &look.body.name;
    if let Some([x, y]) = positions().find(|p| look.is_outside(*p)) {
        let message = format!("the arc leaves body {name:?}: ({x}, {y}) m lies outside");
        findings.error(key, message, ON_BOUNDARY);
    } else if let Some([x, y]) = positions().find(is_between) {
        let message = format!("the arc runs inside body {name:?}: there is material on both sides of ({x}, {y}) m");
        findings.error(key, message, ON_BOUNDARY);
    }
}
