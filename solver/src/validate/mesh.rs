//! Checks of the background mesh: degrees, open knot vectors, geometry.

use super::findings::Findings;
use crate::linear_algebra::extremes::smaller;
use crate::scene::Mesh;
use crate::splines::nurbs::{NurbsError, NurbsPatch, check};

/// Weights of control points: beyond, sums of them lose the smallest ones, and control points are left
/// without mass.
const WEIGHTS: (f64, f64) = (1e-3, 1e3);
/// Extent of a mesh in a direction, m or unit of the knots: beyond, areas and stiffnesses over- or underflow.
const EXTENT: (f64, f64) = (1e-12, 1e12);
/// Shortest span of a direction, of the extent: below, it is within round-off of its neighbours.
const SHORTEST: f64 = crate::splines::spline::ROUND_OFF;
/// Largest number of spans of a mesh.
const MOST_SPANS: usize = 50_000_000;

/// The geometry of a mesh that has one and is sound.
pub(super) fn check(mesh: &Mesh, findings: &mut Findings) -> Option<NurbsPatch> {
    for d in 0..2 {
        if (1..=4).contains(&mesh.degree[d]) {
            knots(d, mesh.degree[d], &mesh.knots[d], findings);
        } else {
            let message = format!("degree {} in direction {}", mesh.degree[d], ["x", "y"][d]);
            findings.error("mesh.degree", message, "give a degree from 1 to 4");
        }
    }
    let spans = mesh.knots[0].len().saturating_mul(mesh.knots[1].len());
    if spans > MOST_SPANS {
        let remedy = format!("use fewer cells: at most {MOST_SPANS} in all");
        findings.error("mesh.cells", format!("a mesh of about {spans} cells"), remedy);
    }
    if !findings.errors.is_empty() {
        return None;
    }
    let patch = mesh.nurbs()?;
    let patch = patch.inspect_err(|error| geometry(error, findings)).ok()?;
    magnitudes(&patch, findings).then_some(patch)
}

/// Whether weights and control points of a patch are of sizes that can be computed with.
fn magnitudes(patch: &NurbsPatch, findings: &mut Findings) -> bool {
    let (low, high) = WEIGHTS;
    if let Some(weight) = patch.weights().iter().find(|w| !(low..=high).contains(*w)) {
        let remedy = "give weights of about 1: a common factor of all changes nothing";
        findings.error("mesh.weights", format!("a weight of {weight:e} is outside {low:e} to {high:e}"), remedy);
        return false;
    }
    let (least, most) = EXTENT;
    let far = patch.control_points().iter().any(|p| p.iter().any(|x| x.abs() > most));
    if far || patch.size() < least {
        let message = format!("a patch smaller than {least:e} m, or with control points beyond {most:e} m");
        findings.error("mesh.control_points", message, "check the unit of the control points");
        return false;
    }
    true
}

/// What is wrong with a patch, by key, and what would be right.
fn geometry(error: &NurbsError, findings: &mut Findings) {
    let (key, remedy) = match error {
        NurbsError::ControlPoints(_) => {
            ("mesh.control_points", "give finite points [x, y], rows of the first direction, as many as functions")
        }
        NurbsError::Folded { .. } => (
            "mesh.control_points",
            "move or reorder the control points: seen along a row the next row lies to its left, and rows do not cross",
        ),
        NurbsError::Weights(_) => {
            ("mesh.weights", "give a weight above zero to each control point; 1 everywhere for a polynomial patch")
        }
        _ => ("mesh.knots", "give open knot vectors for these degrees"),
    };
    findings.error(key, error.to_string(), remedy);
}

fn knots(d: usize, degree: usize, knots: &[f64], findings: &mut Findings) {
    let (key, ends) = (format!("mesh.knots.{d}"), degree + 1);
    if let Err(error) = check::knots(d, degree, knots) {
        let remedy =
            format!("sort the knots; repeat the first and the last {ends} times, others at most {degree} times");
        return findings.error(key, error.to_string(), remedy);
    }
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    let (least, most) = EXTENT;
    if !(least..=most).contains(&(last - first)) {
        let message = format!("from {first:e} to {last:e}: an extent outside {least:e} to {most:e}");
        return findings.error(
            key,
            message,
            "check the unit of a size; knots of a general patch can be scaled to 0 to 1",
        );
    }
    let spans = knots.windows(2).map(|k| k[1] - k[0]).filter(|span| *span > 0.0);
    let shortest = spans.fold(f64::INFINITY, smaller);
    if shortest < SHORTEST * (last - first) {
        let message = format!("a span of {shortest:e} in a mesh of {:e}: too short to be told from none", last - first);
        findings.error(key, message, "repeat a knot exactly, or keep the spans alike");
    }
}
