//! Pictures of the body of the total frame.

use rayon::prelude::*;

use super::TotalFrame;
use crate::material::degradation::{largest_principal, stress_at};
use crate::output::raster::{Raster, places_of_pixels};
use crate::splines::nurbs::locate::Location;

impl TotalFrame {
    /// Phase field, if there is one, and largest principal stress (Pa) on a raster; NaN outside the body.
    pub(crate) fn paint(&self, raster: &Raster) -> (Option<Vec<f64>>, Vec<f64>) {
        let places = places_of_pixels(self.patch(), raster);
        let outside = [f64::NAN; 2];
        let values: Vec<[f64; 2]> =
            places.par_iter().map(|place| place.map_or(outside, |place| values_at(self, place))).collect();
        let phase = self.fracture.is_some().then(|| values.iter().map(|v| v[0]).collect());
        (phase, values.iter().map(|v| v[1]).collect())
    }
}

/// Phase field and largest principal stress at a place of the patch.
fn values_at(frame: &TotalFrame, place: Location) -> [f64; 2] {
    let functions = frame.patch().functions(place);
    if !frame.shape().contains(functions.position) {
        return [f64::NAN; 2];
    }
    let mut here = functions.clone();
    here.lift(frame.lattice.lift(functions.values[0].0, functions.position));
    let [ux, uy] = frame.displacement().each_ref().map(|u| here.interpolate(u).gradient);
    let (strain, growth) = frame.strain([ux, uy]);
    let cauchy = |fracture| largest_principal(stress_at(&frame.moduli, strain, fracture)) / growth;
    match &frame.fracture {
        None => [1.0, cauchy(None)],
        Some(fracture) => {
            let phase = functions.interpolate(fracture.field.control_values()).value;
            [phase, cauchy(Some((&fracture.model, phase)))]
        }
    }
}
