//! Checks of bodies: shape, place in the mesh, points, resolution of the length scale, tractions, cracks.

use std::cell::Cell;

use super::findings::{Findings, side_name};
use super::geometry::{complexity, covered_side, defect, outline};
use super::ground::Ground;
use super::points::Points;
use super::{resolution, seed};
use crate::scene::{Body, Crack, Edge, Fracture, Layout, Scene, Shape, Traction};
use crate::splines::nurbs::{LocateError, NurbsPatch};
use crate::splines::quadrature::MAX_POINTS;

/// Relative tolerance of "inside", of the size of the mesh or body.
const TOLERANCE: f64 = crate::splines::spline::ROUND_OFF;
/// Intervals between the positions at which the segment of a traction is looked at.
const SEGMENT_INTERVALS: usize = 32;
/// Most positions at which a crack is looked at.
const MOST_CRACK_SAMPLES: usize = 10_000;
/// Most tests of a position against a corner or circle, over all lines of a body: a tenth of a second.
const MOST_LOOKS: usize = 10_000_000;
/// Such tests that cost as much as to find a position on a general patch.
const COST_OF_LOCATING: usize = 200;
/// Most points of the Maclaurin rule.
const MOST_MACLAURIN: usize = 5;

pub(super) fn check(scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    if scene.bodies.is_empty() {
        findings.error("body", "there is no body", "add a [[body]] with name, material and shape");
    }
    for (i, body) in scene.bodies.iter().enumerate() {
        let key = format!("body.{i}");
        if scene.bodies[..i].iter().any(|other| other.name == body.name) {
            findings.error(format!("{key}.name"), format!("a second body named {:?}", body.name), "give each its name");
        }
        findings.finite(format!("{key}.velocity"), &body.velocity);
        findings.finite(format!("{key}.angular_velocity"), &[body.angular_velocity]);
        points(&key, body, scene.mesh.degree, findings);
        let fracture = material(&key, body, scene, findings);
        if let Some((message, remedy)) = defect(&body.shape) {
            findings.error(format!("{key}.shape"), message, remedy);
            continue;
        }
        let placed = ground.is_sound && !body.rigid && inside_mesh(&key, body, ground, findings);
        let before = findings.errors.len();
        if placed && let Some(fracture) = fracture {
            resolution::check(body, fracture, ground, findings);
        }
        let look = Look::new(body, ground);
        for (j, traction) in body.tractions.iter().enumerate() {
            check_traction(&format!("{key}.traction.{j}"), traction, &look, findings);
        }
        for (j, crack) in body.cracks.iter().enumerate() {
            check_crack(&format!("{key}.crack.{j}"), crack, fracture, &look, findings);
        }
        if placed && (0..2).all(|d| has_rule(body, d)) {
            material_points(&key, body, fracture.filter(|_| findings.errors.len() == before), ground, findings);
        }
    }
}

/// The body has material points, and the seeds of its cracks, if they are sound, reach them.
fn material_points(key: &str, body: &Body, fracture: Option<&Fracture>, ground: &Ground<'_>, findings: &mut Findings) {
    let Some(points) = Points::new(body, ground) else {
        let seeds = (0..body.cracks.len()).filter(|_| fracture.is_some());
        return seeds.for_each(|j| seed::unchecked(format!("{key}.crack.{j}"), findings));
    };
    let [_, h] = ground.span_lengths(&body.shape);
    if !points.exist() {
        let message = format!("no material point lies in body {:?}: its cells are up to {h:.3e} m wide", body.name);
        let remedy = "use smaller cells or more particles_per_cell, or make the body larger";
        findings.error(format!("{key}.shape"), message, remedy);
    } else if let Some(fracture) = fracture {
        seed::check(key, body, fracture, &points, h, findings);
    }
}

/// Whether the layout of a body has a rule of its number of points in a direction.
pub(super) fn has_rule(body: &Body, d: usize) -> bool {
    let most = if body.layout == Layout::Maclaurin { MOST_MACLAURIN } else { MAX_POINTS };
    (1..=most).contains(&body.particles_per_cell[d])
}

fn points(key: &str, body: &Body, degree: [usize; 2], findings: &mut Findings) {
    let counts = body.particles_per_cell;
    let points = format!("{key}.particles_per_cell");
    if let Some(n) = counts.iter().find(|n| **n == 0 || **n > MAX_POINTS) {
        findings.error(points, format!("{n} points per cell and direction"), format!("give 1 to {MAX_POINTS}"));
    } else if body.layout == Layout::Maclaurin && counts.iter().any(|n| *n > MOST_MACLAURIN) {
        let message = format!("the maclaurin layout has no rule of {} points", counts[0].max(counts[1]));
        let remedy = "give at most 5 particles_per_cell, or use layout = \"gauss\" or \"uniform\"";
        findings.error(format!("{key}.layout"), message, remedy);
    } else if (0..2).any(|d| counts[d] == 1 && degree[d] >= 2) {
        let message =
            "one point per cell leaves modes of a mesh of degree 2 and higher without stiffness; use at least 2";
        findings.warn(points, message);
    }
}

