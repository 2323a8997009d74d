//! The sweep over a strip of spans that the boundary cuts: eight points of one span at a time, whose shape
//! functions have the same control points.

use super::strip::{StripForce, StripSweep};
use crate::linear_algebra::lane::Lane;
use crate::particles::lattice::CutBatch;
use crate::transfer::point_kernel::{PointKernel, PointValues, Stress};

impl<K: PointKernel> StripSweep<'_, K> {
    /// All batches of the strip.
    #[inline(always)]
    pub(super) fn cut_spans<const FMA: bool>(self, kx: usize, ky: usize) {
        let Self { lattice, fields, strip, kernel, mut force } = self;
        let grid = lattice.grid;
        for (at, batch) in lattice.cut_strip(strip).iter().enumerate() {
            if kernel.skips(at / lattice.points_per_span()) {
                continue;
            }
            let CutBatch { first: [column, row], lift, weight, value: [_, y], derivative: [_, dy], .. } = batch;
            let mut point = PointValues::default();
            for l in 0..ky {
                if K::DISPLACEMENT {
                    let at = grid.index(*column, row + lift + l);
                    for d in 0..2 {
                        let [sum, slope] = along_x::<FMA>(batch, &fields.displacement[d][at..at + kx]);
                        let g = &mut point.gradient;
                        g[2 * d] = g[2 * d].add_product::<FMA>(slope, y[l]);
                        g[2 * d + 1] = g[2 * d + 1].add_product::<FMA>(sum, dy[l]);
                    }
                }
                if K::PHASE {
                    let at = grid.index(*column, row + l);
                    let [sum, slope] = along_x::<FMA>(batch, &fields.phase[at..at + kx]);
                    point.phase = point.phase.add_product::<FMA>(sum, y[l]);
                    if K::PHASE_GRADIENT {
                        let g = &mut point.phase_gradient;
                        g[0] = g[0].add_product::<FMA>(slope, y[l]);
                        g[1] = g[1].add_product::<FMA>(sum, dy[l]);
                    }
                }
            }
            let stress = kernel.points::<FMA>(at, *weight, &point);
            if let (true, Some(force)) = (K::STRESS, force.as_deref_mut()) {
                let base = grid.index(*column, row + lift - force.first_row);
                add_forces::<FMA>(batch, &stress, [kx, ky], base, grid.stride, force);
            }
        }
    }
}

/// Sum over a row of control values, and its slope in x.
#[inline(always)]
fn along_x<const FMA: bool>(batch: &CutBatch, controls: &[f64]) -> [Lane; 2] {
    let mut sums = [Lane::ZERO; 2];
    for (k, control) in controls.iter().enumerate() {
        sums[0] = sums[0].add_scaled::<FMA>(batch.value[0][k], *control);
        sums[1] = sums[1].add_scaled::<FMA>(batch.derivative[0][k], *control);
    }
    sums
}

/// Integrates stresses against the gradients of the functions, from index `base` of the forces on.
#[inline(always)]
fn add_forces<const FMA: bool>(
    batch: &CutBatch,
    stress: &Stress,
    [kx, ky]: [usize; 2],
    base: usize,
    stride: usize,
    force: &mut StripForce,
) {
    let CutBatch { weight, value: [x, y], derivative: [dx, dy], .. } = batch;
    let weighted = [[stress.xx, stress.xy], [stress.yx, stress.yy]].map(|s| s.map(|s| s * *weight));
    for l in 0..ky {
        for (component, [sx, sy]) in force.components.iter_mut().zip(weighted) {
            let (in_x, in_y) = (sx * y[l], sy * dy[l]);
            for k in 0..kx {
                let force = (in_x * dx[k]).add_product::<FMA>(in_y, x[k]);
                component[base + l * stride + k] += fault!("cut-forces-of-one-point", force.sum() => force[0]);
            }
        }
    }
}
