//! Shape functions, fields and places of the points of a lattice, and integrals over them against shape
//! functions and their gradients.

use rayon::prelude::*;

use super::{BatchFunctions, CutBatch, Lattice};
use crate::linear_algebra::lane::{LANES, Lane};
use crate::splines::nurbs::locate::Location;
use crate::splines::patch::{Patch, PointFunctions};
use crate::splines::spline::MAX_FUNCTIONS;

impl Lattice {
    /// Shape functions of a batch; those of lane l belong to control points l columns further than those of
    /// lane 0, but for spans that the boundary cuts.
    pub fn shape_functions(&self, batch: usize) -> BatchFunctions {
        let [kx, ky] = self.degree.map(|p| p + 1);
        let mut functions =
            BatchFunctions { value: [Lane::ZERO; MAX_FUNCTIONS], gradient: [[Lane::ZERO; 2]; MAX_FUNCTIONS] };
        if let Some(CutBatch { value: [x, y], derivative: [dx, dy], .. }) = self.cut_batch(batch) {
            for (l, k) in (0..ky).flat_map(|l| (0..kx).map(move |k| (l, k))) {
                functions.value[l * kx + k] = x[k] * y[l];
                functions.gradient[l * kx + k] = [dx[k] * y[l], x[k] * dy[l]];
            }
            return functions;
        }
        let (row_index, tile_index, b, a) = self.unbatch(batch);
        let (row, tile) = (&self.rows[row_index], &self.tiles[tile_index]);
        for l in 0..ky {
            for k in 0..kx {
                let (n, x, dx) = (l * kx + k, tile.value[a * kx + k], tile.derivative[a * kx + k]);
                functions.value[n] = x * row.value[b][l];
                functions.gradient[n] = [dx * row.value[b][l], x * row.derivative[b][l]];
                if let Some(mapping) = &self.mapping {
                    let weight = Lane::load(&mapping.weights, self.grid.index(tile.first + k, row.first + l));
                    let [u, v] = functions.gradient[n].map(|g| g * weight);
                    let rational = mapping.points[batch].field(functions.value[n] * weight, [u, v]);
                    (functions.value[n], functions.gradient[n]) = rational;
                }
            }
        }
        functions
    }

    /// Calls `f` with every function (k, l) of the span of a batch and its values.
    #[inline(always)]
    pub(super) fn for_each_value(&self, batch: usize, mut f: impl FnMut(usize, usize, Lane)) {
        let [kx, ky] = self.degree.map(|p| p + 1);
        let functions = || (0..ky).flat_map(move |l| (0..kx).map(move |k| (k, l)));
        if let Some(CutBatch { value: [x, y], .. }) = self.cut_batch(batch) {
            functions().for_each(|(k, l)| f(k, l, x[k] * y[l]));
        } else if self.mapping.is_some() {
            let values = self.shape_functions(batch).value;
            functions().for_each(|(k, l)| f(k, l, values[l * kx + k]));
        } else {
            let (row, tile, b, a) = self.unbatch(batch);
            let (x, y) = (&self.tiles[tile].value[a * kx..], &self.rows[row].value[b]);
            functions().for_each(|(k, l)| f(k, l, x[k] * y[l]));
        }
    }

    /// Values of a field of control values at a batch of points.
    pub(crate) fn value(&self, batch: usize, field: &[f64]) -> Lane {
        let mut sum = Lane::ZERO;
        self.for_each_value(batch, |k, l, value| sum += value * self.control_values(batch, k, l, field));
        sum
    }

    /// Value and gradient of a field of control values at a batch of points.
    pub fn interpolate(&self, batch: usize, field: &[f64]) -> (Lane, [Lane; 2]) {
        let functions = self.shape_functions(batch);
        let kx = self.degree[0] + 1;
        let (mut value, mut gradient) = (Lane::ZERO, [Lane::ZERO; 2]);
        for n in 0..kx * (self.degree[1] + 1) {
            let control = self.control_values(batch, n % kx, n / kx, field);
            value += functions.value[n] * control;
            for d in 0..2 {
                gradient[d] += functions.gradient[n][d] * control;
            }
        }
        (value, gradient)
    }

    /// Control values of function (k, l) of the span of each point of a batch.
    fn control_values(&self, batch: usize, k: usize, l: usize, field: &[f64]) -> Lane {
        if let Some(CutBatch { first: [column, row], lift, .. }) = self.cut_batch(batch) {
            return Lane::splat(field[self.grid.index(column + k, row + lift + l)]);
        }
        let (row, tile, ..) = self.unbatch(batch);
        Lane::load(field, self.grid.index(self.tiles[tile].first + k, self.rows[row].first + l))
    }

    /// Position of the point of a batch in a lane, m.
    pub fn position(&self, batch: usize, lane: usize) -> [f64; 2] {
        if let Some(mapping) = &self.mapping {
            return mapping.points[batch].position.map(|x| x[lane]);
        }
        if let Some(cut) = self.cut_batch(batch) {
            return cut.position.map(|x| x[lane]);
        }
        self.parameters(batch, lane)
    }

    /// Parameters of the point of a batch in a lane; its position (m) over a rectangle.
    pub(super) fn parameters(&self, batch: usize, lane: usize) -> [f64; 2] {
        let (row, tile, b, a) = self.unbatch(batch);
        [self.tiles[tile].position[a][lane], self.rows[row].position[b]]
    }

    /// Shape functions at the point of a batch in a lane, with the control points of the body.
    pub(crate) fn functions_at(&self, patch: &Patch, batch: usize, lane: usize) -> PointFunctions {
        let mut functions = patch.functions(self.location(patch, batch, lane));
        functions.lift(self.lift_of(batch));
        functions
    }

    /// Distance in fields of the control points of a batch from those of the patch.
    pub(crate) fn lift_of(&self, batch: usize) -> usize {
        let lift = self.cut_batch(batch).map_or_else(|| self.rows[self.unbatch(batch).0].lift, |cut| cut.lift);
        lift * self.grid.stride
    }

    /// Column and row of the first function of the span of the point of a batch in a lane.
    pub(crate) fn first_of(&self, batch: usize, lane: usize) -> [usize; 2] {
        if let Some(cut) = self.cut_batch(batch) {
            return cut.first;
        }
        let (row, tile, _, _) = self.unbatch(batch);
        [self.tiles[tile].first + lane, self.rows[row].first - self.rows[row].lift]
    }

    /// Span and parameters on `patch` of the point of a batch in a lane.
    pub fn location(&self, patch: &Patch, batch: usize, lane: usize) -> Location {
        let first = self.first_of(batch, lane);
        let span = [0, 1].map(|d| patch.spaces[d].spans().partition_point(|span| span.first < first[d]));
        let cut = self.cut_batch(batch).map(|cut| cut.position.map(|x| x[lane]));
        Location { span, parameters: cut.unwrap_or_else(|| self.parameters(batch, lane)) }
    }

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
