//! Fields on a regular raster, for pictures.

use rayon::prelude::*;

use crate::material::ElasticModuli;
use crate::patch::Patch;
use crate::total_frame::TotalFrame;
use crate::updated_frame::UpdatedFrame;

/// Phase field and stress on a raster over the patch, x fastest; NaN outside the body.
#[derive(Debug, Clone, PartialEq)]
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

/// Pixels over a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// Pixels in x and y.
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

    /// Calls `f` with index and overlap (m²) of every pixel that meets a rectangle, given by its ends in x and y.
    pub fn for_each_overlap(&self, ends: [[f64; 2]; 2], mut f: impl FnMut(usize, f64)) {
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

impl Picture {
    /// Picture of a body at `time` (s).
    pub fn of(frame: &TotalFrame, time: f64, pixels: [usize; 2]) -> Self {
        let raster = Raster::new(frame.patch(), pixels);
        let values: Vec<[f64; 2]> =
            (0..pixels[0] * pixels[1]).into_par_iter().map(|index| values_at(frame, raster.center(index))).collect();
        let phase = frame.fracture.is_some().then(|| values.iter().map(|v| v[0]).collect());
        Self::new(raster, time, phase, values.iter().map(|v| v[1]).collect())
    }

    /// Picture of a body in the updated frame at `time` (s).
    pub fn of_updated(frame: &UpdatedFrame, time: f64, pixels: [usize; 2]) -> Self {
        let raster = Raster::new(frame.patch(), pixels);
        let (phase, stress) = frame.paint(&raster);
        Self::new(raster, time, phase, stress)
    }

    fn new(raster: Raster, time: f64, phase: Option<Vec<f64>>, stress: Vec<f64>) -> Self {
        let Raster { pixels, origin, pixel } = raster;
        Self { time, pixels, origin, pixel, phase, stress }
    }

    /// Centre of pixel `index`, m.
    pub fn center(&self, index: usize) -> [f64; 2] {
        Raster { pixels: self.pixels, origin: self.origin, pixel: self.pixel }.center(index)
    }
}

/// Phase field and largest principal stress at a position.
fn values_at(frame: &TotalFrame, position: [f64; 2]) -> [f64; 2] {
    let outside = [f64::NAN; 2];
    if !frame.shape().contains(position) {
        return outside;
    }
    let Some(functions) = frame.patch().functions_at(position) else { return outside };
    let [ux, uy] = frame.displacement().each_ref().map(|u| functions.interpolate(u).gradient);
    let (strain, growth) = frame.strain([ux, uy]);
    let cauchy = |fracture| largest_principal_stress(frame.moduli(), strain, fracture) / growth;
    match &frame.fracture {
        None => [1.0, cauchy(None)],
        Some(fracture) => {
            let phase = functions.interpolate(fracture.field.control_values()).value;
            [phase, cauchy(Some((&fracture.model, phase)))]
        }
    }
}

fn largest_principal_stress(
    moduli: ElasticModuli,
    strain: [f64; 3],
    fracture: Option<(&crate::material::FractureModel, f64)>,
) -> f64 {
    use crate::lane::Lane;
    let strain = strain.map(Lane::splat);
    let stress = match fracture {
        None => moduli.stress(strain),
        Some((model, phase)) => {
            let state = crate::split::split(&moduli, model.split, strain);
            let g = model.degradation(Lane::splat(phase));
            [0, 1, 2].map(|i| state.stress_minus[i] + g * state.stress_plus[i])
        }
    };
    let [xx, yy, xy] = stress.map(|s| s[0]);
    0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy)
}