/// The fracture table of the body's material, if it has one that makes sense.
fn material<'a>(key: &str, body: &Body, scene: &'a Scene, findings: &mut Findings) -> Option<&'a Fracture> {
    let Some(material) = scene.materials.get(&body.material) else {
        let names: Vec<&str> = scene.materials.keys().map(String::as_str).collect();
        let remedy = match names.as_slice() {
            [] => format!("add a table [material.{}]", body.material),
            _ => format!("known materials: {}", names.join(", ")),
        };
        findings.error(format!("{key}.material"), format!("unknown material {:?}", body.material), remedy);
        return None;
    };
    if material.fracture.is_none() && !body.cracks.is_empty() {
        let message = format!("a crack needs the phase field, but material {:?} has no fracture table", body.material);
        let remedy = format!("add [material.{}.fracture], or remove the crack", body.material);
        findings.error(format!("{key}.crack"), message, remedy);
    }
    material.fracture.as_ref().filter(|f| f.length_scale > 0.0)
}

fn inside_mesh(key: &str, body: &Body, ground: &Ground<'_>, findings: &mut Findings) -> bool {
    match (&body.shape, &ground.patch) {
        (Shape::Patch, Some(_)) => return true,
        (Shape::Patch, None) => {
            let remedy = "give the rectangle of the mesh: shape = { rectangle = { min = …, max = … } }";
            findings.error(format!("{key}.shape"), "the mesh is a rectangle without a geometry of its own", remedy);
            return false;
        }
        (shape, Some(patch)) => return inside_patch(key, shape, patch, findings),
        _ => {}
    }
    let (min, max) = body.shape.bounding_box();
    let (origin, end) = (ground.mesh.origin(), ground.mesh.end());
    let outside = |d: usize| {
        let tolerance = TOLERANCE * (end[d] - origin[d]);
        min[d] < origin[d] - tolerance || max[d] > end[d] + tolerance
    };
    let Some(d) = (0..2).find(|d| outside(*d)) else { return true };
    let name = ["x", "y"][d];
    let message = format!(
        "the body reaches from {name} = {} m to {} m, outside the mesh, {} m to {} m",
        min[d], max[d], origin[d], end[d]
    );
    findings.error(format!("{key}.shape"), message, "enlarge mesh.size, or move mesh.origin or the body");
    false
}

/// Whether a shape lies on a patch with a geometry: its outline does, and no side of the patch runs inside
/// it, as that of a hole would.
fn inside_patch(key: &str, shape: &Shape, patch: &NurbsPatch, findings: &mut Findings) -> bool {
    let tolerance = TOLERANCE * patch.size();
    let mut last = None;
    for point in outline(shape) {
        let found = patch.locate(point, last);
        last = found.as_ref().ok().map(|location| location.parameters).or(last);
        if let Err(LocateError::Outside { nearest: [x, y], distance, .. }) = found
            && distance > tolerance
        {
            let message = format!("the point ({}, {}) m of the body lies outside the patch", point[0], point[1]);
            let remedy = format!(
                "move or shrink the body (the patch begins {distance:.3e} m away, at ({x}, {y}) m), or use shape = \"patch\""
            );
            findings.error(format!("{key}.shape"), message, remedy);
            return false;
        }
    }
    if let Some([x, y]) = covered_side(shape, patch) {
        let message =
            format!("the body covers the side of the patch at ({x:.6e}, {y:.6e}) m, beyond which there is no mesh");
        let remedy = "move or shrink the body, cut the hole out of it, or use shape = \"patch\"";
        findings.error(format!("{key}.shape"), message, remedy);
        return false;
    }
    true
}

