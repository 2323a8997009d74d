//! Integrals over the points of a lattice against shape functions and their gradients.

use rayon::prelude::*;

use super::{CutBatch, Lattice};
use crate::linear_algebra::lane::{LANES, Lane};

impl Lattice {
    /// `Σ_p V_p f_p N_I(x_p)` of a density at the points, as a field; `density` gets batch, lane and
    /// position.
    pub fn integrate(&self, density: impl Fn(usize, usize, [f64; 2]) -> f64 + Sync) -> Vec<f64> {
        let mut out = self.grid.zeros();
        self.add_integral(&mut [&mut out], |batch, lane, position| ([density(batch, lane, position)], [[0.0; 2]]));
        out
    }

    /// Adds `Σ_p V_p (f_p N_I + s_p · grad N_I)` to fields; `density` gives f and s of each field for a
    /// batch, lane and position.
    pub fn add_integral<const F: usize>(
        &self,
        out: &mut [&mut Vec<f64>; F],
        density: impl Fn(usize, usize, [f64; 2]) -> ([f64; F], [[f64; 2]; F]) + Sync,
    ) {
        let [kx, ky] = self.degree.map(|p| p + 1);
        let of_batch = |batch: usize| {
            let weight = self.weights_of(batch);
            let (mut force, mut stress) = ([Lane::ZERO; F], [[Lane::ZERO; 2]; F]);
            for lane in (0..LANES).filter(|&lane| weight[lane] > 0.0) {
                let (f, s) = density(batch, lane, self.position(batch, lane));
                for i in 0..F {
                    force[i][lane] = f[i];
                    for d in 0..2 {
                        stress[i][d][lane] = s[i][d];
                    }
                }
            }
            (weight, force, stress)
        };
        let densities: Vec<_> = (0..self.batches()).into_par_iter().map(of_batch).collect();
        for (batch, (weight, force, stress)) in densities.into_iter().enumerate() {
            if weight == Lane::ZERO {
                continue;
            }
            let functions = self.shape_functions(batch);
            for l in 0..ky {
                for k in 0..kx {
                    let (value, [x, y]) = (functions.value[l * kx + k], functions.gradient[l * kx + k]);
                    for i in 0..F {
                        let share = (force[i] * value + stress[i][0] * x + stress[i][1] * y) * weight;
                        self.add_to_control_values(batch, k, l, share, out[i]);
                    }
                }
            }
        }
    }

    /// Adds `V_p f_p N_I(x_p)` of a density at the points of a batch to a field.
    pub(crate) fn add_density(&self, batch: usize, density: Lane, field: &mut [f64]) {
        let weighted = density * self.weights_of(batch);
        self.for_each_value(batch, |k, l, value| self.add_to_control_values(batch, k, l, weighted * value, field));
    }

    /// Adds to the control values of function (k, l) of the span of each point of a batch.
    fn add_to_control_values(&self, batch: usize, k: usize, l: usize, share: Lane, field: &mut [f64]) {
        if let Some(CutBatch { first: [column, row], lift, .. }) = self.cut_batch(batch) {
            field[self.grid.index(column + k, row + lift + l)] += share.sum();
            return;
        }
        let (row, tile, ..) = self.unbatch(batch);
        share.add_to(field, self.grid.index(self.tiles[tile].first + k, self.rows[row].first + l));
    }
}
