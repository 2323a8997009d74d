//! Sums over the couplings of a row of control points, for several neighbours at a time.

use super::lane::{LANES, Lane, Scalar};

/// Most couplings of a control point: those of quartic splines.
const MOST: usize = 81;

/// Batches of neighbours that are summed together when so many neighbours are left: as many as keep four
/// vector registers of 32 bytes busy.
#[inline(always)]
pub(super) fn batches<T>(left: usize) -> usize {
    if size_of::<T>() == 4 && left > 3 * LANES {
        4
    } else if left > LANES {
        2
    } else {
        1
    }
}

/// Where the coefficients of each coupling, and the values they are multiplied by, begin.
pub(super) struct Terms {
    starts: [(usize, usize); MOST],
    count: usize,
}

impl Terms {
    /// No couplings.
    #[inline(always)]
    pub(super) fn none() -> Self {
        Self { starts: [(0, 0); MOST], count: 0 }
    }

    /// Adds a coupling.
    #[inline(always)]
    pub(super) fn push(&mut self, coefficients: usize, values: usize) {
        self.starts[self.count] = (coefficients, values);
        self.count += 1;
    }

    /// `sums ± Σ coefficient · value`, in the order of the couplings, for N batches of neighbours from `at`
    /// on. Several sums at once keep the arithmetic units busy, where one would wait for itself.
    #[inline(always)]
    pub(super) fn add<const FMA: bool, const MINUS: bool, const N: usize, T: Scalar>(
        &self,
        mut sums: [Lane<T>; N],
        coefficients: &[T],
        values: &[T],
        at: usize,
    ) -> [Lane<T>; N] {
        for &(coefficient, value) in &self.starts[..self.count] {
            for n in 0..N {
                let factor = Lane::load(coefficients, coefficient.wrapping_add(at) + n * LANES);
                let factor = if MINUS { factor.map(|factor| -factor) } else { factor };
                sums[n] = sums[n].add_product::<FMA>(factor, Lane::load(values, value.wrapping_add(at) + n * LANES));
            }
        }
        sums
    }
}
