//! What a run shows of a body in the total frame: points one by one, the spans they are in, and pictures. It
//! also finds material that is distorted too far for small strains.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::TotalFrame;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::Lane;
use crate::material::degradation::{BROKEN, largest_principal, stress_at, stress_out_of_plane};
use crate::material::hencky::Distortion;
use crate::material::split::driving_energy;
use crate::output::inspection::{PointFracture, PointState};
use crate::output::picture::{Raster, places_of_pixels};
use crate::output::span_grid::{Corner, SpanGrid};
use crate::phase_field::fracture::LatticeFracture;
use crate::scene::Kinematics;
use crate::splines::nurbs::locate::Location;
use crate::transfer::kernels::LargestDistortion;
use crate::transfer::point_kernel::Fields;
use crate::transfer::sweep::sweep;

/// Samples of a body per pixel and direction where it moves: three leave no gaps up to a stretch of three.
const SAMPLES: f64 = 3.0;

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

    /// Where material that is not broken is distorted most (m, at t = 0) and how, if that is beyond a limit;
    /// `None` with finite strains.
    pub(crate) fn distorted_beyond(&self, limit: f64) -> Option<([f64; 2], Distortion)> {
        if self.kinematics == Kinematics::Finite || self.largest_distortion() <= limit {
            return None;
        }
        let mut most: Option<([f64; 2], Distortion)> = None;
        self.lattice.for_each_point(|batch, lane, position, _| {
            let functions = self.lattice.functions_at(&self.patch, batch, lane);
            let gradient = self.displacement.each_ref().map(|u| functions.interpolate(u).gradient);
            let broken = self.fracture.as_ref().is_some_and(|fracture| fracture.phase[batch][lane] < BROKEN);
            let found = Distortion::of(&gradient, self.fracture.is_none());
            if !broken && found.size() > most.map_or(limit, |(_, most)| most.size()) {
                most = Some((position, found));
            }
        });
        most
    }

    /// An upper bound: the tangent of the largest angle, or the largest strain of a body that cannot break.
    fn largest_distortion(&self) -> f64 {
        let lattice = &self.lattice;
        let phase = self.fracture.as_ref().map_or(&[][..], |fracture| &fracture.phase);
        let mut phases = phase.chunks(lattice.strip_batches());
        let mut kernel = |_| LargestDistortion { phase: phases.next().unwrap_or_default(), size: Lane::ZERO };
        let mut kernels: Vec<_> = (0..lattice.strips()).map(&mut kernel).collect();
        let fields = Fields { displacement: [&self.displacement[0], &self.displacement[1]], phase: &[] };
        sweep(lattice, fields, &mut kernels, None);
        kernels.iter().flat_map(|kernel| kernel.size.0).fold(0.0, larger)
    }

    /// Phase field, if there is one, and largest principal stress (Pa) on a raster; NaN outside the body.
    pub(crate) fn paint(&self, raster: &Raster) -> (Option<Vec<f64>>, Vec<f64>) {
        let places = places_of_pixels(&self.patch, raster);
        let outside = [f64::NAN; 2];
        let values: Vec<[f64; 2]> =
            places.par_iter().map(|place| place.map_or(outside, |place| self.values_at(place).0)).collect();
        let phase = self.fracture.is_some().then(|| values.iter().map(|v| v[0]).collect());
        (phase, values.iter().map(|v| v[1]).collect())
    }

    /// Paints the body where it is now: phase field and largest principal stress (Pa) of every pixel.
    pub(super) fn paint_moved(&self, raster: &Raster, values: &mut [[f64; 2]]) {
        for span in self.spans_with_points().into_values().flatten() {
            let sides = [0, 1].map(|d| &self.patch.spaces[d].spans()[span[d]]);
            let counts = [0, 1].map(|d| (SAMPLES * sides[d].length() / raster.pixel[d]).ceil() as usize);
            let at = |d: usize, i: usize| sides[d].left + (i as f64 + 0.5) / counts[d] as f64 * sides[d].length();
            for (i, j) in (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j))) {
                let (found, present) = self.values_at(Location { span, parameters: [at(0, i), at(1, j)] });
                if let Some(pixel) = raster.pixel_at(present).filter(|_| !found[1].is_nan()) {
                    values[pixel] = found;
                }
            }
        }
    }

    /// Phase field and largest principal stress (Pa) at a place of the patch, NaN outside the body, and where
    /// that is now, m.
    fn values_at(&self, place: Location) -> ([f64; 2], [f64; 2]) {
        let functions = self.patch.functions(place);
        if !self.shape.contains(functions.position) {
            return ([f64::NAN; 2], functions.position);
        }
        let mut here = functions.clone();
        here.lift(self.lattice.lift(functions.values[0].0, functions.position));
        let [x, y] = self.displacement.each_ref().map(|u| here.interpolate(u));
        let present = [functions.position[0] + x.value, functions.position[1] + y.value];
        let (strain, growth) = self.strain([x.gradient, y.gradient]);
        let cauchy = |fracture| largest_principal(stress_at(&self.moduli, strain, fracture)) / growth;
        let values = match &self.fracture {
            None => [1.0, cauchy(None)],
            Some(fracture) => {
                let phase = functions.interpolate(fracture.field.control_values()).value;
                [phase, cauchy(Some((&fracture.model, phase)))]
            }
        };
        (values, present)
    }
}
