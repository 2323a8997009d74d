//! Fields on a regular raster, for pictures: pixels over a patch, and which of them its spans fill.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::splines::nurbs::locate::Location;
use crate::splines::patch::Patch;

/// Phase field and stress on a raster over the patch, x fastest; NaN outside the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// Time since the start of the run, s.
    pub time: f64,
    /// Number of pixels in x and in y.
    pub pixels: [usize; 2],
    /// Lower left corner of the first pixel, m.
    pub origin: [f64; 2],
    /// Size of a pixel, m.
    pub pixel: [f64; 2],
    /// Phase field, if there is one.
    pub phase: Option<Vec<f64>>,
    /// Largest principal stress of the degraded body, Pa.
    pub stress: Vec<f64>,
}

impl Picture {
    /// Picture at `time` (s) of a phase field, if there is one, and of the largest principal stress (Pa),
    /// both on a raster.
    pub fn new(raster: Raster, time: f64, (phase, stress): (Option<Vec<f64>>, Vec<f64>)) -> Self {
        let Raster { pixels, origin, pixel } = raster;
        Self { time, pixels, origin, pixel, phase, stress }
    }

    /// Centre of pixel `index`, m.
    pub fn center(&self, index: usize) -> [f64; 2] {
        Raster { pixels: self.pixels, origin: self.origin, pixel: self.pixel }.center(index)
    }
}

/// Pixels over a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// Number of pixels in x and in y.
    pub pixels: [usize; 2],
    /// Lower left corner of the first pixel, m.
    pub origin: [f64; 2],
    /// Size of a pixel, m.
    pub pixel: [f64; 2],
}

impl Raster {
    /// Raster of `pixels` over the box around a patch.
    pub fn new(patch: &Patch, pixels: [usize; 2]) -> Self {
        let (low, high) = patch.bounding_box();
        let pixel = [0, 1].map(|d| (high[d] - low[d]) / pixels[d] as f64);
        Self { pixels, origin: low, pixel }
    }

    /// Centre of pixel `index`, m.
    pub fn center(&self, index: usize) -> [f64; 2] {
        let at = [index % self.pixels[0], index / self.pixels[0]];
        [0, 1].map(|d| self.origin[d] + (at[d] as f64 + 0.5) * self.pixel[d])
    }

    /// Index of the pixel that holds a position, or of the nearest one.
    fn pixel_of(&self, position: [f64; 2]) -> usize {
        let at = [0, 1]
            .map(|d| (((position[d] - self.origin[d]) / self.pixel[d]).max(0.0) as usize).min(self.pixels[d] - 1));
        at[1] * self.pixels[0] + at[0]
    }

    /// Index of the pixel that holds a position, if one does.
    pub(crate) fn pixel_at(&self, position: [f64; 2]) -> Option<usize> {
        let at = [0, 1].map(|d| ((position[d] - self.origin[d]) / self.pixel[d]).floor());
        let inside = (0..2).all(|d| at[d] >= 0.0 && at[d] < self.pixels[d] as f64);
        inside.then(|| at[1] as usize * self.pixels[0] + at[0] as usize)
    }

    /// Intervals per direction that put three samples on every pixel along two lines of three positions.
    fn samples(&self, along: [[f64; 2]; 3], across: [[f64; 2]; 3]) -> [usize; 2] {
        let size = self.pixel[0].min(self.pixel[1]);
        [along, across].map(|[a, b, c]| {
            let length = (b[0] - a[0]).hypot(b[1] - a[1]) + (c[0] - b[0]).hypot(c[1] - b[1]);
            (3.0 * length / size).ceil() as usize + 1
        })
    }

    /// Calls `f` with index and overlap (m²) of every pixel that meets a rectangle, given by its ends in x
    /// and y.
    pub(crate) fn for_each_overlap(&self, ends: [[f64; 2]; 2], mut f: impl FnMut(usize, f64)) {
        let near = |d: usize| {
            let at = |x: f64| (((x - self.origin[d]) / self.pixel[d]).max(0.0) as usize).min(self.pixels[d] - 1);
            at(ends[d][0])..=at(ends[d][1])
        };
        let overlap = |d: usize, i: usize| {
            let left = self.origin[d] + i as f64 * self.pixel[d];
            (ends[d][1].min(left + self.pixel[d]) - ends[d][0].max(left)).max(0.0)
        };
        for j in near(1) {
            for i in near(0) {
                f(j * self.pixels[0] + i, overlap(0, i) * overlap(1, j));
            }
        }
    }
}

/// Span and parameters of the centre of every pixel; `None` outside the patch.
pub(crate) fn places_of_pixels(patch: &Patch, raster: &Raster) -> Vec<Option<Location>> {
    let count = raster.pixels[0] * raster.pixels[1];
    let Some(geometry) = &patch.geometry else {
        return (0..count).map(|index| patch.locate(raster.center(index))).collect();
    };
    // Samples of the patch tell which pixels it meets and where to search: a search from nowhere would be
    // slow.
    let mut nearest = vec![(f64::INFINITY, [0.0; 2]); count];
    for (j, t) in patch.spaces[1].spans().iter().enumerate() {
        for (i, s) in patch.spaces[0].spans().iter().enumerate() {
            let at = |u: f64, v: f64| [s.left + u * s.length(), t.left + v * t.length()];
            let place = |u: f64, v: f64| geometry.map(&geometry.shape_functions([i, j], at(u, v))).position;
            let [along, across] = raster.samples(
                [place(0.0, 0.5), place(0.5, 0.5), place(1.0, 0.5)],
                [place(0.5, 0.0), place(0.5, 0.5), place(0.5, 1.0)],
            );
            for (n, m) in (0..=across).flat_map(|n| (0..=along).map(move |m| (n, m))) {
                let (u, v) = (m as f64 / along as f64, n as f64 / across as f64);
                let position = place(u, v);
                let index = raster.pixel_of(position);
                let center = raster.center(index);
                let distance = (position[0] - center[0]).hypot(position[1] - center[1]);
                if distance < nearest[index].0 {
                    nearest[index] = (distance, at(u, v));
                }
            }
        }
    }
    let near = nearest.into_par_iter().enumerate().map(|(index, (distance, parameters))| {
        distance.is_finite().then(|| geometry.locate(raster.center(index), Some(parameters)).ok())?
    });
    near.collect()
}
