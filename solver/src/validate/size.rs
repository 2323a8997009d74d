//! How large a scene will be, before anything is made of it.

use super::findings::Findings;
use crate::scene::{Body, Frame, Scene};

/// Most material points of a scene; each takes 100 to 300 bytes.
const MOST_POINTS: usize = 500_000_000;

/// Memory of a process per material point in the total and in the updated frame, bytes: without a phase
/// field, and what that adds. Measured with 10⁶ points, p = 2 and 3, to 15 %.
const BYTES_OF_POINT: [[usize; 2]; 2] = [[20, 30], [170, 80]];
/// The same per control point: of the mechanics, and per pair of coupled functions of a phase field.
const BYTES_OF_CONTROL_POINT: usize = 200;
const BYTES_OF_COUPLING: usize = 21;

/// About how large the model of a scene will be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExpectedSize {
    /// Material points, if every span under the box around a body is full of them.
    pub points: usize,
    /// Control points of the mesh.
    pub control_points: usize,
    /// Memory of points and control points without what the phase field of the control points takes, bytes.
    pub mechanics_bytes: usize,
    /// Memory of the phase field of the control points, bytes.
    pub phase_field_bytes: usize,
}

/// Size of the model of a valid scene, to the points that lie outside a body in spans it cuts.
pub fn expected_size(scene: &Scene) -> ExpectedSize {
    let bodies = scene.bodies.iter().filter(|body| !body.rigid);
    let points = bodies.map(|body| points(body, scene)).fold(0, usize::saturating_add);
    let functions = |d: usize| scene.mesh.knots[d].len().saturating_sub(scene.mesh.degree[d] + 1);
    let control_points = functions(0).saturating_mul(functions(1));
    let fractures = scene.materials.values().any(|material| material.fracture.is_some());
    let [plain, added] = BYTES_OF_POINT[usize::from(scene.analysis.frame == Frame::Updated)];
    let of_point = if fractures { plain + added } else { plain };
    let mechanics_bytes =
        points.saturating_mul(of_point).saturating_add(control_points.saturating_mul(BYTES_OF_CONTROL_POINT));
    let couplings = scene.mesh.degree.iter().map(|p| 2 * p + 1).product::<usize>().div_ceil(2);
    let phase_field_bytes = if fractures { control_points.saturating_mul(couplings * BYTES_OF_COUPLING) } else { 0 };
    ExpectedSize { points, control_points, mechanics_bytes, phase_field_bytes }
}

pub(super) fn check(scene: &Scene, findings: &mut Findings) {
    let points = expected_size(scene).points;
    if points > MOST_POINTS {
        let remedy = format!("use larger cells or fewer particles_per_cell: at most {MOST_POINTS} points in all");
        findings.error("body", format!("bodies of about {points} points"), remedy);
    }
}

fn points(body: &Body, scene: &Scene) -> usize {
    let (from, to) = scene.mesh.extent(&body.shape);
    let along = |d: usize| {
        let spans = scene.mesh.knots[d].windows(2).filter(|k| k[1] > k[0]);
        let under = |k: &&[f64]| scene.mesh.geometry.is_some() || (k[1] > from[d] && k[0] < to[d]);
        spans.filter(under).count().saturating_mul(body.particles_per_cell[d])
    };
    along(0).saturating_mul(along(1))
}
