//! Conjugate gradients on tiles of nodes whose residual counts, for a matrix with unit diagonal.

use std::ops::Range;

use rayon::prelude::*;

use crate::stencil::{Stencil, TILE_COLUMNS, TILE_ROWS, dot, row};

/// Tiles beside a row of tiles that counts are kept as well: this many rows, and one column.
const MARGIN: usize = 2;

/// Solves `A x = b` again and again, from starts close to the solution.
#[derive(Debug)]
pub struct ConjugateGradients {
    stride: usize,
    rows: usize,
    /// Rows of a band, the work of one thread: a multiple of [`TILE_ROWS`].
    band: usize,
    residual: Vec<f64>,
    direction: Vec<f64>,
    last_direction: Vec<f64>,
    product: Vec<f64>,
    /// Columns of each row of tiles that are iterated on.
    active: Vec<Vec<Range<usize>>>,
    halos: Vec<[Vec<f64>; 2]>,
}

/// When a solve ends.
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    /// Norm of the residual over that of the right-hand side.
    pub tolerance: f64,
    /// Whether tiles of small residual are left out.
    pub tiles: bool,
    /// Most iterations.
    pub most: usize,
}

impl ConjugateGradients {
    /// For arrays like `nodal`, on so many threads.
    pub fn new(nodal: &[f64], stride: usize, threads: usize) -> Self {
        let rows = nodal.len() / stride;
        let tile_rows = rows.div_ceil(TILE_ROWS);
        let band = tile_rows.div_ceil(threads) * TILE_ROWS;
        let halo = || [vec![0.0; stride], vec![0.0; stride]];
        Self {
            stride,
            rows,
            band,
            residual: nodal.to_vec(),
            direction: nodal.to_vec(),
            last_direction: nodal.to_vec(),
            product: nodal.to_vec(),
            active: vec![Vec::new(); tile_rows],
            halos: (0..rows.div_ceil(band)).map(|_| halo()).collect(),
        }
    }

    /// Improves `x` until the residual is small enough; `b` is scaled as the matrix is. Gives the iterations.
    pub fn solve(&mut self, a: &Stencil, b: &[f64], x: &mut [f64], stop: Stop) -> usize {
        let size: f64 = b.par_chunks(self.stride).map(square).collect::<Vec<f64>>().iter().sum();
        let limit = stop.tolerance * stop.tolerance * size;
        let tiles = self.start(a, b, x);
        if tiles.iter().flatten().sum::<f64>() <= limit {
            return 0;
        }
        let count = (tiles.len() * tiles[0].len()) as f64;
        let negligible = if stop.tiles { 0.25 * limit / count } else { -1.0 };
        let mut squared = self.choose(&tiles, negligible);
        let limit = if stop.tiles { 0.7 * limit } else { limit };
        let mut beta = 0.0;
        let mut iterations = 0;
        while squared > limit && iterations < stop.most {
            let alpha = squared / self.advance(a, beta);
            let next = self.step(alpha, x);
            beta = next / squared;
            squared = next;
            iterations += 1;
        }
        self.forget_directions();
        iterations
    }

    /// Residual `b − A x`, and its square tile by tile.
    fn start(&mut self, a: &Stencil, b: &[f64], x: &[f64]) -> Vec<Vec<f64>> {
        let stride = self.stride;
        let columns = (stride - 2).div_ceil(TILE_COLUMNS);
        let strips = self.residual.par_chunks_mut(TILE_ROWS * stride).enumerate();
        let squares = strips.map(|(tile, residual)| {
            let mut squares = vec![0.0; columns];
            for (k, residual) in residual.chunks_exact_mut(stride).enumerate() {
                let j = tile * TILE_ROWS + k;
                a.multiply_row(j, a.neighbours(x, j), 0..stride, residual);
                for (residual, b) in residual[1..stride - 1].iter_mut().zip(&row(b, j, stride)[1..stride - 1]) {
                    *residual = b - *residual;
                }
                for (square_sum, part) in squares.iter_mut().zip(residual[1..stride - 1].chunks(TILE_COLUMNS)) {
                    *square_sum += square(part);
                }
            }
            squares
        });
        squares.collect()
    }

