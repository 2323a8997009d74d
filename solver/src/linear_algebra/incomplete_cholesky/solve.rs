//! Solves with the factor of a block of rows: `L z = S r`, then `Lᵀ x = D⁻¹ z`.
//!
//! Couplings with other rows are summed for many neighbours side by side. Along a row each value waits for
//! the one before it, so the rows of two blocks, which do not depend on each other, go side by side.

use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::lane::{LANES, Lane, Scalar, Vectorised, add_product};
use crate::linear_algebra::stencil::Offset;
use crate::linear_algebra::terms::Terms;

/// A block of rows of the factor, with the right-hand side `r` and the solution `out`.
pub(super) struct SolveBlock<'a, T> {
    pub grid: ControlGrid,
    pub offsets: &'a [Offset],
    pub active: &'a ActiveColumns,
    /// First row of the block.
    pub first: usize,
    pub factor: &'a [f32],
    pub scale: Option<&'a [f32]>,
    /// Couplings of the rows now at hand.
    pub terms: Terms,
    pub r: &'a [T],
    pub out: &'a mut [T],
}

/// Two blocks; the second may have no rows.
pub(super) struct SolvePair<'a, T>(pub [SolveBlock<'a, T>; 2]);

/// Values along a part of a row, each of which takes from the P before it.
struct Recurrence<'a, T, const P: usize> {
    coefficients: [&'a [f32]; P],
    values: &'a mut [T],
    last: [T; P],
}

impl<T: Scalar, const P: usize> Recurrence<'_, T, P> {
    /// The next value: number n from the left, or from the right.
    #[inline(always)]
    fn step<const FMA: bool, const FORWARD: bool>(&mut self, n: usize) {
        let at = if FORWARD { n } else { self.values.len() - 1 - n };
        let mut value = self.values[at];
        for index in (0..P).rev() {
            let coefficient = -T::from(self.coefficients[index][at]);
            value = add_product::<FMA, _>(value, coefficient, self.last[index]);
        }
        self.values[at] = value;
        self.last.copy_within(0..P - 1, 1);
        self.last[0] = value;
    }
}

/// One or two recurrences to their ends.
#[inline(always)]
fn run_along<const FMA: bool, const FORWARD: bool, T: Scalar, const P: usize>(parts: [Option<Recurrence<T, P>>; 2]) {
    let (mut one, from) = match parts {
        [Some(mut a), Some(mut b)] => {
            let common = a.values.len().min(b.values.len());
            for n in 0..common {
                a.step::<FMA, FORWARD>(n);
                b.step::<FMA, FORWARD>(n);
            }
            (if a.values.len() > common { a } else { b }, common)
        }
        [Some(one), None] | [None, Some(one)] => (one, 0),
        [None, None] => return,
    };
    for n in from..one.values.len() {
        one.step::<FMA, FORWARD>(n);
    }
}

