//! Preconditioned conjugate gradients on a stencil matrix.

use rayon::prelude::*;

use crate::lane::{LANES, Lane};
use crate::preconditioner::Preconditioner;
use crate::stencil::{CHUNK_ROWS, Stencil};

/// Outcome of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Iterations taken; zero if the start already met the tolerance.
    pub iterations: usize,
    /// Residual norm over the norm of the right-hand side.
    pub relative_residual: f64,
}

/// Working vectors, kept between solves.
#[derive(Debug, Clone)]
pub struct ConjugateGradients {
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    chunk: usize,
}

impl ConjugateGradients {
    /// Room for systems of the size of `matrix`.
    pub fn new(matrix: &Stencil) -> Self {
        let zeros = || matrix.grid.zeros();
        let chunk = CHUNK_ROWS * matrix.grid.stride;
        Self { residual: zeros(), preconditioned: zeros(), direction: zeros(), image: zeros(), chunk }
    }

    /// Improves `x` until `‖b − A x‖ ≤ tolerance ‖b‖`, or `limit` iterations are spent.
    pub fn solve(
        &mut self,
        matrix: &Stencil,
        preconditioner: &Preconditioner,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        limit: usize,
    ) -> Convergence {
        let chunk = self.chunk;
        let scale = dot(chunk, b, b).sqrt();
        matrix.apply(x, &mut self.image);
        let mut square = combine(chunk, &mut self.residual, b, &self.image, -1.0);
        let mut previous = 0.0;
        for iterations in 0.. {
            let relative_residual = square.sqrt() / scale;
            if relative_residual <= tolerance || iterations == limit || !relative_residual.is_finite() {
                return Convergence { iterations, relative_residual };
            }
            let rho = preconditioner.apply(&self.residual, &mut self.preconditioned);
            let beta = if iterations == 0 { 0.0 } else { rho / previous };
            previous = rho;
            self.direction.par_chunks_mut(chunk).zip(self.preconditioned.par_chunks(chunk)).for_each(|(d, z)| {
                for (d, z) in d.iter_mut().zip(z) {
                    *d = z + beta * *d;
                }
            });
            let alpha = rho / matrix.apply(&self.direction, &mut self.image);
            accumulate(chunk, x, &self.direction, alpha);
            accumulate(chunk, &mut self.residual, &self.image, -alpha);
            square = dot(chunk, &self.residual, &self.residual);
        }
        unreachable!("the loop returns")
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        4 * 8 * self.residual.len()
    }
}

/// Inner product, summed chunk by chunk.
pub fn dot(chunk: usize, a: &[f64], b: &[f64]) -> f64 {
    let parts: Vec<f64> = a
        .par_chunks(chunk)
        .zip(b.par_chunks(chunk))
        .map(|(a, b)| {
            let mut sum = Lane::ZERO;
            for (a, b) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
                sum += Lane::load(a, 0) * Lane::load(b, 0);
            }
            sum.sum()
        })
        .collect();
    parts.iter().sum()
}

/// `x += factor y`.
fn accumulate(chunk: usize, x: &mut [f64], y: &[f64], factor: f64) {
    x.par_chunks_mut(chunk).zip(y.par_chunks(chunk)).for_each(|(x, y)| {
        for (x, y) in x.iter_mut().zip(y) {
            *x += factor * y;
        }
    });
}

/// `out = a + factor b`; returns `outᵀ out`.
fn combine(chunk: usize, out: &mut [f64], a: &[f64], b: &[f64], factor: f64) -> f64 {
    out.par_chunks_mut(chunk).zip(a.par_chunks(chunk)).zip(b.par_chunks(chunk)).for_each(|((out, a), b)| {
        for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
            *out = a + factor * b;
        }
    });
    dot(chunk, out, out)
}
