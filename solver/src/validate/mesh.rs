//! Checks of the background mesh: degrees, open knot vectors, geometry, what local refinement cannot be used
//! with, and whether the mesh resolves the length scale of the phase field. Cells longer than that make a
//! crack coarse, and where they are more than four times as long there is none.

use super::ground::{Findings, Ground, TOLERANCE};
use crate::linear_algebra::extremes::{around, larger, smaller};
use crate::material::mesh_toughness::slope_in;
use crate::particles::spans::{finest_cell, longest_span};
use crate::phase_field::fracture::half_width;
use crate::scene::{Body, Fracture, Frame, Kinematics, Mass, Mesh, PhaseFieldSolver, Scene, Shape};
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

/// Checks what local refinement is used with.
pub(super) fn check_refinement(scene: &Scene, findings: &mut Findings) {
    let body = scene.bodies.first();
    let fracture = body.and_then(|body| scene.materials.get(&body.material)?.fracture.as_ref());
    let covers = |shape: &Shape| {
        let (origin, end) = (scene.mesh.origin(), scene.mesh.end());
        let near = |d: usize, one: f64, other: f64| (one - other).abs() <= TOLERANCE * (end[d] - origin[d]);
        match shape {
            Shape::Rectangle { min, max } => (0..2).all(|d| near(d, min[d], origin[d]) && near(d, max[d], end[d])),
            _ => *shape == Shape::Patch,
        }
    };
    let repeats = |d: usize| {
        let (knots, ends) = (&scene.mesh.knots[d], scene.mesh.degree[d] + 1);
        knots.get(ends..knots.len().saturating_sub(ends)).is_some_and(|inner| inner.windows(2).any(|k| k[0] == k[1]))
    };
    let output = &scene.output;
    let obstacles = [
        (scene.analysis.frame == Frame::Updated, "frame = \"updated\"", "use frame = \"total\""),
        (scene.analysis.kinematics == Kinematics::Finite, "finite kinematics", "use kinematics = \"small\""),
        (scene.analysis.mass == Mass::Consistent, "a consistent mass", "leave analysis.mass out"),
        (scene.contact.is_some() || scene.bodies.len() > 1, "several bodies or contact", "describe one body alone"),
        (
            body.is_some_and(|body| !body.conditions.is_empty()),
            "conditions on edges of a body",
            "give them on sides of the mesh ([[boundary]])",
        ),
        (body.is_some_and(|body| !covers(&body.shape)), "a body that does not cover the mesh", "let it cover the mesh"),
        (fracture.is_none(), "a body that does not break", "give its material a fracture table"),
        (scene.equilibrium, "a static start", "remove start.equilibrium"),
        ((0..2).any(repeats), "repeated knots", "give every inner knot once"),
        (
            scene.solver.phase_field_solver == PhaseFieldSolver::Cholesky,
            "phase_field_solver = \"cholesky\"",
            "use \"conjugate-gradients\"",
        ),
        (!output.j_integrals.is_empty(), "J-integrals", "remove output.j_integral"),
        (output.fragments || output.bodies, "a count of fragments or a record of bodies", "remove them from output"),
    ];
    for (_, what, remedy) in obstacles.into_iter().filter(|(is_there, ..)| *is_there) {
        findings.error(
            "mesh.refine",
            format!("local refinement with {what} is not implemented"),
            format!("{remedy}, or remove mesh.refine"),
        );
    }
    if let (Some(body), Some(fracture)) = (body, fracture) {
        let (coarse, l0) = (longest_span(&scene.mesh, &body.shape), fracture.shortest_length());
        // With a threshold, spans are halved before a crack begins.
        let begins_anywhere = !fracture.model.has_threshold() && (body.cracks.is_empty() || fracture.random.is_some());
        if begins_anywhere && scene.mesh.geometry.is_none() && coarse > l0 * (1.0 + TOLERANCE) {
            let message = format!(
                "a crack may begin where cells are {:.4} mm long against l0 = {:.4} mm: they are halved when it is there, \
                 which is late; use cells of at most l0, or fewer levels",
                1e3 * coarse,
                1e3 * l0
            );
            findings.warn("mesh.refine", message);
        }
    }
}

/// An error for cells above four times the length scale at the initial cracks of a body, or everywhere if it
/// has none; a warning for such cells elsewhere, and for cells above the length scale.
pub(super) fn check_resolution(body: &Body, fracture: &Fracture, ground: &Ground<'_>, findings: &mut Findings) {
    let is_mapped = ground.patch.is_some();
    let longest = if is_mapped { ground.span_lengths(&body.shape)[1] } else { longest_span(ground.mesh, &body.shape) };
    let l0 = fracture.shortest_length();
    if let Some(random) = fracture.random.filter(|random| random.correlation < longest) {
        let message = format!("{:.4e} m is shorter than the largest cell, {longest:.4e} m", random.correlation);
        let remedy = "give at least the length of a cell: the points of one cell cannot differ by more";
        findings.error(format!("material.{}.fracture.random.correlation", body.material), message, remedy);
    }
    if fracture.mesh_toughness && slope_in(fracture, ground.mesh.degree, body).is_none() {
        let message = "the key has no effect on body";
        let known = "the cost of a crack is known for at1 and at2 without anisotropy, Gauss points, and degree 1 or 2 \
                     with 2 x 2 points a cell; with at2 also for degree 3 with 3 x 3";
        let key = format!("material.{}.fracture.mesh_toughness", body.material);
        findings.warn(key, format!("{message} {:?}: {known}", body.name));
    }
    let needed = if is_mapped { longest } else { span_of_cracks(body, l0, ground.mesh) };
    let exceeds = |h: f64, times: f64| h > times * l0 * (1.0 + TOLERANCE);
    let sizes = |h: f64| format!("cells of h = {:.4} mm against l0 = {:.4} mm", 1e3 * h, 1e3 * l0);
    let key = format!("material.{}.fracture.length_scale", body.material);
    if exceeds(needed, 4.0) {
        let finer = if ground.mesh.geometry.is_some() { "subdivide or mesh.cells" } else { "cells" };
        let remedy = format!(
            "h may be at most l0, and never above 4 l0: refine mesh.{finer} {:.0} times, or raise length_scale",
            (needed / l0 - TOLERANCE).ceil()
        );
        findings.error(key, format!("the mesh cannot resolve a crack: {}", sizes(needed)), remedy);
    } else if exceeds(longest, 4.0) {
        let message = "a crack that comes to the largest cells is not resolved";
        findings.warn(key, format!("{message}: {}; refine where one may go", sizes(longest)));
    } else if exceeds(longest, 1.0) {
        findings
            .warn(key, format!("the crack is resolved coarsely: {}; h <= l0 is advised, l0/2 better", sizes(longest)));
    }
}

/// Largest span of a rectangle that the seed of a crack of a body touches, m; without a crack, of its finest
/// cell.
fn span_of_cracks(body: &Body, l0: f64, mesh: &Mesh) -> f64 {
    let spans = body.cracks.iter().map(|crack| {
        let width = half_width(crack, l0).unwrap_or(0.0);
        let [low, high] = around(crack.points.iter().map(|point| [*point; 2]));
        longest_span(mesh, &Shape::Rectangle { min: low.map(|x| x - width), max: high.map(|x| x + width) })
    });
    spans.reduce(larger).unwrap_or_else(|| finest_cell(mesh, &body.shape))
}