impl<T: Scalar> SolveBlock<'_, T> {
    #[inline(always)]
    fn rows(&self) -> usize {
        self.r.len() / self.grid.stride
    }

    #[inline(always)]
    fn start(&self, row: usize, offset: usize) -> usize {
        (row * self.offsets.len() + offset) * self.grid.stride
    }

    /// What earlier rows take from a row of `S r`, or later ones from one of `D⁻¹ z`.
    #[inline(always)]
    fn across<const FMA: bool, const FORWARD: bool, const P: usize>(&mut self, row: usize) {
        let (grid, active, rows) = (self.grid, self.active, self.rows());
        if row >= rows {
            return;
        }
        let last = self.offsets.last().map_or(0, |offset| offset.rows);
        let reach = if FORWARD { [row.min(last), 0] } else { [0, (rows - 1 - row).min(last)] };
        if self.terms.begin(reach) {
            let [stride, row_length] = [1, self.offsets.len()].map(|lines| (lines * grid.stride) as isize);
            for (index, offset) in self.offsets.iter().enumerate().skip(P + 1) {
                let (coefficients, rows) = (index as isize * stride, offset.rows as isize);
                if offset.rows <= reach[0] {
                    let there = -rows * stride - offset.columns;
                    self.terms.push(coefficients - rows * row_length - offset.columns, there);
                } else if offset.rows <= reach[1] {
                    self.terms.push(coefficients, (rows - 1) * stride + offset.columns);
                }
            }
        }
        let (stride, pivots) = (grid.stride, self.start(row, 0));
        let (before, rest) = self.out.split_at_mut(row * stride);
        let (out, after) = rest.split_at_mut(stride);
        for range in active.row(self.first + row) {
            let (at, used) = (grid.index(range.start, 0), range.len());
            let sums = &mut out[at..];
            if FORWARD {
                let here = row * stride + at;
                sums[..used].copy_from_slice(&self.r[here..][..used]);
                if let Some(scale) = self.scale {
                    sums[..used].iter_mut().zip(&scale[here..]).for_each(|(sum, scale)| *sum = *sum * T::from(*scale));
                }
            } else {
                sums[..used]
                    .iter_mut()
                    .zip(&self.factor[pivots + at..])
                    .for_each(|(sum, pivot)| *sum = *sum * T::from(*pivot));
            }
            let values = if FORWARD { (&*before, row * stride + at) } else { (&*after, at) };
            self.terms.add::<FMA, true, T, f32>(sums, used, (self.factor, pivots + at), values);
        }
    }

    /// Along range number n of a row, counted from the left or from the right.
    #[inline(always)]
    fn along<const FORWARD: bool, const P: usize>(&mut self, row: usize, n: usize) -> Option<Recurrence<'_, T, P>> {
        if row >= self.rows() {
            return None;
        }
        let ranges = self.active.row(self.first + row);
        let range = if FORWARD { ranges.get(n) } else { ranges.iter().rev().nth(n) }?;
        let (first, length, stride) = (self.grid.index(range.start, 0), range.len(), self.grid.stride);
        let start = self.start(row, 0);
        let out = &mut self.out[row * stride..][..stride];
        let mut last = [T::ZERO; P];
        for (n, last) in last.iter_mut().enumerate() {
            *last = if FORWARD { out[first - 1 - n] } else { out[first + length + n] };
        }
        let mut coefficients: [&[f32]; P] = [&[]; P];
        for (index, coefficients) in coefficients.iter_mut().enumerate() {
            let coupling = start + (index + 1) * stride + first;
            *coefficients = &self.factor[if FORWARD { coupling - index - 1 } else { coupling }..][..length];
        }
        Some(Recurrence { coefficients, values: &mut out[first..][..length], last })
    }

    /// `r · out`, after the scale is taken off both.
    #[inline(always)]
    fn finish<const FMA: bool>(&mut self) -> f64 {
        if let Some(scale) = self.scale {
            self.out.iter_mut().zip(scale).for_each(|(out, scale)| *out = *out * T::from(*scale));
        }
        let stride = self.grid.stride;
        let mut total = 0.0;
        for (r, out) in self.r.chunks(stride).zip(self.out.chunks(stride)) {
            let mut product = Lane::ZERO;
            for at in (0..stride).step_by(LANES) {
                product = product.add_product::<FMA>(Lane::load(r, at), Lane::load(out, at));
            }
            total += product.sum().into();
        }
        total
    }
}

impl<T: Scalar> SolvePair<'_, T> {
    #[inline(always)]
    fn row<const FMA: bool, const FORWARD: bool, const P: usize>(&mut self, row: usize) {
        let [a, b] = &mut self.0;
        a.across::<FMA, FORWARD, P>(row);
        b.across::<FMA, FORWARD, P>(row);
        for n in 0.. {
            let parts = [a.along::<FORWARD, P>(row, n), b.along::<FORWARD, P>(row, n)];
            if parts.iter().all(Option::is_none) {
                break;
            }
            run_along::<FMA, FORWARD, T, P>(parts);
        }
    }

    #[inline(always)]
    fn solve<const FMA: bool, const P: usize>(mut self) -> f64 {
        let rows = self.0[0].rows();
        for row in 0..rows {
            self.row::<FMA, true, P>(row);
        }
        for row in (0..rows).rev() {
            self.row::<FMA, false, P>(row);
        }
        let [a, b] = &mut self.0;
        a.finish::<FMA>() + b.finish::<FMA>()
    }
}

impl<T: Scalar> Vectorised for SolvePair<'_, T> {
    type Output = f64;

    #[inline(always)]
    fn run<const FMA: bool>(self) -> f64 {
        match self.0[0].offsets.iter().take_while(|o| o.rows == 0).count() {
            2 => self.solve::<FMA, 1>(),
            3 => self.solve::<FMA, 2>(),
            4 => self.solve::<FMA, 3>(),
            _ => self.solve::<FMA, 4>(),
        }
    }
}
