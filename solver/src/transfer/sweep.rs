//! One pass over the material points of a body: control values to points, physics at the points, points to
//! nodes.
//!
//! In the total frame the transfers G2P and P2G (E 15–18) are interpolation from and integration onto control
//! points that never move, and both factor over the directions. A sweep walks down a column of tiles with the
//! partial sums in x of the last `q + 1` control rows at hand, so every control value is read and every nodal
//! force written once per strip. What happens at the points is a [`PointKernel`]; what it does not ask for is
//! not interpolated.
//!
//! A strip of spans that the boundary cuts is swept eight points of one span at a time, whose shape functions
//! have the same control points.

mod strip;

use rayon::prelude::*;

use super::point_kernel::{Fields, PointKernel, PointValues, Stress};
use crate::linear_algebra::lane::{Lane, dispatch};
use crate::particles::lattice::{CutBatch, Lattice};
use strip::{StripForce, StripSweep};

/// Nodal forces strip by strip; neighbouring strips share control rows and are added in a fixed order.
#[derive(Debug, Clone)]
pub struct StripForces {
    /// Strips with points.
    strips: Vec<Option<StripForce>>,
}

impl StripForces {
    /// Room for the forces on the control points of `lattice`.
    pub fn new(lattice: &Lattice) -> Self {
        let strips = (0..lattice.strips()).map(|strip| {
            let rows = lattice.strip_control_rows(strip);
            let length = rows.len() * lattice.grid.stride;
            let columns = lattice.columns_of_strip(strip)?;
            Some(StripForce { first_row: rows.start, columns, components: [vec![0.0; length], vec![0.0; length]] })
        });
        Self { strips: strips.collect() }
    }

    /// Adds the strips up, per unit thickness: N/m, into fields on the control points.
    pub fn assemble(&self, stride: usize, out: &mut [Vec<f64>; 2]) {
        let [x, y] = out;
        x.par_chunks_mut(stride).zip(y.par_chunks_mut(stride)).enumerate().for_each(|(row, (x, y))| {
            let reaches = |strip: &&StripForce| {
                row >= strip.first_row && (row - strip.first_row) * stride < strip.components[0].len()
            };
            for strip in self.strips.iter().flatten().filter(reaches) {
                x[strip.columns.clone()].fill(0.0);
                y[strip.columns.clone()].fill(0.0);
            }
            for strip in self.strips.iter().flatten().filter(reaches) {
                let part = (row - strip.first_row) * stride..(row - strip.first_row + 1) * stride;
                for (out, component) in [&mut *x, &mut *y].into_iter().zip(&strip.components) {
                    let added = &component[part.clone()][strip.columns.clone()];
                    out[strip.columns.clone()].iter_mut().zip(added).for_each(|(value, add)| *value += add);
                }
            }
        });
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        self.strips.iter().flatten().map(|s| 16 * s.components[0].len()).sum()
    }
}

/// Runs one kernel per strip over the points of `lattice`; `forces` receives the integrated stresses.
pub fn sweep<K: PointKernel>(lattice: &Lattice, fields: Fields, kernels: &mut [K], forces: Option<&mut StripForces>) {
    assert_eq!(kernels.len(), lattice.strips(), "one kernel per strip");
    match forces {
        Some(forces) if K::STRESS => {
            kernels.par_iter_mut().zip(&mut forces.strips).enumerate().for_each(|(strip, (kernel, force))| {
                let Some(force) = force else { return };
                if !kernel.adds() {
                    let rows = force.components.iter_mut().flat_map(|c| c.chunks_mut(lattice.grid.stride));
                    rows.for_each(|row| row[force.columns.clone()].fill(0.0));
                }
                dispatch(StripSweep { lattice, fields, strip, kernel, force: Some(force) });
            });
        }
        _ => {
            kernels.par_iter_mut().enumerate().filter(|(strip, _)| lattice.columns_of_strip(*strip).is_some()).for_each(
                |(strip, kernel)| {
                    dispatch(StripSweep { lattice, fields, strip, kernel, force: None });
                },
            )
        }
    }
}

impl<K: PointKernel> StripSweep<'_, K> {
    /// All batches of a strip of spans that the boundary cuts.
    #[inline(always)]
    fn cut_spans<const FMA: bool>(self, kx: usize, ky: usize) {
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
