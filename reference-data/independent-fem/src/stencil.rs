//! A symmetric matrix that couples each node with its eight neighbours, scaled to a unit diagonal.

use std::ops::Range;

use rayon::prelude::*;

/// Node rows of a tile; conjugate gradients leave out tiles whose residual does not count.
pub const TILE_ROWS: usize = 8;
/// Node columns of a tile.
pub const TILE_COLUMNS: usize = 32;

/// Couplings of each node with its neighbours ahead, in arrays of nodal values with a zero guard on either
/// side.
#[derive(Debug)]
pub struct Stencil {
    /// With itself, before scaling.
    pub diagonal: Vec<f64>,
    /// With the next node of the row.
    pub east: Vec<f64>,
    /// With the node above.
    pub north: Vec<f64>,
    /// With the node after that.
    pub north_east: Vec<f64>,
    /// With the node before that.
    pub north_west: Vec<f64>,
    /// Inverse square roots of the diagonal.
    pub scale: Vec<f64>,
    stride: usize,
    zeros: Vec<f64>,
}

impl Stencil {
    /// A zero matrix for arrays like `nodal`.
    pub fn new(nodal: &[f64], stride: usize) -> Self {
        let zero = || nodal.to_vec();
        Self {
            diagonal: zero(),
            east: zero(),
            north: zero(),
            north_east: zero(),
            north_west: zero(),
            scale: zero(),
            stride,
            zeros: vec![0.0; stride],
        }
    }

    /// Scales rows and columns so that the diagonal is one.
    pub fn scale_to_unit_diagonal(&mut self) {
        let stride = self.stride;
        let nodes = 1..stride - 1;
        let rows = self.scale.par_chunks_mut(stride).zip(self.diagonal.par_chunks(stride));
        rows.for_each(|(scale, diagonal)| {
            for i in nodes.clone() {
                scale[i] = 1.0 / diagonal[i].sqrt();
            }
        });
        let (scale, zeros) = (&self.scale, &self.zeros);
        let couplings = (
            self.east.par_chunks_mut(stride),
            self.north.par_chunks_mut(stride),
            self.north_east.par_chunks_mut(stride),
            self.north_west.par_chunks_mut(stride),
        );
        couplings.into_par_iter().enumerate().for_each(|(j, (east, north, north_east, north_west))| {
            let own = &row(scale, j, stride)[..stride];
            let above = &scale.get((j + 1) * stride..(j + 2) * stride).unwrap_or(zeros)[..stride];
            let (east, north) = (&mut east[..stride], &mut north[..stride]);
            let (north_east, north_west) = (&mut north_east[..stride], &mut north_west[..stride]);
            for i in 1..stride - 1 {
                east[i] *= own[i] * own[i + 1];
                north[i] *= own[i] * above[i];
                north_east[i] *= own[i] * above[i + 1];
                north_west[i] *= own[i] * above[i - 1];
            }
        });
    }

    /// Product of row `j` with `p`, whose rows below, here and above are given, for the columns `range`.
    #[inline]
    pub fn multiply_row(&self, j: usize, [below, here, above]: [&[f64]; 3], range: Range<usize>, out: &mut [f64]) {
        let n = self.stride;
        let lower = |values| if j == 0 { &self.zeros[..n] } else { &row(values, j - 1, n)[..n] };
        let (below, here, above, out) = (&below[..n], &here[..n], &above[..n], &mut out[..n]);
        let (east, north) = (&row(&self.east, j, n)[..n], &row(&self.north, j, n)[..n]);
        let (north_east, north_west) = (&row(&self.north_east, j, n)[..n], &row(&self.north_west, j, n)[..n]);
        let (south, south_west, south_east) = (lower(&self.north), lower(&self.north_east), lower(&self.north_west));
        let (start, end) = (range.start.max(1), range.end.min(n - 1));
        for i in start..end {
            out[i] = here[i]
                + east[i] * here[i + 1]
                + east[i - 1] * here[i - 1]
                + north[i] * above[i]
                + south[i] * below[i]
                + north_east[i] * above[i + 1]
                + south_west[i - 1] * below[i - 1]
                + north_west[i] * above[i - 1]
                + south_east[i + 1] * below[i + 1];
        }
    }

    /// Rows below, at and above `j` of an array of nodal values.
    pub fn neighbours<'a>(&'a self, values: &'a [f64], j: usize) -> [&'a [f64]; 3] {
        let n = self.stride;
        let below = if j == 0 { self.zeros.as_slice() } else { row(values, j - 1, n) };
        [below, row(values, j, n), values.get((j + 1) * n..(j + 2) * n).unwrap_or(&self.zeros)]
    }
}

/// Row `j` of an array of nodal values.
pub fn row(values: &[f64], j: usize, stride: usize) -> &[f64] {
    &values[j * stride..(j + 1) * stride]
}

/// Sum of products, in eight interleaved partial sums.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_chunks, b_chunks) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a_chunks.remainder().iter().zip(b_chunks.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_chunks.zip(b_chunks) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}
