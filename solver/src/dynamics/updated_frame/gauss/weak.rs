//! Control points that hold little of a body: solved for exactly within the preconditioner.
//!
//! Where the boundary cuts spans, or points have just left them, only the penalty ties the outermost control
//! values to their neighbours, as a continuation of degree p whose condition no diagonal mends. With w those
//! weak control points and s the others, the preconditioner is the block factorisation
//!
//! ```text
//! z_w = W⁻¹ r_w,      z_s = P⁻¹ (r_s − A_sw z_w),      z_w ← W⁻¹ (r_w − A_ws z_s),      W = A_ww
//! ```
//!
//! W is a thin ring along the boundary: a band matrix in the order of a breadth-first search.

use std::collections::VecDeque;

use super::kronecker::BandFactor;
use super::penalty::Penalty;
use crate::linear_algebra::stencil::Stencil;

/// No weak control point.
const NONE: u32 = u32::MAX;

/// The weak control points of a system, and the factor of their block.
#[derive(Debug, Clone, Default)]
pub(crate) struct Weak {
    /// Control points, in the order of the band matrix.
    pub nodes: Vec<usize>,
    factor: BandFactor,
    /// Couplings with others: start of each row, control point, value.
    starts: Vec<usize>,
    couplings: Vec<(usize, f64)>,
    values: Vec<f64>,
}

impl Weak {
    /// Factors the block of some control points.
    pub(crate) fn new(nodes: &[usize], matrix: &Stencil, penalty: &Penalty, weight: f64) -> Self {
        let (grid, reach) = (matrix.grid, matrix.degree()[0].max(matrix.degree()[1]) as isize + 1);
        let side = (2 * reach + 1) as usize;
        let mut number = vec![NONE; grid.len()];
        nodes.iter().enumerate().for_each(|(i, &at)| number[at] = i as u32);
        let mut rows = vec![0.0; nodes.len() * side * side];
        for (row, &at) in rows.chunks_mut(side * side).zip(nodes) {
            for dy in -reach + 1..reach {
                for dx in -reach + 1..reach {
                    row[((dy + reach) * (2 * reach + 1) + dx + reach) as usize] = matrix.entry(at, dx, dy);
                }
            }
        }
        penalty.for_each_pair(weight, |at, dx, dy, value| {
            if number[at] != NONE {
                let index = (dy + reach) * (2 * reach + 1) + dx + reach;
                rows[number[at] as usize * side * side + index as usize] += value;
            }
        });
        let there = |at: usize, index: usize| {
            let (dx, dy) = ((index % side) as isize - reach, (index / side) as isize - reach);
            at.wrapping_add_signed(dy * grid.stride as isize + dx)
        };
        let order = breadth_first(nodes, &rows, side, &number, there);
        let mut place = vec![0; nodes.len()];
        order.iter().enumerate().for_each(|(i, &old)| place[old] = i);
        let entries = |old: usize| {
            let row = &rows[old * side * side..][..side * side];
            row.iter().enumerate().filter(|(_, v)| **v != 0.0).map(move |(index, v)| (there(nodes[old], index), *v))
        };
        let mut width = 0;
        for (i, &old) in order.iter().enumerate() {
            for (at, _) in entries(old).filter(|(at, _)| number[*at] != NONE) {
                width = width.max(i.saturating_sub(place[number[at] as usize]));
            }
        }
        let mut weak =
            Self { nodes: order.iter().map(|&old| nodes[old]).collect(), starts: vec![0], ..Self::default() };
        let mut band = BandFactor::zeros(width, nodes.len());
        for (i, &old) in order.iter().enumerate() {
            for (at, value) in entries(old) {
                if number[at] == NONE {
                    weak.couplings.push((at, value));
                } else if place[number[at] as usize] <= i {
                    band.set(i, place[number[at] as usize], value);
                }
            }
            weak.starts.push(weak.couplings.len());
        }
        weak.factor = band.factored();
        weak.values = vec![0.0; nodes.len()];
        weak
    }

    /// `z_w = W⁻¹ r_w`, and `z_s = r_s − A_sw z_w`.
    pub(crate) fn eliminate(&mut self, r: &[f64], z: &mut [f64]) {
        let Self { nodes, factor, starts, couplings, values } = self;
        z.copy_from_slice(r);
        values.iter_mut().zip(&*nodes).for_each(|(value, &at)| *value = r[at]);
        factor.solve_line(values);
        for (i, value) in values.iter().enumerate() {
            couplings[starts[i]..starts[i + 1]].iter().for_each(|&(at, coupling)| z[at] -= coupling * value);
        }
    }

    /// `z_w = W⁻¹ (r_w − A_ws z_s)`.
    pub(crate) fn substitute(&mut self, r: &[f64], z: &mut [f64]) {
        let Self { nodes, factor, starts, couplings, values } = self;
        for (i, value) in values.iter_mut().enumerate() {
            let known: f64 = couplings[starts[i]..starts[i + 1]].iter().map(|&(at, coupling)| coupling * z[at]).sum();
            *value = r[nodes[i]] - known;
        }
        factor.solve_line(values);
        nodes.iter().zip(values).for_each(|(&at, value)| z[at] = *value);
    }
}

/// Order of a breadth-first search along couplings, component by component.
fn breadth_first(
    nodes: &[usize],
    rows: &[f64],
    side: usize,
    number: &[u32],
    there: impl Fn(usize, usize) -> usize,
) -> Vec<usize> {
    let mut order = Vec::with_capacity(nodes.len());
    let mut seen = vec![false; nodes.len()];
    let mut queue = VecDeque::new();
    for start in 0..nodes.len() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        queue.push_back(start);
        while let Some(node) = queue.pop_front() {
            order.push(node);
            let row = &rows[node * side * side..][..side * side];
            for index in (0..side * side).filter(|&index| row[index] != 0.0) {
                let next = number[there(nodes[node], index)];
                if next != NONE && !seen[next as usize] {
                    seen[next as usize] = true;
                    queue.push_back(next as usize);
                }
            }
        }
    }
    order
}
