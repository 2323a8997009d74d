//! Sums over the couplings of a row of control points, for several neighbours at a time.

use super::lane::{LANES, Lane};

/// Most couplings of a control point: those of quartic splines.
const MOST: usize = 81;

/// Numbers that are read eight at a time.
pub(super) trait Coefficients {
    /// Eight neighbours.
    fn lane(&self, at: usize) -> Lane;
}

impl Coefficients for [f64] {
    #[inline(always)]
    fn lane(&self, at: usize) -> Lane {
        Lane::load(self, at)
    }
}

impl Coefficients for [f32] {
    #[inline(always)]
    fn lane(&self, at: usize) -> Lane {
        Lane::load_single(self, at)
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
    pub(super) fn add<const FMA: bool, const MINUS: bool, const N: usize, C: Coefficients + ?Sized>(
        &self,
        mut sums: [Lane; N],
        coefficients: &C,
        values: &[f64],
        at: usize,
    ) -> [Lane; N] {
        for &(coefficient, value) in &self.starts[..self.count] {
            for n in 0..N {
                let factor = coefficients.lane(coefficient.wrapping_add(at) + n * LANES);
                let factor = if MINUS { factor * -1.0 } else { factor };
                sums[n] = sums[n].add_product::<FMA>(factor, Lane::load(values, value.wrapping_add(at) + n * LANES));
            }
        }
        sums
    }
}
