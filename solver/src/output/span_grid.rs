//! The spans of the mesh that hold material, with the fields of the control points at their corners: for
//! looking at a run.

use crate::splines::nurbs::locate::Location;
use crate::splines::patch::{Patch, PointFunctions};

/// Spans with material points, body by body.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SpanGrid {
    /// Corners; spans of one body share theirs, spans of different bodies do not.
    pub corners: Vec<Corner>,
    /// Corners of each span, in the order of a quadrilateral: counter-clockwise.
    pub spans: Vec<[usize; 4]>,
}

/// A corner of one or more spans, with the fields of one body there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Number of the body among those that deform, in the order of the scene.
    pub body: usize,
    /// Position now, m: in the total frame it moves with the body, in the updated frame it stays.
    pub position: [f64; 2],
    /// Velocity of the nodal field of the body, m/s; in the updated frame that of half a step before.
    pub velocity: [f64; 2],
    /// Phase field of a body that fractures.
    pub phase: Option<f64>,
}

/// Ends of a span in both directions, counter-clockwise.
const ENDS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

impl SpanGrid {
    /// Adds spans of a patch that hold points of a body; `corner` evaluates the fields of that body.
    pub(crate) fn add(
        &mut self,
        patch: &Patch,
        spans: impl IntoIterator<Item = [usize; 2]>,
        corner: impl Fn(&PointFunctions) -> Corner,
    ) {
        let [columns, rows] = [0, 1].map(|d| patch.spaces[d].spans().len() + 1);
        let mut numbers: Vec<Option<usize>> = vec![None; columns * rows];
        for span in spans {
            let corners = ENDS.map(|end| {
                let number = &mut numbers[(span[1] + end[1]) * columns + span[0] + end[0]];
                *number.get_or_insert_with(|| {
                    let parameters = [0, 1].map(|d| {
                        let span = &patch.spaces[d].spans()[span[d]];
                        [span.left, span.right][end[d]]
                    });
                    // Only functions of spans with points: control points without mass may be anywhere.
                    self.corners.push(corner(&patch.functions(Location { span, parameters })));
                    self.corners.len() - 1
                })
            });
            self.spans.push(corners);
        }
    }
}
