//! Weight function and geometry map at the points of a lattice of parameters.

use super::Lattice;
use super::mapped::{MappedPoint, Mapping};
use crate::linear_algebra::lane::Lane;
use crate::splines::nurbs::NurbsPatch;

impl Lattice {
    /// Evaluates weight function and geometry map at every point.
    pub(super) fn map_by(&mut self, patch: &NurbsPatch) {
        let mut weights = self.grid.zeros();
        for (at, weight) in self.grid.indices().zip(patch.weights()) {
            weights[at] = fault!("rational-weights-ignored", *weight => 1.0);
        }
        let mut points = vec![MappedPoint::default(); self.batches()];
        let mut determinants = vec![Lane::ZERO; self.batches()];
        for batch in 0..self.batches() {
            let (_, tile, _, _) = self.unbatch(batch);
            for lane in 0..self.tiles[tile].count {
                let parameters = self.parameters(batch, lane);
                let Some(span) = patch.find_span(parameters) else { continue };
                let (image, weight) = patch.image(span, parameters);
                let [[xu, xv], [yu, yv]] = image.jacobian;
                let determinant = image.determinant();
                determinants[batch][lane] = fault!("jacobian-missing", determinant => 1.0);
                let point = &mut points[batch];
                point.inverse_weight[lane] = 1.0 / weight.value;
                for d in 0..2 {
                    point.weight_slope[d][lane] = weight.gradient[d] / weight.value;
                    point.position[d][lane] = image.position[d];
                }
                let [yu, xv] = fault!("inverse-map-transposed", [yu, xv] => [xv, yu]);
                for (entry, value) in point.inverse_jacobian.iter_mut().zip([yv, -xv, -yu, xu]) {
                    entry[lane] = value / determinant;
                }
            }
        }
        self.mapping = Some(Box::new(Mapping { weights, points }));
        self.factor = Some(determinants);
    }
}
