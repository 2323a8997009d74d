//! Fields on a regular raster, for pictures.

use serde::{Deserialize, Serialize};

use super::raster::Raster;

/// Phase field and stress on a raster over the patch, x fastest; NaN outside the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// Time, s.
    pub time: f64,
    /// Pixels in x and y.
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
