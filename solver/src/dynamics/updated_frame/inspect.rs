//! The points of the bodies in the updated frame, one by one, and the spans they are in: for looking at a
//! run.

use super::UpdatedFrame;
use crate::material::degradation::stress_out_of_plane;
use crate::output::inspection::{PointFracture, PointState};
use crate::output::span_grid::{Corner, SpanGrid};
use crate::particles::points::Point;

impl UpdatedFrame {
    /// Calls `f` with the state of every point.
    pub(crate) fn for_each_point_state(&self, f: &mut dyn FnMut(PointState)) {
        for (field, body) in self.fields.iter().zip(self.bodies.iter().copied()) {
            for (point, carried) in field.points.iter().enumerate() {
                let cracked = field.fracture.as_ref().map(|fracture| (&fracture.model, fracture.points[point]));
                let fracture = cracked.map(|(_, c)| PointFracture { history: c.history, phase: c.phase });
                let Point { position, velocity, displacement, strain, stress, .. } = *carried;
                let degraded = cracked.map(|(model, c)| (model, c.phase));
                let stress_out_of_plane = stress_out_of_plane(&field.moduli, strain, degraded);
                f(PointState {
                    body,
                    point,
                    area: carried.volume,
                    position,
                    present: position,
                    displacement,
                    velocity,
                    strain,
                    stress,
                    stress_out_of_plane,
                    fracture,
                });
            }
        }
    }

    /// The spans with points of each body, with the nodal fields of that body.
    pub(crate) fn span_grid(&self) -> SpanGrid {
        let mut grid = SpanGrid::default();
        for (field, body) in self.fields.iter().zip(self.bodies.iter().copied()) {
            let spans = field.cells.cells.iter().map(|cell| cell.span);
            let velocity = &field.nodes.velocity;
            grid.add(&field.patch, spans, |functions| Corner {
                body,
                position: functions.position,
                velocity: velocity.each_ref().map(|v| functions.interpolate(v).value),
                phase: field.fracture.as_ref().map(|f| functions.interpolate(f.field.control_values()).value),
            });
        }
        grid
    }
}
