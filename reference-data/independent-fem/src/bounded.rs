//! The least energy `½ x·A x − b·x` with x between 0 and a bound, by a primal-dual active set: nodes that the
//! residual pushes against an end are held there, the others are found by conjugate gradients. Without the
//! end 0, an overshoot below it could never be taken back, and what is broken would become stiff again.

use std::ops::Range;

use rayon::prelude::*;

use crate::stencil::{Stencil, dot, row};

/// Most changes of the set of held nodes, and most iterations for one set.
const MOST: [usize; 2] = [200, 5000];

/// Improves `x`, which is between 0 and `bound`, until the residual of free nodes and what pulls held nodes
/// from their ends are below `tolerance` of `b`; the matrix has a unit diagonal. Gives the iterations.
///
/// # Panics
/// If no set of held nodes is found.
pub fn solve(a: &Stencil, stride: usize, b: &[f64], bound: &[f64], x: &mut [f64], tolerance: f64) -> usize {
    let limit = tolerance * dot(b, b).sqrt();
    let mut residual = vec![0.0; b.len()];
    let mut iterations = 0;
    for _ in 0..MOST[0] {
        residual.par_chunks_mut(stride).enumerate().for_each(|(j, residual)| {
            a.multiply_row(j, a.neighbours(x, j), 0..stride, residual);
            for (residual, b) in residual[1..stride - 1].iter_mut().zip(&row(b, j, stride)[1..stride - 1]) {
                *residual = b - *residual;
            }
        });
        // A held node has the residual zero: it is no unknown.
        let held = residual
            .iter_mut()
            .zip(x.iter().zip(bound))
            .filter(|(r, (x, bound))| (**r >= 0.0 && x >= bound) || (**r <= 0.0 && **x <= 0.0));
        held.for_each(|(residual, _)| *residual = 0.0);
        if dot(&residual, &residual).sqrt() <= limit {
            return iterations;
        }
        iterations += improve(a, stride, &mut residual, bound, x, 0.3 * limit);
        x.iter_mut().zip(bound).for_each(|(x, bound)| *x = x.clamp(0.0, *bound));
    }
    panic!("no set of held nodes was found in {} changes", MOST[0]);
}

/// Conjugate gradients on the nodes that are between their ends or have a residual.
fn improve(a: &Stencil, stride: usize, residual: &mut [f64], bound: &[f64], x: &mut [f64], limit: f64) -> usize {
    let free: Vec<f64> = residual
        .iter()
        .zip(x.iter().zip(bound))
        .map(|(r, (x, bound))| f64::from(u8::from(*r != 0.0 || (x < bound && *x > 0.0))))
        .collect();
    let free_of_row = |j: usize| -> Range<usize> {
        let row = row(&free, j, stride);
        let first = row.iter().position(|free| *free > 0.0).unwrap_or(0);
        first..row.iter().rposition(|free| *free > 0.0).map_or(0, |last| last + 1)
    };
    let rows: Vec<(usize, Range<usize>)> = (0..free.len() / stride).map(|j| (j, free_of_row(j))).collect();
    let rows: Vec<(usize, Range<usize>)> = rows.into_iter().filter(|(_, columns)| !columns.is_empty()).collect();
    let places = || rows.iter().map(|(j, columns)| j * stride + columns.start..j * stride + columns.end);
    let product_of = |p: &[f64], q: &[f64]| places().map(|place| dot(&p[place.clone()], &q[place])).sum::<f64>();
    let mut direction = residual.to_vec();
    let mut product = vec![0.0; residual.len()];
    let mut squared = product_of(residual, residual);
    let mut iterations = 0;
    while squared.sqrt() > limit && iterations < MOST[1] {
        for (j, columns) in &rows {
            let of_row = j * stride..(j + 1) * stride;
            let product = &mut product[of_row.clone()];
            a.multiply_row(*j, a.neighbours(&direction, *j), columns.clone(), product);
            product[columns.clone()].iter_mut().zip(&free[of_row][columns.clone()]).for_each(|(p, free)| *p *= free);
        }
        let alpha = squared / product_of(&direction, &product);
        for place in places().flatten() {
            x[place] += alpha * direction[place];
            residual[place] -= alpha * product[place];
        }
        let next = product_of(residual, residual);
        let beta = next / squared;
        places().flatten().for_each(|place| direction[place] = residual[place] + beta * direction[place]);
        squared = next;
        iterations += 1;
    }
    iterations
}