fn check_traction(key: &str, traction: &Traction, look: &Look<'_>, findings: &mut Findings) {
    let Look { body, ground, .. } = *look;
    findings.finite(format!("{key}.stress"), &traction.stress);
    if let Some(ramp) = traction.ramp {
        findings.positive(format!("{key}.ramp"), ramp, "ramp = \"1 us\", or leave it out for a load from t = 0");
    }
    match &traction.edge {
        Edge::Side(_) if body.shape == Shape::Patch => {}
        _ if ground.mesh.geometry.is_some() => {
            let remedy =
                "give the body shape = \"patch\" and the traction edge = \"left\", \"right\", \"bottom\" or \"top\"";
            let form = if matches!(traction.edge, Edge::Segment(_)) { "segment" } else { "edge" };
            let message = "on a patch with control_points or annulus only its sides can be loaded";
            findings.error(format!("{key}.{form}"), message, remedy);
        }
        Edge::Side(_) if matches!(body.shape, Shape::Rectangle { .. }) => {}
        Edge::Side(side) => {
            let message = format!("only a rectangle has a {} side", side_name(*side));
            findings.error(format!("{key}.edge"), message, "give segment = [[x0, y0], [x1, y1]] instead");
        }
        Edge::Segment(ends) => {
            let key = format!("{key}.segment");
            if !findings.finite(key.clone(), &[ends[0], ends[1]].concat()) {
                return;
            }
            if ends[0] == ends[1] {
                findings.error(key, "a segment of zero length", "give two different ends");
            } else if let Some([x, y]) = look.first_outside(*ends, SEGMENT_INTERVALS) {
                let message = format!("the segment leaves body {:?}: ({x}, {y}) m lies outside", body.name);
                findings.error(key, message, "give two ends between which every point lies on the body's boundary");
            }
        }
    }
}

/// A body looked at position by position.
struct Look<'a> {
    body: &'a Body,
    ground: &'a Ground<'a>,
    tolerance: f64,
    /// Parameters of the last position found on the patch.
    last: Cell<Option<[f64; 2]>>,
    /// Most positions along one line: the more lines and corners, the fewer.
    most: usize,
}

impl<'a> Look<'a> {
    fn new(body: &'a Body, ground: &'a Ground<'a>) -> Self {
        let (min, max) = ground.mesh.extent(&body.shape);
        let lines = body.cracks.len() + body.tractions.len();
        let cost = lines * (complexity(&body.shape) + if ground.patch.is_some() { COST_OF_LOCATING } else { 0 });
        Self {
            body,
            ground,
            tolerance: TOLERANCE * (max[0] - min[0]).max(max[1] - min[1]),
            last: Cell::new(None),
            most: (MOST_LOOKS / cost.max(1)).clamp(2, MOST_CRACK_SAMPLES),
        }
    }

    fn is_outside(&self, position: [f64; 2]) -> bool {
        let off_patch = || self.ground.patch.as_ref().is_some_and(|patch| !self.is_on(patch, position));
        !self.body.shape.contains_within(position, self.tolerance) || off_patch()
    }

    /// Whether a position (m) is on a patch; searched from the one before, which is near.
    fn is_on(&self, patch: &NurbsPatch, position: [f64; 2]) -> bool {
        let found = patch.locate(position, self.last.get());
        found.map(|location| self.last.set(Some(location.parameters))).is_ok()
    }

    /// First of about `intervals + 1` equally spaced positions (m) between two ends, both included, that is
    /// not in the closure of the body.
    fn first_outside(&self, [from, to]: [[f64; 2]; 2], intervals: usize) -> Option<[f64; 2]> {
        let intervals = intervals.min(self.most - 1);
        let position = |i: usize| {
            let t = i as f64 / intervals as f64;
            [0, 1].map(|d| (1.0 - t) * from[d] + t * to[d])
        };
        (0..=intervals).map(position).find(|p| self.is_outside(*p))
    }
}

fn check_crack(key: &str, crack: &Crack, fracture: Option<&Fracture>, look: &Look<'_>, findings: &mut Findings) {
    if let Some(half_width) = crack.half_width {
        let like = "half_width = \"0.125 mm\", or leave it out for l0/2";
        findings.positive(format!("{key}.half_width"), half_width, like);
    }
    if !findings.finite(format!("{key}.from"), &[crack.from, crack.to].concat()) {
        return;
    }
    if crack.from == crack.to {
        return findings.error(format!("{key}.to"), "a crack of zero length", "give two different ends");
    }
    let ends_inside = [("from", crack.from), ("to", crack.to)].map(|(name, [x, y])| {
        let inside = !look.is_outside([x, y]);
        if !inside {
            let message = format!("the end ({x}, {y}) m of the crack lies outside body {:?}", look.body.name);
            findings.error(format!("{key}.{name}"), message, "give ends inside the body or on its boundary");
        }
        inside
    });
    let length = (crack.to[0] - crack.from[0]).hypot(crack.to[1] - crack.from[1]);
    let finest = fracture.map_or(f64::INFINITY, |f| 0.5 * f.length_scale);
    let intervals = ((length / finest).ceil() as usize).clamp(2, MOST_CRACK_SAMPLES - 1);
    if ends_inside == [true, true]
        && let Some([x, y]) = look.first_outside([crack.from, crack.to], intervals)
    {
        let message = format!("the crack leaves body {:?} between its ends, at ({x}, {y}) m", look.body.name);
        findings.error(format!("{key}.from"), message, "give one crack for each part that lies inside the body");
    }
}
