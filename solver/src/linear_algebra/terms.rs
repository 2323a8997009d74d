//! Sums over the couplings of a row of control points.
//!
//! A few couplings at a time go along the whole row: memory delivers a few long streams faster than many that
//! take turns, and the sums stay in the nearest cache.

use super::control_grid::MAX_DEGREE;
use super::lane::{LANES, Lane, Scalar, each};

/// Most couplings of a control point: those of two splines of the highest degree.
const MOST: usize = (2 * MAX_DEGREE + 1) * (2 * MAX_DEGREE + 1);
/// Couplings that go along a row together.
const TOGETHER: usize = 5;

/// Where the coefficients of each coupling of a row, and the values they are multiplied by, begin: relative
/// to the row, so that rows with as many rows before and after them have the same.
pub(super) struct Terms {
    starts: [(isize, isize); MOST],
    count: usize,
    /// Rows before and after that count.
    rows: [usize; 2],
}

impl Terms {
    /// No couplings, of no row.
    pub(super) fn none() -> Self {
        Self { starts: [(0, 0); MOST], count: 0, rows: [usize::MAX; 2] }
    }

    /// Whether they are not those of a row with that many before and after it; then none is left.
    #[inline(always)]
    pub(super) fn begin(&mut self, rows: [usize; 2]) -> bool {
        let other = self.rows != rows;
        if other {
            self.rows = rows;
            self.count = 0;
        }
        other
    }

    /// Adds a coupling, given by where its coefficients and its values begin, relative to the row.
    #[inline(always)]
    pub(super) fn push(&mut self, coefficients: isize, values: isize) {
        self.starts[self.count] = (coefficients, values);
        self.count += 1;
    }

    /// `sums ± Σ coefficient · value`, in the order of the couplings, for `used` neighbours; coefficients and
    /// values with the place of the first. All fields have room for reading to the end of a batch, and sums
    /// behind the last become zero.
    #[inline(always)]
    pub(super) fn add<const FMA: bool, const MINUS: bool, T: Scalar + From<C>, C: Copy>(
        &self,
        sums: &mut [T],
        used: usize,
        (coefficients, coefficient_at): (&[C], usize),
        (values, value_at): (&[T], usize),
    ) {
        let length = used.next_multiple_of(LANES);
        let part = |n: usize| {
            let (coefficient, value) = self.starts[n];
            let first = coefficient_at.wrapping_add_signed(coefficient);
            (&coefficients[first..][..length], &values[value_at.wrapping_add_signed(value)..][..length])
        };
        let sums = &mut sums[..length];
        let mut n = 0;
        while n + TOGETHER <= self.count {
            add_some::<FMA, MINUS, TOGETHER, T, C>(sums, used, each!(k in [0, 1, 2, 3, 4] => part(n + k)));
            n += TOGETHER;
        }
        for n in n..self.count {
            add_some::<FMA, MINUS, 1, T, C>(sums, used, [part(n)]);
        }
    }
}

/// N couplings along a row.
#[inline(always)]
fn add_some<const FMA: bool, const MINUS: bool, const N: usize, T: Scalar + From<C>, C: Copy>(
    sums: &mut [T],
    used: usize,
    parts: [(&[C], &[T]); N],
) {
    let whole = used - used % LANES;
    let mut at = 0;
    while at < whole {
        let sum = add_batch::<FMA, MINUS, N, T, C>(sums, &parts, at);
        sums[at..at + LANES].copy_from_slice(&sum.0);
        at += LANES;
    }
    if whole < used {
        let mut sum = add_batch::<FMA, MINUS, N, T, C>(sums, &parts, whole);
        for l in 0..LANES {
            sum.0[l] = if whole + l < used { sum.0[l] } else { T::ZERO };
        }
        sums[whole..whole + LANES].copy_from_slice(&sum.0);
    }
}

#[inline(always)]
fn add_batch<const FMA: bool, const MINUS: bool, const N: usize, T: Scalar + From<C>, C: Copy>(
    sums: &[T],
    parts: &[(&[C], &[T]); N],
    at: usize,
) -> Lane<T> {
    let mut sum = Lane::load(sums, at);
    for (coefficients, values) in parts {
        let mut factor = Lane::<T>::load_from(coefficients, at);
        if MINUS {
            factor = factor.map(|factor| -factor);
        }
        sum = sum.add_product::<FMA>(factor, Lane::load(values, at));
    }
    sum
}
