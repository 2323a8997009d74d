//! Pictures of the bodies of the updated frame.

use super::UpdatedFrame;
use super::field::DiscreteField;
use crate::material::degradation::largest_principal;
use crate::output::raster::Raster;

/// Side of the square a point fills in a picture, over the root of its volume. The points of a Gauss rule
/// stand up to 1.16 of that apart.
const FILL: f64 = 1.25;

impl UpdatedFrame {
    /// Phase field, if there is one, and largest principal stress (Pa) on a raster; NaN where there is no
    /// material.
    ///
    /// Each point fills a square, a quarter larger than its volume so that no gaps are left between them.
    /// The stress is a mean over the points weighted with volume, and the phase field that of the body
    /// with the most of a pixel.
    pub(crate) fn paint(&self, raster: &Raster) -> (Option<Vec<f64>>, Vec<f64>) {
        let count = raster.pixels[0] * raster.pixels[1];
        let (mut covered, mut stress, mut most) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        let mut phase = vec![f64::NAN; count];
        for field in &self.fields {
            let [own, weighted] = field.cover(raster);
            for pixel in (0..count).filter(|&pixel| own[pixel] > 0.0) {
                covered[pixel] += own[pixel];
                stress[pixel] += weighted[pixel];
                if own[pixel] > most[pixel] {
                    most[pixel] = own[pixel];
                    phase[pixel] = field.phase_at(raster.center(pixel));
                }
            }
        }
        let empty = |pixel: usize| covered[pixel] < 0.5 * raster.pixel[0] * raster.pixel[1];
        for pixel in 0..count {
            stress[pixel] /= covered[pixel];
            if empty(pixel) {
                (stress[pixel], phase[pixel]) = (f64::NAN, f64::NAN);
            }
        }
        (self.fields.iter().any(|field| field.fracture.is_some()).then_some(phase), stress)
    }
}

impl DiscreteField {
    /// Area of the body in each pixel, m², and the largest principal stress times area.
    fn cover(&self, raster: &Raster) -> [Vec<f64>; 2] {
        let mut covered = vec![0.0; raster.pixels[0] * raster.pixels[1]];
        let mut stress = covered.clone();
        for point in &self.points {
            let half = 0.5 * FILL * point.volume.sqrt();
            let principal = largest_principal(point.stress) / self.volume_ratio(point.strain);
            raster.for_each_overlap(point.position.map(|x| [x - half, x + half]), |pixel, area| {
                covered[pixel] += area;
                stress[pixel] += area * principal;
            });
        }
        [covered, stress]
    }

    /// Phase field at a position, m: 1 if the body does not fracture.
    fn phase_at(&self, position: [f64; 2]) -> f64 {
        let Some(fracture) = &self.fracture else { return 1.0 };
        self.patch.evaluate(fracture.field.control_values(), position).map_or(f64::NAN, |c| c.value)
    }

    /// Present volume over that at t = 0, which leads from the stress of a point to Cauchy's; 1 for small
    /// strains.
    fn volume_ratio(&self, strain: [f64; 3]) -> f64 {
        let dilatation = strain[0] + strain[1];
        if self.deformation.is_some() { (self.thickening * dilatation).exp() } else { 1.0 }
    }
}
