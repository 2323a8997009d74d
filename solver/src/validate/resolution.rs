//! Whether the mesh resolves the length scale of the phase field: cells longer than that make a crack
//! coarse, and where they are more than four times as long there is none.

use super::findings::Findings;
use super::ground::Ground;
use crate::linear_algebra::extremes::{around, larger};
use crate::material::mesh_toughness::slope_in;
use crate::particles::spans::{finest_cell, longest_span};
use crate::phase_field::fracture::half_width;
use crate::scene::{Body, Fracture, Mesh, Shape};

/// Relative tolerance of lengths.
const TOLERANCE: f64 = crate::splines::spline::ROUND_OFF;

/// An error for cells above four times the length scale at the initial cracks of a body, or everywhere if it
/// has none; a warning for such cells elsewhere, and for cells above the length scale.
pub(super) fn check(body: &Body, fracture: &Fracture, ground: &Ground<'_>, findings: &mut Findings) {
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
