//! The points of a body in the total frame, one by one, and the spans they are in: for looking at a run.

use std::collections::{BTreeMap, BTreeSet};

use super::TotalFrame;
use crate::linear_algebra::lane::Lane;
use crate::material::degradation::{stress_at, stress_out_of_plane};
use crate::material::split::driving_energy;
use crate::output::inspection::{PointFracture, PointState};
use crate::output::span_grid::{Corner, SpanGrid};
use crate::phase_field::fracture::LatticeFracture;

impl TotalFrame {
    /// Calls `f` with the state of every point.
    pub(crate) fn for_each_point_state(&self, f: &mut dyn FnMut(PointState)) {
        let mut point = 0;
        self.lattice.for_each_point(|batch, lane, position, area| {
            let functions = self.lattice.functions_at(&self.patch, batch, lane);
            let value = |field: &Vec<f64>| functions.interpolate(field);
            let [x, y] = self.displacement.each_ref().map(value);
            let displacement = [x.value, y.value];
            let velocity = self.velocity.each_ref().map(|v| value(v).value);
            let present = [0, 1].map(|d| position[d] + displacement[d]);
            let (strain, _) = self.strain([x.gradient, y.gradient]);
            let fracture = self.fracture.as_ref();
            let degraded = fracture.map(|f| (&f.model, f.phase[batch][lane]));
            let stress = stress_at(&self.moduli, strain, degraded);
            let stress_out_of_plane = stress_out_of_plane(&self.moduli, strain, degraded);
            let drive = |f: &LatticeFracture| {
                // with a threshold it is the present one, and stored only where it is near the threshold
                let present = || driving_energy(&self.moduli, f.model.split, strain.map(Lane::splat))[0];
                if f.has_threshold() { present() } else { f.history[batch][lane] }
            };
            let fracture = fracture.map(|f| PointFracture { history: drive(f), phase: f.phase[batch][lane] });
            f(PointState {
                body: 0,
                point,
                area,
                position,
                present,
                displacement,
                velocity,
                strain,
                stress,
                stress_out_of_plane,
                fracture,
            });
            point += 1;
        });
    }

    /// Adds the spans with points of this body; their corners move with it.
    pub(super) fn add_spans(&self, body: usize, grid: &mut SpanGrid) {
        for (lift, spans) in self.spans_with_points() {
            grid.add(&self.patch, spans, |functions| {
                let mut here = functions.clone();
                here.lift(lift);
                let value = |field: &Vec<f64>| here.interpolate(field).value;
                let displacement = self.displacement.each_ref().map(value);
                Corner {
                    body,
                    position: [0, 1].map(|d| functions.position[d] + displacement[d]),
                    velocity: self.velocity.each_ref().map(value),
                    phase: self.fracture.as_ref().map(|f| functions.interpolate(f.field.control_values()).value),
                }
            });
        }
    }

    /// The spans with points, by the distance of their control points from those of the patch: a span that a
    /// slit cuts is there once for each side.
    pub(super) fn spans_with_points(&self) -> BTreeMap<usize, BTreeSet<[usize; 2]>> {
        let mut spans = BTreeMap::<usize, BTreeSet<[usize; 2]>>::new();
        self.lattice.for_each_point(|batch, lane, _, _| {
            let span = self.lattice.location(&self.patch, batch, lane).span;
            spans.entry(self.lattice.lift_of(batch)).or_default().insert(span);
        });
        spans
    }
}
