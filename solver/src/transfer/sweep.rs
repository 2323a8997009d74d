//! One pass over the material points of a body: control values to points, physics at the points, points to
//! nodes.
//!
//! In the total frame the transfers G2P and P2G (E 15–18) are interpolation from and integration onto control
//! points that never move, and both factor over the directions. A sweep walks down a column of tiles with the
//! partial sums in x of the last `q + 1` control rows at hand, so every control value is read and every nodal
//! force written once per strip. What happens at the points is a [`PointKernel`]; what it does not ask for is
//! not interpolated.

mod cut;
mod strip;

use rayon::prelude::*;

use super::point_kernel::{Fields, PointKernel};
use crate::linear_algebra::lane::dispatch;
use crate::particles::lattice::Lattice;
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
