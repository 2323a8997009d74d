//! Pictures of the body of the total frame.

use rayon::prelude::*;

use super::TotalFrame;
use crate::material::degradation::{largest_principal, stress_at};
use crate::output::raster::{Raster, places_of_pixels};
use crate::splines::nurbs::locate::Location;

/// Samples of a body per pixel and direction where it moves: three leave no gaps up to a stretch of three.
const SAMPLES: f64 = 3.0;

impl TotalFrame {
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