    /// Tiles whose squared residual exceeds `negligible`, with a margin, are iterated on; gives the square
    /// left in them.
    fn choose(&mut self, tiles: &[Vec<f64>], negligible: f64) -> f64 {
        let (rows, columns) = (tiles.len(), tiles[0].len());
        let counts = |row: usize, column: usize| tiles[row][column] > negligible;
        let mut sum = 0.0;
        for (j, spans) in self.active.iter_mut().enumerate() {
            spans.clear();
            let near = j.saturating_sub(MARGIN)..(j + MARGIN + 1).min(rows);
            for i in 0..columns {
                let beside = i.saturating_sub(1)..(i + 2).min(columns);
                if !near.clone().any(|row| beside.clone().any(|column| counts(row, column))) {
                    continue;
                }
                sum += tiles[j][i];
                let (start, end) = (1 + i * TILE_COLUMNS, (1 + (i + 1) * TILE_COLUMNS).min(self.stride - 1));
                match spans.last_mut().filter(|last| last.end == start) {
                    Some(last) => last.end = end,
                    None => spans.push(start..end),
                }
            }
        }
        sum
    }

    /// Direction `r + beta d`, product with the matrix, and their scalar product.
    fn advance(&mut self, a: &Stencil, beta: f64) -> f64 {
        std::mem::swap(&mut self.direction, &mut self.last_direction);
        let (stride, rows, band, active) = (self.stride, self.rows, self.band, &self.active);
        let (residual, last) = (&self.residual, &self.last_direction);
        let update = |j: usize, direction: &mut [f64]| {
            for span in &active[j / TILE_ROWS] {
                let parts = (&row(residual, j, stride)[span.clone()], &row(last, j, stride)[span.clone()]);
                for (d, (r, l)) in direction[span.clone()].iter_mut().zip(parts.0.iter().zip(parts.1)) {
                    *d = r + beta * l;
                }
            }
        };
        let bands = (
            self.direction.par_chunks_mut(band * stride),
            self.product.par_chunks_mut(band * stride),
            self.halos.par_iter_mut(),
        );
        let sums = bands.into_par_iter().enumerate().map(|(number, (direction, product, [below, above]))| {
            let first = number * band;
            let count = direction.len() / stride;
            below.fill(0.0);
            above.fill(0.0);
            if first > 0 {
                update(first - 1, below);
            }
            if first + count < rows {
                update(first + count, above);
            }
            update(first, &mut direction[..stride]);
            let mut sums = vec![0.0; count.div_ceil(TILE_ROWS)];
            for k in 0..count {
                if k + 1 < count {
                    update(first + k + 1, &mut direction[(k + 1) * stride..(k + 2) * stride]);
                }
                let here = row(direction, k, stride);
                let lower = if k == 0 { below.as_slice() } else { row(direction, k - 1, stride) };
                let upper = if k + 1 == count { above.as_slice() } else { row(direction, k + 1, stride) };
                let product = &mut product[k * stride..(k + 1) * stride];
                for span in &active[(first + k) / TILE_ROWS] {
                    a.multiply_row(first + k, [lower, here, upper], span.clone(), product);
                    sums[k / TILE_ROWS] += dot(&here[span.clone()], &product[span.clone()]);
                }
            }
            sums
        });
        // Tile by tile: the same bits for any number of threads.
        sums.collect::<Vec<_>>().iter().flatten().sum()
    }

    /// Moves `x` along the direction; gives the square of the new residual.
    fn step(&mut self, alpha: f64, x: &mut [f64]) -> f64 {
        let (stride, active) = (self.stride, &self.active);
        let size = TILE_ROWS * stride;
        let arrays = (
            x.par_chunks_mut(size),
            self.residual.par_chunks_mut(size),
            self.direction.par_chunks(size),
            self.product.par_chunks(size),
        );
        let sums = arrays.into_par_iter().zip(active).map(|((x, residual, direction, product), spans)| {
            let mut sum = 0.0;
            for k in 0..x.len() / stride {
                for span in spans {
                    let range = k * stride + span.start..k * stride + span.end;
                    let (x, r) = (&mut x[range.clone()], &mut residual[range.clone()]);
                    for (((x, r), d), q) in
                        x.iter_mut().zip(r).zip(&direction[range.clone()]).zip(&product[range.clone()])
                    {
                        *x += alpha * d;
                        *r -= alpha * q;
                    }
                    sum += square(&residual[range]);
                }
            }
            sum
        });
        sums.collect::<Vec<f64>>().iter().sum()
    }

    /// Outside the tiles that are iterated on, directions are zero.
    fn forget_directions(&mut self) {
        let (stride, active) = (self.stride, &self.active);
        for directions in [&mut self.direction, &mut self.last_direction] {
            directions.par_chunks_mut(stride).enumerate().for_each(|(j, row)| {
                active[j / TILE_ROWS].iter().for_each(|span| row[span.clone()].fill(0.0));
            });
        }
    }
}

fn square(values: &[f64]) -> f64 {
    dot(values, values)
}
